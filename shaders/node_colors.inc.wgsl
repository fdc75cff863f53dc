// Colors of a node's points: their own, or filtered ones.

@group(0) @binding(9) var<storage, read> filtered_colors: array<u32>;

fn color_of(id: u32) -> u32 {
    if (id & ID_ODD) != 0u {
        return filtered_colors[id >> ID_SHIFT];
    }
    return colors[id >> ID_SHIFT];
}

// Ids to colors, one eye, one chunk of the pool a dispatch. [2022 §3.3]

@group(0) @binding(4) var<storage, read> colors: array<u32>;
@group(0) @binding(5) var<storage, read> filtered_colors: array<u32>;
@group(0) @binding(6) var<uniform> chunk: ChunkUniform;

// Writes a pixel's point `id` at depth `w`, in bits; EMPTY_DEPTH if there is no point.
fn show(pixel: u32, w: u32, id: u32) {
    if w == EMPTY_DEPTH {
        surface[pixel] = vec2<u32>(EMPTY_DEPTH, 0u);
        return;
    }
    let point = (id >> ID_SHIFT) - chunk.first_index;
    if point < chunk.num_points {
        if (id & ID_ODD) != 0u {
            surface[pixel] = vec2<u32>(w, filtered_colors[point]);
        } else {
            surface[pixel] = vec2<u32>(w, colors[point]);
        }
    }
}

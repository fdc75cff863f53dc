// Colors of discs: the mean of what they stand for.

fn color_of(id: u32) -> u32 {
    return colors[id >> 1u];
}

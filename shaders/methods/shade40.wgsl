// resolve, first step of `fixed40`: writes the pixel's color, and clears the target for the next frame. [2019 §2.1]

@group(0) @binding(2) var<storage, read_write> keys40: array<u64>;

fn finish(pixel: u32) {
    let key = keys40[pixel];
    keys40[pixel] = EMPTY_KEY;
    let depth40 = key >> DEPTH40_SHIFT;
    if depth40 == EMPTY40 {
        surface[pixel] = vec2<u32>(EMPTY_DEPTH, 0u);
        return;
    }
    let color = (u32(key) & RGB_MASK) | OPAQUE;
    surface[pixel] = vec2<u32>(bitcast<u32>(f32(depth_of(depth40))) & ~REACH_MASK, color);
}

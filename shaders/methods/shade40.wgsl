// resolve, first step of `fixed40`: the pixel's color, and the target is ready for the next frame. [2019 §2.1]

@group(0) @binding(2) var<storage, read_write> keys: array<u64>;

fn finish(pixel: u32) {
    let key = keys[pixel];
    keys[pixel] = 0xfffffffffffffffflu;
    let depth40 = key >> 24u;
    if depth40 == EMPTY40 {
        surface[pixel] = vec2<u32>(EMPTY_DEPTH, 0u);
        return;
    }
    surface[pixel] = vec2<u32>(bitcast<u32>(f32(depth_of(depth40))) & ~REACH_MASK, u32(key & 0xfffffflu) | 0xff000000u);
}

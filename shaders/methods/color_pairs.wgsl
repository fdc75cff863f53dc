// color in the first form of high-quality shading: sums of 32 bits, two to a 64-bit addition. [2021 §3.5]

@group(0) @binding(10) var<storage, read_write> wide_left: array<atomic<u64>>;
@group(0) @binding(11) var<storage, read_write> wide_right: array<atomic<u64>>;

fn add_pair(eye: u32, at: u32, first: u32, second: u32) {
    let pair = u64(first) | (u64(second) << PAIR_SHIFT);
    if eye == 0u {
        atomicAdd(&wide_left[at], pair);
    } else {
        atomicAdd(&wide_right[at], pair);
    }
}

fn put(eye: u32, pixel: u32, w: f32, id: u32) {
    if counts(eye, pixel, w) {
        let color = color_of(id);
        add_pair(eye, 2u * pixel, color & CHANNEL_MASK, (color >> GREEN_SHIFT) & CHANNEL_MASK);
        add_pair(eye, 2u * pixel + 1u, (color >> BLUE_SHIFT) & CHANNEL_MASK, 1u);
    }
}

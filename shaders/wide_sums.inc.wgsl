// Sums in four u32 a pixel.

@group(0) @binding(10) var<storage, read_write> wide_left: array<atomic<u32>>;
@group(0) @binding(11) var<storage, read_write> wide_right: array<atomic<u32>>;

fn add_wide(eye: u32, pixel: u32, color: u32) {
    let rgb = vec3<u32>(color, color >> GREEN_SHIFT, color >> BLUE_SHIFT) & vec3<u32>(CHANNEL_MASK);
    let first = 4u * pixel;
    if eye == 0u {
        atomicAdd(&wide_left[first], rgb.r);
        atomicAdd(&wide_left[first + 1u], rgb.g);
        atomicAdd(&wide_left[first + 2u], rgb.b);
        atomicAdd(&wide_left[first + 3u], 1u);
    } else {
        atomicAdd(&wide_right[first], rgb.r);
        atomicAdd(&wide_right[first + 1u], rgb.g);
        atomicAdd(&wide_right[first + 2u], rgb.b);
        atomicAdd(&wide_right[first + 3u], 1u);
    }
}

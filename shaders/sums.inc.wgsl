// What both forms of `color` share: which points count, and sums in four u32 a pixel.

@group(0) @binding(6) var<storage, read> depth_left: array<u32>;
@group(0) @binding(7) var<storage, read> depth_right: array<u32>;
@group(0) @binding(8) var<storage, read> colors: array<u32>;
@group(0) @binding(10) var<storage, read_write> wide_left: array<atomic<u32>>;
@group(0) @binding(11) var<storage, read_write> wide_right: array<atomic<u32>>;

fn counts(eye: u32, pixel: u32, w: f32) -> bool {
    count_look();
    var nearest: u32;
    if eye == 0u {
        nearest = depth_left[pixel];
    } else {
        nearest = depth_right[pixel];
    }
    let is_near = w <= SURFACE_TOLERANCE * bitcast<f32>(nearest);
    if is_near {
        count_color();
    }
    return is_near;
}

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

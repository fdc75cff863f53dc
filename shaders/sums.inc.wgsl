// What both forms of `color` share: which points count, and sums in four u32 a pixel.

@group(0) @binding(6) var<storage, read> depth_left: array<u32>;
@group(0) @binding(7) var<storage, read> depth_right: array<u32>;
@group(0) @binding(8) var<storage, read> colors: array<u32>;
@group(0) @binding(10) var<storage, read_write> wide_left: array<atomic<u32>>;
@group(0) @binding(11) var<storage, read_write> wide_right: array<atomic<u32>>;

fn counts(w: f32, nearest: u32) -> bool {
    return w <= SURFACE_TOLERANCE * bitcast<f32>(nearest);
}

fn add_wide_left(pixel: u32, color: u32) {
    atomicAdd(&wide_left[4u * pixel], color & 255u);
    atomicAdd(&wide_left[4u * pixel + 1u], (color >> 8u) & 255u);
    atomicAdd(&wide_left[4u * pixel + 2u], (color >> 16u) & 255u);
    atomicAdd(&wide_left[4u * pixel + 3u], 1u);
}

fn add_wide_right(pixel: u32, color: u32) {
    atomicAdd(&wide_right[4u * pixel], color & 255u);
    atomicAdd(&wide_right[4u * pixel + 1u], (color >> 8u) & 255u);
    atomicAdd(&wide_right[4u * pixel + 2u], (color >> 16u) & 255u);
    atomicAdd(&wide_right[4u * pixel + 3u], 1u);
}

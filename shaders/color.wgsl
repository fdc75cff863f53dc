// color: adds up, in each pixel, the colors of the points within the tolerance of the nearest. [2021 §3.5,
// 2022 §3.6] Sums are integers, so their order does not matter.

@group(0) @binding(6) var<storage, read> depth_left: array<u32>;
@group(0) @binding(7) var<storage, read> depth_right: array<u32>;
@group(0) @binding(8) var<storage, read> colors: array<u32>;
@group(0) @binding(9) var<storage, read> filtered_colors: array<u32>;
@group(0) @binding(10) var<storage, read_write> sums_left: array<atomic<u64>>;
@group(0) @binding(11) var<storage, read_write> sums_right: array<atomic<u64>>;
@group(0) @binding(12) var<storage, read_write> wide_left: array<atomic<u32>>;
@group(0) @binding(13) var<storage, read_write> wide_right: array<atomic<u32>>;

fn color_of(id: u32) -> u32 {
    if (id & 1u) != 0u {
        return filtered_colors[id >> 1u];
    }
    return colors[id >> 1u];
}

fn counts(w: f32, nearest: u32) -> bool {
    return w <= DEPTH_TOLERANCE * bitcast<f32>(nearest);
}

// Count in 10 bits, red, green, blue in 18 each.
fn packed(color: u32) -> u64 {
    return 1lu | (u64(color & 255u) << 10u) | (u64((color >> 8u) & 255u) << 28u)
        | (u64((color >> 16u) & 255u) << 46u);
}

// Count, red, green, blue in 16 bits each.
fn protected_form(color: u32) -> u64 {
    return 1lu | (u64(color & 255u) << 16u) | (u64((color >> 8u) & 255u) << 32u)
        | (u64((color >> 16u) & 255u) << 48u);
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

fn put_left(pixel: u32, w: f32, id: u32) {
    if !counts(w, depth_left[pixel]) {
        return;
    }
    let color = color_of(id);
    if SUMS == PACKED {
        atomicAdd(&sums_left[pixel], packed(color));
        return;
    }
    if (atomicLoad(&sums_left[pixel]) & 0xfffflu) < u64(PROTECTED_POINTS) {
        let before = atomicAdd(&sums_left[pixel], protected_form(color));
        if (before & 0xfffflu) < u64(PROTECTED_POINTS) {
            return;
        }
        // Others were faster: take it back.
        atomicSub(&sums_left[pixel], protected_form(color));
    }
    add_wide_left(pixel, color);
}

fn put_right(pixel: u32, w: f32, id: u32) {
    if !counts(w, depth_right[pixel]) {
        return;
    }
    let color = color_of(id);
    if SUMS == PACKED {
        atomicAdd(&sums_right[pixel], packed(color));
        return;
    }
    if (atomicLoad(&sums_right[pixel]) & 0xfffflu) < u64(PROTECTED_POINTS) {
        let before = atomicAdd(&sums_right[pixel], protected_form(color));
        if (before & 0xfffflu) < u64(PROTECTED_POINTS) {
            return;
        }
        // Others were faster: take it back.
        atomicSub(&sums_right[pixel], protected_form(color));
    }
    add_wide_right(pixel, color);
}

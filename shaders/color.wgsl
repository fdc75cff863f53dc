// color: adds up, in each pixel, the colors of the points within the tolerance of the nearest. [2021 §3.5,
// 2022 §3.6] Sums are integers, so their order does not matter.

@group(0) @binding(12) var<storage, read_write> sums_left: array<atomic<u64>>;
@group(0) @binding(13) var<storage, read_write> sums_right: array<atomic<u64>>;

// The color as packed sums: count in 10 bits, red, green, blue in 18 each.
fn packed(color: u32) -> u64 {
    return 1lu | (u64(color & CHANNEL_MASK) << PACKED_RED_SHIFT)
        | (u64((color >> GREEN_SHIFT) & CHANNEL_MASK) << PACKED_GREEN_SHIFT)
        | (u64((color >> BLUE_SHIFT) & CHANNEL_MASK) << PACKED_BLUE_SHIFT);
}

// The color as protected sums: count, red, green, blue in 16 bits each.
fn protected_form(color: u32) -> u64 {
    return 1lu | (u64(color & CHANNEL_MASK) << PROTECTED_RED_SHIFT)
        | (u64((color >> GREEN_SHIFT) & CHANNEL_MASK) << PROTECTED_GREEN_SHIFT)
        | (u64((color >> BLUE_SHIFT) & CHANNEL_MASK) << PROTECTED_BLUE_SHIFT);
}

fn num_points_in(eye: u32, pixel: u32) -> u64 {
    if eye == 0u {
        return atomicLoad(&sums_left[pixel]) & u64(PROTECTED_MASK);
    }
    return atomicLoad(&sums_right[pixel]) & u64(PROTECTED_MASK);
}

// Adds to a pixel's sums and returns what they were before.
fn add(eye: u32, pixel: u32, sum: u64) -> u64 {
    if eye == 0u {
        return atomicAdd(&sums_left[pixel], sum);
    }
    return atomicAdd(&sums_right[pixel], sum);
}

fn put(eye: u32, pixel: u32, w: f32, id: u32) {
    if !counts(eye, pixel, w) {
        return;
    }
    let color = color_of(id);
    if SUMS == PACKED {
        add(eye, pixel, packed(color));
        return;
    }
    if num_points_in(eye, pixel) < u64(PROTECTED_POINTS) {
        let before = add(eye, pixel, protected_form(color));
        if (before & u64(PROTECTED_MASK)) < u64(PROTECTED_POINTS) {
            return;
        }
        // Other threads were faster, so the sum is taken back. Unsigned addition wraps.
        add(eye, pixel, 0lu - protected_form(color));
    }
    add_wide(eye, pixel, color);
}

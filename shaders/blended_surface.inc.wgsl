// The surface in `hqs` quality: nearest depths, and sums to colors. [2021 §3.5]

@group(0) @binding(2) var<storage, read> depth: array<u32>;
@group(0) @binding(4) var<storage, read> sums: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> wide: array<vec4<u32>>;

// Packed sums: bits of green in the low word.
const GREEN_LOW_BITS: u32 = 32u - PACKED_GREEN_SHIFT;
// Packed sums: place of blue in the high word.
const HIGH_BLUE_SHIFT: u32 = PACKED_BLUE_SHIFT - 32u;
// Packed sums: bits of green in the high word.
const HIGH_GREEN_MASK: u32 = (1u << HIGH_BLUE_SHIFT) - 1u;
// Packed sums: bits of a channel.
const PACKED_CHANNEL_MASK: u32 = (1u << (PACKED_GREEN_SHIFT - PACKED_RED_SHIFT)) - 1u;

// Red, green, blue and count of a pixel; the low word of a u64 comes first.
fn sum_of(pixel: u32) -> vec4<u32> {
    if SUMS == WIDE {
        return wide[pixel];
    }
    let sum = sums[pixel];
    if SUMS == PACKED {
        let red = (sum.x >> PACKED_RED_SHIFT) & PACKED_CHANNEL_MASK;
        let green = (sum.x >> PACKED_GREEN_SHIFT) | ((sum.y & HIGH_GREEN_MASK) << GREEN_LOW_BITS);
        return vec4<u32>(red, green, sum.y >> HIGH_BLUE_SHIFT, sum.x & PACKED_COUNT_MASK);
    }
    // The high half of either word begins at red's place.
    let shift = PROTECTED_RED_SHIFT;
    let first = vec4<u32>(sum.x >> shift, sum.y & PROTECTED_MASK, sum.y >> shift, sum.x & PROTECTED_MASK);
    if first.w < PROTECTED_POINTS {
        return first;
    }
    return first + wide[pixel];
}

fn surface_depth(pixel: u32) -> u32 {
    return depth[pixel];
}

// The blend of a pixel that has a depth. The nearest point itself counts, so there is at least one.
fn surface_color(pixel: u32) -> u32 {
    let sum = sum_of(pixel);
    var rgb = mean(sum, vec4<u32>(sum.w)).xyz;
    if SUMS != PACKED && sum.w >= MAX_MEAN_COUNT {
        rgb = (sum.xyz + sum.w / 2u) / sum.w;
    }
    return rgb.x | (rgb.y << GREEN_SHIFT) | (rgb.z << BLUE_SHIFT) | OPAQUE;
}

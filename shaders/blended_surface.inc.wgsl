// The surface in `hqs` quality: nearest depths, and sums to colors. [2021 §3.5]

@group(0) @binding(2) var<storage, read> depth: array<u32>;
@group(0) @binding(4) var<storage, read> sums: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> wide: array<vec4<u32>>;

// Red, green, blue, count; the low word of a u64 comes first.
fn sum_of(pixel: u32) -> vec4<u32> {
    if SUMS == WIDE || SUMS == PAIRS {
        return wide[pixel];
    }
    let sum = sums[pixel];
    if SUMS == PACKED {
        let green = (sum.x >> 28u) | ((sum.y & 0x3fffu) << 4u);
        return vec4<u32>((sum.x >> 10u) & 0x3ffffu, green, sum.y >> 14u, sum.x & 0x3ffu);
    }
    let first = vec4<u32>(sum.x >> 16u, sum.y & 0xffffu, sum.y >> 16u, sum.x & 0xffffu);
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
    return rgb.x | (rgb.y << 8u) | (rgb.z << 16u) | 0xff000000u;
}

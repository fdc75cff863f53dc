// resolve, first step in `hqs` quality: sums to colors, one eye. [2021 §3.5] A workgroup a tile that somebody sees.

@group(0) @binding(0) var<uniform> resolve: ResolveUniform;
@group(0) @binding(1) var<storage, read> tiles: array<u32>;
@group(0) @binding(2) var<storage, read> depth: array<u32>;
@group(0) @binding(3) var<storage, read> sums: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> wide: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read_write> surface: array<vec2<u32>>;

// Red, green, blue, count; the low word of a u64 comes first.
fn sum_of(pixel: u32) -> vec4<u32> {
    if SUMS == WIDE {
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

@compute @workgroup_size(TILE_PX, TILE_PX)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
) {
    let number = group.y * groups.x + group.x;
    if number >= arrayLength(&tiles) {
        return;
    }
    let tile = tiles[number];
    let x = (tile & 0xffffu) * TILE_PX + local.x;
    let y = (tile >> 16u) * TILE_PX + local.y;
    if x >= resolve.size_px.x || y >= resolve.size_px.y {
        return;
    }
    let pixel = y * resolve.size_px.x + x;
    let w = depth[pixel];
    if w == EMPTY_DEPTH {
        surface[pixel] = vec2<u32>(EMPTY_DEPTH, resolve.background);
        return;
    }
    // The nearest point itself counts, so there is at least one.
    let sum = sum_of(pixel);
    let rgb = (sum.xyz + sum.w / 2u) / sum.w;
    surface[pixel] = vec2<u32>(w, rgb.x | (rgb.y << 8u) | (rgb.z << 16u) | 0xff000000u);
}

// resolve, first step in `closest` quality: ids to colors, one eye, one chunk of the pool a dispatch.
// [2022 §3.3] A workgroup a tile that somebody sees.

@group(0) @binding(0) var<uniform> resolve: ResolveUniform;
@group(0) @binding(1) var<storage, read> tiles: array<u32>;
// Depth and id: the two words of a u64, or two buffers.
@group(0) @binding(2) var<storage, read> depth: array<u32>;
@group(0) @binding(3) var<storage, read> ids: array<u32>;
@group(0) @binding(4) var<storage, read> colors: array<u32>;
@group(0) @binding(5) var<storage, read> filtered_colors: array<u32>;
@group(0) @binding(6) var<storage, read_write> surface: array<vec2<u32>>;

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
    var w: u32;
    var id: u32;
    if KEYS {
        w = depth[2u * pixel + 1u];
        id = depth[2u * pixel];
    } else {
        w = depth[pixel];
        id = ids[pixel];
    }
    if w == EMPTY_DEPTH {
        surface[pixel] = vec2<u32>(EMPTY_DEPTH, resolve.background);
        return;
    }
    let point = (id >> 1u) - resolve.first_index;
    if point < resolve.num_points {
        if (id & 1u) != 0u {
            surface[pixel] = vec2<u32>(w, filtered_colors[point]);
        } else {
            surface[pixel] = vec2<u32>(w, colors[point]);
        }
    }
}

// resolve, first step in `closest` quality: ids to colors, one eye, one chunk of the pool a dispatch.
// [2022 §3.3]

// Depth and id: the two words of a u64, or two buffers.
@group(0) @binding(2) var<storage, read> depth: array<u32>;
@group(0) @binding(3) var<storage, read> ids: array<u32>;
@group(0) @binding(4) var<storage, read> colors: array<u32>;
@group(0) @binding(5) var<storage, read> filtered_colors: array<u32>;
@group(0) @binding(6) var<uniform> chunk: ChunkUniform;

fn finish(pixel: u32) {
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
        surface[pixel] = vec2<u32>(EMPTY_DEPTH, 0u);
        return;
    }
    let point = (id >> 1u) - chunk.first_index;
    if point < chunk.num_points {
        if (id & 1u) != 0u {
            surface[pixel] = vec2<u32>(w, filtered_colors[point]);
        } else {
            surface[pixel] = vec2<u32>(w, colors[point]);
        }
    }
}

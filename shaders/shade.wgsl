// resolve, first step in `closest` quality: ids to colors.

// Depth and id: the two words of a u64, or two buffers.
@group(0) @binding(2) var<storage, read> depth: array<u32>;
@group(0) @binding(3) var<storage, read> ids: array<u32>;

fn finish(pixel: u32) {
    if KEYS {
        show(pixel, depth[2u * pixel + 1u], depth[2u * pixel]);
    } else {
        show(pixel, depth[pixel], ids[pixel]);
    }
}

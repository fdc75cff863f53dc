// depth, `closest` quality, the tier without 64-bit atomics, second dispatch: the smallest id among the points at each
// pixel's nearest depth. docs/FRAME.md §7.

@group(0) @binding(5) var<uniform> chunk: ChunkUniform;
@group(0) @binding(6) var<storage, read> depth_left: array<u32>;
@group(0) @binding(7) var<storage, read> depth_right: array<u32>;
@group(0) @binding(8) var<storage, read_write> ids_left: array<atomic<u32>>;
@group(0) @binding(9) var<storage, read_write> ids_right: array<atomic<u32>>;

fn put(eye: u32, pixel: u32, w: f32, id: u32) {
    if eye == 0u {
        if bitcast<u32>(w) == depth_left[pixel] {
            atomicMin(&ids_left[pixel], (chunk.first_index << ID_SHIFT) + id);
        }
    } else if bitcast<u32>(w) == depth_right[pixel] {
        atomicMin(&ids_right[pixel], (chunk.first_index << ID_SHIFT) + id);
    }
}

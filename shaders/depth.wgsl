// depth, `closest` quality: the nearest point of each pixel, as depth ≪ 32 | id.

@group(0) @binding(5) var<uniform> chunk: ChunkUniform;
@group(0) @binding(6) var<storage, read_write> keys_left: array<atomic<u64>>;
@group(0) @binding(7) var<storage, read_write> keys_right: array<atomic<u64>>;

fn key_of(w: f32, id: u32) -> u64 {
    return (u64(bitcast<u32>(w)) << 32u) | u64(2u * chunk.first_index + id);
}

// Early-z: a plain look first, since most points lie behind one that is already there. [2022 §3.2]
fn put_left(pixel: u32, w: f32, id: u32) {
    let key = key_of(w, id);
    if key < atomicLoad(&keys_left[pixel]) {
        atomicMin(&keys_left[pixel], key);
    }
}

fn put_right(pixel: u32, w: f32, id: u32) {
    let key = key_of(w, id);
    if key < atomicLoad(&keys_right[pixel]) {
        atomicMin(&keys_right[pixel], key);
    }
}

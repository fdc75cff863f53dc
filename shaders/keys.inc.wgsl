// The targets of `closest` quality: in each pixel the smallest depth ≪ 32 | id. WGSL cannot pass a buffer to a
// function, so these functions choose the eye's buffer; their callers pass the eye as a constant.

@group(0) @binding(5) var<uniform> chunk: ChunkUniform;
@group(0) @binding(6) var<storage, read_write> keys_left: array<atomic<u64>>;
@group(0) @binding(7) var<storage, read_write> keys_right: array<atomic<u64>>;

alias Key = u64;

fn key_of(w: f32, id: u32) -> Key {
    return (u64(bitcast<u32>(w)) << KEY_DEPTH_SHIFT) | u64((chunk.first_index << ID_SHIFT) + id);
}

fn key_in(eye: u32, pixel: u32) -> Key {
    if eye == 0u {
        return atomicLoad(&keys_left[pixel]);
    }
    return atomicLoad(&keys_right[pixel]);
}

fn min_key(eye: u32, pixel: u32, key: Key) {
    if eye == 0u {
        atomicMin(&keys_left[pixel], key);
    } else {
        atomicMin(&keys_right[pixel], key);
    }
}

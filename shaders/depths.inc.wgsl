// Stands in for keys.inc.wgsl where a pixel's depth has a buffer of its own: in `hqs` quality, and in the tier without
// 64-bit atomics, in which `ids` comes after. A key is the depth alone.

@group(0) @binding(6) var<storage, read_write> depth_left: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> depth_right: array<atomic<u32>>;

alias Key = u32;

fn key_of(w: f32, id: u32) -> Key {
    return bitcast<u32>(w);
}

fn key_in(eye: u32, pixel: u32) -> Key {
    if eye == 0u {
        return atomicLoad(&depth_left[pixel]);
    }
    return atomicLoad(&depth_right[pixel]);
}

fn min_key(eye: u32, pixel: u32, key: Key) {
    if eye == 0u {
        atomicMin(&depth_left[pixel], key);
    } else {
        atomicMin(&depth_right[pixel], key);
    }
}

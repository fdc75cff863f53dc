// busy-loop: a thread waits until nobody has the pixel locked, locks it, writes, and unlocks it; [2013],
// with their early-z. [2021 §2.2, §5]
//
// A pixel's depth is its lock: it reads LOCKED while a thread writes the id, and writing the new depth unlocks it. The
// whole of it stands inside the loop: a thread that holds a lock comes to its end while threads beside it, of the same
// subgroup, go round. WGSL promises neither that, nor that a thread which sees the new depth sees the new id; drivers
// keep both as far as tests can tell. `exchange-loop` needs neither.

@group(0) @binding(5) var<uniform> chunk: ChunkUniform;
/// Two words a pixel: id, depth.
@group(0) @binding(6) var<storage, read_write> keys_left: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> keys_right: array<atomic<u32>>;

/// A depth that no point has: points lie beyond the near plane.
const LOCKED: u32 = 0u;

fn depth_in(eye: u32, pixel: u32) -> u32 {
    if eye == 0u {
        return atomicLoad(&keys_left[2u * pixel + 1u]);
    }
    return atomicLoad(&keys_right[2u * pixel + 1u]);
}

// True if the pixel still had the depth that was seen, and is this thread's now.
fn lock(eye: u32, pixel: u32, seen: u32) -> bool {
    if eye == 0u {
        return atomicCompareExchangeWeak(&keys_left[2u * pixel + 1u], seen, LOCKED).exchanged;
    }
    return atomicCompareExchangeWeak(&keys_right[2u * pixel + 1u], seen, LOCKED).exchanged;
}

// Writes the id of a point; the smallest id stays if depths are equal.
fn write_id(eye: u32, pixel: u32, id: u32, is_nearer: bool) {
    if eye == 0u {
        if is_nearer {
            atomicStore(&keys_left[2u * pixel], id);
        } else {
            atomicMin(&keys_left[2u * pixel], id);
        }
    } else if is_nearer {
        atomicStore(&keys_right[2u * pixel], id);
    } else {
        atomicMin(&keys_right[2u * pixel], id);
    }
}

fn unlock(eye: u32, pixel: u32, depth: u32) {
    if eye == 0u {
        atomicStore(&keys_left[2u * pixel + 1u], depth);
    } else {
        atomicStore(&keys_right[2u * pixel + 1u], depth);
    }
}

fn put(eye: u32, pixel: u32, w: f32, id: u32) {
    let depth = bitcast<u32>(w);
    var waits = true;
    while waits {
        let seen = depth_in(eye, pixel);
        if seen != LOCKED {
            if seen < depth {
                waits = false;
            } else if lock(eye, pixel, seen) {
                write_id(eye, pixel, (chunk.first_index << ID_SHIFT) + id, depth < seen);
                unlock(eye, pixel, depth);
                waits = false;
            }
        }
    }
}

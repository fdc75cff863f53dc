// busy-loop: without 64-bit minima a thread tries until nobody comes between its look and its exchange, or somebody
// nearer was there before it; Günther et al. 2013, with their early-z. [2021 §5]
//
// They lock a pixel, write depth and color, and unlock it. A thread that spins on another's lock may wait for a thread
// of its own subgroup, which WGSL does not promise to run; exchanging both words at once needs no lock.

// Puts the key there if `seen` still is; what is there then.
fn exchange_key(eye: u32, pixel: u32, seen: u64, key: u64) -> u64 {
    if eye == 0u {
        let result = atomicCompareExchangeWeak(&keys_left[pixel], seen, key);
        return select(result.old_value, key, result.exchanged);
    }
    let result = atomicCompareExchangeWeak(&keys_right[pixel], seen, key);
    return select(result.old_value, key, result.exchanged);
}

fn put(eye: u32, pixel: u32, w: f32, id: u32) {
    let key = key_of(w, id);
    var seen = key_in(eye, pixel);
    while key < seen {
        seen = exchange_key(eye, pixel, seen, key);
    }
}

// exchange-loop: busy-loop without a lock. A thread tries until no other comes between its look and its exchange, or
// until a nearer point is there. Depth and id change at once, so no thread waits for another.

// Writes the key if `seen` is still there, and returns what is there then.
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

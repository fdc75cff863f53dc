// dedup: for each pixel that a subgroup has, only the threads with the smallest depth ask; points that lie behind one
// which is already there do not take part. [2021 §3.4, §5: "also includes an early-z test"]

fn put(eye: u32, pixel: u32, w: f32, id: u32) {
    let depth = bitcast<u32>(w);
    let key = key_of(w, id);
    var asks = false;
    if pixel != NO_PIXEL {
        asks = may_win(eye, pixel, key);
    }
    let least = least_of_same(select(NO_PIXEL, pixel, asks), depth);
    if asks && depth == least {
        min_key(eye, pixel, key);
    }
}

// reduce, reduce-early-z: if a subgroup has only one pixel, the thread with the smallest depth asks for it; if only a
// pair of threads shares one, the nearer of the two does. [2021 §3.3]

fn put(eye: u32, pixel: u32, w: f32, id: u32) {
    let depth = bitcast<u32>(w);
    let of_all = least_if_same(pixel, depth);
    let of_pair = vec2<u32>(neighbors(pixel), neighbors(depth));
    let least = min(of_all, select(depth, of_pair.y, of_pair.x == pixel));
    if pixel == NO_PIXEL || depth > least {
        return;
    }
    // All threads of equal depths ask: the smallest id wins, as always.
    let key = key_of(w, id);
    if !EARLY_Z || may_win(eye, pixel, key) {
        min_key(eye, pixel, key);
    }
}

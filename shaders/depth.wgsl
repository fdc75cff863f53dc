// depth: the nearest point of each pixel, or the nearest depth. Early-z is a plain look before the atomic, since most
// points lie behind one that is already there. [2021 §3.2, 2022 §3.2]

fn put(eye: u32, pixel: u32, w: f32, id: u32) {
    let key = key_of(w, id);
    if may_win(eye, pixel, key) {
        min_key(eye, pixel, key);
    }
}

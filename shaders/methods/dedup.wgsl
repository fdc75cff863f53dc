// dedup: of each pixel that a subgroup has, the threads with the smallest depth ask. [2021 §3.4]

fn put(eye: u32, pixel: u32, w: f32, id: u32) {
    let depth = bitcast<u32>(w);
    let least = least_of_same(pixel, depth);
    if pixel != NO_PIXEL && depth == least {
        min_key(eye, pixel, key_of(w, id));
    }
}

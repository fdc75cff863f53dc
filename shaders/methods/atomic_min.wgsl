// atomic-min: every point asks for its pixel. [2021 §3.1]

fn put(eye: u32, pixel: u32, w: f32, id: u32) {
    min_key(eye, pixel, key_of(w, id));
}

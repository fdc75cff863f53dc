// Puts a point into its pixel, if it has one.

fn put_seen(eye: u32, pixel: u32, w: f32, id: u32) {
    if pixel != NO_PIXEL {
        put(eye, pixel, w, id);
    }
}

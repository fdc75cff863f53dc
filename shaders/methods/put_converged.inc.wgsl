// Puts a point into its pixel, if it has one. All threads of a workgroup come to `put` together, since they ask each
// other there; those without a point have the pixel NO_PIXEL.

fn put_seen(eye: u32, pixel: u32, w: f32, id: u32) {
    put(eye, pixel, w, id);
}

// A point in its pixel, if it has one: all threads of a workgroup come to `put` together, for they ask each other there. The
// pixel of those without a point is NO_PIXEL.

fn put_seen(eye: u32, pixel: u32, w: f32, id: u32) {
    put(eye, pixel, w, id);
}

// The point of a turn, in its pixel. All threads of a workgroup come to `put` together, for they ask each other there: the
// pixel of those without a point is NO_PIXEL.

fn put_seen(eye: u32, pixel: u32, w: f32, id: u32) {
    put(eye, pixel, w, id);
}

fn put_turn(eye: u32, p: Projected, id: vec4<u32>) {
    put_seen(eye, p.pixel.x, p.w.x, id.x);
    count_point();
}

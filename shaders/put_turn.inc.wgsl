// The points of a turn, each in its pixel.

fn put_seen(eye: u32, pixel: u32, w: f32, id: u32) {
    if pixel != NO_PIXEL {
        put(eye, pixel, w, id);
    }
}

fn put_turn(eye: u32, p: Projected, id: vec4<u32>) {
    put_seen(eye, p.pixel.x, p.w.x, id.x);
    count_point();
    put_seen(eye, p.pixel.y, p.w.y, id.y);
    count_point();
    put_seen(eye, p.pixel.z, p.w.z, id.z);
    count_point();
    put_seen(eye, p.pixel.w, p.w.w, id.w);
    count_point();
}

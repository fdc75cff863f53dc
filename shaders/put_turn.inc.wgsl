// Puts the points of a turn into their pixels.

fn put_turn(eye: u32, p: Projected, id: vec4<u32>) {
    put_seen(eye, p.pixel.x, p.w.x, id.x);
    put_seen(eye, p.pixel.y, p.w.y, id.y);
    put_seen(eye, p.pixel.z, p.w.z, id.z);
    put_seen(eye, p.pixel.w, p.w.w, id.w);
}

// Puts the one point of a turn into its pixel.

fn put_turn(eye: u32, p: Projected, id: vec4<u32>) {
    put_seen(eye, p.pixel.x, p.w.x, id.x);
}

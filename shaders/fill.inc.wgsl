// How far a point reaches to close a square `open_px` pixels wide: by the kernel of dilation, and by a splat.

// The narrowest kernel of dilation that closes a square, 1 to 3.
fn reach_of(open_px: f32) -> u32 {
    return 1u + select(0u, 1u, open_px > view.fill_reach_px.x) + select(0u, 1u, open_px > view.fill_reach_px.y);
}

// How far a splat reaches round its own pixel, to close what the widest kernel leaves open.
fn radius_of(open_px: f32) -> f32 {
    return ceil(clamp(0.5 * (open_px - view.fill_reach_px.z), 0.0, f32(MAX_FILL_RADIUS)));
}

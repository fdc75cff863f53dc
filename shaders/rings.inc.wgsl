// The rings round the gaze, for pixels and for points.

// A square that grows with x on both sides of 0, so that cosines compare without the root that a direction's length
// needs.
fn signed_square(x: f32) -> f32 {
    return x * abs(x);
}

// The ring that a direction lies in: 0 inner, 1 middle, 2 outer; `along` is its part along the gaze.
fn ring_of(along: f32, length_sq: f32) -> u32 {
    let along_sq = signed_square(along);
    let outer = select(2u, 1u, along_sq >= signed_square(view.ring_cos.y) * length_sq);
    return select(outer, 0u, along_sq >= signed_square(view.ring_cos.x) * length_sq);
}

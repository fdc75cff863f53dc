//! CPU reference of `rings.inc.wgsl`: the rings round the gaze, for pixels and for points.

use render::layout::ViewUniform;

/// The ring that a direction lies in: 0 inner, 1 middle, 2 outer; `along` is its part along the gaze.
#[must_use]
pub fn ring(view: &ViewUniform, along: f32, length_sq: f32) -> usize {
    let inside = |cos: f32| signed_square(along) >= signed_square(cos) * length_sq;
    match view.ring_cos.map(inside) {
        [true, _] => 0,
        [false, true] => 1,
        [false, false] => 2,
    }
}

/// x·|x|, which grows with x on both sides of 0: cosines compare without the root that a direction's length needs.
fn signed_square(x: f32) -> f32 {
    x * x.abs()
}

//! Twin of the tolerance in `steps.inc.wgsl` and `cull`: the length that a point tree may be wrong by, by the distance from
//! an eye and the angle from its gaze.

use render::layout::{EyeUniform, ViewUniform};

/// At a place relative to the eye.
#[must_use]
pub fn of(view: &ViewUniform, eye: &EyeUniform, [x, y, z]: [f32; 3]) -> f32 {
    let gaze = eye.gaze_in_head;
    let distance = (x * x + y * y + z * z).sqrt();
    let along = x * gaze[0] + y * gaze[1] + z * gaze[2];
    let [inner, middle] = view.ring_cos;
    let outside = (inner * distance - along).max(0.0).min((inner - middle) * distance);
    eye.tolerance_rad * distance + eye.tolerance_growth * outside
}

/// Radians that it spans in the outer ring.
#[must_use]
pub fn outer_rad(view: &ViewUniform, eye: &EyeUniform) -> f32 {
    eye.tolerance_rad + eye.tolerance_growth * (view.ring_cos[0] - view.ring_cos[1])
}

/// The most that it grows by on a way of length 1.
#[must_use]
pub fn steepest(view: &ViewUniform, eye: &EyeUniform) -> f32 {
    let [inner, middle] = view.ring_cos;
    let steepness = (inner * inner + 1.0 - 2.0 * inner * middle).max(0.0).sqrt();
    (eye.tolerance_rad + eye.tolerance_growth * steepness).max(outer_rad(view, eye))
}

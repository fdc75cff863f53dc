//! CPU reference of the tolerance in `spt/steps.inc.wgsl` and `spt/cull.wgsl`: the length that a point tree may be
//! wrong by, at a distance from an eye and an angle from its gaze.

use crate::technique::tree::TreeUniform;
use render::layout::ViewUniform;

/// Tolerance of eye number `eye` at a place relative to it.
#[must_use]
pub fn of(view: &ViewUniform, tree: &TreeUniform, eye: usize, [x, y, z]: [f32; 3]) -> f32 {
    let gaze = view.eyes[eye].gaze_in_head;
    let distance = (x * x + y * y + z * z).sqrt();
    let along = x * gaze[0] + y * gaze[1] + z * gaze[2];
    let [inner, middle] = view.ring_cos;
    let outside = (inner * distance - along).max(0.0).min((inner - middle) * distance);
    tree.tolerance_rad[eye] * distance + tree.tolerance_growth[eye] * outside
}

/// Angle that the tolerance spans in the outer ring, radians.
#[must_use]
pub fn outer_rad(view: &ViewUniform, tree: &TreeUniform, eye: usize) -> f32 {
    tree.tolerance_rad[eye] + tree.tolerance_growth[eye] * (view.ring_cos[0] - view.ring_cos[1])
}

/// The most that the tolerance grows by over a length of 1.
#[must_use]
pub fn steepest(view: &ViewUniform, tree: &TreeUniform, eye: usize) -> f32 {
    let [inner, middle] = view.ring_cos;
    let steepness = (inner * inner + 1.0 - 2.0 * inner * middle).max(0.0).sqrt();
    (tree.tolerance_rad[eye] + tree.tolerance_growth[eye] * steepness).max(outer_rad(view, tree, eye))
}

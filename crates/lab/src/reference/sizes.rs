//! CPU reference of `sizes.inc.wgsl`: the nearest depth in a box, which projected sizes go by.

use render::layout::{EyeUniform, ViewUniform};

/// The least depth that visible points of a box can have, at least that of the near plane. `reach` is how far the box
/// reaches along the optical axis from its center.
pub(super) fn nearest_depth(
    view: &ViewUniform,
    eye: &EyeUniform,
    center: [f32; 3],
    half_edge: [f32; 3],
    reach: f32,
) -> f32 {
    let axis = eye.row_w;
    let middle = axis[0] * center[0] + axis[1] * center[1] + axis[2] * center[2] + axis[3];
    let gap: [f32; 3] =
        std::array::from_fn(|i| ((center[i] - eye.eye_in_head[i]).abs() - half_edge[i]).max(0.0));
    let distance = (gap[0] * gap[0] + gap[1] * gap[1] + gap[2] * gap[2]).sqrt();
    (middle - reach).max(eye.widest_cos * distance).max(view.near)
}

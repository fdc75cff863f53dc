// The projected size of boxes, by their depth, for `lod` and `cull`.

// The least depth of the points of a box that the eye sees; at least near, since nothing nearer is drawn. `reach` is
// how far the box reaches along the optical axis from its center. The terms are added in the CPU reference's order.
fn nearest_depth(eye: EyeUniform, center: vec3<f32>, half_edge: vec3<f32>, reach: f32) -> f32 {
    let axis = eye.row_w;
    let middle = axis.x * center.x + axis.y * center.y + axis.z * center.z + axis.w;
    let gap = max(abs(center - eye.eye_in_head) - half_edge, vec3<f32>(0.0));
    let distance = sqrt(gap.x * gap.x + gap.y * gap.y + gap.z * gap.z);
    return max(max(middle - reach, eye.widest_cos * distance), view.near);
}

// Which boxes an eye sees.

fn is_seen(eye: EyeUniform, center: vec3<f32>, half_edge: vec3<f32>) -> bool {
    return in_frustum(eye, center, half_edge);
}

// Hardware points as the papers draw them: from vertices of their own, straight into the image. `bench` measures
// against them. [2022 §4.1, GL_POINTS]
//
// Depth is near / w, compared with "greater": the far plane is infinite, and floats are dense far away.

@group(0) @binding(0) var<uniform> clip_from_cloud: mat4x4<f32>;

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat, either) color: vec4<f32>,
}

@vertex
fn vertex(@location(0) p_in_cloud: vec3<f32>, @location(1) color: vec4<f32>) -> Vertex {
    return Vertex(clip_from_cloud * vec4<f32>(p_in_cloud, 1.0), color);
}

@fragment
fn fragment(point: Vertex) -> @location(0) vec4<f32> {
    return point.color;
}

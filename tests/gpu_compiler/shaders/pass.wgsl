// A full-screen pass with every kind of resource that a pass of ours may have; it writes color and depth.
struct Target {
    @location(0) color: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@group(0) @binding(0) var<uniform> width: vec4<u32>;
@group(0) @binding(1) var<storage, read> colors: array<u32>;
@group(1) @binding(0) var image: texture_2d<f32>;
@group(1) @binding(1) var filtering: sampler;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> Target {
    let color = unpack4x8unorm(colors[u32(position.y) * width.x + u32(position.x)]);
    let seen = textureSampleLevel(image, filtering, position.xy / f32(width.x), 0.0);
    return Target(color * seen, color.a);
}

// resolve: point indices to colours, one eye, one chunk of the pool a pass. [2022 §3.3]
//
// Colours are stored sRGB-encoded and the target encodes what it is given, so they are decoded here: the
// image ends up with the stored bytes. A pixel without a point of this chunk stays as it is.

@group(0) @binding(0) var<uniform> resolve: ResolveUniform;
@group(0) @binding(1) var<storage, read> depth: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read> colors: array<u32>;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    // One triangle that covers the image.
    return vec4<f32>(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn linear_from_srgb(c: vec3<f32>) -> vec3<f32> {
    return select(pow((c + 0.055) / 1.055, vec3<f32>(2.4)), c / 12.92, c <= vec3<f32>(0.04045));
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = depth[u32(position.y) * resolve.width + u32(position.x)];
    // Index in the low word, depth in the high one. An empty pixel's index is beyond every chunk.
    let index = pixel.x - resolve.first_index;
    if pixel.y == EMPTY_DEPTH || index >= resolve.num_points {
        discard;
    }
    return vec4<f32>(linear_from_srgb(unpack4x8unorm(colors[index]).rgb), 1.0);
}

// resolve, for the runtime's reprojection: an eye's depths to its depth image, near / w, or 0, infinitely far, where
// nothing is. Only a pass that draws can write a depth image.

@group(0) @binding(0) var<uniform> resolve: ResolveUniform;
@group(0) @binding(1) var<storage, read> image_depth: array<u32>;
@group(0) @binding(2) var<uniform> view: ViewUniform;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    // One triangle that covers the image.
    return vec4<f32>(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @builtin(frag_depth) f32 {
    let w = image_depth[u32(position.y) * image_pitch_px(resolve.size_px.x) + u32(position.x)];
    return select(view.near / bitcast<f32>(w), 0.0, w == EMPTY_DEPTH);
}

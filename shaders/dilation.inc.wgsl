// The rule of dilation (docs/FRAME.md §6), which `dilate` applies by rows and columns. Resources of one eye.

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> dilate: DilateUniform;

// How far the kernel of the pixel in this column and row reaches: 1, 2, 3 by the ring that its center lies in. The
// terms are added in the CPU reference's order.
fn radius_px(eye: EyeUniform, x: i32, y: i32) -> u32 {
    let gaze = eye.gaze_in_view;
    let right = eye.tangent_origin.x + eye.tangent_per_px.x * (f32(x) + eye.first_px.x + 0.5);
    let up = eye.tangent_origin.y + eye.tangent_per_px.y * (f32(y) + eye.first_px.y + 0.5);
    return 1u + ring_of(right * gaze.x + up * gaze.y - gaze.z, right * right + up * up + 1.0);
}

// The farthest depth of the surface whose nearest is given; 0, which no point has, if there is none.
fn surface_end(nearest: vec4<u32>) -> vec4<u32> {
    let end = bitcast<vec4<u32>>(SURFACE_TOLERANCE * bitcast<vec4<f32>>(nearest));
    return select(end, vec4<u32>(0u), nearest == vec4<u32>(EMPTY_DEPTH));
}

// The rule of dilation (frame.md section 6), which `dilate` applies by rows and columns. Resources of one eye, row by
// row: .x is the linear depth's bits, EMPTY_DEPTH where there is nothing; .y the stored colour, r | g≪8 | b≪16 | a≪24.

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> dilate: DilateUniform;
@group(0) @binding(2) var<storage, read> surface: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read_write> image: array<vec2<u32>>;

const EMPTY: vec2<u32> = vec2<u32>(EMPTY_DEPTH, 0u);
const OPAQUE: u32 = 0xff000000u;

// How far the kernel of the pixel in this column and row reaches: 1, 2, 3 by the ring that its centre lies in. The terms are added in the
// twin's order.
fn radius_px(x: i32, y: i32) -> u32 {
    if dilate.radius_px != 0u {
        return dilate.radius_px;
    }
    let gaze = view.eyes[dilate.eye].gaze_in_view;
    let origin = view.eyes[dilate.eye].tangent_origin;
    let per_px = view.eyes[dilate.eye].tangent_per_px;
    let first = view.eyes[dilate.eye].first_px;
    let right = origin.x + per_px.x * (f32(x) + first.x + 0.5);
    let up = origin.y + per_px.y * (f32(y) + first.y + 0.5);
    return 1u + ring_of(right * gaze.x + up * gaze.y - gaze.z, right * right + up * up + 1.0);
}

// The farthest depth of the surface whose nearest is given; 0, which no point has, if there is none.
fn surface_end(nearest: vec4<u32>) -> vec4<u32> {
    let end = bitcast<vec4<u32>>(SURFACE_TOLERANCE * bitcast<vec4<f32>>(nearest));
    return select(end, vec4<u32>(0u), nearest == vec4<u32>(EMPTY_DEPTH));
}

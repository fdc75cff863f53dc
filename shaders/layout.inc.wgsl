// Structs shared with the host: crates/render/src/layout, which documents every field. Offsets are compared by a test.

struct GpuBatch {
    min_hi: vec3<f32>,
    first_point: u32,
    min_lo: vec3<f32>,
    num_points: u32,
    cell: vec3<f32>,
    node: u32,
    steps_per_unit: vec3<f32>,
    reserved: u32,
}

struct GpuNode {
    min_hi: vec3<f32>,
    edge: f32,
    min_lo: vec3<f32>,
    flags: u32,
    spacing: vec4<u32>,
    children: array<u32, 8>,
    level: u32,
    sample_spacing: f32,
    spacing_step: f32,
    reserved: u32,
}

struct EyeUniform {
    row_x: vec4<f32>,
    row_y: vec4<f32>,
    row_w: vec4<f32>,
    eye_in_head: vec3<f32>,
    pixels_per_radian: f32,
    gaze_in_head: vec3<f32>,
    widest_cos: f32,
    gaze_in_view: vec3<f32>,
    reserved: f32,
    tangent_origin: vec2<f32>,
    tangent_per_px: vec2<f32>,
    first_px: vec2<f32>,
    end_px: vec2<f32>,
    width: u32,
    height: u32,
    reserved_end: vec2<u32>,
}

struct ViewUniform {
    head_hi: vec3<f32>,
    near: f32,
    head_lo: vec3<f32>,
    forced_planes: u32,
    threshold_px: vec3<f32>,
    flags: u32,
    ring_cos: vec2<f32>,
    ring_sin: vec2<f32>,
    fill_reach_px: vec3<f32>,
    margin_px: f32,
    undivided_px: vec3<f32>,
    reserved: f32,
    eyes: array<EyeUniform, 2>,
}

struct VisibleBatch {
    head_cell: vec3<i32>,
    first_point: u32,
    offset: vec3<f32>,
    num_points: u32,
    cell: vec3<f32>,
    flags: u32,
    spacing: vec4<u32>,
    own: vec2<u32>,
    drawn: u32,
    spacing_step: f32,
    sample_spacing: f32,
    reserved: u32,
    reserved_end: vec2<u32>,
}

struct ChunkUniform {
    first_index: u32,
    num_points: u32,
    reserved: vec2<u32>,
}

struct ClearUniform {
    value: u32,
    num_left: u32,
    num_right: u32,
    reserved: u32,
}

struct ResolveUniform {
    size_px: vec2<u32>,
    background: u32,
    is_bgra: u32,
}

struct DilateUniform {
    eye: u32,
}

// Number of the slice that this is, among those of its batch.
fn slice_of(batch: VisibleBatch) -> u32 {
    return (batch.flags >> SLICE_SHIFT) & (MAX_SLICES - 1u);
}

fn num_slices_of(batch: VisibleBatch) -> u32 {
    return ((batch.flags >> NUM_SLICES_SHIFT) & (MAX_SLICES - 1u)) + 1u;
}

// The size of an eye's image with its guard band.
fn guarded(size_px: vec2<u32>) -> vec2<u32> {
    return size_px + 2u * GUARD_PX;
}

// Pixels from a row of a finished image to the next.
fn image_pitch_px(width: u32) -> u32 {
    return (width + IMAGE_PITCH_PX - 1u) / IMAGE_PITCH_PX * IMAGE_PITCH_PX;
}

// Structs of sequential point trees shared with the host: crates/lab/src/technique/tree.rs, which documents every
// field.

struct Run {
    behind: vec4<f32>,
    flags: u32,
    reserved: u32,
    reserved_end: vec2<u32>,
}

struct DiscBatch {
    min_hi: vec3<f32>,
    first_point: u32,
    min_lo: vec3<f32>,
    num_points: u32,
    cell: vec3<f32>,
    run: u32,
    steps_per_unit: vec3<f32>,
    interval: u32,
}

struct TreeUniform {
    tolerance_rad: vec2<f32>,
    tolerance_growth: vec2<f32>,
    step_base: u32,
    reserved: u32,
    reserved_end: vec2<u32>,
}

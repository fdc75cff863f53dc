//! The shaders' prelude: every constant of the layout as WGSL text, and what differs between variants of a text.

use super::{
    BATCH_POINTS, CHILD_ABSENT, COORDINATE_BITS, COUNT_BINS, COUNTERS_STRIDE, DILATE_FALLOFF_BITS,
    DILATE_REACH_PX, DRAWN_WHOLE, EMPTY_DEPTH, ENDLESS_STEP, FADE_BEGIN, FADE_END, FILL_OVERLAP,
    FIXED40_RANGES, GUARD_PX, HEAD_CELL_LIMIT, HEAD_CELL_STEP, HYSTERESIS, IMAGE_PITCH_PX, KEEP_UNSEEN,
    LOD_FADE, LOD_SMOOTH, MAX_EXTRA_SLICES, MAX_FILL_RADIUS, MAX_SLICES, NO_CHILD, NODE_DISCS,
    NODE_ONE_SIDED, NODE_RESIDENT, NODE_ROOT, NODE_TRIANGLES, NODE_WHOLE, NUM_SLICES_SHIFT, OWN_FILL_RADIUS,
    PLANE_BITS, POINTS_COVER, POINTS_PER_LOAD, PRECISION_THRESHOLD_PX, PROTECTED_POINTS, REACH_MASK,
    SAMPLES_COVER, SLICE_PIXELS, SLICE_SHIFT, SPACING_EXPONENT_SHIFT, STEP_SHIFT, SURFACE_TOLERANCE,
    TILE_HIDES, TILE_PX, TRIANGLE_SLACK_PX, VISIBLE_DISCS, VISIBLE_FILL, VISIBLE_TRIANGLES, VISIBLE_WIDE,
    WORKGROUP_SIZE, fixed40_firsts,
};

/// How a pixel's colors are added up. All forms give the same sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Sums {
    /// One u64: count in 10 bits, red, green, blue in 18 each: exact up to 1023 points, which a layered cloud
    /// stays below [2022 §3.6].
    Packed = 0,
    /// One u64 of four times 16 bits, and what comes after [`PROTECTED_POINTS`] in four u32 [2021 §3.5.1].
    Protected = 1,
    /// Four u32, for GPUs that cannot add 64 bits.
    Wide = 2,
    /// Two u64 of two u32 each, where [`Sums::Wide`] has its four [2021 §3.5].
    Pairs = 3,
}

/// What a shader's text is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    /// Eyes of the frame, one or two.
    pub num_eyes: u32,
    /// Points may be larger than a pixel.
    pub fill: bool,
    /// All threads of a workgroup draw wide points together.
    pub together: bool,
    /// Points may be discs of a sequential point tree, and are not samples of an octree's nodes.
    pub discs: bool,
    /// How a pixel's colors are added up.
    pub sums: Sums,
    /// Depth and id are the two words of one u64; else each has a buffer of its own.
    pub keys: bool,
    /// A thread draws one point at a time, not [`POINTS_PER_LOAD`] [2022 §3.2].
    pub basic: bool,
    /// Threads of a workgroup come to a pixel together, those without a point too.
    pub converged: bool,
    /// A pixel is looked at before it is asked for [2021 §3.2].
    pub early_z: bool,
    /// That look is a plain load, not an atomic one.
    pub plain_looks: bool,
    /// Depths are of 40 bits, made with f64 [2019 §2.1].
    pub fixed40: bool,
    /// What is done is counted: for `bench`.
    pub counts: bool,
}

impl Variant {
    /// The plainest for so many eyes.
    #[must_use]
    pub fn eyes(num_eyes: u32) -> Self {
        Self {
            num_eyes,
            fill: false,
            together: true,
            discs: false,
            sums: Sums::Packed,
            keys: true,
            basic: false,
            converged: false,
            early_z: true,
            plain_looks: false,
            fixed40: false,
            counts: false,
        }
    }
}

/// WGSL text of every constant of the layout; put in front of each shader.
#[must_use]
pub fn prelude(variant: Variant) -> String {
    let Variant { num_eyes, fill, together, discs, sums, keys, basic, converged, early_z, fixed40, .. } =
        variant;
    let sums = sums as u32;
    let [tile_width, tile_height] = TILE_PX;
    // Not every GPU knows f64: only those hear of it who use it.
    let ranges = if fixed40 { fixed40_prelude() } else { String::new() };
    format!(
        "{ranges}\
         const NUM_EYES: u32 = {num_eyes}u;\n\
         const FILL: bool = {fill};\n\
         const TOGETHER: bool = {together};\n\
         const DISCS: bool = {discs};\n\
         const SUMS: u32 = {sums}u;\n\
         const KEYS: bool = {keys};\n\
         const BASIC: bool = {basic};\n\
         const CONVERGED: bool = {converged};\n\
         const EARLY_Z: bool = {early_z};\n\
         const WORKGROUP_SIZE: u32 = {WORKGROUP_SIZE}u;\n\
         const COUNT_BINS: u32 = {COUNT_BINS}u;\n\
         const BATCH_POINTS: u32 = {BATCH_POINTS}u;\n\
         const POINTS_PER_LOAD: u32 = {POINTS_PER_LOAD}u;\n\
         const COORDINATE_BITS: u32 = {COORDINATE_BITS}u;\n\
         const PLANE_BITS: u32 = {PLANE_BITS}u;\n\
         const PRECISION_THRESHOLD_PX: f32 = {PRECISION_THRESHOLD_PX:?};\n\
         const COUNTERS_STRIDE: u32 = {COUNTERS_STRIDE}u;\n\
         const EMPTY_DEPTH: u32 = {EMPTY_DEPTH}u;\n\
         const HEAD_CELL_STEP: i32 = {HEAD_CELL_STEP};\n\
         const HEAD_CELL_LIMIT: i32 = {HEAD_CELL_LIMIT};\n\
         const PACKED: u32 = {}u;\n\
         const PROTECTED: u32 = {}u;\n\
         const WIDE: u32 = {}u;\n\
         const PAIRS: u32 = {}u;\n\
         const NODE_RESIDENT: u32 = {NODE_RESIDENT}u;\n\
         const NO_CHILD: u32 = {NO_CHILD}u;\n\
         const CHILD_ABSENT: u32 = {CHILD_ABSENT}u;\n\
         const NODE_WHOLE: u32 = {NODE_WHOLE}u;\n\
         const NODE_ROOT: u32 = {NODE_ROOT}u;\n\
         const NODE_DISCS: u32 = {NODE_DISCS}u;\n\
         const NODE_ONE_SIDED: u32 = {NODE_ONE_SIDED}u;\n\
         const NODE_TRIANGLES: u32 = {NODE_TRIANGLES}u;\n\
         const DRAWN_WHOLE: u32 = {DRAWN_WHOLE}u;\n\
         const HYSTERESIS: f32 = {HYSTERESIS:?};\n\
         const FADE_BEGIN: f32 = {FADE_BEGIN:?};\n\
         const FADE_END: f32 = {FADE_END:?};\n\
         const MAX_FILL_RADIUS: u32 = {MAX_FILL_RADIUS}u;\n\
         const OWN_FILL_RADIUS: u32 = {OWN_FILL_RADIUS}u;\n\
         const FILL_OVERLAP: f32 = {FILL_OVERLAP:?};\n\
         const POINTS_COVER: f32 = {POINTS_COVER:?};\n\
         const SAMPLES_COVER: f32 = {SAMPLES_COVER:?};\n\
         const REACH_MASK: u32 = {REACH_MASK}u;\n\
         const SPACING_EXPONENT_SHIFT: u32 = {SPACING_EXPONENT_SHIFT}u;\n\
         const PROTECTED_POINTS: u32 = {PROTECTED_POINTS}u;\n\
         const VISIBLE_FILL: u32 = {VISIBLE_FILL}u;\n\
         const VISIBLE_DISCS: u32 = {VISIBLE_DISCS}u;\n\
         const VISIBLE_TRIANGLES: u32 = {VISIBLE_TRIANGLES}u;\n\
         const VISIBLE_WIDE: u32 = {VISIBLE_WIDE}u;\n\
         const TRIANGLE_SLACK_PX: f32 = {TRIANGLE_SLACK_PX:?};\n\
         const SLICE_PIXELS: u32 = {SLICE_PIXELS}u;\n\
         const MAX_SLICES: u32 = {MAX_SLICES}u;\n\
         const MAX_EXTRA_SLICES: u32 = {MAX_EXTRA_SLICES}u;\n\
         const SLICE_SHIFT: u32 = {SLICE_SHIFT}u;\n\
         const NUM_SLICES_SHIFT: u32 = {NUM_SLICES_SHIFT}u;\n\
         const STEP_SHIFT: u32 = {STEP_SHIFT}u;\n\
         const ENDLESS_STEP: u32 = {ENDLESS_STEP}u;\n\
         const LOD_FADE: u32 = {LOD_FADE}u;\n\
         const LOD_SMOOTH: u32 = {LOD_SMOOTH}u;\n\
         const KEEP_UNSEEN: u32 = {KEEP_UNSEEN}u;\n\
         const SURFACE_TOLERANCE: f32 = {SURFACE_TOLERANCE:?};\n\
         const TILE_PX: vec2<u32> = vec2<u32>({tile_width}u, {tile_height}u);\n\
         const TILE_HIDES: u32 = {TILE_HIDES}u;\n\
         const DILATE_REACH_PX: u32 = {DILATE_REACH_PX}u;\n\
         const IMAGE_PITCH_PX: u32 = {IMAGE_PITCH_PX}u;\n\
         const GUARD_PX: u32 = {GUARD_PX}u;\n\
         const DILATE_FALLOFF_BITS: u32 = {DILATE_FALLOFF_BITS}u;\n",
        Sums::Packed as u32,
        Sums::Protected as u32,
        Sums::Wide as u32,
        Sums::Pairs as u32,
    )
}

fn fixed40_prelude() -> String {
    let names = ["A", "B", "C"].into_iter().zip(FIXED40_RANGES).zip(fixed40_firsts());
    let lines = names.map(|((name, (begin, steps)), first)| {
        format!(
            "const RANGE_{name}_BEGIN: f64 = {begin:?}lf;\n\
             const RANGE_{name}_STEPS: f64 = {steps:?}lf;\n\
             const RANGE_{name}_FIRST: u64 = {first}lu;\n"
        )
    });
    lines.collect()
}

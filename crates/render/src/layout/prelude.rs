//! The shaders' prelude: every constant of the layout as WGSL text, and what differs between variants of a text.

// Every constant, by its name.
use super::*;

/// Lines of constants that have a type of both languages, by their names.
macro_rules! constants {
    ($($type:ident $suffix:literal: $($name:ident)+;)+) => {
        concat_lines(&[$($((stringify!($name), stringify!($type), format!(concat!("{:?}", $suffix), $name)),)+)+])
    };
}

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
    // Not every GPU knows f64 or u64: only those hear of them who use them.
    let ranges = if fixed40 { fixed40_prelude() } else { String::new() };
    let constants = constants! {
        u32 "u":
            ALPHA_SHIFT BATCH_POINTS BLUE_SHIFT CHANNEL_MASK CHILD_ABSENT COARSE_CENTER COARSE_MASK
            COARSE_SHIFT COORDINATE_BITS CORNER_MASK COUNTERS_STRIDE COUNT_BINS DEPTH40_SHIFT
            DIAMETER_SHIFT DILATE_FALLOFF_BITS DILATE_REACH_PX DRAWN_WHOLE EMPTY_DEPTH ENDLESS_STEP
            GREEN_SHIFT GUARD_PX ID_ODD ID_SHIFT IMAGE_PITCH_PX KEEP_UNSEEN KEY_DEPTH_SHIFT LOD_FADE
            LOD_SMOOTH MASK_WORD_PX MAX_EXTRA_SLICES MAX_FILL_RADIUS MAX_SLICES MIDDLE_CENTER MIDDLE_MASK
            MIDDLE_SHIFT NODE_DISCS NODE_ONE_SIDED NODE_RESIDENT NODE_ROOT NODE_TRIANGLES NODE_WHOLE
            NO_CHILD NUM_SLICES_SHIFT OCTANT_SHIFT OPAQUE OWN_BITS OWN_FILL_RADIUS OWN_NONE OWN_NONE_WORD
            OWN_PER_WORD OWN_SHIFT PACKED_BLUE_SHIFT PACKED_COUNT_MASK PACKED_GREEN_SHIFT
            PACKED_RED_SHIFT PAIR_SHIFT PLANE_BITS PLANE_MASK POINTS_PER_LOAD PROTECTED_BLUE_SHIFT
            PROTECTED_GREEN_SHIFT PROTECTED_MASK PROTECTED_POINTS PROTECTED_RED_SHIFT REACH_MASK RGB_MASK
            SECOND_CORNER_SHIFT SIDE_SHIFT SLICE_PIXELS WIDE_SLICE_PIXELS SLICE_SHIFT SPACING_EXPONENT_SHIFT STATE_LOW
            STATE_PARTS STATE_SHIFT STEP_MASK STEP_SHIFT THIRD_CORNER_SHIFT TILE_COLUMN_MASK TILE_HIDES
            TILE_ROW_SHIFT UNTIL_SHIFT VISIBLE_BY_EYE VISIBLE_DISCS VISIBLE_FILL VISIBLE_PLANES
            VISIBLE_TRIANGLES VISIBLE_WIDE WORKGROUP_SIZE Y_SHIFT Z_SHIFT;
        i32 "":
            HEAD_CELL_LIMIT HEAD_CELL_STEP;
        f32 "":
            CELLS CUBE_RADIUS CULL_SLACK FADE_BEGIN FADE_END FILL_OVERLAP FINE_THRESHOLD_PX HYSTERESIS
            POINTS_COVER PRECISION_THRESHOLD_PX SAMPLES_COVER SURFACE_TOLERANCE TRIANGLE_SLACK_PX;
    };
    format!(
        "{ranges}{constants}\
         const NUM_EYES: u32 = {num_eyes}u;\n\
         const FILL: bool = {fill};\n\
         const TOGETHER: bool = {together};\n\
         const DISCS: bool = {discs};\n\
         const SUMS: u32 = {sums}u;\n\
         const KEYS: bool = {keys};\n\
         const BASIC: bool = {basic};\n\
         const CONVERGED: bool = {converged};\n\
         const EARLY_Z: bool = {early_z};\n\
         const PACKED: u32 = {}u;\n\
         const PROTECTED: u32 = {}u;\n\
         const WIDE: u32 = {}u;\n\
         const PAIRS: u32 = {}u;\n\
         const TILE_PX: vec2<u32> = vec2<u32>({tile_width}u, {tile_height}u);\n",
        Sums::Packed as u32,
        Sums::Protected as u32,
        Sums::Wide as u32,
        Sums::Pairs as u32,
    )
}

/// Name, type and value of each.
fn concat_lines(constants: &[(&str, &str, String)]) -> String {
    constants.iter().map(|(name, of, value)| format!("const {name}: {of} = {value};\n")).collect()
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
    let empty = format!("const EMPTY40: u64 = {EMPTY40}lu;\nconst EMPTY_KEY: u64 = {EMPTY_KEY}lu;\n");
    lines.chain([empty]).collect()
}

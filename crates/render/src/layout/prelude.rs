//! The shaders' prelude: every constant of the layout as WGSL text, and what differs between variants of a text.

// The prelude has every constant of the layout, by its name.
use super::*;
use crate::technique::Texts;

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
}

/// What a shader's text is made for.
#[derive(Clone, Copy, Debug)]
pub struct Variant {
    /// Eyes of the frame, one or two.
    pub num_eyes: u32,
    /// True if points may be larger than a pixel.
    pub fill: bool,
    /// True if all threads of a workgroup draw wide points together.
    pub together: bool,
    /// How a pixel's colors are added up.
    pub sums: Sums,
    /// True if depth and id are the two words of one u64; else each has a buffer of its own.
    pub keys: bool,
    /// The texts of the technique.
    pub texts: Texts,
}

impl Variant {
    /// The plainest variant for this many eyes.
    #[must_use]
    pub fn eyes(num_eyes: u32) -> Self {
        Self { num_eyes, fill: false, together: true, sums: Sums::Packed, keys: true, texts: Texts::FRAME }
    }
}

/// WGSL text of every constant of the layout; put in front of each shader.
#[must_use]
pub fn prelude(variant: Variant) -> String {
    let Variant { num_eyes, fill, together, sums, keys, .. } = variant;
    let sums = sums as u32;
    let [tile_width, tile_height] = TILE_PX;
    let (ring_alpha, edge_alpha) = (vector(RING_ALPHA), vector(EDGE_ALPHA));
    let (ramp, palette) = (colors(&OVERLAY_RAMP), colors(&PALETTE));
    let constants = constants! {
        u32 "u":
            ALL_PLANES ALPHA_SHIFT BATCH_POINTS BLUE_SHIFT CHANNEL_MASK CHILD_ABSENT COARSE_CENTER COARSE_MASK
            COARSE_PLANES COARSE_SHIFT COORDINATE_BITS COUNTERS_STRIDE DILATE_FALLOFF_BITS DILATE_REACH_PX DRAWN_WHOLE
            EMPTY_DEPTH GREEN_SHIFT GUARD_PX ID_ODD ID_SHIFT IMAGE_PITCH_PX KEY_DEPTH_SHIFT LOD_FADE LOD_SMOOTH
            MASK_WORD_PX MAX_EXTRA_SLICES MAX_FILL_RADIUS MAX_MEAN_COUNT MAX_SLICES MIDDLE_CENTER MIDDLE_MASK
            MIDDLE_PLANES MIDDLE_SHIFT NODE_RESIDENT NODE_ROOT NODE_WHOLE NO_CHILD NUM_SLICES_SHIFT OCTANT_SHIFT OPAQUE
            OWN_BITS OWN_FILL_RADIUS OWN_NONE OWN_NONE_WORD OWN_PER_WORD OWN_SHIFT PACKED_BLUE_SHIFT PACKED_COUNT_MASK
            PACKED_GREEN_SHIFT PACKED_RED_SHIFT PALETTE_COLORS PIXELS_PER_THREAD PLANE_BITS PLANE_MASK POINTS_PER_LOAD
            PROTECTED_BLUE_SHIFT PROTECTED_GREEN_SHIFT PROTECTED_MASK PROTECTED_POINTS PROTECTED_RED_SHIFT RAMP_STEPS
            REACH_MASK RGB_MASK SLICE_SHIFT SPACING_EXPONENT_SHIFT STATE_LOW STATE_PARTS STATE_SHIFT TILE_COLUMN_MASK
            TILE_HIDES TILE_ROW_SHIFT VISIBLE_BY_EYE VISIBLE_FILL VISIBLE_PLANES VISIBLE_WIDE WIDE_SLICE_PIXELS
            WORKGROUP_SIZE Y_SHIFT Z_SHIFT;
        i32 "":
            HEAD_CELL_LIMIT HEAD_CELL_STEP;
        f32 "":
            CARD_BEHIND_ALPHA CARD_STEP CARD_TURN CELLS CUBE_RADIUS CULL_SLACK DEPTH_OCTAVES FADE_BEGIN FADE_END
            FILL_OVERLAP FINE_THRESHOLD_PX GRID_CELL_M GRID_LEAST_CELLS GRID_LEAST_WIDTH_M GRID_LINE_ALPHA GRID_LINE_M
            GRID_REACH_M GRID_WIDE_CELL_M GRID_WIDE_LINE_M HORIZON_FALLOFF HYSTERESIS LINEAR_STRAIGHT OVERDRAW_OCTAVES
            POINTS_COVER PRECISION_THRESHOLD_PX SAMPLES_BELOW SAMPLES_COVER SRGB_POWER SRGB_SHIFT SRGB_SLOPE
            SRGB_STRAIGHT SRGB_STRETCH SURFACE_TOLERANCE VIGNETTE_EDGE_COS VIGNETTE_NARROW_COS VIGNETTE_RISE
            VIGNETTE_WIDE_COS;
    };
    format!(
        "{constants}\
         const RING_ALPHA: vec2<f32> = {ring_alpha};\n\
         const EDGE_ALPHA: vec2<f32> = {edge_alpha};\n\
         const OVERLAY_RAMP: {ramp};\n\
         const PALETTE: {palette};\n\
         const NUM_EYES: u32 = {num_eyes}u;\n\
         const FILL: bool = {fill};\n\
         const TOGETHER: bool = {together};\n\
         const SUMS: u32 = {sums}u;\n\
         const KEYS: bool = {keys};\n\
         const PACKED: u32 = {}u;\n\
         const PROTECTED: u32 = {}u;\n\
         const WIDE: u32 = {}u;\n\
         const TILE_PX: vec2<u32> = vec2<u32>({tile_width}u, {tile_height}u);\n",
        Sums::Packed as u32,
        Sums::Protected as u32,
        Sums::Wide as u32,
    )
}

/// A line for each constant, from its name, type and value.
fn concat_lines(constants: &[(&str, &str, String)]) -> String {
    constants.iter().map(|(name, of, value)| format!("const {name}: {of} = {value};\n")).collect()
}

/// A vector of floats.
fn vector<const N: usize>(values: [f32; N]) -> String {
    format!("vec{N}<f32>({})", values.map(|value| format!("{value:?}")).join(", "))
}

/// The type of a list of colors, and the list.
fn colors(colors: &[[f32; 3]]) -> String {
    let of = format!("array<vec3<f32>, {}>", colors.len());
    let list: Vec<String> = colors.iter().copied().map(vector).collect();
    format!("{of} = {of}({})", list.join(", "))
}

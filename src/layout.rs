//! What host and shaders share: constants and structs. Constants flow one way, host → shader, as the
//! generated [`prelude`]; struct offsets are compared with naga's in `tests/shaders.rs`.

use bytemuck::{Pod, Zeroable};

/// Threads of a workgroup of the geometry stages [2022 §3.2].
pub const WORKGROUP_SIZE: u32 = 128;
/// Points a batch holds at most: 128 threads × 80 points [2022 §3.2].
pub const BATCH_POINTS: u32 = 10_240;
/// Points a thread loads at once, as one 128-bit load [2022 §3.4].
pub const POINTS_PER_LOAD: u32 = 4;
/// Bits of a quantised coordinate; three planes of [`PLANE_BITS`].
pub const COORDINATE_BITS: u32 = 30;
/// Bits an axis in one plane.
pub const PLANE_BITS: u32 = 10;
/// A batch whose longest side projects to fewer pixels than this is read at 10 bits; at 20 bits below
/// 1024 times as many [2022 §3.3].
pub const PRECISION_THRESHOLD_PX: f32 = 500.0;
/// The head's cell coordinate is a multiple of this, so that its product with a cell edge is exact in f32
/// (12 + 12 bits of mantissa); see [`VisibleBatch`].
pub const HEAD_CELL_STEP: i32 = 1 << 18;
/// The head's cell coordinate is clamped to ± this; beyond, plain f32 is relatively exact.
pub const HEAD_CELL_LIMIT: i32 = 1 << 30;

/// A batch on the GPU: a run of points and the box that their coordinates are relative to.
///
/// Positions are (hi, lo) pairs relative to the cloud's origin: `hi` is a multiple of a power of two chosen
/// from the cloud's extent, so the difference of two `hi` is exact in f32, and `lo` is the small rest.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Batch {
    /// Box minimum, coarse part, world axes, relative to the cloud origin.
    pub min_hi: [f32; 3],
    /// First point in the chunk's planes; a multiple of [`POINTS_PER_LOAD`].
    pub first_point: u32,
    /// Box minimum, fine part.
    pub min_lo: [f32; 3],
    /// Points in the batch, ≤ [`BATCH_POINTS`].
    pub num_points: u32,
    /// Edge of a 30-bit cell an axis, world units, ≤ 12 bits of mantissa; 0 on a flat axis.
    pub cell: [f32; 3],
    /// Always 0.
    pub reserved: u32,
}

/// One eye as the shaders see it: rows of `pixel_from_head` ([`crate::space::Eye::pixel_from_head`]).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct EyeUniform {
    /// Row that gives px · w.
    pub row_x: [f32; 4],
    /// Row that gives py · w.
    pub row_y: [f32; 4],
    /// Row that gives w, the linear depth.
    pub row_w: [f32; 4],
    /// Image size in pixels, as floats.
    pub size_px: [f32; 2],
    /// Image width in pixels.
    pub width: u32,
    /// Pixels per radian at the optical axis.
    pub pixels_per_radian: f32,
}

/// The view of one frame: both eyes and the head that they are relative to.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ViewUniform {
    /// Head position, coarse part, relative to the cloud origin.
    pub head_hi: [f32; 3],
    /// Points with w ≤ near are not drawn.
    pub near: f32,
    /// Head position, fine part.
    pub head_lo: [f32; 3],
    /// 0: precision by projected size; 1, 2, 3: that many planes always.
    pub forced_planes: u32,
    /// Left, right. With one eye the second is a copy of the first and not drawn.
    pub eyes: [EyeUniform; 2],
}

/// What `cull` tells `depth` about a batch that is seen.
///
/// A point at cell X is at `p_in_head = f32(X − head_cell) · cell + offset`: the integer difference is exact,
/// so points near the head keep all their 30 bits although the arithmetic is f32.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct VisibleBatch {
    /// Head in the batch's cells, a multiple of [`HEAD_CELL_STEP`].
    pub head_cell: [i32; 3],
    /// First point in the chunk's planes.
    pub first_point: u32,
    /// `p_in_head` of the corner of cell `head_cell` (of its centre at 30 bits).
    pub offset: [f32; 3],
    /// Points in the batch.
    pub num_points: u32,
    /// Edge of a 30-bit cell an axis.
    pub cell: [f32; 3],
    /// Bits 0–1: planes to read (1–3); bit 4: seen by the left eye; bit 5: by the right.
    pub flags: u32,
}

/// Dispatch arguments of `depth` and the frame's counters, written by `cull`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Pod, Zeroable)]
pub struct CullCounters {
    /// Workgroups of `depth` = visible batches.
    pub num_visible: u32,
    /// Always 1.
    pub workgroups_y: u32,
    /// Always 1.
    pub workgroups_z: u32,
    /// Points in the visible batches.
    pub num_points: u32,
}

/// WGSL text of every constant above; put in front of each shader.
#[must_use]
pub fn prelude(num_eyes: u32) -> String {
    format!(
        "const NUM_EYES: u32 = {num_eyes}u;\n\
         const WORKGROUP_SIZE: u32 = {WORKGROUP_SIZE}u;\n\
         const BATCH_POINTS: u32 = {BATCH_POINTS}u;\n\
         const POINTS_PER_LOAD: u32 = {POINTS_PER_LOAD}u;\n\
         const COORDINATE_BITS: u32 = {COORDINATE_BITS}u;\n\
         const PLANE_BITS: u32 = {PLANE_BITS}u;\n\
         const PRECISION_THRESHOLD_PX: f32 = {PRECISION_THRESHOLD_PX:?};\n\
         const HEAD_CELL_STEP: i32 = {HEAD_CELL_STEP};\n\
         const HEAD_CELL_LIMIT: i32 = {HEAD_CELL_LIMIT};\n"
    )
}

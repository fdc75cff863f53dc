//! What host and shaders share: constants and structs. Constants flow one way, host → shader, as the
//! generated [`prelude`]; struct offsets are compared with naga's in `tests/shaders.rs`.

use crate::space::{Eye, Fov, Split, View};
use bytemuck::{Pod, Zeroable};
use glam::DVec3;

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
/// Bytes from one chunk's [`CullCounters`] to the next: no adapter wants bindings aligned more coarsely.
pub const COUNTERS_STRIDE: u32 = 256;
/// The high word of a pixel that no point has reached; depths are finite, so their bits are below.
pub const EMPTY_DEPTH: u32 = u32::MAX;
/// [`ViewUniform::lod_flags`]: points of a node appear one by one.
pub const LOD_FADE: u32 = 1;
/// [`ViewUniform::lod_flags`]: thresholds grow smoothly from ring to ring.
pub const LOD_SMOOTH: u32 = 2;
/// The head's cell coordinate is clamped to ± this; beyond, plain f32 is relatively exact.
pub const HEAD_CELL_LIMIT: i32 = 1 << 30;
/// Two depths are of one surface if the farther is at most this many times the nearer.
pub const SURFACE_TOLERANCE: f32 = 1.01;
/// Pixels that a workgroup of `dilate` fills, across and down, four a thread. With what reaches into them they take
/// 15.2 of the 16 KiB of workgroup memory that every Vulkan device has.
pub const DILATE_TILE_PX: [u32; 2] = [32, 16];
/// Pixels that `dilate` reaches at most, to each side: 7×7.
pub const DILATE_REACH_PX: u32 = 3;
/// The weight of a neighbour falls by this many bits a pixel of distance, along each axis: 64, 16, 4, 1.
pub const DILATE_FALLOFF_BITS: u32 = 2;

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
    pub reserved_a: u32,
    /// 1 / (cell · [`HEAD_CELL_STEP`]); 0 on a flat axis.
    pub steps_per_unit: [f32; 3],
    /// Always 0.
    pub reserved_b: u32,
}

impl Batch {
    /// The GPU's form of a batch whose points begin at `first_point` of its chunk.
    #[must_use]
    pub fn new(
        split: &Split,
        min_in_world: DVec3,
        cell: [f32; 3],
        first_point: u32,
        num_points: u32,
    ) -> Self {
        let (hi, lo) = split.pair(min_in_world);
        let steps_per_unit = cell.map(|c| if c > 0.0 { 1.0 / (c * HEAD_CELL_STEP as f32) } else { 0.0 });
        let (min_hi, min_lo) = (hi.to_array(), lo.to_array());
        Self { min_hi, first_point, min_lo, num_points, cell, reserved_a: 0, steps_per_unit, reserved_b: 0 }
    }
}

/// One eye as the shaders see it: rows of `pixel_from_head` ([`crate::space::Eye::pixel_from_head`]), the gaze,
/// and the way from a pixel back to a direction.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct EyeUniform {
    /// Row that gives px · w.
    pub row_x: [f32; 4],
    /// Row that gives py · w.
    pub row_y: [f32; 4],
    /// Row that gives w, the linear depth.
    pub row_w: [f32; 4],
    /// The eye in head space.
    pub eye_in_head: [f32; 3],
    /// Pixels per radian at the optical axis.
    pub pixels_per_radian: f32,
    /// Direction of the gaze in head space, unit length.
    pub gaze_in_head: [f32; 3],
    /// Always 0.
    pub reserved_a: u32,
    /// Direction of the gaze in view space, unit length; (0, 0, −1) is the optical axis.
    pub gaze_in_view: [f32; 3],
    /// Always 0.
    pub reserved_b: u32,
    /// Tangents of the angles to the image's top left corner: right and up are positive.
    pub tangent_origin: [f32; 2],
    /// Tangents from one pixel to the next, to the right and down. The centre of pixel (x, y) lies in the
    /// direction `(tangent_origin + tangent_per_px · (x + ½, y + ½), −1)` of view space.
    pub tangent_per_px: [f32; 2],
    /// Image size in pixels, as floats.
    pub size_px: [f32; 2],
    /// Image width in pixels.
    pub width: u32,
    /// Image height in pixels.
    pub height: u32,
}

impl EyeUniform {
    /// The GPU's form of an eye, relative to the head.
    #[must_use]
    pub fn new(eye: &Eye, head_in_world: DVec3) -> Self {
        let [row_x, row_y, row_w] = eye.pixel_from_head(head_in_world).map(|row| row.map(|v| v as f32));
        let [width, height] = eye.size_px;
        let Fov { left, right, up, down } = eye.fov;
        let per_px = [(right - left) / f64::from(width), (down - up) / f64::from(height)];
        Self {
            row_x,
            row_y,
            row_w,
            eye_in_head: (eye.world_from_view.position - head_in_world).as_vec3().to_array(),
            pixels_per_radian: eye.pixels_per_radian() as f32,
            gaze_in_head: (eye.world_from_view.orientation * eye.gaze_in_view).as_vec3().to_array(),
            reserved_a: 0,
            gaze_in_view: eye.gaze_in_view.as_vec3().to_array(),
            reserved_b: 0,
            tangent_origin: [left as f32, up as f32],
            tangent_per_px: per_px.map(|t| t as f32),
            size_px: [width as f32, height as f32],
            width,
            height,
        }
    }
}

/// How much of a cloud a frame draws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// 0: precision by projected size; 1, 2, 3: that many planes always.
    pub forced_planes: u32,
    /// Pixels that a node's projected edge needs in the inner, middle and outer ring.
    pub threshold_px: [f32; 3],
    /// Angles from the gaze at which the inner and the middle ring end, radians.
    pub ring_rad: [f64; 2],
    /// Thresholds grow from the first to the third between the rings' ends.
    pub smooth: bool,
    /// Points of a node appear one by one.
    pub fade: bool,
}

impl Default for Detail {
    /// The papers' thresholds, no fading.
    fn default() -> Self {
        Self {
            forced_planes: 0,
            threshold_px: [100.0, 200.0, 300.0],
            ring_rad: [20f64.to_radians(), 38f64.to_radians()],
            smooth: false,
            fade: false,
        }
    }
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
    /// Pixels that a node's projected edge needs in the inner, middle and outer ring.
    pub threshold_px: [f32; 3],
    /// [`LOD_FADE`], [`LOD_SMOOTH`].
    pub lod_flags: u32,
    /// Cosines of the angles from the gaze at which the inner and the middle ring end.
    pub ring_cos: [f32; 2],
    /// Their sines.
    pub ring_sin: [f32; 2],
    /// Left, right. With one eye the second is a copy of the first and not drawn.
    pub eyes: [EyeUniform; 2],
}

impl ViewUniform {
    /// The GPU's form of a view of one or two eyes.
    ///
    /// # Panics
    /// If the view has no eye.
    #[must_use]
    pub fn new(view: &View, split: &Split, detail: &Detail) -> Self {
        let head_in_world = view.head_in_world();
        let (hi, lo) = split.pair(head_in_world);
        let eye = |index: usize| EyeUniform::new(&view.eyes[index.min(view.eyes.len() - 1)], head_in_world);
        Self {
            head_hi: hi.to_array(),
            near: view.near as f32,
            head_lo: lo.to_array(),
            forced_planes: detail.forced_planes,
            threshold_px: detail.threshold_px,
            lod_flags: if detail.fade { LOD_FADE } else { 0 } | if detail.smooth { LOD_SMOOTH } else { 0 },
            ring_cos: detail.ring_rad.map(|angle| angle.cos() as f32),
            ring_sin: detail.ring_rad.map(|angle| angle.sin() as f32),
            eyes: [eye(0), eye(1)],
        }
    }
}

/// A chunk of the point pool.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct ChunkUniform {
    /// Index of its first point in the whole pool.
    pub first_index: u32,
    /// Points in its planes.
    pub num_points: u32,
    /// Always 0.
    pub reserved: [u32; 2],
}

/// What `resolve` needs to turn point indices into colours.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct ResolveUniform {
    /// Image width in pixels.
    pub width: u32,
    /// Index of the chunk's first point in the whole pool.
    pub first_index: u32,
    /// Points in the chunk's planes.
    pub num_points: u32,
    /// Always 0.
    pub reserved: u32,
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

/// Which image `dilate` works on, and how far it reaches.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Pod, Zeroable)]
pub struct DilateUniform {
    /// The eye, 0 or 1.
    pub eye: u32,
    /// 0: by the pixel's ring; 1, 2, 3: that radius everywhere.
    pub radius_px: u32,
    /// Always 0.
    pub reserved: [u32; 2],
}

/// WGSL text of every constant above; put in front of each shader.
#[must_use]
pub fn prelude(num_eyes: u32) -> String {
    let [tile_width, tile_height] = DILATE_TILE_PX;
    format!(
        "const NUM_EYES: u32 = {num_eyes}u;\n\
         const WORKGROUP_SIZE: u32 = {WORKGROUP_SIZE}u;\n\
         const BATCH_POINTS: u32 = {BATCH_POINTS}u;\n\
         const POINTS_PER_LOAD: u32 = {POINTS_PER_LOAD}u;\n\
         const COORDINATE_BITS: u32 = {COORDINATE_BITS}u;\n\
         const PLANE_BITS: u32 = {PLANE_BITS}u;\n\
         const PRECISION_THRESHOLD_PX: f32 = {PRECISION_THRESHOLD_PX:?};\n\
         const COUNTERS_STRIDE: u32 = {COUNTERS_STRIDE}u;\n\
         const EMPTY_DEPTH: u32 = {EMPTY_DEPTH}u;\n\
         const HEAD_CELL_STEP: i32 = {HEAD_CELL_STEP};\n\
         const HEAD_CELL_LIMIT: i32 = {HEAD_CELL_LIMIT};\n\
         const LOD_FADE: u32 = {LOD_FADE}u;\n\
         const LOD_SMOOTH: u32 = {LOD_SMOOTH}u;\n\
         const SURFACE_TOLERANCE: f32 = {SURFACE_TOLERANCE:?};\n\
         const DILATE_TILE_PX: vec2<u32> = vec2<u32>({tile_width}u, {tile_height}u);\n\
         const DILATE_REACH_PX: u32 = {DILATE_REACH_PX}u;\n\
         const DILATE_FALLOFF_BITS: u32 = {DILATE_FALLOFF_BITS}u;\n"
    )
}

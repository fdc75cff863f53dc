//! What host and shaders share: constants and structs. Constants flow one way, host → shader, as the
//! generated [`prelude`]; struct offsets are compared with naga's in `tests/gpu/shaders/structs.rs`.

mod flags;
mod guard;
mod overlay;
mod pixel;
mod prelude;
mod scenery;
mod view;
mod words;

pub use flags::{
    ALL_PLANES, COARSE_PLANES, LOD_FADE, LOD_SMOOTH, MIDDLE_PLANES, NODE_RESIDENT, NODE_ROOT, NODE_WHOLE,
    NUM_SLICES_SHIFT, SLICE_SHIFT, VISIBLE_BY_EYE, VISIBLE_FILL, VISIBLE_OTHERS, VISIBLE_PLANES,
    VISIBLE_WIDE,
};
pub use guard::{GUARD_PX, IMAGE_PITCH_PX, guarded, image_pitch_px, of_image, without_guard};
pub use overlay::*;
pub use pixel::{Pixel, depth_of};
pub use prelude::{Sums, Variant, prelude};
pub use scenery::*;
pub use view::{Detail, EyeUniform, ViewUniform, WIDEST_RAD};
pub use words::{
    EMPTY_KEY, ID_ODD, ID_SHIFT, KEY_DEPTH_SHIFT, MASK_WORD_PX, OWN_BITS, OWN_NONE, OWN_NONE_WORD,
    OWN_PER_WORD, OWN_SHIFT, PACKED_BLUE_SHIFT, PACKED_COUNT_MASK, PACKED_GREEN_SHIFT, PACKED_RED_SHIFT,
    PROTECTED_BLUE_SHIFT, PROTECTED_GREEN_SHIFT, PROTECTED_MASK, PROTECTED_RED_SHIFT, STATE_LOW, STATE_PARTS,
    STATE_SHIFT, TILE_COLUMN_MASK, TILE_ROW_SHIFT,
};

pub use base::srgb::{LINEAR_STRAIGHT, SRGB_POWER, SRGB_SHIFT, SRGB_SLOPE, SRGB_STRAIGHT, SRGB_STRETCH};
pub use cloud::format::{
    ALPHA_SHIFT, BATCH_POINTS, BLUE_SHIFT, CELLS, CHANNEL_MASK, COARSE_CENTER, COARSE_MASK, COARSE_SHIFT,
    COORDINATE_BITS, GREEN_SHIFT, MIDDLE_CENTER, MIDDLE_MASK, MIDDLE_SHIFT, OCTANT_SHIFT, OPAQUE,
    PAGE_POINTS, PLANE_BITS, PLANE_MASK, POINTS_PER_LOAD, RGB_MASK, SPACING_EXPONENT_SHIFT, WORKGROUP_SIZE,
    Y_SHIFT, Z_SHIFT,
};

use base::space::Split;
use bytemuck::{Pod, Zeroable};
use cloud::octree;

/// A batch whose longest side projects to fewer pixels than this is read at 10 bits [2022 §3.3].
pub const PRECISION_THRESHOLD_PX: f32 = 500.0;
/// A batch whose longest side projects to fewer pixels than this, 1024 times as many, is read at 20 bits, else at 30.
pub const FINE_THRESHOLD_PX: f32 = PRECISION_THRESHOLD_PX * (1 << PLANE_BITS) as f32;
/// Share of a plane's terms that rounding may cost in `cull`, which must never lose a point that `depth` would draw.
pub const CULL_SLACK: f32 = 1e-5;
/// Half a cube's diagonal, as a share of its edge.
pub const CUBE_RADIUS: f32 = 0.866_025_4;
/// The head's cell coordinate is a multiple of this, so that its product with a cell edge is exact in f32
/// (12 + 12 bits of mantissa); see [`VisibleBatch`].
pub const HEAD_CELL_STEP: i32 = 1 << 18;
/// Bytes from one chunk's [`CullCounters`] to the next: no adapter wants bindings aligned more coarsely.
pub const COUNTERS_STRIDE: u32 = 256;
/// The high word of a pixel that no point has reached; depths are finite, so their bits are below.
pub const EMPTY_DEPTH: u32 = u32::MAX;
/// A node's state if all of its points are drawn; it is 0 if none are. Between them, a point is drawn if its number in
/// the batch, bits reversed, is smaller than the state: halves of the Morton curve come first, then quarters, …
pub const DRAWN_WHOLE: u32 = u32::MAX;
/// A node that was drawn stays until it is this much below its threshold.
pub const HYSTERESIS: f32 = 0.95;
/// Share of its threshold at which a node begins to fade in: 2^(−1/4).
pub const FADE_BEGIN: f32 = 0.840_896_4;
/// Share of its threshold from which a node is drawn whole: 2^(1/4). The mean of both shares is the threshold.
pub const FADE_END: f32 = 1.189_207_1;
/// Two depths are of one surface if the farther is at most this many times the nearer [2021 §3.5].
pub const SURFACE_TOLERANCE: f32 = 1.01;
/// Pixels from a point's own to the edge of the splat that `fill` draws, at most.
pub const MAX_FILL_RADIUS: u32 = 31;
/// Pixels that a splat reaches at most that a thread draws alone; all threads of a workgroup draw larger ones together.
pub const OWN_FILL_RADIUS: u32 = 1;
/// Largest width of a splat that `fill` draws, in multiples of the points' mean distance: it must reach over the
/// diagonal, and points lie irregularly.
pub const FILL_OVERLAP: f32 = 1.5;
/// Width of the square that splat and dilation are to cover together, in multiples of the points' mean distance. Among
/// points that lie at random, a square of this width is empty once in eight thousand times, and the mean distance is an
/// estimate.
pub const POINTS_COVER: f32 = 3.0;
/// Width of the square that dilation alone is to cover, as far as it can, in multiples of the distance of a node's
/// samples, which lie more evenly: less than 1 % of what level of detail leaves out lies further from the nearest
/// sample than half of this (`tests/files/octree.rs`), which one sees at silhouettes.
pub const SAMPLES_COVER: f32 = 2.24;
/// Samples of a surface in the nodes of the next level, in multiples of those in a node: edges are half as long there.
pub const SAMPLES_BELOW: f32 = 4.0;
/// Points that a pixel's sums hold before the others go to the fallback sums: 16 bits hold 257 · 255, and the
/// room above 255 is for threads that add at the same time [2021 §3.5.1].
pub const PROTECTED_POINTS: u32 = 255;
/// A batch of wide points gets another workgroup for each of this many pixels: four times as many a thread as there are
/// threads. With fewer, the list of slices is full in large frames, and a batch that comes late is drawn by one
/// workgroup (docs/bench/gpu/README.md: 20 ms for 6).
pub const WIDE_SLICE_PIXELS: u32 = 4 * WORKGROUP_SIZE * WORKGROUP_SIZE;
/// Workgroups of a batch at most.
pub const MAX_SLICES: u32 = 256;
/// Workgroups beyond the first of all batches of a chunk, at most: room in its list.
pub const MAX_EXTRA_SLICES: u32 = 16_384;
/// The head's cell coordinate is clamped to ± this; beyond, plain f32 is relatively exact.
pub const HEAD_CELL_LIMIT: i32 = 1 << 30;
/// Pixels that a workgroup of `resolve` works on, across and down, [`PIXELS_PER_THREAD`] each thread. With the pixels that reach into them
/// they take 15.2 of the 16 KiB of workgroup memory that every Vulkan device has.
pub const TILE_PX: [u32; 2] = [32, 16];
/// Pixels that a thread of `resolve` works on.
pub const PIXELS_PER_THREAD: u32 = 4;
/// Sums of channels of fewer points than this have means that floats compute exactly.
pub const MAX_MEAN_COUNT: u32 = 12_000;
/// Pixels that `dilate` reaches at most, to each side: 7×7.
pub const DILATE_REACH_PX: u32 = 3;
/// The bits of a pixel's depth that say how far `dilate` takes its surface at least, [`DILATE_REACH_PX`] at most; 0
/// where the ring's kernel is enough. They are the last two: depths differ by 2⁻²² of themselves.
pub const REACH_MASK: u32 = 3;
/// A tile's word in the list of those that `resolve` works on: lenses hide some of its pixels.
pub const TILE_HIDES: u32 = 1 << 31;
/// The weight of a neighbor falls by this many bits a pixel of distance, along each axis: 64, 16, 4, 1.
pub const DILATE_FALLOFF_BITS: u32 = 2;

/// A batch on the GPU: a run of points and the box that their coordinates are relative to.
///
/// Positions are (hi, lo) pairs relative to the cloud's origin: `hi` is a multiple of a power of two chosen
/// from the cloud's extent, so the difference of two `hi` is exact in f32, and `lo` is the small rest.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GpuBatch {
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
    /// Number of its node in the cloud's list.
    pub node: u32,
    /// 1 / (cell · [`HEAD_CELL_STEP`]); 0 on a flat axis.
    pub steps_per_unit: [f32; 3],
    /// Always 0.
    pub reserved: u32,
}

impl GpuBatch {
    /// The GPU's form of a batch of node number `node` whose points begin at `first_point` of its chunk.
    #[must_use]
    pub fn new(split: &Split, batch: &cloud::Batch, node: u32, first_point: u32) -> Self {
        let (hi, lo) = split.pair(batch.min);
        let (cell, num_points) = (batch.cell, batch.num_points);
        let steps_per_unit = cell.map(|c| if c > 0.0 { 1.0 / (c * HEAD_CELL_STEP as f32) } else { 0.0 });
        let (min_hi, min_lo) = (hi.to_array(), lo.to_array());
        Self { min_hi, first_point, min_lo, num_points, cell, node, steps_per_unit, reserved: 0 }
    }
}

/// A node of the octree on the GPU. A flat cloud is one node that is always drawn whole.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GpuNode {
    /// Smallest corner of its cube, coarse part, as [`GpuBatch::min_hi`].
    pub min_hi: [f32; 3],
    /// Edge of its cube, world units.
    pub edge: f32,
    /// Smallest corner, fine part.
    pub min_lo: [f32; 3],
    /// [`NODE_RESIDENT`], [`NODE_WHOLE`], [`NODE_ROOT`].
    pub flags: u32,
    /// How far apart the finest points in each octant lie, as a share of `edge`, where they lie closest: eight f16.
    pub spacing: [u32; 4],
    /// The number of the child in octant o = x | y≪1 | z≪2, [`NO_CHILD`] or [`CHILD_ABSENT`].
    pub children: [u32; 8],
    /// Halvings from the root's cube.
    pub level: u32,
    /// How far apart its samples lie, as a share of `edge`: what is seen of the surface while nothing below it is
    /// drawn. 0 where nothing is below.
    pub sample_spacing: f32,
    /// How many times as far apart points lie for each count of their exponent: see [`SPACING_EXPONENT_SHIFT`].
    pub spacing_step: f32,
    /// Always 0.
    pub reserved: u32,
}

/// In a node's list of children: that octant has no points, or none that nodes above have left.
pub const NO_CHILD: u32 = u32::MAX;
/// In a node's list of children: the child is not on the GPU.
pub const CHILD_ABSENT: u32 = u32::MAX - 1;

impl GpuNode {
    /// The one node of a flat cloud.
    pub const FLAT: Self = Self {
        min_hi: [0.0; 3],
        edge: 0.0,
        min_lo: [0.0; 3],
        flags: NODE_RESIDENT | NODE_WHOLE,
        spacing: [0; 4],
        children: [NO_CHILD; 8],
        level: 0,
        sample_spacing: 0.0,
        spacing_step: 1.0,
        reserved: 0,
    };

    /// The GPU's form of node `number` of an octree, if all nodes are on the GPU.
    #[must_use]
    pub fn new(split: &Split, nodes: &[octree::Node], number: usize) -> Self {
        let node = &nodes[number];
        let (hi, lo) = split.pair(node.min);
        let mut children = [NO_CHILD; 8];
        for child in node.children.clone() {
            children[node.octant_of(&nodes[child as usize])] = child;
        }
        let is_root = node.parent.is_none();
        let flags = match (is_root, node.children.is_empty()) {
            (true, true) => NODE_WHOLE,
            (true, false) => NODE_ROOT,
            _ => 0,
        };
        Self {
            min_hi: hi.to_array(),
            edge: node.edge as f32,
            min_lo: lo.to_array(),
            flags: NODE_RESIDENT | flags,
            spacing: std::array::from_fn(|pair| {
                let share = |octant: usize| half::f16::from_f32(node.octant_spacing[octant]).to_bits();
                u32::from(share(2 * pair)) | u32::from(share(2 * pair + 1)) << 16
            }),
            children,
            level: node.level,
            sample_spacing: node.sample_spacing,
            spacing_step: node.spacing_step,
            reserved: 0,
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

/// What `clear` writes into a pair of targets.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct ClearUniform {
    /// Every word's new value.
    pub value: u32,
    /// 16-byte words of the left eye that are in use.
    pub num_left: u32,
    /// 16-byte words of the right eye that are in use.
    pub num_right: u32,
    /// Always 0.
    pub reserved: u32,
}

/// Words of a row of `width` pixels in a mask of a bit a pixel: pixel x is bit x mod 32 of word x / 32, and rows
/// begin with a word of their own.
#[must_use]
pub fn mask_words_per_row(width: u32) -> u32 {
    width.div_ceil(MASK_WORD_PX)
}

/// What the steps of `resolve` need to know of an eye's image.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ResolveUniform {
    /// Width, height in pixels, without the guard band.
    pub size_px: [u32; 2],
    /// Color where no point is, as the image holds it.
    pub background: u32,
    /// 1: the image holds b | g≪8 | r≪16 | 255≪24; 0: r | g≪8 | b≪16 | 255≪24.
    pub is_bgra: u32,
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
    /// `p_in_head` of the corner of cell `head_cell` (of its center at 30 bits).
    pub offset: [f32; 3],
    /// Points in the batch.
    pub num_points: u32,
    /// Edge of a 30-bit cell an axis.
    pub cell: [f32; 3],
    /// [`VISIBLE_PLANES`]; [`VISIBLE_BY_EYE`], once for each eye that sees it; [`VISIBLE_FILL`],
    /// [`VISIBLE_WIDE`]; from [`SLICE_SHIFT`] on which slice of the batch, and from
    /// [`NUM_SLICES_SHIFT`] on how many it has, less one.
    pub flags: u32,
    /// [`GpuNode::spacing`].
    pub spacing: [u32; 4],
    /// State of the child in each octant in [`OWN_BITS`], [`OWN_NONE`] where there is none: a point whose child is
    /// drawn has its own color, else the filtered one, point by point as the child fades in.
    pub own: [u32; 2],
    /// State of the node, not 0; see [`DRAWN_WHOLE`].
    pub drawn: u32,
    /// [`GpuNode::spacing_step`].
    pub spacing_step: f32,
    /// [`GpuNode::sample_spacing`]; for the root, that of the samples that are drawn.
    pub sample_spacing: f32,
    /// Always 0.
    pub reserved: u32,
    /// Always 0.
    pub reserved_end: [u32; 2],
}

impl VisibleBatch {
    /// True for the first slice of a batch, or the only one.
    #[must_use]
    pub fn is_first_slice(&self) -> bool {
        self.flags >> SLICE_SHIFT & (MAX_SLICES - 1) == 0
    }
}

/// Dispatch arguments of `depth` and the frame's counters, written by `cull`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Pod, Zeroable)]
pub struct CullCounters {
    /// Workgroups of `depth`: visible batches, and the slices beyond the first of some.
    pub num_visible: u32,
    /// Always 1.
    pub workgroups_y: u32,
    /// Always 1.
    pub workgroups_z: u32,
    /// Points in the visible batches.
    pub num_points: u32,
    /// Nodes whose batches these are, except those that an earlier chunk has counted.
    pub num_nodes: u32,
    /// Slices beyond the first that were asked for; [`MAX_EXTRA_SLICES`] are given.
    pub num_extra: u32,
    /// Always 0.
    pub reserved: [u32; 2],
}

impl CullCounters {
    /// Visible batches.
    #[must_use]
    pub fn num_batches(&self) -> u32 {
        self.num_visible - self.num_extra.min(MAX_EXTRA_SLICES)
    }
}

/// Which image `dilate` works on.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Pod, Zeroable)]
pub struct DilateUniform {
    /// The eye, 0 or 1.
    pub eye: u32,
}

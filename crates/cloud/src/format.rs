//! How points lie in memory: what the builders write and the shaders read. `render` hands these constants to the shaders.

/// Threads of a workgroup of the geometry stages [2022 §3.2].
pub const WORKGROUP_SIZE: u32 = 128;
/// Points a batch holds at most: 128 threads × 80 points [2022 §3.2].
pub const BATCH_POINTS: u32 = 10_240;
/// Points a thread loads at once, as one 128-bit load [2022 §3.4].
pub const POINTS_PER_LOAD: u32 = 4;
/// Points of a page of the pool: an octree's node has pages of its own, so that it can come and go. Its last one is half empty
/// on average: some 0.3 % of a node.
pub const PAGE_POINTS: u32 = 128;
/// Bits of a quantised coordinate; three planes of [`PLANE_BITS`].
pub const COORDINATE_BITS: u32 = 30;
/// Bits an axis in one plane.
pub const PLANE_BITS: u32 = 10;
/// From this bit on a word of the coarse plane says in two bits how far apart a point's neighbours lie: as far as its octant's
/// spacing says, times its node's `spacing_step` to the power of these bits. 0 in flat clouds.
pub const SPACING_EXPONENT_SHIFT: u32 = 3 * PLANE_BITS;
/// Bits of an f32 below a step of a sequential point tree's lengths; see [`crate::spt::Scale`].
pub const STEP_SHIFT: u32 = 20;
/// The step above every tolerance.
pub const ENDLESS_STEP: u32 = 255;

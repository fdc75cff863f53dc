//! How points lie in memory: what the builders write and the shaders read. `render` hands these constants to the
//! shaders.

/// Threads of a workgroup of the geometry stages [2022 §3.2].
pub const WORKGROUP_SIZE: u32 = 128;
/// Points a batch holds at most: 128 threads × 80 points [2022 §3.2].
pub const BATCH_POINTS: u32 = 10_240;
/// Points a thread loads at once, as one 128-bit load [2022 §3.4].
pub const POINTS_PER_LOAD: u32 = 4;
/// Points of a page of the pool: an octree's node has pages of its own, so that it can come and go. Its last page is
/// half empty on average, which wastes some 0.3 % of a node.
pub const PAGE_POINTS: u32 = 128;
/// Bits of a quantized coordinate; three planes of [`PLANE_BITS`].
pub const COORDINATE_BITS: u32 = 30;
/// Bits an axis in one plane.
pub const PLANE_BITS: u32 = 10;
/// Place of the spacing exponent in a word of the coarse plane: two bits that tell how far apart a point's neighbors
/// lie. The distance is the octant's spacing times the node's `spacing_step` to the power of the exponent, which is 0
/// in flat clouds.
pub const SPACING_EXPONENT_SHIFT: u32 = 3 * PLANE_BITS;
/// Bits of an f32 that a sequential point tree's lengths drop to become steps; see [`crate::spt::StepScale`].
pub const STEP_SHIFT: u32 = 20;
/// The step above every tolerance.
pub const ENDLESS_STEP: u32 = 255;

/// Bits of an axis in a word of a plane.
pub const PLANE_MASK: u32 = (1 << PLANE_BITS) - 1;
/// The place of y in a word of a plane.
pub const Y_SHIFT: u32 = PLANE_BITS;
/// The place of z in a word of a plane.
pub const Z_SHIFT: u32 = 2 * PLANE_BITS;
/// The place of the coarse plane's bits in a coordinate.
pub const COARSE_SHIFT: u32 = 2 * PLANE_BITS;
/// The place of the middle plane's bits in a coordinate.
pub const MIDDLE_SHIFT: u32 = PLANE_BITS;
/// The bits of a coordinate's word that the coarse plane has, and the two above.
pub const COARSE_MASK: u32 = u32::MAX << COARSE_SHIFT;
/// The bits of a coordinate's word that the coarse and the middle plane have, and the two above.
pub const MIDDLE_MASK: u32 = u32::MAX << MIDDLE_SHIFT;
/// Half of the range that the coarse plane leaves open of a coordinate.
pub const COARSE_CENTER: u32 = 1 << (COARSE_SHIFT - 1);
/// Half of the range that the coarse and the middle plane leave open of a coordinate.
pub const MIDDLE_CENTER: u32 = 1 << (MIDDLE_SHIFT - 1);
/// The place of a coordinate's highest bit; the three axes' highest bits tell the octant of its node that a point is
/// in.
pub const OCTANT_SHIFT: u32 = COORDINATE_BITS - 1;
/// Cells that a box edge has.
pub const CELLS: f32 = (1u32 << COORDINATE_BITS) as f32;

/// A stored color: the place of green, above red.
pub const GREEN_SHIFT: u32 = 8;
/// A stored color: the place of blue.
pub const BLUE_SHIFT: u32 = 16;
/// A stored color: the place of alpha.
pub const ALPHA_SHIFT: u32 = 24;
/// A stored color: a channel's bits.
pub const CHANNEL_MASK: u32 = 255;
/// A stored color: the bits of red, green and blue.
pub const RGB_MASK: u32 = (1 << ALPHA_SHIFT) - 1;
/// A stored color: the alpha that all have.
pub const OPAQUE: u32 = CHANNEL_MASK << ALPHA_SHIFT;

/// A step's bits in words of discs and triangles.
pub const STEP_MASK: u32 = 255;
/// A disc's word: the place of the step below which it is drawn; the step from which on it is drawn has the lowest
/// bits. A batch's interval is laid out in the same way.
pub const UNTIL_SHIFT: u32 = 8;
/// A disc's word: the place of its diameter's step.
pub const DIAMETER_SHIFT: u32 = 16;
/// A triangle's word: the place of its second corner, above the first.
pub const SECOND_CORNER_SHIFT: u32 = 8;
/// A triangle's word: the place of its third corner.
pub const THIRD_CORNER_SHIFT: u32 = 16;
/// A triangle's word: a corner's bits.
pub const CORNER_MASK: u32 = 255;
/// A triangle's word: the place of its longest side's step.
pub const SIDE_SHIFT: u32 = 24;

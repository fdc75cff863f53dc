//! Bits of the structs' `flags`.

#[cfg(doc)]
use super::{GpuNode, ViewUniform, VisibleBatch};

/// [`ViewUniform::flags`]: points of a node appear one by one.
pub const LOD_FADE: u32 = 1;
/// [`ViewUniform::flags`]: thresholds grow smoothly from ring to ring.
pub const LOD_SMOOTH: u32 = 2;
/// [`GpuNode::flags`]: drawn whole, always.
pub const NODE_WHOLE: u32 = 1;
/// [`GpuNode::flags`]: drawn always, though with fewer points when it is small.
pub const NODE_ROOT: u32 = 2;
/// [`GpuNode::flags`]: its points are on the GPU. A node without this is not drawn.
pub const NODE_RESIDENT: u32 = 4;
/// [`VisibleBatch::flags`]: planes to read, [`COARSE_PLANES`] to [`ALL_PLANES`].
pub const VISIBLE_PLANES: u32 = 3;
/// Planes to read for the coarse bits of coordinates alone.
pub const COARSE_PLANES: u32 = 1;
/// Planes to read for the coarse and the middle bits of coordinates.
pub const MIDDLE_PLANES: u32 = 2;
/// Planes to read for all bits of coordinates.
pub const ALL_PLANES: u32 = 3;
/// [`VisibleBatch::flags`]: seen by the left eye. The bit above: seen by the right eye.
pub const VISIBLE_BY_EYE: u32 = 16;
/// [`VisibleBatch::flags`]: points may be further apart than a kernel reaches.
pub const VISIBLE_FILL: u32 = 64;
/// [`VisibleBatch::flags`]: some points may be splats that reach farther than [`super::OWN_FILL_RADIUS`].
pub const VISIBLE_WIDE: u32 = 128;
/// [`VisibleBatch::flags`]: the first bit that the frame leaves to other techniques, up to [`SLICE_SHIFT`].
pub const VISIBLE_OTHERS: u32 = 256;
/// [`VisibleBatch::flags`]: the place of a slice's number, 8 bits.
pub const SLICE_SHIFT: u32 = 16;
/// [`VisibleBatch::flags`]: the place of the number of slices less one, 8 bits.
pub const NUM_SLICES_SHIFT: u32 = 24;

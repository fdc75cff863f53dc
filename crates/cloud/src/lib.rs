//! Pure CPU: points to Morton-ordered batches of quantized planes, ready for the GPU. Names no GPU API.

mod build;
pub mod format;
mod index;
#[cfg(test)]
mod made_up;
pub mod morton;
pub mod octree;
pub mod quantize;
pub mod spt;

pub use build::{BuildError, CodedPoint, build, build_rearranged};

use base::space::{Bounds, Split};
use glam::DVec3;
use points::Scene;

/// A run of consecutive points and the box that they are quantized in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Batch {
    /// First point in the planes; a multiple of [`crate::format::POINTS_PER_LOAD`].
    pub first_point: u32,
    /// Points; at most [`crate::format::BATCH_POINTS`].
    pub num_points: u32,
    /// Box minimum, world space.
    pub min: DVec3,
    /// Edge of a 30-bit cell an axis, world units; 12 bits of mantissa, 0 on a flat axis.
    pub cell: [f32; 3],
}

/// A cloud as the GPU wants it.
#[derive(Clone, Debug)]
pub struct Cloud {
    /// How world positions become the GPU's pairs of f32.
    pub split: Split,
    /// True box of the points, world space.
    pub bounds: Bounds,
    /// The scan's scene.
    pub scene: Scene,
    /// Batches in the order of their points in the planes.
    pub batches: Vec<Batch>,
    /// Coordinate planes: bits 20–29, 10–19, 0–9; each x | y≪10 | z≪20. Gaps between batches (to keep
    /// 128-bit loads aligned) hold zeros.
    pub planes: [Vec<u32>; 3],
    /// r | g≪8 | b≪16 | 255≪24, sRGB as stored.
    pub colors: Vec<u32>,
    /// Points, gaps not counted.
    pub num_points: u64,
}

//! The CPU reference of the GPU's stages, one file a stage, written to be compared with the shaders: the same
//! f32 operations in the same order, so that integer buffers match bit for bit. Knows no GPU API.

pub mod clear;
pub mod cull;
pub mod depth;
pub mod dilate;
pub mod resolve;

use crate::cloud::Cloud;
use crate::layout::{Batch, Detail, ViewUniform};
use crate::space::View;

/// The frame of a flat cloud: a pixel buffer an eye, and its image as r | g≪8 | b≪16 | a≪24 a pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// depth ≪ 32 | point index, an eye.
    pub depth: Vec<Vec<u64>>,
    /// The images.
    pub images: Vec<Vec<u32>>,
    /// Batches drawn.
    pub num_visible: u32,
    /// Points in them.
    pub points_read: u64,
}

/// Draws `cloud` as the GPU does; `forced_planes` as in [`ViewUniform`].
#[must_use]
pub fn frame(cloud: &Cloud, view: &View, forced_planes: u32, background: [u8; 3]) -> Frame {
    let uniform = ViewUniform::new(view, &cloud.split, &Detail { forced_planes, ..Detail::default() });
    let num_eyes = view.eyes.len();
    let batches = batches(cloud);
    let visible = cull::cull(&uniform, num_eyes, &batches);
    let mut depth: Vec<Vec<u64>> = view.eyes.iter().map(|e| clear::pixels(e.size_px)).collect();
    depth::depth(&uniform, &visible, [&cloud.planes[0], &cloud.planes[1], &cloud.planes[2]], &mut depth);
    let images = depth.iter().map(|d| resolve::resolve(d, &cloud.colors, background)).collect();
    Frame {
        depth,
        images,
        num_visible: visible.len() as u32,
        points_read: visible.iter().map(|v| u64::from(v.num_points)).sum(),
    }
}

/// The batches as one chunk holds them.
#[must_use]
pub fn batches(cloud: &Cloud) -> Vec<Batch> {
    let batch =
        |b: &crate::cloud::Batch| Batch::new(&cloud.split, b.min, b.cell, b.first_point, b.num_points);
    cloud.batches.iter().map(batch).collect()
}

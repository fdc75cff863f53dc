//! What the geometry stages do in a frame, counted rather than timed: for tables, in frames of their own.

use bytemuck::{Pod, Zeroable};
use render::gpu::Gpu;

/// As shaders name the bins.
pub const COUNT_BINS_NAME: &str = "count_bins";
/// Bins of [`Counts`], of which workgroups use one each, so that few threads meet.
pub const COUNT_BINS: u32 = 256;

/// What was done in the frames so far, all eyes together.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Pod, Zeroable)]
pub struct Counts {
    /// Points, discs and triangles that asked for a pixel.
    pub num_drawn: u32,
    /// Atomics, or writes where there are none, for pixels.
    pub num_asked: u32,
    /// Loads of a pixel's word, to see whether it is worth an atomic, or how near the surface is.
    pub num_looks: u32,
    /// Loads of a point's color.
    pub num_colors: u32,
    /// Discs of a point tree that the tolerance draws, in the picture or not, in each stage anew.
    pub num_chosen: u32,
    /// Always 0.
    pub reserved: [u32; 3],
}

/// Empty bins, to be added up.
pub(super) fn bins(gpu: &Gpu) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    gpu.buffer("counts", u64::from(COUNT_BINS) * size_of::<Counts>() as u64, usage)
}

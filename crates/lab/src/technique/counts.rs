//! Counters of what the geometry stages do in a frame, for tables. They run in frames of their own, which are not
//! timed.

use bytemuck::{Pod, Zeroable};
use render::gpu::Gpu;
use render::layout::WORKGROUP_SIZE;

/// Name by which shaders bind the bins.
pub const COUNT_BINS_NAME: &str = "count_bins";

/// Counts over the frames so far, all eyes together.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Pod, Zeroable)]
pub struct Counts {
    /// Points, discs and triangles that asked for a pixel.
    pub num_drawn: u32,
    /// Atomics for pixels, or writes in methods without atomics.
    pub num_asked: u32,
    /// Loads of a pixel's word, to see whether it is worth an atomic, or how near the surface is.
    pub num_reads: u32,
    /// Loads of a point's color.
    pub num_colors: u32,
    /// Discs of a point tree that the tolerance chooses, in the picture or not; each geometry stage counts them again.
    pub num_chosen: u32,
    /// Always 0.
    pub reserved: [u32; 3],
}

/// Makes bins of zeros, one for each thread of a workgroup, so that few contend for a counter. Their sum is the count.
pub(super) fn bins(gpu: &Gpu) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    gpu.buffer("counts", u64::from(WORKGROUP_SIZE) * size_of::<Counts>() as u64, usage)
}

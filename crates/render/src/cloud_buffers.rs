//! A cloud on the GPU, cut into chunks that fit the adapter's largest storage binding: one on an ordinary GPU,
//! several on a software driver.

use crate::gpu::Gpu;
use crate::layout::{ChunkUniform, MAX_EXTRA_SLICES, VisibleBatch};
use base::space::Split;
use base::task::Progress;
use cloud::Cloud;
use cloud::octree::Octree;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::upload::{CloudUpload, UploadError, Whole};
use bytemuck::Pod;

/// A cloud on the GPU: handles, which can be cloned.
#[derive(Clone, Debug)]
pub struct CloudBuffers {
    /// How world positions become the batches' pairs of f32.
    pub split: Split,
    /// Points in all chunks, once all have come.
    pub num_points: u64,
    /// Bytes in all buffers.
    pub bytes: u64,
    /// True if a pixel may get more points than the packed sums hold; see [`crate::layout::Sums`].
    pub(super) is_crowded: bool,
    /// Buffers of it that shaders of a technique bind, by name.
    pub(super) besides: Vec<(&'static str, wgpu::Buffer)>,
    /// True if it is no flat cloud.
    pub(super) has_detail: bool,
    /// Points that are resident.
    pub(super) num_resident: Arc<AtomicU64>,
    /// Nodes, each with a state.
    pub(super) num_nodes: u32,
    /// Nodes of an octree; those of another cloud are always drawn whole.
    pub(super) nodes: wgpu::Buffer,
    pub(super) states: wgpu::Buffer,
    /// A word a node, used while a frame's visible nodes are counted.
    pub(super) counted: wgpu::Buffer,
    pub(super) chunks: Vec<Chunk>,
}

/// A run of batches with their points.
#[derive(Clone, Debug)]
pub(super) struct Chunk {
    pub(super) uniform: ChunkUniform,
    pub(super) num_batches: u32,
    pub(super) chunk: wgpu::Buffer,
    pub(super) batches: wgpu::Buffer,
    pub(super) visible: wgpu::Buffer,
    pub(super) planes: [wgpu::Buffer; 3],
    pub(super) colors: wgpu::Buffer,
    /// The column beside the colors, if there is one, by the name that shaders have for it.
    pub(super) column: Option<(&'static str, wgpu::Buffer)>,
}

impl Chunk {
    /// Batches and slices that its list of visible ones holds at most.
    pub(super) fn num_slots(&self) -> u32 {
        // The list has no more entries than a dispatch has workgroups.
        (self.visible.size() / size_of::<VisibleBatch>() as u64) as u32
    }

    /// The column of this name.
    pub(super) fn column(&self, name: &str) -> Option<&wgpu::Buffer> {
        self.column.as_ref().filter(|(own, _)| *own == name).map(|(_, column)| column)
    }

    /// Planes, colors, and the column beside the colors, if there is one.
    pub(super) fn columns(&self) -> impl Iterator<Item = &wgpu::Buffer> {
        let [hi, mid, lo] = &self.planes;
        let beside = self.column.as_ref().map(|(_, column)| column);
        [hi, mid, lo, &self.colors].into_iter().chain(beside)
    }
}

impl CloudBuffers {
    /// Sends a flat cloud to the GPU; `chunk_limit` caps the bytes of a plane in one chunk (0: what the GPU
    /// allows). Meant for a thread of its own: it shares the queue with the frame thread piece by piece.
    ///
    /// # Errors
    /// See [`UploadError`].
    pub fn upload(
        gpu: &Gpu,
        cloud: &Cloud,
        chunk_limit: u64,
        progress: &Progress,
    ) -> Result<Self, UploadError> {
        CloudUpload::flat(gpu, cloud, chunk_limit, progress)
    }

    /// Sends a cloud that a technique draws to the GPU, all at once; see [`Self::upload`].
    ///
    /// # Errors
    /// See [`UploadError`].
    pub fn upload_whole<B: Pod>(
        gpu: &Gpu,
        whole: Whole<B>,
        chunk_limit: u64,
        progress: &Progress,
    ) -> Result<Self, UploadError> {
        CloudUpload::whole(gpu, whole, chunk_limit, progress)
    }

    /// Sends a layered cloud to the GPU, all at once; see [`Self::upload`].
    ///
    /// # Errors
    /// See [`UploadError`].
    pub fn upload_layered(
        gpu: &Gpu,
        octree: &Octree,
        chunk_limit: u64,
        progress: &Progress,
    ) -> Result<Self, UploadError> {
        CloudUpload::whole_octree(gpu, octree, chunk_limit, progress)
    }

    /// How many chunks the points fill; 1 on an ordinary GPU.
    #[must_use]
    pub fn num_chunks(&self) -> usize {
        self.chunks.len()
    }

    /// The buffer of it that a technique's shaders bind by this name; see [`Whole::besides`].
    #[must_use]
    pub fn besides(&self, name: &str) -> Option<&wgpu::Buffer> {
        self.besides.iter().find(|(own, _)| *own == name).map(|(_, buffer)| buffer)
    }

    /// True if it has a buffer of this name for a technique's shaders, in each of its chunks if it is a column.
    pub(super) fn has(&self, name: &str) -> bool {
        self.besides(name).is_some() || self.chunks.iter().all(|chunk| chunk.column(name).is_some())
    }

    /// Points that are resident.
    #[must_use]
    pub fn num_resident(&self) -> u64 {
        self.num_resident.load(Ordering::Relaxed)
    }
}

/// The column of an octree beside its colors.
pub(super) const FILTERED_COLORS: &str = "filtered_colors";

/// Entries for slices of batches. Batches of flat clouds have none: their points are never wide.
pub(super) fn num_extra_slices(column: Option<&str>) -> usize {
    if column.is_some() { MAX_EXTRA_SLICES as usize } else { 0 }
}

/// Makes buffers and counts their bytes.
pub(super) struct Allocator<'a> {
    pub gpu: &'a Gpu,
    pub bytes: u64,
}

impl Allocator<'_> {
    pub fn take(&mut self, label: &'static str, usage: wgpu::BufferUsages, size: usize) -> wgpu::Buffer {
        self.bytes += size as u64;
        self.gpu.buffer(label, size as u64, usage)
    }

    pub fn chunk(
        &mut self,
        uniform: ChunkUniform,
        (num_batches, batch_bytes): (usize, usize),
        column: Option<&'static str>,
    ) -> Chunk {
        let storage = wgpu::BufferUsages::STORAGE;
        let written = storage | wgpu::BufferUsages::COPY_DST;
        let uniform_usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let mut words = |label| self.take(label, written, 4 * uniform.num_points as usize);
        let planes = [words("plane_hi"), words("plane_mid"), words("plane_lo")];
        let colors = words("colors");
        let num_extra = num_extra_slices(column);
        let column = column.map(|name| (name, words(name)));
        Chunk {
            uniform,
            num_batches: num_batches as u32,
            chunk: self.take("chunk", uniform_usage, size_of::<ChunkUniform>()),
            batches: self.take("batches", written, num_batches * batch_bytes),
            visible: self.take(
                "visible",
                storage | wgpu::BufferUsages::COPY_SRC,
                (num_batches + num_extra) * size_of::<VisibleBatch>(),
            ),
            planes,
            colors,
            column,
        }
    }
}

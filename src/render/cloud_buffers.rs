//! A cloud on the GPU, cut into chunks that fit the adapter's largest storage binding: one on an ordinary GPU,
//! several on a software driver.

use crate::cloud::Cloud;
use crate::gpu::Gpu;
use crate::layout::{BATCH_POINTS, Batch, ChunkUniform, VisibleBatch};
use crate::progress::Progress;
use crate::space::Split;

/// Bytes handed to the queue at once. Small, so that the frame thread never waits long for the queue lock.
const PIECE_BYTES: usize = 2 << 20;
/// Bytes under way to the GPU before the uploader waits for it.
const PENDING_BYTES: usize = 64 << 20;

/// Why a cloud is not on the GPU.
#[derive(Debug, thiserror::Error)]
pub enum UploadError {
    /// It does not fit.
    #[error("the GPU has no room for the scan's {points} points ({bytes} bytes): {source}")]
    OutOfMemory {
        /// Points of the scan.
        points: u64,
        /// Bytes they need.
        bytes: u64,
        /// The driver's words.
        source: wgpu::Error,
    },
    /// The device was lost.
    #[error("the GPU stopped answering while the scan was sent to it: {0}")]
    Lost(#[from] wgpu::PollError),
    /// The user asked to stop.
    #[error("interrupted")]
    Stopped,
}

/// A cloud on the GPU.
#[derive(Debug)]
pub struct CloudBuffers {
    /// How world positions become the batches' pairs of f32.
    pub split: Split,
    /// Points in all chunks.
    pub num_points: u64,
    /// Bytes in all buffers.
    pub bytes: u64,
    pub(super) chunks: Vec<Chunk>,
}

/// A run of batches with their points.
#[derive(Debug)]
pub(super) struct Chunk {
    pub(super) uniform: ChunkUniform,
    pub(super) num_batches: u32,
    pub(super) chunk: wgpu::Buffer,
    pub(super) batches: wgpu::Buffer,
    pub(super) visible: wgpu::Buffer,
    pub(super) planes: [wgpu::Buffer; 3],
    pub(super) colors: wgpu::Buffer,
}

impl CloudBuffers {
    /// Sends a cloud to the GPU; `chunk_limit` caps the bytes of a plane in one chunk (0: what the GPU allows).
    /// Meant for a thread of its own: it shares the queue with the frame thread piece by piece.
    ///
    /// # Errors
    /// See [`UploadError`].
    pub fn upload(
        gpu: &Gpu,
        cloud: &Cloud,
        chunk_limit: u64,
        progress: &Progress,
    ) -> Result<Self, UploadError> {
        let limit = if chunk_limit == 0 { u64::MAX } else { chunk_limit }.min(gpu.binding_limit());
        let max_batches = gpu.device.limits().max_compute_workgroups_per_dimension as usize;
        let mut uploader = Uploader { gpu, progress, pending: 0, bytes: 0 };
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let chunks: Result<Vec<Chunk>, UploadError> =
            chunk_ranges(cloud, limit, max_batches).into_iter().map(|r| uploader.chunk(cloud, r)).collect();
        // Vulkan reports at once: the scope's future is ready.
        if let Some(source) = crate::gpu::block_on(scope.pop()) {
            return Err(UploadError::OutOfMemory { points: cloud.num_points, bytes: uploader.bytes, source });
        }
        let chunks = chunks?;
        Ok(Self { split: cloud.split, num_points: cloud.num_points, bytes: uploader.bytes, chunks })
    }

    /// How many chunks the points fill; 1 on an ordinary GPU.
    #[must_use]
    pub fn num_chunks(&self) -> usize {
        self.chunks.len()
    }
}

/// Consecutive batches whose planes fit `limit` bytes and one dispatch.
fn chunk_ranges(cloud: &Cloud, limit: u64, max_batches: usize) -> Vec<std::ops::Range<usize>> {
    // At least one batch fits: no adapter binds less than 128 MiB, and a lower wish is raised to a batch.
    let max_points = (limit / 4).max(u64::from(BATCH_POINTS));
    let end =
        |i: usize| cloud.batches.get(i).map_or(cloud.planes[0].len() as u64, |b| u64::from(b.first_point));
    let mut ranges = Vec::new();
    let mut first = 0;
    for i in 0..cloud.batches.len() {
        if end(i + 1) - end(first) > max_points || i - first >= max_batches {
            ranges.push(first..i);
            first = i;
        }
    }
    ranges.push(first..cloud.batches.len());
    ranges.retain(|r| !r.is_empty());
    ranges
}

struct Uploader<'a> {
    gpu: &'a Gpu,
    progress: &'a Progress,
    pending: usize,
    bytes: u64,
}

impl Uploader<'_> {
    fn chunk(&mut self, cloud: &Cloud, range: std::ops::Range<usize>) -> Result<Chunk, UploadError> {
        let batches = &cloud.batches[range.clone()];
        let first = batches[0].first_point as usize;
        let end = cloud.batches.get(range.end).map_or(cloud.planes[0].len(), |b| b.first_point as usize);
        let gpu_batches: Vec<Batch> = batches
            .iter()
            .map(|b| Batch::new(&cloud.split, b.min, b.cell, b.first_point - first as u32, b.num_points))
            .collect();
        let uniform =
            ChunkUniform { first_index: first as u32, num_points: (end - first) as u32, reserved: [0; 2] };
        let storage = wgpu::BufferUsages::STORAGE;
        let visible_bytes = size_of_val(batches) / size_of_val(&batches[0]) * size_of::<VisibleBatch>();
        Ok(Chunk {
            uniform,
            num_batches: batches.len() as u32,
            chunk: self.buffer("chunk", wgpu::BufferUsages::UNIFORM, bytemuck::bytes_of(&uniform))?,
            batches: self.buffer("batches", storage, bytemuck::cast_slice(&gpu_batches))?,
            visible: self.empty("visible", storage | wgpu::BufferUsages::COPY_SRC, visible_bytes as u64),
            planes: [
                self.words("plane_hi", &cloud.planes[0][first..end])?,
                self.words("plane_mid", &cloud.planes[1][first..end])?,
                self.words("plane_lo", &cloud.planes[2][first..end])?,
            ],
            colors: self.words("colors", &cloud.colors[first..end])?,
        })
    }

    fn words(&mut self, label: &'static str, words: &[u32]) -> Result<wgpu::Buffer, UploadError> {
        self.buffer(label, wgpu::BufferUsages::STORAGE, bytemuck::cast_slice(words))
    }

    fn empty(&mut self, label: &'static str, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
        self.bytes += size;
        self.gpu.buffer(label, size, usage)
    }

    fn buffer(
        &mut self,
        label: &'static str,
        usage: wgpu::BufferUsages,
        contents: &[u8],
    ) -> Result<wgpu::Buffer, UploadError> {
        let buffer = self.empty(label, usage | wgpu::BufferUsages::COPY_DST, contents.len() as u64);
        for (number, piece) in contents.chunks(PIECE_BYTES).enumerate() {
            if self.progress.stopped() {
                return Err(UploadError::Stopped);
            }
            let submission = {
                let queue = self.gpu.queue.lock();
                queue.write_buffer(&buffer, (number * PIECE_BYTES) as u64, piece);
                queue.submit([])
            };
            self.pending += piece.len();
            if self.pending > PENDING_BYTES {
                let wait = wgpu::PollType::Wait { submission_index: Some(submission), timeout: None };
                self.gpu.device.poll(wait)?;
                self.pending = 0;
            }
            self.progress.add(piece.len() as u64);
        }
        Ok(buffer)
    }
}

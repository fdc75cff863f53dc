//! A cloud on the GPU, cut into chunks that fit the adapter's largest storage binding: one on an ordinary GPU,
//! several on a software driver.

use crate::gpu::Gpu;
use crate::layout::{BATCH_POINTS, Batch, ChunkUniform, MAX_EXTRA_SLICES, Node, VisibleBatch};
use base::progress::Progress;
use base::space::Split;
use cloud::Cloud;
use cloud::octree::Octree;
use cloud::spt::SequentialCloud;
use std::ops::Range;

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
    /// A pixel may get more points than the packed sums hold; see [`crate::layout::Sums`].
    pub(super) is_crowded: bool,
    /// Of a sequential point tree's lengths; see [`cloud::spt::Scale`].
    pub(super) step_base: u32,
    /// It is no flat cloud.
    pub(super) has_detail: bool,
    pub(super) num_nodes: u32,
    pub(super) nodes: wgpu::Buffer,
    pub(super) states: wgpu::Buffer,
    /// One a node, while a frame's visible nodes are counted.
    pub(super) counted: wgpu::Buffer,
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
    /// But in an octree the same buffer as `colors`.
    pub(super) filtered_colors: wgpu::Buffer,
    /// But in a sequential point tree the same buffer as `colors`.
    pub(super) shapes: wgpu::Buffer,
}

impl Chunk {
    /// Batches and slices that its list of visible ones holds at most.
    pub(super) fn num_slots(&self) -> u32 {
        // No more than workgroups of a dispatch.
        (self.visible.size() / size_of::<VisibleBatch>() as u64) as u32
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
        let mut upload = CloudUpload::flat(gpu, cloud, chunk_limit, progress)?;
        upload.write(cloud, None, 0..cloud.planes[0].len())?;
        Ok(upload.finish())
    }

    /// Sends a sequential point tree to the GPU, all at once; see [`Self::upload`].
    ///
    /// # Errors
    /// See [`UploadError`].
    pub fn upload_sequential(
        gpu: &Gpu,
        spt: &SequentialCloud,
        chunk_limit: u64,
        progress: &Progress,
    ) -> Result<Self, UploadError> {
        let mut upload = CloudUpload::sequential(gpu, spt, chunk_limit, progress)?;
        upload.write(&spt.cloud, Some(&spt.shapes), 0..spt.shapes.len())?;
        Ok(upload.finish())
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
        let mut upload = CloudUpload::layered(gpu, octree, chunk_limit, progress)?;
        upload.write_nodes(octree, 0..octree.nodes.len())?;
        Ok(upload.finish())
    }

    /// Frees what no frame submitted from now on draws. It happens on this thread, which waits for the frames under
    /// way: they hold the buffers too, and would else be freed by whoever sees the last of them end.
    pub fn free(self, gpu: &Gpu) {
        // A lost device shows at the next submit; it holds nothing.
        let _ = gpu.device.poll(wgpu::PollType::wait_indefinitely());
    }

    /// How many chunks the points fill; 1 on an ordinary GPU.
    #[must_use]
    pub fn num_chunks(&self) -> usize {
        self.chunks.len()
    }
}

impl Chunk {
    /// The column beside the colours; `colors` itself if there is none.
    fn beside(&self) -> &wgpu::Buffer {
        if self.shapes == self.colors { &self.filtered_colors } else { &self.shapes }
    }
}

/// A column that some kinds of clouds have beside the colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Beside {
    /// Of an octree.
    FilteredColors,
    /// Of a sequential point tree.
    Shapes,
}

/// A cloud before its points are there.
#[derive(Clone, Copy)]
struct Outline<'a> {
    cloud: &'a Cloud,
    nodes: &'a [Node],
    /// The GPU's form of a batch in a chunk that begins with the given point.
    batch: &'a dyn Fn(usize, u32) -> Batch,
    beside: Option<Beside>,
}

/// A cloud on its way to the GPU: room for all of it is taken first, then its points are written as they come.
#[derive(Debug)]
pub struct CloudUpload<'a> {
    gpu: &'a Gpu,
    progress: &'a Progress,
    cloud: CloudBuffers,
    /// Bytes since the GPU was last waited for.
    pending: usize,
}

impl<'a> CloudUpload<'a> {
    /// Takes room for a flat cloud.
    ///
    /// # Errors
    /// See [`UploadError`].
    pub fn flat(
        gpu: &'a Gpu,
        cloud: &Cloud,
        chunk_limit: u64,
        progress: &'a Progress,
    ) -> Result<Self, UploadError> {
        let batch = |i: usize, first: u32| {
            Batch::new(&cloud.split, &cloud.batches[i], 0, cloud.batches[i].first_point - first)
        };
        let outline = Outline { cloud, nodes: &[Node::FLAT], batch: &batch, beside: None };
        Self::begin(gpu, &outline, chunk_limit, progress)
    }

    /// Takes room for a layered cloud, whose nodes and batches stand; its points may follow.
    ///
    /// # Errors
    /// See [`UploadError`].
    pub fn layered(
        gpu: &'a Gpu,
        octree: &Octree,
        chunk_limit: u64,
        progress: &'a Progress,
    ) -> Result<Self, UploadError> {
        let nodes: Vec<Node> = (0..octree.nodes.len()).map(|number| Node::new(octree, number)).collect();
        let mut node_of = vec![0; octree.cloud.batches.len()];
        for (number, node) in octree.nodes.iter().enumerate() {
            node_of[node.batches.start as usize..node.batches.end as usize].fill(number as u32);
        }
        let cloud = &octree.cloud;
        let batch = |i: usize, first: u32| {
            Batch::new(&cloud.split, &cloud.batches[i], node_of[i], cloud.batches[i].first_point - first)
        };
        let outline = Outline { cloud, nodes: &nodes, batch: &batch, beside: Some(Beside::FilteredColors) };
        let mut upload = Self::begin(gpu, &outline, chunk_limit, progress)?;
        upload.cloud.is_crowded = octree.is_crowded();
        Ok(upload)
    }

    /// Takes room for a sequential point tree.
    fn sequential(
        gpu: &'a Gpu,
        spt: &SequentialCloud,
        chunk_limit: u64,
        progress: &'a Progress,
    ) -> Result<Self, UploadError> {
        let nodes: Vec<Node> = spt.runs.iter().map(|run| Node::of_run(&spt.cloud.split, run)).collect();
        let run_of = |i: usize| spt.runs.partition_point(|run| run.batches.end as usize <= i) as u32;
        let batch = |i: usize, first: u32| Batch::of_discs(spt, i, run_of(i), first);
        let outline =
            Outline { cloud: &spt.cloud, nodes: &nodes, batch: &batch, beside: Some(Beside::Shapes) };
        let mut upload = Self::begin(gpu, &outline, chunk_limit, progress)?;
        upload.cloud.step_base = spt.scale.base;
        upload.cloud.num_points = spt.num_points;
        Ok(upload)
    }

    fn begin(
        gpu: &'a Gpu,
        outline: &Outline,
        chunk_limit: u64,
        progress: &'a Progress,
    ) -> Result<Self, UploadError> {
        let Outline { cloud, nodes, batch, beside } = *outline;
        let limit = if chunk_limit == 0 { u64::MAX } else { chunk_limit }.min(gpu.binding_limit());
        let max_groups = gpu.device.limits().max_compute_workgroups_per_dimension as usize;
        let max_batches = max_groups - num_extra_slices(beside);
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let mut room = Room { gpu, bytes: 0 };
        let storage = wgpu::BufferUsages::STORAGE;
        let nodes_buffer = room.take("nodes", storage | wgpu::BufferUsages::COPY_DST, size_of_val(nodes));
        let states = room.take("states", storage | wgpu::BufferUsages::COPY_SRC, 4 * nodes.len());
        let counted = room.take("counted", storage, 4 * nodes.len());
        let ranges = chunk_ranges(cloud, limit, max_batches);
        let chunks: Vec<Chunk> = ranges.iter().map(|r| room.chunk(cloud, r.clone(), beside)).collect();
        let bytes = room.bytes;
        // Vulkan reports at once: the scope's future is ready.
        if let Some(source) = crate::gpu::block_on(scope.pop()) {
            return Err(UploadError::OutOfMemory { points: cloud.num_points, bytes, source });
        }
        let cloud_buffers = CloudBuffers {
            split: cloud.split,
            num_points: cloud.num_points,
            bytes,
            is_crowded: true,
            step_base: 0,
            has_detail: beside.is_some(),
            num_nodes: nodes.len() as u32,
            nodes: nodes_buffer.clone(),
            states,
            counted,
            chunks,
        };
        let mut upload = Self { gpu, progress, cloud: cloud_buffers, pending: 0 };
        upload.send(&nodes_buffer, 0, bytemuck::cast_slice(nodes))?;
        for (number, range) in ranges.into_iter().enumerate() {
            let chunk = &upload.cloud.chunks[number];
            let (first, uniform) = (chunk.uniform.first_index, chunk.uniform);
            let (uniform_buffer, batches_buffer) = (chunk.chunk.clone(), chunk.batches.clone());
            let batches: Vec<Batch> = range.map(|i| batch(i, first)).collect();
            upload.send(&uniform_buffer, 0, bytemuck::bytes_of(&uniform))?;
            upload.send(&batches_buffer, 0, bytemuck::cast_slice(&batches))?;
        }
        Ok(upload)
    }

    /// Sends the points of a run of nodes.
    ///
    /// # Errors
    /// See [`UploadError`].
    pub fn write_nodes(&mut self, octree: &Octree, nodes: Range<usize>) -> Result<(), UploadError> {
        let start = |number: usize| {
            octree.nodes.get(number).map_or(octree.cloud.planes[0].len(), |n| n.first_point as usize)
        };
        let words = start(nodes.start)..start(nodes.end);
        self.write(&octree.cloud, Some(&octree.filtered_colors), words)
    }

    /// Sends a range of the planes, and of the column beside the colours, if there is one.
    fn write(
        &mut self,
        cloud: &Cloud,
        beside: Option<&[u32]>,
        words: Range<usize>,
    ) -> Result<(), UploadError> {
        for number in 0..self.cloud.chunks.len() {
            let chunk = &self.cloud.chunks[number];
            let first = chunk.uniform.first_index as usize;
            let part = words.start.max(first)..words.end.min(first + chunk.uniform.num_points as usize);
            if part.is_empty() {
                continue;
            }
            let [hi, mid, lo] = chunk.planes.clone();
            let columns = [
                (hi, Some(&cloud.planes[0][..])),
                (mid, Some(&cloud.planes[1][..])),
                (lo, Some(&cloud.planes[2][..])),
                (chunk.colors.clone(), Some(&cloud.colors[..])),
                (chunk.beside().clone(), beside),
            ];
            for (buffer, column) in columns.iter().filter_map(|(b, c)| Some((b, (*c)?))) {
                self.send(
                    buffer,
                    4 * (part.start - first) as u64,
                    bytemuck::cast_slice(&column[part.clone()]),
                )?;
            }
        }
        Ok(())
    }

    /// The cloud, to be shown.
    #[must_use]
    pub fn finish(self) -> CloudBuffers {
        self.cloud
    }

    /// Writes bytes piece by piece, waiting for the GPU now and then.
    fn send(&mut self, buffer: &wgpu::Buffer, offset: u64, contents: &[u8]) -> Result<(), UploadError> {
        for (number, piece) in contents.chunks(PIECE_BYTES).enumerate() {
            if self.progress.stopped() {
                return Err(UploadError::Stopped);
            }
            let submission = {
                let queue = self.gpu.queue.lock();
                queue.write_buffer(buffer, offset + (number * PIECE_BYTES) as u64, piece);
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
        Ok(())
    }
}

/// Consecutive batches whose planes fit `limit` bytes and one dispatch.
fn chunk_ranges(cloud: &Cloud, limit: u64, max_batches: usize) -> Vec<Range<usize>> {
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

/// Room for slices of batches, which have some only where points may be wide: in trees.
fn num_extra_slices(beside: Option<Beside>) -> usize {
    if beside.is_some() { MAX_EXTRA_SLICES as usize } else { 0 }
}

/// Makes buffers and counts their bytes.
struct Room<'a> {
    gpu: &'a Gpu,
    bytes: u64,
}

impl Room<'_> {
    fn take(&mut self, label: &'static str, usage: wgpu::BufferUsages, size: usize) -> wgpu::Buffer {
        self.bytes += size as u64;
        self.gpu.buffer(label, size as u64, usage)
    }

    fn chunk(&mut self, cloud: &Cloud, range: Range<usize>, beside: Option<Beside>) -> Chunk {
        let first = cloud.batches[range.start].first_point as usize;
        let end = cloud.batches.get(range.end).map_or(cloud.planes[0].len(), |b| b.first_point as usize);
        let uniform =
            ChunkUniform { first_index: first as u32, num_points: (end - first) as u32, reserved: [0; 2] };
        let storage = wgpu::BufferUsages::STORAGE;
        let written = storage | wgpu::BufferUsages::COPY_DST;
        let uniform_usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let mut words = |label| self.take(label, written, 4 * (end - first));
        let planes = [words("plane_hi"), words("plane_mid"), words("plane_lo")];
        let colors = words("colors");
        let mut only_in =
            |kind: Beside, label| if beside == Some(kind) { words(label) } else { colors.clone() };
        let filtered_colors = only_in(Beside::FilteredColors, "filtered_colors");
        let shapes = only_in(Beside::Shapes, "shapes");
        Chunk {
            uniform,
            num_batches: range.len() as u32,
            chunk: self.take("chunk", uniform_usage, size_of::<ChunkUniform>()),
            batches: self.take("batches", written, range.len() * size_of::<Batch>()),
            visible: self.take(
                "visible",
                storage | wgpu::BufferUsages::COPY_SRC,
                (range.len() + num_extra_slices(beside)) * size_of::<VisibleBatch>(),
            ),
            planes,
            colors,
            filtered_colors,
            shapes,
        }
    }
}

//! A cloud on its way to the GPU: room for all of it is taken first, then its points are written as they come. A node
//! is drawn from the first frame on that is submitted after all of its points were.

use crate::cloud_buffers::{Allocator, CloudBuffers, FILTERED_COLORS, num_extra_slices};
use crate::gpu::{Gpu, PollError};
use crate::layout::{CHILD_ABSENT, ChunkUniform, GpuBatch, GpuNode, NO_CHILD, NODE_RESIDENT};
use crate::pool::BatchPlaces;
use base::space::Split;
use base::task::{Cancelled, Progress};
use bytemuck::Pod;
use cloud::Cloud;
use cloud::octree::{self, Hierarchy, NodeBlock, Octree};
use std::ops::Range;
use std::sync::atomic::Ordering;

/// Bytes handed to the queue at once. Small, so that the frame thread never waits long for the queue lock.
const PIECE_BYTES: usize = 2 << 20;
/// Bytes under way to the GPU before the uploader waits for it.
const PENDING_BYTES: usize = 64 << 20;

/// Why a cloud is not on the GPU.
#[derive(Debug, thiserror::Error)]
pub enum UploadError {
    /// The cloud does not fit.
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
    Lost(#[from] PollError),
    /// The user asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A cloud that is sent all at once, with its points as they lie in memory, and with records of its batches (`B`) that a
/// technique's shaders read.
pub struct Whole<'a, B> {
    /// Its points and batches.
    pub cloud: &'a Cloud,
    /// Number of points to tell people.
    pub num_points: u64,
    /// What its technique's `lod` gives states to, in place of an octree's nodes.
    pub num_nodes: usize,
    /// Makes the record of a batch from its number and the place of its first point in its chunk.
    pub batch: &'a dyn Fn(usize, u32) -> B,
    /// A column beside the colors, by the name that shaders have for it.
    pub column: (&'static str, &'a [u32]),
    /// Buffers that shaders bind besides, by name.
    pub besides: Vec<(&'static str, wgpu::Buffer)>,
}

/// A cloud before its points are there.
struct Outline<'a> {
    split: Split,
    num_points: u64,
    batches: &'a [cloud::Batch],
    batch_bytes: usize,
    /// Words of a plane.
    num_words: usize,
    nodes: &'a [GpuNode],
    /// The column beside the colors.
    column: Option<&'static str>,
}

/// A cloud on its way to the GPU.
#[derive(Debug)]
pub struct CloudUpload<'a> {
    gpu: &'a Gpu,
    progress: &'a Progress,
    cloud: CloudBuffers,
    places: BatchPlaces,
    /// Nodes of an octree, as the GPU has them or will have them.
    nodes: Vec<GpuNode>,
    /// The node of each batch of an octree.
    node_of: Vec<u32>,
    /// Bytes sent since the GPU was last waited for.
    pending: usize,
}

impl<'a> CloudUpload<'a> {
    /// Takes room for a layered cloud, and draws nothing of it until its nodes come.
    ///
    /// # Errors
    /// See [`UploadError`].
    pub fn layered(
        gpu: &'a Gpu,
        hierarchy: &Hierarchy,
        chunk_limit: u64,
        progress: &'a Progress,
    ) -> Result<Self, UploadError> {
        let Hierarchy { split, nodes, batches, num_points, .. } = hierarchy;
        Self::of_nodes(gpu, (split, nodes, batches, *num_points), chunk_limit, progress)
    }

    /// Sends the points of consecutive nodes, whose parents have come before or are among them.
    ///
    /// # Errors
    /// See [`UploadError`].
    pub fn write_blocks(&mut self, hierarchy: &Hierarchy, blocks: &[NodeBlock]) -> Result<(), UploadError> {
        let Some(first) = blocks.first().map(|block| block.node) else { return Ok(()) };
        self.write_nodes(&hierarchy.nodes, &hierarchy.batches, first..first + blocks.len(), &|node| {
            let NodeBlock { planes: [hi, mid, lo], colors, filtered_colors, .. } = &blocks[node - first];
            [hi, mid, lo, colors, filtered_colors]
        })
    }

    /// The cloud to draw: its nodes that have come, and those that will.
    #[must_use]
    pub fn buffers(&self) -> CloudBuffers {
        self.cloud.clone()
    }

    /// See [`CloudBuffers::upload_layered`].
    pub(super) fn whole_octree(
        gpu: &'a Gpu,
        octree: &Octree,
        chunk_limit: u64,
        progress: &'a Progress,
    ) -> Result<CloudBuffers, UploadError> {
        let Octree { cloud, filtered_colors, nodes } = octree;
        let outline = (&cloud.split, &nodes[..], &cloud.batches[..], cloud.num_points);
        let mut upload = Self::of_nodes(gpu, outline, chunk_limit, progress)?;
        let [hi, mid, lo] = &cloud.planes;
        upload.write_nodes(nodes, &cloud.batches, 0..nodes.len(), &|number| {
            let node = &nodes[number];
            let points = node.first_point as usize..(node.first_point + node.num_points) as usize;
            [hi, mid, lo, &cloud.colors, filtered_colors].map(|column| &column[points.clone()])
        })?;
        Ok(upload.cloud)
    }

    /// See [`CloudBuffers::upload`].
    pub(super) fn flat(
        gpu: &'a Gpu,
        cloud: &Cloud,
        chunk_limit: u64,
        progress: &'a Progress,
    ) -> Result<CloudBuffers, UploadError> {
        let outline = Outline {
            split: cloud.split,
            num_points: cloud.num_points,
            batches: &cloud.batches,
            batch_bytes: size_of::<GpuBatch>(),
            num_words: cloud.planes[0].len(),
            nodes: &[GpuNode::FLAT],
            column: None,
        };
        let batch =
            |i: usize, first_point: u32| GpuBatch::new(&cloud.split, &cloud.batches[i], 0, first_point);
        let mut upload = Self::begin(gpu, outline, chunk_limit, progress)?;
        let [hi, mid, lo] = &cloud.planes;
        upload.write_whole(cloud, &[hi, mid, lo, &cloud.colors], &batch)?;
        Ok(upload.cloud)
    }

    /// See [`CloudBuffers::upload_whole`].
    pub(super) fn whole<B: Pod>(
        gpu: &'a Gpu,
        whole: Whole<B>,
        chunk_limit: u64,
        progress: &'a Progress,
    ) -> Result<CloudBuffers, UploadError> {
        let Whole { cloud, num_points, num_nodes, batch, column: (name, column), besides } = whole;
        let outline = Outline {
            split: cloud.split,
            num_points,
            batches: &cloud.batches,
            batch_bytes: size_of::<B>(),
            num_words: cloud.planes[0].len(),
            nodes: &vec![GpuNode::FLAT; num_nodes],
            column: Some(name),
        };
        let mut upload = Self::begin(gpu, outline, chunk_limit, progress)?;
        upload.cloud.bytes += besides.iter().map(|(_, buffer)| buffer.size()).sum::<u64>();
        upload.cloud.besides = besides;
        let [hi, mid, lo] = &cloud.planes;
        upload.write_whole(cloud, &[hi, mid, lo, &cloud.colors, column], batch)?;
        Ok(upload.cloud)
    }

    fn of_nodes(
        gpu: &'a Gpu,
        (split, nodes, batches, num_points): (&Split, &[octree::Node], &[cloud::Batch], u64),
        chunk_limit: u64,
        progress: &'a Progress,
    ) -> Result<Self, UploadError> {
        let mut node_of = vec![0; batches.len()];
        for (number, node) in nodes.iter().enumerate() {
            node_of[node.batches.start as usize..node.batches.end as usize].fill(number as u32);
        }
        let absent = |number: usize| {
            let whole = GpuNode::new(split, nodes, number);
            let children =
                whole.children.map(|child| if child == NO_CHILD { NO_CHILD } else { CHILD_ABSENT });
            GpuNode { children, flags: whole.flags & !NODE_RESIDENT, ..whole }
        };
        let gpu_nodes: Vec<GpuNode> = (0..nodes.len()).map(absent).collect();
        let outline = Outline {
            split: *split,
            num_points,
            batches,
            batch_bytes: size_of::<GpuBatch>(),
            num_words: octree::num_words(nodes),
            nodes: &gpu_nodes,
            column: Some(FILTERED_COLORS),
        };
        let mut upload = Self::begin(gpu, outline, chunk_limit, progress)?;
        (upload.nodes, upload.node_of) = (gpu_nodes, node_of);
        upload.cloud.is_crowded = octree::is_crowded(nodes);
        Ok(upload)
    }

    fn begin(
        gpu: &'a Gpu,
        outline: Outline,
        chunk_limit: u64,
        progress: &'a Progress,
    ) -> Result<Self, UploadError> {
        let Outline { split, num_points, batches, batch_bytes, num_words, nodes, column } = outline;
        let limit = if chunk_limit == 0 { u64::MAX } else { chunk_limit }.min(gpu.binding_limit());
        let max_groups = gpu.device.limits().max_compute_workgroups_per_dimension as usize;
        let max_batches = max_groups - num_extra_slices(column);
        let starts: Vec<u32> = batches.iter().map(|batch| batch.first_point).collect();
        // Numbers of words fit 32 bits: the builders make no more.
        let places = BatchPlaces::new(&starts, num_words as u32, limit, max_batches);
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let mut allocator = Allocator { gpu, bytes: 0 };
        let storage = wgpu::BufferUsages::STORAGE;
        let nodes_buffer =
            allocator.take("nodes", storage | wgpu::BufferUsages::COPY_DST, size_of_val(nodes));
        let states = allocator.take("states", storage | wgpu::BufferUsages::COPY_SRC, 4 * nodes.len());
        let counted = allocator.take("counted", storage, 4 * nodes.len());
        let chunks = places.chunks.iter().zip(&places.batches);
        let chunk = |(uniform, batches): (&ChunkUniform, &Range<usize>)| {
            allocator.chunk(*uniform, (batches.len(), batch_bytes), column)
        };
        let chunks = chunks.map(chunk).collect();
        let bytes = allocator.bytes;
        // Vulkan reports at once: the scope's future is ready.
        if let Some(source) = crate::gpu::block_on(scope.pop()) {
            return Err(UploadError::OutOfMemory { points: num_points, bytes, source });
        }
        let cloud = CloudBuffers {
            split,
            num_points,
            bytes,
            is_crowded: true,
            besides: vec![],
            has_detail: column.is_some(),
            num_resident: Default::default(),
            num_nodes: nodes.len() as u32,
            nodes: nodes_buffer,
            states,
            counted,
            chunks,
        };
        let mut upload = Self { gpu, progress, cloud, places, nodes: vec![], node_of: vec![], pending: 0 };
        for number in 0..upload.cloud.chunks.len() {
            let (buffer, uniform) =
                (upload.cloud.chunks[number].chunk.clone(), upload.cloud.chunks[number].uniform);
            upload.send(&buffer, 0, bytemuck::bytes_of(&uniform))?;
        }
        let buffer = upload.cloud.nodes.clone();
        upload.send(&buffer, 0, bytemuck::cast_slice(nodes))?;
        Ok(upload)
    }

    /// Sends a cloud whose points lie in the pool as they do in memory.
    fn write_whole<B: Pod>(
        &mut self,
        cloud: &Cloud,
        columns: &[&[u32]],
        batch: &dyn Fn(usize, u32) -> B,
    ) -> Result<(), UploadError> {
        for number in 0..self.cloud.chunks.len() {
            let (chunk, range) = (self.cloud.chunks[number].clone(), self.places.batches[number].clone());
            let first = cloud.batches[range.start].first_point as usize;
            let end = first + chunk.uniform.num_points as usize;
            for (buffer, column) in chunk.columns().zip(columns) {
                self.send(buffer, 0, bytemuck::cast_slice(&column[first..end]))?;
            }
            let batches: Vec<B> = range.map(|i| batch(i, self.places.places[i].first_point)).collect();
            self.send(&chunk.batches, 0, bytemuck::cast_slice(&batches))?;
        }
        self.cloud.num_resident.store(cloud.num_points, Ordering::Relaxed);
        Ok(())
    }

    /// Sends the points of a run of nodes, and then the nodes.
    fn write_nodes<'c>(
        &mut self,
        nodes: &[octree::Node],
        batches: &[cloud::Batch],
        run: Range<usize>,
        columns: &dyn Fn(usize) -> [&'c [u32]; 5],
    ) -> Result<(), UploadError> {
        let Some(last) = run.clone().next_back() else { return Ok(()) };
        let of_run = nodes[run.start].batches.start as usize..nodes[last].batches.end as usize;
        // Batches that lie in the same chunk are sent together.
        let mut from = of_run.start;
        while from < of_run.end {
            let number = self.places.places[from].chunk;
            let until = self.places.batches[number].end.min(of_run.end);
            let chunk = self.cloud.chunks[number].clone();
            let first = self.places.places[from].first_point;
            for (which, buffer) in chunk.columns().enumerate() {
                let mut words: Vec<u32> = Vec::new();
                for batch in from..until {
                    let node = &nodes[self.node_of[batch] as usize];
                    let of_node = (batches[batch].first_point - node.first_point) as usize;
                    let points = of_node..of_node + batches[batch].num_points as usize;
                    words.resize((self.places.places[batch].first_point - first) as usize, 0);
                    words.extend(&columns(self.node_of[batch] as usize)[which][points]);
                }
                self.send(buffer, 4 * u64::from(first), bytemuck::cast_slice(&words))?;
            }
            from = until;
        }
        self.show(nodes, batches, run, of_run)
    }

    /// Has nodes drawn whose points have been sent. All their batches appear in the same frame.
    fn show(
        &mut self,
        nodes: &[octree::Node],
        batches: &[cloud::Batch],
        run: Range<usize>,
        of_run: Range<usize>,
    ) -> Result<(), UploadError> {
        let mut touched: Vec<usize> = run.clone().collect();
        for number in run.clone() {
            let node = GpuNode::new(&self.cloud.split, nodes, number);
            // Its children are linked as they come.
            self.nodes[number].flags = node.flags;
            if let Some(parent) = nodes[number].parent.map(|parent| parent as usize) {
                let octant = nodes[parent].octant_of(&nodes[number]);
                self.nodes[parent].children[octant] = number as u32;
                touched.push(parent);
            }
        }
        touched.sort_unstable();
        touched.dedup();
        let batch = |i: usize| {
            GpuBatch::new(&self.cloud.split, &batches[i], self.node_of[i], self.places.places[i].first_point)
        };
        let gpu_batches: Vec<GpuBatch> = of_run.clone().map(batch).collect();
        let queue = self.gpu.queue.lock();
        for (i, batch) in of_run.zip(&gpu_batches) {
            let chunk = &self.cloud.chunks[self.places.places[i].chunk];
            let offset = self.places.slot(i) * size_of::<GpuBatch>();
            queue.write_buffer(&chunk.batches, offset as u64, bytemuck::bytes_of(batch));
        }
        for number in touched {
            let offset = number * size_of::<GpuNode>();
            queue.write_buffer(&self.cloud.nodes, offset as u64, bytemuck::bytes_of(&self.nodes[number]));
        }
        queue.submit([]);
        drop(queue);
        let num_points: u64 = run.map(|number| u64::from(nodes[number].num_points)).sum();
        self.cloud.num_resident.fetch_add(num_points, Ordering::Relaxed);
        Ok(())
    }

    /// Writes bytes piece by piece, waiting for the GPU now and then.
    fn send(&mut self, buffer: &wgpu::Buffer, offset: u64, contents: &[u8]) -> Result<(), UploadError> {
        for (number, piece) in contents.chunks(PIECE_BYTES).enumerate() {
            if self.progress.is_cancelled() {
                return Err(Cancelled.into());
            }
            let submission = {
                let queue = self.gpu.queue.lock();
                queue.write_buffer(buffer, offset + (number * PIECE_BYTES) as u64, piece);
                queue.submit([])
            };
            self.pending += piece.len();
            if self.pending > PENDING_BYTES {
                let wait = wgpu::PollType::Wait { submission_index: Some(submission), timeout: None };
                self.gpu.poll(wait)?;
                self.pending = 0;
            }
            self.progress.add(piece.len() as u64);
        }
        Ok(())
    }
}

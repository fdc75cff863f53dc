//! The way to the nearest points of `closest` quality: what it is asked for, and what it is told while a frame is
//! recorded. The frame has one of its own, [`Closest`]; techniques may have others.

use crate::bindings::{ChunkSet, EyeSet, GeometrySet};
use crate::cloud_buffers::CloudBuffers;
use crate::draw_options::Access;
use crate::frame::DEPTH;
use crate::gpu::Gpu;
use crate::gpu::stage::{ShaderError, Stage};
use crate::gpu::timer::Timer;
use crate::groups::{ClearedTarget, Parts};
use crate::layout::Variant;
use crate::shaders;
use crate::targets::Targets;
use std::fmt;
use timing::STAGES;

/// Finds each pixel's nearest point, and its color.
pub trait Nearest: fmt::Debug + Send {
    /// The targets that the frame clears before `depth`.
    fn cleared_targets(&self) -> &'static [ClearedTarget];

    /// Makes bind groups anew after a change of the cloud, the targets or their sizes.
    fn bind(&mut self, parts: &Parts<'_>);

    /// Records `depth`.
    fn record_depth(&self, encoder: &mut wgpu::CommandEncoder, recording: &Recording<'_>);

    /// Records the first step of `resolve` for an eye: the nearest points' depths and colors into its surface.
    fn record_shade(&self, pass: &mut wgpu::ComputePass<'_>, eye: usize, num_tiles: u32);
}

/// Parts of the renderer that recording a frame needs.
#[derive(Debug)]
pub struct Recording<'a> {
    pub(super) timer: &'a Timer,
    pub(super) cloud: Option<&'a CloudBuffers>,
    /// Counters of each chunk, [`crate::layout::COUNTERS_STRIDE`] bytes apart.
    pub counters: &'a wgpu::Buffer,
    /// Buffers that are drawn into.
    pub targets: &'a Targets,
}

impl Recording<'_> {
    /// Chunks of the cloud.
    #[must_use]
    pub fn num_chunks(&self) -> usize {
        self.cloud.map_or(0, |cloud| cloud.chunks.len())
    }

    /// The times of `depth`, if it is a render pass an eye.
    #[must_use]
    pub fn render_times(&self, eye: usize) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.timer.render(DEPTH, eye == 0, eye + 1 == self.targets.sizes_px.len())
    }

    /// The pass of `depth`, if it is a compute pass.
    #[must_use]
    pub fn compute_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::ComputePass<'e> {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(STAGES[DEPTH]),
            timestamp_writes: self.timer.compute(DEPTH, true, true),
        })
    }
}

/// The frame's own way: `depth`, then `shade`.
#[derive(Debug)]
pub(super) struct Closest {
    depth: Stage<GeometrySet>,
    /// Finds ids, if depth and id do not fit one atomic.
    ids: Option<Stage<GeometrySet>>,
    shade: Stage<(ChunkSet, EyeSet)>,
    /// Bind groups of `depth`, one a chunk, as those of `ids`.
    depth_groups: Vec<wgpu::BindGroup>,
    ids_groups: Vec<wgpu::BindGroup>,
    /// Bind groups of `shade`, one an eye and a chunk.
    shade_groups: Vec<Vec<wgpu::BindGroup>>,
}

impl Closest {
    pub fn new(gpu: &Gpu, variant: Variant, access: Access, others: &[&str]) -> Result<Self, ShaderError> {
        let geometry = |shader| Stage::of(gpu, shader, variant, access, others);
        Ok(Self {
            depth: geometry(shaders::DEPTH)?,
            ids: (!variant.keys).then(|| geometry(shaders::IDS)).transpose()?,
            shade: Stage::of(gpu, shaders::SHADE, variant, access, others)?,
            depth_groups: vec![],
            ids_groups: vec![],
            shade_groups: vec![],
        })
    }
}

impl Nearest for Closest {
    fn cleared_targets(&self) -> &'static [ClearedTarget] {
        // Without keys, their buffers hold ids.
        if self.ids.is_none() { &[ClearedTarget::Keys] } else { &[ClearedTarget::Depths, ClearedTarget::Ids] }
    }

    fn bind(&mut self, parts: &Parts<'_>) {
        self.depth_groups = parts.bind_geometry(&self.depth);
        self.ids_groups = self.ids.as_ref().map_or_else(Vec::new, |ids| parts.bind_geometry(ids));
        let shade = |eye| parts.each_chunk_of_eye(eye, |resources| self.shade.bind(parts.gpu, &resources));
        self.shade_groups = (0..parts.targets.sizes_px.len()).map(shade).collect();
    }

    fn record_depth(&self, encoder: &mut wgpu::CommandEncoder, recording: &Recording<'_>) {
        let mut pass = recording.compute_pass(encoder);
        self.depth.dispatch_visible(&mut pass, &self.depth_groups, recording.counters);
        if let Some(ids) = &self.ids {
            ids.dispatch_visible(&mut pass, &self.ids_groups, recording.counters);
        }
    }

    fn record_shade(&self, pass: &mut wgpu::ComputePass<'_>, eye: usize, num_tiles: u32) {
        for group in &self.shade_groups[eye] {
            self.shade.dispatch(pass, group, num_tiles);
        }
    }
}

//! Other ways to the nearest points of `closest` quality than the frame's stages: what they are asked for, and what
//! they are told while a frame is recorded.

use crate::cloud_buffers::CloudBuffers;
use crate::frame::DEPTH;
use crate::gpu::stage::Compiled;
use crate::gpu::timer::Timer;
use crate::groups::Parts;
use crate::layout::COUNTERS_STRIDE;
use crate::targets::Targets;
use std::fmt;
use timing::STAGES;

/// Which keys the frame clears before `depth`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clears {
    /// No keys: they are not used.
    Nothing,
    /// All keys, in the first frame after a change; afterwards the shading step leaves them clear.
    Once,
}

/// Finds each pixel's nearest point, and its color.
pub trait Nearest: fmt::Debug + Send {
    /// Which keys the frame clears for it.
    fn clears(&self) -> Clears;

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
    /// Counters of each chunk, [`COUNTERS_STRIDE`] bytes apart.
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

    /// Records `depth` as the frame does: a dispatch a chunk, a workgroup a visible batch.
    pub fn dispatch_visible(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        stage: &Compiled,
        groups: &[wgpu::BindGroup],
    ) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(STAGES[DEPTH]),
            timestamp_writes: self.timer.compute(DEPTH, true, true),
        });
        for (number, group) in groups.iter().enumerate() {
            let arguments = number as u64 * u64::from(COUNTERS_STRIDE);
            stage.dispatch_indirect(&mut pass, group, self.counters, arguments);
        }
    }
}

//! The frame as a contents list, and what it needs from one frame to the next.

use super::cloud_buffers::{Chunk, CloudBuffers};
use super::groups::{self, Groups, Parts};
use super::pipelines::{For, Pipelines};
use super::targets::{TargetTooLarge, Targets};
use crate::config::Quality;
use crate::gpu::stage::Stage;
use crate::gpu::timer::Timer;
use crate::gpu::{Atomics, Gpu, QueueGuard};
use crate::layout::{COUNTERS_STRIDE, CullCounters, Detail, Sums, ViewUniform, WORKGROUP_SIZE};
use crate::look::Look;
use crate::space::{Split, View};
use crate::timing::{STAGES, StageMs};
use std::sync::Arc;

/// Where each stage's times stand in [`STAGES`].
const CLEAR: usize = 0;
const LOD: usize = 1;
const CULL: usize = 2;
const DEPTH: usize = 3;
const COLOR: usize = 4;
const RESOLVE: usize = 5;

/// Chunks for which there are counters from the start; few clouds have more.
const NUM_COUNTERS: u64 = 16;

/// What the GPU tells of a frame, some frames late.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTimes {
    /// The frame's number.
    pub frame: u64,
    /// GPU time of each stage.
    pub stage_ms: StageMs,
    /// GPU time of them all.
    pub gpu_ms: f32,
    /// Batches that `depth` drew.
    pub visible_nodes: u32,
    /// Points in them.
    pub points_read: u64,
}

/// What a renderer draws to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setup {
    /// Width, height of each eye's image; one or two.
    pub sizes_px: Vec<[u32; 2]>,
    /// Format of the images, sRGB.
    pub color_format: wgpu::TextureFormat,
    /// Format of the depth images, if there are any.
    pub depth_format: Option<wgpu::TextureFormat>,
    /// The tier; see [`super::tier`].
    pub atomics: Atomics,
}

/// An eye's image to draw to.
#[derive(Clone, Copy, Debug)]
pub struct EyeImage<'a> {
    /// Where the colours go.
    pub color: &'a wgpu::TextureView,
    /// Where [`View::near`] / w goes, 0 where nothing is; given if [`Setup::depth_format`] is.
    pub depth: Option<&'a wgpu::TextureView>,
}

/// Draws frames of one or two eyes. Create once, give it a cloud, then for every frame: [`Renderer::record`],
/// [`Renderer::set_view`] as late as possible, submit, [`Renderer::submitted`].
#[derive(Debug)]
pub struct Renderer {
    pub(super) gpu: Arc<Gpu>,
    pub(super) setup: Setup,
    pub(super) look: Look,
    /// Factor on the thresholds of level of detail.
    lod_scale: f32,
    pub(super) pipelines: Pipelines,
    pub(super) view: wgpu::Buffer,
    pub(super) cloud: Option<CloudBuffers>,
    pub(super) counters: wgpu::Buffer,
    pub(super) targets: Targets,
    /// Sums of the frame's colors, which `dilate` writes over; see [`Self::keep_sums`].
    pub(super) kept_sums: Option<[wgpu::Buffer; 2]>,
    hidden: Vec<Vec<u32>>,
    groups: Groups,
    timer: Timer,
}

impl Renderer {
    /// A renderer without a cloud.
    ///
    /// # Errors
    /// If the sizes do not fit the device.
    pub fn new(gpu: &Arc<Gpu>, setup: Setup, look: Look) -> Result<Self, TargetTooLarge> {
        let pipelines = Pipelines::new(gpu, what(&setup, &look));
        let view_usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let view = gpu.buffer("view", size_of::<ViewUniform>() as u64, view_usage);
        let has_wide = needs_wide(&pipelines, None, look.quality);
        let targets = Targets::new(gpu, &setup.sizes_px, has_wide)?;
        let counters = counters_buffer(gpu, NUM_COUNTERS);
        let timer = Timer::new(gpu, STAGES.len(), counters.size());
        let mut renderer = Self {
            gpu: Arc::clone(gpu),
            setup,
            look,
            lod_scale: 1.0,
            pipelines,
            view,
            cloud: None,
            counters,
            targets,
            kept_sums: None,
            hidden: vec![],
            groups: Groups::default(),
            timer,
        };
        renderer.rebind();
        Ok(renderer)
    }

    /// Shows this cloud from the next frame on, and gives back the one before: dropping it may take a while.
    ///
    /// # Errors
    /// If what the cloud's sums need does not fit the device; then nothing has changed.
    pub fn set_cloud(&mut self, cloud: CloudBuffers) -> Result<Option<CloudBuffers>, TargetTooLarge> {
        self.fit_targets(needs_wide(&self.pipelines, Some(&cloud), self.look.quality))?;
        let num_chunks = cloud.chunks.len() as u64;
        if num_chunks * u64::from(COUNTERS_STRIDE) > self.counters.size() {
            self.counters = counters_buffer(&self.gpu, num_chunks);
            // Frames under way go without times.
            self.timer = Timer::new(&self.gpu, STAGES.len(), self.counters.size());
        }
        let before = self.cloud.replace(cloud);
        self.rebind();
        Ok(before)
    }

    /// New image sizes, one an eye.
    ///
    /// # Errors
    /// If they do not fit the device.
    pub fn resize(&mut self, sizes_px: &[[u32; 2]]) -> Result<(), TargetTooLarge> {
        if self.setup.sizes_px != sizes_px {
            self.targets = Targets::new(&self.gpu, sizes_px, self.targets.has_wide())?;
            self.setup.sizes_px = sizes_px.to_vec();
            self.hidden.clear();
            self.rebind();
        }
        Ok(())
    }

    /// Draws only this much of each image, from its top left corner on: no larger than the image. The views'
    /// eyes must have these sizes.
    pub fn set_drawn(&mut self, drawn_px: &[[u32; 2]]) {
        if self.targets.drawn_px != drawn_px {
            self.targets.drawn_px = drawn_px.to_vec();
            self.hidden.clear();
            self.rebind();
        }
    }

    /// Pixels of each eye's drawn part that nobody sees: a bit a pixel, rows of whole words.
    pub fn set_hidden(&mut self, hidden: Vec<Vec<u32>>) {
        self.hidden = hidden;
        self.rebind();
    }

    /// How frames look from the next one on. A change of the method, or of [`Detail::fill_reach_px`] from or to `None`,
    /// compiles pipelines; all else is quick.
    ///
    /// # Errors
    /// If what the quality needs does not fit the device; then nothing has changed.
    pub fn set_look(&mut self, look: Look) -> Result<(), TargetTooLarge> {
        self.fit_targets(needs_wide(&self.pipelines, self.cloud.as_ref(), look.quality))?;
        if what(&self.setup, &look) != what(&self.setup, &self.look) {
            self.pipelines = Pipelines::new(&self.gpu, what(&self.setup, &look));
        }
        self.look = look;
        self.rebind();
        Ok(())
    }

    /// What a pixel shows from the next frame on.
    ///
    /// # Errors
    /// See [`Self::set_look`].
    pub fn set_quality(&mut self, quality: Quality) -> Result<(), TargetTooLarge> {
        if quality == self.look.quality { Ok(()) } else { self.set_look(Look { quality, ..self.look }) }
    }

    /// Makes room for four-word sums where there is none.
    fn fit_targets(&mut self, needs_wide: bool) -> Result<(), TargetTooLarge> {
        if needs_wide && !self.targets.has_wide() {
            let targets = Targets::new(&self.gpu, &self.setup.sizes_px, true)?;
            let drawn_px = std::mem::take(&mut self.targets.drawn_px);
            self.targets = Targets { drawn_px, ..targets };
        }
        Ok(())
    }

    /// How frames look.
    #[must_use]
    pub fn look(&self) -> &Look {
        &self.look
    }

    /// Factor on the thresholds of level of detail, 1 or more.
    pub fn set_lod_scale(&mut self, scale: f32) {
        self.lod_scale = scale;
    }

    /// Points and bytes on the GPU.
    #[must_use]
    pub fn resident(&self) -> (u64, u64) {
        self.cloud.as_ref().map_or((0, 0), |c| (c.num_points, c.bytes))
    }

    /// How world positions become the shown cloud's pairs of f32.
    #[must_use]
    pub fn split(&self) -> Option<&Split> {
        self.cloud.as_ref().map(|c| &c.split)
    }

    /// The eyes' pixels, for pictures and tests.
    #[must_use]
    pub fn targets(&self) -> &Targets {
        &self.targets
    }

    /// An eye's finished pixels, (depth, color), for pictures.
    #[must_use]
    pub fn pixels(&self, eye: usize) -> &wgpu::Buffer {
        &self.targets.finished(self.look.dilate)[eye]
    }

    /// Visible lists of each chunk, the counters and the nodes' states, for tests.
    #[must_use]
    pub fn cull_results(&self) -> (Vec<&wgpu::Buffer>, &wgpu::Buffer, Option<&wgpu::Buffer>) {
        let visible = self.chunks().iter().map(|c| &c.visible).collect();
        (visible, &self.counters, self.cloud.as_ref().map(|c| &c.states))
    }

    /// Records frame number `frame` into `images`, one an eye. Poses are not needed yet: see [`Self::set_view`].
    pub fn record(&mut self, encoder: &mut wgpu::CommandEncoder, frame: u64, images: &[EyeImage]) {
        self.timer.begin(encoder, frame);
        self.record_clear(encoder);
        self.record_lod(encoder);
        self.record_cull(encoder);
        self.record_depth(encoder);
        self.record_color(encoder);
        self.record_kept_sums(encoder);
        self.record_resolve(encoder, images);
        self.timer.end(encoder, &self.counters);
    }

    /// Sets the eyes of the frame that is submitted next through the same guard.
    pub fn set_view(&mut self, queue: &QueueGuard, view: &View) {
        if let Some(cloud) = &self.cloud {
            let threshold_px = self.look.detail.threshold_px.map(|px| px * self.lod_scale);
            let detail = Detail { threshold_px, ..self.look.detail };
            let uniform = ViewUniform::new(view, &cloud.split, &detail);
            queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&uniform));
        }
    }

    /// To be called after the frame's submit.
    pub fn submitted(&mut self) {
        self.timer.submitted();
    }

    /// Times of the oldest frame that has come back, if any; never waits.
    pub fn collect_times(&mut self) -> Option<FrameTimes> {
        let drawn = self.cloud.is_some();
        self.timer.collect(&self.gpu, |times| {
            let mut stage_ms = [f32::NAN; STAGES.len()];
            stage_ms.copy_from_slice(times.stage_ms);
            let (mut visible_nodes, mut points_read) = (0, 0);
            for chunk in times.extra.chunks_exact(COUNTERS_STRIDE as usize).filter(|_| drawn) {
                let counters: CullCounters =
                    bytemuck::pod_read_unaligned(&chunk[..size_of::<CullCounters>()]);
                visible_nodes += counters.num_visible;
                points_read += u64::from(counters.num_points);
            }
            FrameTimes { frame: times.frame, stage_ms, gpu_ms: times.total_ms, visible_nodes, points_read }
        })
    }

    fn chunks(&self) -> &[Chunk] {
        self.cloud.as_ref().map_or(&[], |c| &c.chunks)
    }

    fn record_clear(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = self.compute_pass(encoder, CLEAR);
        let limit = self.gpu.device.limits().max_compute_workgroups_per_dimension;
        for (group, num_words) in &self.groups.clear {
            let num_groups = num_words.div_ceil(WORKGROUP_SIZE).min(limit);
            self.pipelines.clear.dispatch(&mut pass, group, num_groups);
        }
    }

    fn record_lod(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = self.compute_pass(encoder, LOD);
        if let (Some(cloud), Some(group)) = (&self.cloud, &self.groups.lod) {
            self.pipelines.lod.dispatch(&mut pass, group, cloud.num_nodes.div_ceil(WORKGROUP_SIZE));
        }
    }

    fn record_cull(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = self.compute_pass(encoder, CULL);
        for (chunk, group) in self.chunks().iter().zip(&self.groups.cull) {
            self.pipelines.cull.dispatch(&mut pass, group, chunk.num_batches.div_ceil(WORKGROUP_SIZE));
        }
    }

    fn record_depth(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = self.compute_pass(encoder, DEPTH);
        let depth = match self.look.quality {
            Quality::Closest => &self.pipelines.closest.depth,
            Quality::Hqs => &groups::hqs(&self.pipelines, self.cloud.as_ref()).depth,
        };
        self.dispatch_visible(&mut pass, depth, &self.groups.depth);
        if let Some(ids) = &self.pipelines.closest.ids {
            self.dispatch_visible(&mut pass, ids, &self.groups.ids);
        }
    }

    fn record_color(&self, encoder: &mut wgpu::CommandEncoder) {
        // wgpu puts a barrier between passes that write and read the same buffer.
        let mut pass = self.compute_pass(encoder, COLOR);
        let color = &groups::hqs(&self.pipelines, self.cloud.as_ref()).color;
        self.dispatch_visible(&mut pass, color, &self.groups.color);
    }

    /// One dispatch a chunk, a workgroup a visible batch.
    fn dispatch_visible(&self, pass: &mut wgpu::ComputePass, stage: &Stage, groups: &[wgpu::BindGroup]) {
        for (number, group) in groups.iter().enumerate() {
            let arguments = number as u64 * u64::from(COUNTERS_STRIDE);
            stage.dispatch_indirect(pass, group, &self.counters, arguments);
        }
    }

    fn record_resolve(&self, encoder: &mut wgpu::CommandEncoder, images: &[EyeImage]) {
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("surface"),
                timestamp_writes: self.timer.compute(RESOLVE, true, false),
            });
            let surface = match self.look.quality {
                Quality::Closest => &self.pipelines.closest.shade,
                Quality::Hqs => &groups::hqs(&self.pipelines, self.cloud.as_ref()).blend,
            };
            for eye in &self.groups.eyes {
                for group in &eye.surface {
                    surface.dispatch(&mut pass, group, eye.num_tiles);
                }
                if let Some(group) = &eye.dilate {
                    self.pipelines.dilate.dispatch(&mut pass, group, eye.num_tiles);
                }
            }
        }
        for (eye, image) in images.iter().enumerate() {
            self.record_image(encoder, eye, image, eye + 1 == images.len());
        }
    }

    fn record_image(&self, encoder: &mut wgpu::CommandEncoder, eye: usize, image: &EyeImage, is_last: bool) {
        let [r, g, b] = self.look.background.map(linear_from_srgb);
        let store = wgpu::StoreOp::Store;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(STAGES[RESOLVE]),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: image.color,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 }), store },
            })],
            depth_stencil_attachment: image.depth.map(|view| wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store }),
                stencil_ops: None,
            }),
            timestamp_writes: self.timer.render(RESOLVE, false, is_last),
            ..Default::default()
        });
        // Before there is a cloud, the background is all there is to see.
        if self.cloud.is_some() {
            let [width, height] = self.targets.drawn_px[eye];
            pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
            pass.set_scissor_rect(0, 0, width, height);
            pass.set_pipeline(&self.pipelines.image.pipeline);
            pass.set_bind_group(0, &self.groups.eyes[eye].image, &[]);
            pass.draw(0..3, 0..1);
        }
    }

    fn compute_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder, stage: usize) -> wgpu::ComputePass<'e> {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(STAGES[stage]),
            timestamp_writes: self.timer.compute(stage, true, true),
        })
    }

    /// Makes every bind group anew; after a change of cloud, sizes or look.
    fn rebind(&mut self) {
        let parts = Parts {
            gpu: &self.gpu,
            pipelines: &self.pipelines,
            targets: &self.targets,
            cloud: self.cloud.as_ref(),
            view: &self.view,
            counters: &self.counters,
            quality: self.look.quality,
            dilate: self.look.dilate,
            background: self.look.background_word(),
            hidden: &self.hidden,
        };
        self.groups = parts.groups();
    }
}

fn what(setup: &Setup, look: &Look) -> For {
    For {
        num_eyes: setup.sizes_px.len() as u32,
        fill: look.detail.fill_reach_px.is_some(),
        atomics: setup.atomics,
        method: look.method,
        color_format: setup.color_format,
        depth_format: setup.depth_format,
    }
}

/// True if a frame of this cloud and quality adds up in four u32.
fn needs_wide(pipelines: &Pipelines, cloud: Option<&CloudBuffers>, quality: Quality) -> bool {
    quality == Quality::Hqs && groups::hqs(pipelines, cloud).sums != Sums::Packed
}

fn counters_buffer(gpu: &Gpu, num_chunks: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_SRC;
    gpu.buffer("counters", num_chunks * u64::from(COUNTERS_STRIDE), usage)
}

/// The value that an sRGB image encodes back to `c`.
fn linear_from_srgb(c: u8) -> f64 {
    let c = f64::from(c) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

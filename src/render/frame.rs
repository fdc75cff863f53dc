//! The frame as a contents list, and what it needs from one frame to the next.

use super::cloud_buffers::{Chunk, CloudBuffers};
use super::shaders;
use super::targets::{TargetTooLarge, Targets};
use crate::config::Quality;
use crate::gpu::stage::{Bindings, Stage, shader_module};
use crate::gpu::timer::Timer;
use crate::gpu::{Gpu, QueueGuard};
use crate::layout::{COUNTERS_STRIDE, CullCounters, Detail, ResolveUniform, ViewUniform, WORKGROUP_SIZE};
use crate::space::{Split, View};
use crate::timing::{STAGES, StageMs};
use std::sync::Arc;
use wgpu::util::DeviceExt;

/// Where each stage's times stand in [`STAGES`].
const CLEAR: usize = 0;
const CULL: usize = 1;
const DEPTH: usize = 2;
const RESOLVE: usize = 3;

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

/// Draws frames of one or two eyes. Create once, give it a cloud and sizes, then for every frame:
/// [`Renderer::record`], [`Renderer::set_view`] as late as possible, submit, [`Renderer::submitted`].
#[derive(Debug)]
pub struct Renderer {
    gpu: Arc<Gpu>,
    num_eyes: u32,
    clear: Stage,
    cull: Stage,
    depth: Stage,
    resolve: wgpu::RenderPipeline,
    resolve_bindings: Bindings,
    view: wgpu::Buffer,
    cloud: Option<CloudBuffers>,
    counters: wgpu::Buffer,
    targets: Targets,
    groups: Groups,
    timer: Timer,
    forced_planes: u32,
    lod_scale: f32,
    background: wgpu::Color,
}

/// Bind groups: of the cloud's chunks and the targets at hand.
#[derive(Debug)]
struct Groups {
    clear: wgpu::BindGroup,
    /// One a chunk.
    cull: Vec<wgpu::BindGroup>,
    depth: Vec<wgpu::BindGroup>,
    /// Of each eye, one a chunk.
    resolve: Vec<Vec<wgpu::BindGroup>>,
}

impl Renderer {
    /// A renderer without a cloud, for `sizes_px.len()` eyes (one or two) and images of `format` (sRGB).
    ///
    /// # Errors
    /// If the sizes do not fit the device.
    pub fn new(
        gpu: &Arc<Gpu>,
        sizes_px: &[[u32; 2]],
        format: wgpu::TextureFormat,
    ) -> Result<Self, TargetTooLarge> {
        let num_eyes = sizes_px.len() as u32;
        let stage = |name| Stage::new(gpu, name, &shaders::source(name, num_eyes));
        let (clear, cull, depth) = (stage(STAGES[CLEAR]), stage(STAGES[CULL]), stage(STAGES[DEPTH]));
        let (resolve, resolve_bindings) = resolve_pipeline(gpu, num_eyes, format);
        let view_usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let view = gpu.buffer("view", size_of::<ViewUniform>() as u64, view_usage);
        let targets = Targets::new(gpu, sizes_px)?;
        let counters = counters_buffer(gpu, 1);
        let clear_group = clear.bind(gpu, &clear_resources(&targets, &counters));
        let groups =
            Groups { clear: clear_group, cull: vec![], depth: vec![], resolve: vec![vec![]; sizes_px.len()] };
        let timer = Timer::new(gpu, STAGES.len(), counters.size());
        Ok(Self {
            gpu: Arc::clone(gpu),
            num_eyes,
            clear,
            cull,
            depth,
            resolve,
            resolve_bindings,
            view,
            cloud: None,
            counters,
            targets,
            groups,
            timer,
            forced_planes: 0,
            lod_scale: 1.0,
            background: wgpu::Color::BLACK,
        })
    }

    /// Shows this cloud from the next frame on; the one before is freed when the GPU is done with it.
    pub fn set_cloud(&mut self, cloud: CloudBuffers) {
        self.counters = counters_buffer(&self.gpu, cloud.chunks.len().max(1) as u64);
        self.timer = Timer::new(&self.gpu, STAGES.len(), self.counters.size());
        self.cloud = Some(cloud);
        self.rebind();
    }

    /// New image sizes, one an eye.
    ///
    /// # Errors
    /// If they do not fit the device.
    pub fn resize(&mut self, sizes_px: &[[u32; 2]]) -> Result<(), TargetTooLarge> {
        if self.targets.sizes_px != sizes_px {
            self.targets = Targets::new(&self.gpu, sizes_px)?;
            self.rebind();
        }
        Ok(())
    }

    /// Draws only so many pixels of each image, from its top left corner, from the next recorded frame on.
    /// Never more than the images have.
    pub fn set_sizes(&mut self, sizes_px: &[[u32; 2]]) {
        if let Err(error) = self.resize(sizes_px) {
            tracing::warn!("{error}");
        }
    }

    /// Factor on the pixels that a node's projected edge needs.
    pub fn set_lod_scale(&mut self, lod_scale: f32) {
        self.lod_scale = lod_scale;
    }

    /// What a pixel shows of the points in it; for now always the nearest one's color.
    pub fn set_quality(&mut self, _quality: Quality) {}

    /// Reads all 30 coordinate bits always (true) or as many as the projected size asks for.
    pub fn set_full_precision(&mut self, full: bool) {
        self.forced_planes = if full { 3 } else { 0 };
    }

    /// Colour where no point is, as stored in the image.
    pub fn set_background(&mut self, rgb: [u8; 3]) {
        let [r, g, b] = rgb.map(linear_from_srgb);
        self.background = wgpu::Color { r, g, b, a: 1.0 };
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

    /// Visible lists of each chunk and the counters, for tests.
    #[must_use]
    pub fn cull_results(&self) -> (Vec<&wgpu::Buffer>, &wgpu::Buffer) {
        let chunks = self.cloud.iter().flat_map(|c| &c.chunks);
        (chunks.map(|c| &c.visible).collect(), &self.counters)
    }

    /// Records frame number `frame` into `images`, one an eye. Poses are not needed yet: see [`Self::set_view`].
    pub fn record(&mut self, encoder: &mut wgpu::CommandEncoder, frame: u64, images: &[&wgpu::TextureView]) {
        self.timer.begin(encoder, frame);
        self.record_clear(encoder);
        self.record_cull(encoder);
        self.record_depth(encoder);
        self.record_resolve(encoder, images);
        self.timer.end(encoder, &self.counters);
    }

    /// Sets the eyes of the frame that is submitted next through the same guard.
    pub fn set_view(&self, queue: &QueueGuard, view: &View) {
        if let Some(cloud) = &self.cloud {
            let papers = Detail::default();
            let threshold_px = papers.threshold_px.map(|px| px * self.lod_scale);
            let detail = Detail { forced_planes: self.forced_planes, threshold_px, ..papers };
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
        let sixteen_bytes = self.targets.depth.iter().map(|b| b.size() / 16).max().unwrap_or(0);
        let limit = self.gpu.device.limits().max_compute_workgroups_per_dimension;
        let num_groups = sixteen_bytes.div_ceil(u64::from(WORKGROUP_SIZE)).min(u64::from(limit));
        self.clear.dispatch(&mut pass, &self.groups.clear, num_groups as u32);
    }

    fn record_cull(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = self.compute_pass(encoder, CULL);
        for (chunk, group) in self.chunks().iter().zip(&self.groups.cull) {
            self.cull.dispatch(&mut pass, group, chunk.num_batches.div_ceil(WORKGROUP_SIZE));
        }
    }

    fn record_depth(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = self.compute_pass(encoder, DEPTH);
        for (number, group) in self.groups.depth.iter().enumerate() {
            let arguments = number as u64 * u64::from(COUNTERS_STRIDE);
            self.depth.dispatch_indirect(&mut pass, group, &self.counters, arguments);
        }
    }

    fn record_resolve(&self, encoder: &mut wgpu::CommandEncoder, images: &[&wgpu::TextureView]) {
        for (eye, image) in images.iter().enumerate() {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(STAGES[RESOLVE]),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: image,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(self.background),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                timestamp_writes: self.timer.render(RESOLVE, eye == 0, eye + 1 == images.len()),
                ..Default::default()
            });
            let [width, height] = self.targets.sizes_px[eye].map(|edge| edge as f32);
            pass.set_viewport(0.0, 0.0, width, height, 0.0, 1.0);
            pass.set_pipeline(&self.resolve);
            for group in &self.groups.resolve[eye] {
                pass.set_bind_group(0, group, &[]);
                pass.draw(0..3, 0..1);
            }
        }
    }

    fn compute_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder, stage: usize) -> wgpu::ComputePass<'e> {
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(STAGES[stage]),
            timestamp_writes: self.timer.compute(stage, true, true),
        })
    }

    /// Makes every bind group anew; after a change of cloud or sizes.
    fn rebind(&mut self) {
        let gpu = &self.gpu;
        let clear = self.clear.bind(gpu, &clear_resources(&self.targets, &self.counters));
        let (mut cull, mut depth, mut resolve) = (vec![], vec![], vec![vec![]; self.num_eyes as usize]);
        for (number, chunk) in self.chunks().iter().enumerate() {
            let resources = self.resources(number as u64, chunk);
            cull.push(self.cull.bind(gpu, &resources));
            depth.push(self.depth.bind(gpu, &resources));
            for (eye, groups) in resolve.iter_mut().enumerate() {
                groups.push(self.bind_resolve(eye, chunk));
            }
        }
        self.groups = Groups { clear, cull, depth, resolve };
    }

    /// Everything that `cull` and `depth` may bind, by the shaders' names.
    fn resources<'a>(
        &'a self,
        number: u64,
        chunk: &'a Chunk,
    ) -> [(&'static str, wgpu::BindingResource<'a>); 10] {
        let counters = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.counters,
            offset: number * u64::from(COUNTERS_STRIDE),
            size: std::num::NonZeroU64::new(size_of::<CullCounters>() as u64),
        });
        [
            ("view", self.view.as_entire_binding()),
            ("chunk", chunk.chunk.as_entire_binding()),
            ("batches", chunk.batches.as_entire_binding()),
            ("visible", chunk.visible.as_entire_binding()),
            ("counters", counters),
            ("plane_hi", chunk.planes[0].as_entire_binding()),
            ("plane_mid", chunk.planes[1].as_entire_binding()),
            ("plane_lo", chunk.planes[2].as_entire_binding()),
            ("depth_left", self.targets.depth[0].as_entire_binding()),
            ("depth_right", self.targets.depth[1].as_entire_binding()),
        ]
    }

    fn bind_resolve(&self, eye: usize, chunk: &Chunk) -> wgpu::BindGroup {
        let uniform = ResolveUniform {
            width: self.targets.sizes_px[eye][0],
            first_index: chunk.uniform.first_index,
            num_points: chunk.uniform.num_points,
            reserved: 0,
        };
        let uniform = self.gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("resolve"),
            contents: bytemuck::bytes_of(&uniform),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let resources = [
            ("resolve", uniform.as_entire_binding()),
            ("depth", self.targets.depth[eye].as_entire_binding()),
            ("colors", chunk.colors.as_entire_binding()),
        ];
        let layout = self.resolve.get_bind_group_layout(0);
        self.resolve_bindings.bind(&self.gpu.device, STAGES[RESOLVE], &layout, &resources)
    }
}

fn clear_resources<'a>(
    targets: &'a Targets,
    counters: &'a wgpu::Buffer,
) -> [(&'static str, wgpu::BindingResource<'a>); 3] {
    [
        ("depth_left", targets.depth[0].as_entire_binding()),
        ("depth_right", targets.depth[1].as_entire_binding()),
        ("counters", counters.as_entire_binding()),
    ]
}

fn counters_buffer(gpu: &Gpu, num_chunks: u64) -> wgpu::Buffer {
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_SRC;
    gpu.buffer("counters", num_chunks * u64::from(COUNTERS_STRIDE), usage)
}

fn resolve_pipeline(
    gpu: &Gpu,
    num_eyes: u32,
    format: wgpu::TextureFormat,
) -> (wgpu::RenderPipeline, Bindings) {
    let name = STAGES[RESOLVE];
    let wgsl = shaders::source(name, num_eyes);
    let module = shader_module(&gpu.device, name, &wgsl);
    let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(name),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(format.into())],
        }),
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        multiview_mask: None,
        cache: None,
    });
    (pipeline, Bindings::of(name, &wgsl))
}

/// The value that an sRGB image encodes back to `c`.
fn linear_from_srgb(c: u8) -> f64 {
    let c = f64::from(c) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

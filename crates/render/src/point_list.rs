//! The method `point-list`: `depth` by the hardware's own pipeline, into an image from which `shade` takes ids and
//! depths. What the compute frame is measured against [2022 §4.1]: the same cull, the same points, bit for bit the
//! same places; but each eye reads and decodes every point for itself.

use super::cloud_buffers::Chunk;
use super::shaders;
use super::targets::Targets;
use crate::bindings::{self, Cloud, OfChunk, OfCloud};
use crate::gpu::Gpu;
use crate::gpu::points::{self, DEPTH_FORMAT, Points};
use crate::gpu::stage::{Bindings, shader_module};
use crate::layout::{BATCH_POINTS, COUNTERS_STRIDE, Variant, guarded};

/// Id and depth of a pixel's point.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;
/// No id, and the depth of an empty pixel, [`crate::layout::EMPTY_DEPTH`].
const EMPTY: wgpu::Color = wgpu::Color { r: u32::MAX as f64, g: u32::MAX as f64, b: 0.0, a: 0.0 };

/// Vertices, instances, first vertex, first instance.
type DrawArguments = [u32; 4];

/// The pipelines of both eyes.
#[derive(Debug)]
pub(super) struct PointList {
    eyes: [(wgpu::RenderPipeline, Bindings<(Cloud, bindings::Chunk)>); 2],
}

/// What it draws into: each eye's points and the hardware's depths.
#[derive(Debug)]
pub(super) struct PointImages {
    sizes_px: Vec<[u32; 2]>,
    pub points: Vec<wgpu::TextureView>,
    depths: Vec<wgpu::TextureView>,
}

/// How much it draws: [`DrawArguments`] of each chunk.
#[derive(Debug)]
pub(super) struct Draws(wgpu::Buffer);

impl PointList {
    pub fn new(gpu: &Gpu, variant: Variant) -> Self {
        let wgsl = shaders::POINT_LIST.source(variant);
        let module = shader_module(&gpu.device, "point-list", &wgsl);
        let eye = |entry| {
            let bindings = Bindings::of("point-list", &wgsl, entry);
            let points = Points {
                module: &module,
                vertex: entry,
                buffers: &[],
                format: FORMAT,
                nearer: wgpu::CompareFunction::Less,
            };
            (points::pipeline(gpu, points), bindings.with(Bindings::of("point-list", &wgsl, "fragment")))
        };
        Self { eyes: [eye("left"), eye("right")] }
    }

    /// A bind group to draw a chunk in an eye.
    pub fn bind(&self, gpu: &Gpu, eye: usize, resources: (OfCloud, OfChunk)) -> wgpu::BindGroup {
        let (pipeline, bindings) = &self.eyes[eye];
        bindings.bind(&gpu.device, "point-list", &pipeline.get_bind_group_layout(0), resources)
    }

    /// Records one eye: a draw a chunk.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        (eye, images): (usize, &PointImages),
        size_px: [u32; 2],
        (groups, draws): (&[wgpu::BindGroup], &Draws),
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites>,
    ) {
        let [width, height] = guarded(size_px);
        let store = wgpu::StoreOp::Store;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("point-list"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &images.points[eye],
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(EMPTY), store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &images.depths[eye],
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes,
            ..Default::default()
        });
        pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
        pass.set_scissor_rect(0, 0, width, height);
        pass.set_pipeline(&self.eyes[eye].0);
        for (number, group) in groups.iter().enumerate() {
            pass.set_bind_group(0, group, &[]);
            pass.draw_indirect(&draws.0, (number * size_of::<DrawArguments>()) as u64);
        }
    }
}

impl PointImages {
    pub fn new(gpu: &Gpu, targets: &Targets) -> Self {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let view = |label, size_px, format, usage| {
            gpu.texture(label, guarded(size_px), format, usage)
                .create_view(&wgpu::TextureViewDescriptor::default())
        };
        let with_reads = usage | wgpu::TextureUsages::TEXTURE_BINDING;
        let sizes = &targets.sizes_px;
        Self {
            sizes_px: sizes.clone(),
            points: sizes.iter().map(|&size| view("points", size, FORMAT, with_reads)).collect(),
            depths: sizes.iter().map(|&size| view("depths of points", size, DEPTH_FORMAT, usage)).collect(),
        }
    }

    /// True if they are as large as the targets.
    pub fn fit(&self, targets: &Targets) -> bool {
        self.sizes_px == targets.sizes_px
    }
}

impl Draws {
    pub fn new(gpu: &Gpu, num_chunks: usize) -> Self {
        use wgpu::util::DeviceExt;
        let arguments: Vec<DrawArguments> = vec![[BATCH_POINTS, 0, 0, 0]; num_chunks.max(1)];
        Self(gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("draws"),
            contents: bytemuck::cast_slice(&arguments),
            usage: wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST,
        }))
    }

    /// Records that each chunk has as many instances as `cull` counted batches.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, counters: &wgpu::Buffer, chunks: &[Chunk]) {
        for number in 0..chunks.len() as u64 {
            let instances = number * size_of::<DrawArguments>() as u64 + 4;
            let counted = number * u64::from(COUNTERS_STRIDE);
            encoder.copy_buffer_to_buffer(counters, counted, &self.0, instances, 4);
        }
    }
}

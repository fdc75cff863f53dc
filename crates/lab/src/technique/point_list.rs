//! The method `point-list`: the hardware's own pipeline draws `depth` into an image, from which `shade` takes ids and
//! depths. The compute frame is measured against it [2022 §4.1]. It has the same cull, and the same points in bit for
//! bit the same places, but each eye reads and decodes every point for itself.

use super::texts::text;
use crate::hardware::{self, DEPTH_FORMAT, PointPipeline};
use render::bindings::{BatchSet, ChunkSet, EyeSet};
use render::gpu::Gpu;
use render::gpu::stage::{Bindings, ShaderError, Stage, shader_module};
use render::layout::{BATCH_POINTS, COUNTERS_STRIDE, Variant, guarded};
use render::shaders::{ShaderOfSet, parts};
use render::technique::{ClearedTarget, Nearest, Recording};
use render::{Access, Parts, Targets};
use std::mem::offset_of;
use wgpu::util::{BufferInitDescriptor, DeviceExt, DrawIndirectArgs};

/// The pass that draws points.
pub const POINT_LIST: ShaderOfSet<BatchSet> =
    ShaderOfSet::new("point-list", &[parts::POINTS], |_| &[text!("methods/point_list")]);
render::sets! {
    /// What [`POINT_LIST`] drew into.
    PointImageSet, OfPointImage {
        /// An eye's image of points.
        points,
    }
}

/// The step of `resolve` that takes points from the images that they were drawn into.
pub const SHADE_POINTS: ShaderOfSet<((ChunkSet, EyeSet), PointImageSet)> =
    ShaderOfSet::new("shade-points", &[parts::SURFACE, parts::CHUNK_COLORS], |_| {
        &[text!("methods/shade_points")]
    });

/// Format of an image of points: id and depth of a pixel's point.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;
/// Clear value of an image of points: no id, and the depth of an empty pixel, [`render::layout::EMPTY_DEPTH`].
const EMPTY: wgpu::Color = wgpu::Color { r: u32::MAX as f64, g: u32::MAX as f64, b: 0.0, a: 0.0 };

/// The pipelines of both eyes, and what they draw into.
#[derive(Debug)]
pub(super) struct PointList {
    eyes: [(wgpu::RenderPipeline, Bindings<BatchSet>); 2],
    shade: Stage<((ChunkSet, EyeSet), PointImageSet)>,
    images: Option<PointImages>,
    /// [`DrawIndirectArgs`] of each chunk.
    draws: Option<wgpu::Buffer>,
    /// Bind groups of the draws, per eye and chunk.
    draw_groups: Vec<Vec<wgpu::BindGroup>>,
    shade_groups: Vec<Vec<wgpu::BindGroup>>,
}

/// Each eye's points and the hardware's depths.
#[derive(Debug)]
struct PointImages {
    sizes_px: Vec<[u32; 2]>,
    points: Vec<wgpu::TextureView>,
    depths: Vec<wgpu::TextureView>,
}

impl PointList {
    pub fn new(gpu: &Gpu, variant: Variant, access: Access, others: &[&str]) -> Result<Self, ShaderError> {
        let wgsl = POINT_LIST.source(variant);
        let module = shader_module(&gpu.device, "point-list", &wgsl);
        let of = |entry| Bindings::of("point-list", &wgsl, entry, others);
        let eye = |entry| {
            let points = PointPipeline {
                module: &module,
                vertex: entry,
                buffers: &[],
                format: FORMAT,
                nearer: wgpu::CompareFunction::Less,
            };
            Ok((hardware::pipeline(gpu, points), of(entry)?.with(of("fragment")?)))
        };
        Ok(Self {
            eyes: [eye("left")?, eye("right")?],
            shade: Stage::of(gpu, SHADE_POINTS, variant, access, others)?,
            images: None,
            draws: None,
            draw_groups: vec![],
            shade_groups: vec![],
        })
    }
}

impl Nearest for PointList {
    fn cleared_targets(&self) -> &'static [ClearedTarget] {
        // The images are cleared as the passes begin.
        &[ClearedTarget::Counters]
    }

    fn bind(&mut self, parts: &Parts<'_>) {
        let sizes_px = &parts.targets.sizes_px;
        let images = self.images.take().filter(|images| images.sizes_px == *sizes_px);
        let images = images.unwrap_or_else(|| PointImages::new(parts.gpu, parts.targets));
        let eyes = || 0..sizes_px.len();
        let draw = |eye: usize| {
            let (pipeline, bindings) = &self.eyes[eye];
            let layout = pipeline.get_bind_group_layout(0);
            parts.each_chunk(|resources| bindings.bind(&parts.gpu.device, &layout, &resources))
        };
        let shade = |eye: usize| {
            parts.each_chunk_of_eye(eye, |resources| {
                let image = OfPointImage { points: wgpu::BindingResource::TextureView(&images.points[eye]) };
                self.shade.bind(parts.gpu, &(resources, image))
            })
        };
        self.draw_groups = eyes().map(draw).collect();
        self.shade_groups = eyes().map(shade).collect();
        self.draws = Some(draws(parts.gpu, self.draw_groups.first().map_or(0, Vec::len)));
        self.images = Some(images);
    }

    fn record_depth(&self, encoder: &mut wgpu::CommandEncoder, recording: &Recording<'_>) {
        let (Some(images), Some(draws)) = (&self.images, &self.draws) else { return };
        // Each chunk has as many instances as `cull` counted batches.
        for number in 0..recording.num_chunks() {
            let instances =
                number * size_of::<DrawIndirectArgs>() + offset_of!(DrawIndirectArgs, instance_count);
            let counted = number as u64 * u64::from(COUNTERS_STRIDE);
            encoder.copy_buffer_to_buffer(recording.counters, counted, draws, instances as u64, 4);
        }
        for (eye, groups) in self.draw_groups.iter().enumerate() {
            let [width, height] = guarded(recording.targets.drawn_px[eye]);
            let mut pass = images.pass(encoder, eye, recording.render_times(eye));
            pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
            pass.set_scissor_rect(0, 0, width, height);
            pass.set_pipeline(&self.eyes[eye].0);
            for (number, group) in groups.iter().enumerate() {
                pass.set_bind_group(0, group, &[]);
                pass.draw_indirect(draws, (number * size_of::<DrawIndirectArgs>()) as u64);
            }
        }
    }

    fn record_shade(&self, pass: &mut wgpu::ComputePass<'_>, eye: usize, num_tiles: u32) {
        for group in self.shade_groups.get(eye).into_iter().flatten() {
            self.shade.dispatch(pass, group, num_tiles);
        }
    }
}

impl PointImages {
    fn new(gpu: &Gpu, targets: &Targets) -> Self {
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

    /// A pass into an eye's images, which begin empty.
    fn pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        eye: usize,
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites>,
    ) -> wgpu::RenderPass<'e> {
        let store = wgpu::StoreOp::Store;
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("point-list"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.points[eye],
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(EMPTY), store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depths[eye],
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            timestamp_writes,
            ..Default::default()
        })
    }
}

/// Makes the draw arguments of each chunk, with no instance yet.
fn draws(gpu: &Gpu, num_chunks: usize) -> wgpu::Buffer {
    let of_chunk = DrawIndirectArgs { vertex_count: BATCH_POINTS, ..Default::default() };
    let arguments = vec![of_chunk; num_chunks.max(1)];
    gpu.device.create_buffer_init(&BufferInitDescriptor {
        label: Some("draws"),
        contents: bytemuck::cast_slice(&arguments),
        usage: wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_DST,
    })
}

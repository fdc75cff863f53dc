//! Overlays: what a frame knows of itself, drawn over copies of the eyes' images. The images themselves stay as they
//! are, and a frame without an overlay costs what it did. With one the GPU has more to do after the frame's stages,
//! which the frame log does not count: it tells what the headset's picture costs.

use super::cloud_buffers::{Chunk, CloudBuffers};
use super::groups;
use super::renderer::Renderer;
use super::shaders::{self, ShaderOfSet};
use crate::bindings::{self, CloudSet, OfCloud, OfOverlay};
use crate::gpu::Gpu;
use crate::gpu::drawing::Drawing;
use crate::gpu::stage::{Bindings, ShaderError};
use crate::layout::{COUNTERS_STRIDE, CullCounters, DilateUniform, Sums, Variant};
use crate::options::{Overlay, Quality};
use std::num::NonZeroU64;
use wgpu::util::DeviceExt;

/// Vertices of a box: 12 edges of two triangles.
const BOX_VERTICES: u32 = 72;

/// The overlays' pipelines, made at the start of a walk that a window watches: choosing one stops no frame.
#[derive(Debug)]
pub struct Overlays {
    rings: OverlayPass,
    depth: OverlayPass,
    /// A pass for each form of sums that the GPU can do.
    overdraw: Vec<(Sums, OverlayPass)>,
    nodes: OverlayPass,
    batches: OverlayPass,
    /// Uniforms with each eye's number, as `dilate` in the shaders.
    eyes: [wgpu::Buffer; 2],
    bound: Option<Bound>,
}

/// Draws of an overlay, valid until the renderer's buffers or the overlay change.
#[derive(Debug)]
struct Bound {
    overlay: Overlay,
    /// [`Renderer::binding`] that it goes with.
    binding: u64,
    /// Draws of each eye.
    draws: [Vec<Draw>; 2],
}

/// A pipeline that blends over an image.
#[derive(Debug)]
struct OverlayPass {
    pipeline: wgpu::RenderPipeline,
    bindings: Bindings<(CloudSet, bindings::OverlaySet)>,
}

/// Instances to draw, with their bind group.
type Draw = (wgpu::BindGroup, u32);

impl Overlays {
    /// Overlays for copies of the images that `renderer` draws.
    ///
    /// # Errors
    /// If a shader of theirs cannot be used.
    pub fn new(renderer: &Renderer) -> Result<Self, ShaderError> {
        let (gpu, format) = (&*renderer.gpu, renderer.setup.color_format);
        let pass = |shader: ShaderOfSet<_>, sums, entries| {
            let wgsl = shader.source(Variant { sums, ..Variant::eyes(2) });
            OverlayPass::new(gpu, shader.name(), &wgsl, entries, format)
        };
        let whole = |entry, sums| pass(shaders::OVERLAY, sums, ["whole", entry]);
        let boxes = |entry| pass(shaders::BOXES, Sums::Packed, [entry, "line"]);
        let eye = |eye| {
            let uniform = DilateUniform { eye };
            gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("overlay"),
                contents: bytemuck::bytes_of(&uniform),
                usage: wgpu::BufferUsages::UNIFORM,
            })
        };
        let forms = renderer.pipelines.hqs.iter().map(|hqs| hqs.sums);
        Ok(Self {
            rings: whole("rings", Sums::Packed)?,
            depth: whole("depth", Sums::Packed)?,
            overdraw: forms.map(|sums| Ok((sums, whole("overdraw", sums)?))).collect::<Result<_, _>>()?,
            nodes: boxes("node_box")?,
            batches: boxes("batch_box")?,
            eyes: [eye(0), eye(1)],
            bound: None,
        })
    }

    /// Lets go of the renderer's buffers, until the next [`Self::record`].
    pub fn release(&mut self) {
        self.bound = None;
    }

    /// Draws an overlay of the frame that `renderer` has just recorded over copies of its images, one an eye.
    /// `overdraw` needs the quality `hqs`: without it, and without a cloud, nothing is drawn. The time that it takes
    /// comes after the frame's stages and is in none of their times.
    pub fn record(
        &mut self,
        renderer: &Renderer,
        encoder: &mut wgpu::CommandEncoder,
        overlay: Overlay,
        copies: &[&wgpu::TextureView; 2],
    ) {
        let is_bound = |bound: &Bound| (bound.overlay, bound.binding) == (overlay, renderer.binding());
        if !self.bound.as_ref().is_some_and(is_bound) {
            self.bound = self.bind(renderer, overlay);
        }
        let (Some(bound), Some(pass)) = (&self.bound, self.pass(renderer, overlay)) else { return };
        let is_boxes = matches!(overlay, Overlay::Nodes | Overlay::Precision);
        let num_vertices = if is_boxes { BOX_VERTICES } else { 3 };
        for (eye, copy) in copies.iter().enumerate() {
            let mut over = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("overlay"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: copy,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
                })],
                ..Default::default()
            });
            let [width, height] = renderer.targets.drawn_px[eye];
            over.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
            over.set_scissor_rect(0, 0, width, height);
            over.set_pipeline(&pass.pipeline);
            for (group, num_instances) in &bound.draws[eye] {
                over.set_bind_group(0, group, &[]);
                over.draw(0..num_vertices, 0..*num_instances);
            }
        }
    }

    /// The pass of an overlay, if this frame has what it shows.
    fn pass(&self, renderer: &Renderer, overlay: Overlay) -> Option<&OverlayPass> {
        match overlay {
            Overlay::None => None,
            Overlay::Rings => Some(&self.rings),
            Overlay::Depth => Some(&self.depth),
            Overlay::Overdraw => self.overdraw(renderer),
            Overlay::Nodes => Some(&self.nodes),
            Overlay::Precision => Some(&self.batches),
        }
    }

    fn bind(&self, renderer: &Renderer, overlay: Overlay) -> Option<Bound> {
        let cloud = renderer.cloud.as_ref()?;
        let pass = self.pass(renderer, overlay)?;
        // Instances to draw of each chunk.
        let instances: Vec<u32> = match overlay {
            Overlay::Nodes => vec![cloud.num_nodes],
            Overlay::Precision => cloud.chunks.iter().map(Chunk::num_slots).collect(),
            _ => vec![1],
        };
        let draws = [0, 1].map(|eye| {
            let draw = |(chunk, &num): (usize, &u32)| (self.group(renderer, cloud, pass, eye, chunk), num);
            instances.iter().enumerate().map(draw).collect()
        });
        Some(Bound { overlay, binding: renderer.binding(), draws })
    }

    /// The pass for the form of sums that the frame adds up, if it adds up any.
    fn overdraw(&self, renderer: &Renderer) -> Option<&OverlayPass> {
        if renderer.options.quality != Quality::Hqs {
            return None;
        }
        let sums = groups::hqs(&renderer.pipelines, renderer.cloud.as_ref()).sums;
        self.overdraw.iter().find(|(form, _)| *form == sums).map(|(_, pass)| pass)
    }

    fn group(
        &self,
        renderer: &Renderer,
        cloud: &CloudBuffers,
        pass: &OverlayPass,
        eye: usize,
        chunk: usize,
    ) -> wgpu::BindGroup {
        let targets = &renderer.targets;
        let counters = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &renderer.counters,
            offset: chunk as u64 * u64::from(COUNTERS_STRIDE),
            size: NonZeroU64::new(size_of::<CullCounters>() as u64),
        });
        let of_cloud = OfCloud {
            view: renderer.view.as_entire_binding(),
            nodes: cloud.nodes.as_entire_binding(),
            states: cloud.states.as_entire_binding(),
            counted: cloud.counted.as_entire_binding(),
        };
        let of_overlay = OfOverlay {
            dilate: self.eyes[eye].as_entire_binding(),
            image_depth: targets.image_depth[eye].as_entire_binding(),
            sums: targets.keys[eye].as_entire_binding(),
            wide: targets.wide[eye].as_entire_binding(),
            counters,
            visible: cloud.chunks[chunk].visible.as_entire_binding(),
        };
        let layout = pass.pipeline.get_bind_group_layout(0);
        pass.bindings.bind(&renderer.gpu.device, &layout, &(of_cloud, of_overlay))
    }
}

impl OverlayPass {
    fn new(
        gpu: &Gpu,
        name: &'static str,
        wgsl: &str,
        [vertex, fragment]: [&str; 2],
        format: wgpu::TextureFormat,
    ) -> Result<Self, ShaderError> {
        let bindings = Bindings::of(name, wgsl, vertex, &[])?.with(Bindings::of(name, wgsl, fragment, &[])?);
        let target = wgpu::ColorTargetState {
            format,
            blend: Some(wgpu::BlendState::ALPHA_BLENDING),
            write_mask: wgpu::ColorWrites::COLOR,
        };
        let entries = [vertex, fragment];
        let pipeline =
            Drawing { name, wgsl, entries, buffers: &[], target: Some(target), depth_format: None }
                .pipeline(gpu);
        Ok(Self { pipeline, bindings })
    }
}

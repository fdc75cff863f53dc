//! The pipeline that lays the eyes' images on the window.

use super::MirroredEyes;
use super::placement::{PixelRect, panes};
use crate::walk::link::MirrorImages;
use bytemuck::{Pod, Zeroable};
use render::gpu::stage::{Bindings, ShaderError, shader_module};
use render::layout::Variant;
use render::shaders::{SRGB, ShaderOfSet};
use wgpu::util::DeviceExt;

render::sets! {
    /// What the mirror shows of an eye.
    Mirrored, OfMirrored {
        /// The image.
        image,
        /// How it is read between its pixels.
        image_sampler,
        /// The part of it that is drawn.
        drawn,
    }
}

/// The mirror's shader.
pub const MIRROR: ShaderOfSet<Mirrored> =
    ShaderOfSet::new("mirror", &[&[SRGB]], |_| &[include_str!("../../shaders/mirror.wgsl")]);

/// The part of an image that is drawn, from its top left corner, in shares of its size.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct DrawnUniform {
    /// Width, height.
    pub size: [f32; 2],
    /// Center of the last pixel.
    pub last: [f32; 2],
}

/// Draws [`MirrorImages`] into a window's picture.
#[derive(Debug)]
pub(super) struct MirrorPipeline {
    pipeline: wgpu::RenderPipeline,
    bindings: Bindings<Mirrored>,
    sampler: wgpu::Sampler,
    longest_px: u32,
    bound: Option<BoundImages>,
}

/// Bind groups of the mirrored images, which live as long as the images that they were made for.
#[derive(Debug)]
struct BoundImages {
    images: MirrorImages,
    groups: [wgpu::BindGroup; 2],
}

impl MirrorPipeline {
    /// A pipeline for pictures of `format`. An sRGB format encodes by itself; the shader encodes for any other.
    ///
    /// # Errors
    /// If the shader cannot be used.
    pub(super) fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Result<Self, ShaderError> {
        let wgsl = MIRROR.source(Variant::eyes(1));
        let bindings = Bindings::of("mirror", &wgsl, "pixel", &[])?;
        let module = shader_module(device, "mirror", &wgsl);
        let constants = [("ENCODE_SRGB", f64::from(u8::from(!format.is_srgb())))];
        let options = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("mirror"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("corner"),
                compilation_options: options.clone(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("pixel"),
                compilation_options: options,
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("mirror"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let longest_px = device.limits().max_texture_dimension_2d;
        Ok(Self { pipeline, bindings, sampler, longest_px, bound: None })
    }

    /// Draws the mirrored eyes into a pass over a picture of `size_px`.
    pub(super) fn draw(
        &mut self,
        device: &wgpu::Device,
        pass: &mut wgpu::RenderPass<'_>,
        size_px: [u32; 2],
        images: &MirrorImages,
        mirror: MirroredEyes,
    ) {
        let longest_px = self.longest_px;
        let groups = self.groups(device, images).clone();
        pass.set_pipeline(&self.pipeline);
        for pane in panes(mirror, images.drawn_px, size_px, longest_px) {
            let PixelRect { x, y, width, height } = pane.image;
            pass.set_viewport(x, y, width, height, 0.0, 1.0);
            let clip = pane.clip;
            pass.set_scissor_rect(clip.x as u32, clip.y as u32, clip.width as u32, clip.height as u32);
            pass.set_bind_group(0, &groups[pane.eye], &[]);
            pass.draw(0..3, 0..1);
        }
        let [width, height] = size_px;
        pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
        pass.set_scissor_rect(0, 0, width, height);
    }

    fn groups(&mut self, device: &wgpu::Device, images: &MirrorImages) -> &[wgpu::BindGroup; 2] {
        let bound =
            self.bound.take().filter(|bound| bound.images == *images).unwrap_or_else(|| BoundImages {
                groups: [0, 1]
                    .map(|eye: usize| self.group(device, &images.textures[eye], images.drawn_px[eye])),
                images: images.clone(),
            });
        &self.bound.insert(bound).groups
    }

    fn group(
        &self,
        device: &wgpu::Device,
        image: &wgpu::Texture,
        [width, height]: [u32; 2],
    ) -> wgpu::BindGroup {
        let [across, down] = [width as f32, height as f32];
        let [full_across, full_down] = [image.width() as f32, image.height() as f32];
        let drawn = DrawnUniform {
            size: [across / full_across, down / full_down],
            last: [(across - 0.5) / full_across, (down - 0.5) / full_down],
        };
        let drawn = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("mirror"),
            contents: bytemuck::bytes_of(&drawn),
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let resources = OfMirrored {
            image: wgpu::BindingResource::TextureView(&image.create_view(&Default::default())),
            image_sampler: wgpu::BindingResource::Sampler(&self.sampler),
            drawn: drawn.as_entire_binding(),
        };
        self.bindings.bind(device, &self.pipeline.get_bind_group_layout(0), &resources)
    }
}

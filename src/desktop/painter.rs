//! One picture of the window: the mirror, egui on top. Draws into any texture view, so tests need no window.

use super::MirroredEyes;
use super::QUEUE_PATIENCE;
use super::mirror::MirrorPipeline;
use crate::walk::link::MirrorImages;
use base::srgb::linear_from_srgb;
use render::gpu::Gpu;
use render::gpu::stage::ShaderError;

/// Color where nothing else is drawn: near black and a little bluish, so that an empty window is not a black hole.
const EMPTY: [f64; 3] = [18.0 / 255.0, 20.0 / 255.0, 24.0 / 255.0];

/// Pipelines and egui's textures, for one format of picture.
pub(super) struct Painter {
    /// Draws the mirror, if there may be one.
    mirror: Option<MirrorPipeline>,
    egui: egui_wgpu::Renderer,
    format: wgpu::TextureFormat,
    /// Textures that egui freed in the picture before, which had to be submitted first.
    freed: Vec<egui::TextureId>,
    /// Changes of textures that the GPU does not know of yet.
    unsent: egui::TexturesDelta,
}

/// What egui wants painted.
pub(super) struct EguiPicture {
    /// Triangles to paint.
    pub primitives: Vec<egui::ClippedPrimitive>,
    /// Textures that changed.
    pub textures: egui::TexturesDelta,
    /// Physical pixels a point.
    pub pixels_per_point: f32,
}

impl EguiPicture {
    /// Takes the picture of a finished egui pass.
    pub(super) fn new(context: &egui::Context, output: egui::FullOutput) -> Self {
        let egui::FullOutput { shapes, pixels_per_point, textures_delta: textures, .. } = output;
        Self { primitives: context.tessellate(shapes, pixels_per_point), textures, pixels_per_point }
    }
}

impl Painter {
    /// A painter for pictures of `format` without a mirror.
    pub(super) fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let egui = egui_wgpu::Renderer::new(device, format, egui_wgpu::RendererOptions::default());
        Self { mirror: None, egui, format, freed: Vec::new(), unsent: Default::default() }
    }

    /// A painter for pictures of `format` that may mirror the eyes.
    ///
    /// # Errors
    /// If the mirror's shader cannot be used.
    pub(super) fn with_mirror(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
    ) -> Result<Self, ShaderError> {
        let mut painter = Self::new(device, format);
        painter.mirror = Some(MirrorPipeline::new(device, format)?);
        Ok(painter)
    }

    /// Records a picture of `size_px`; the caller submits the commands, in order. `None` if the queue is not to be had.
    ///
    /// The queue is locked only for egui's uploads, which copy into staging memory and wait for nothing.
    pub(super) fn record(
        &mut self,
        gpu: &Gpu,
        target: &wgpu::TextureView,
        size_px: [u32; 2],
        mirror: Option<(&MirrorImages, MirroredEyes)>,
        mut ui: EguiPicture,
    ) -> Option<Vec<wgpu::CommandBuffer>> {
        let device = &gpu.device;
        self.unsent.append(std::mem::take(&mut ui.textures));
        let screen =
            egui_wgpu::ScreenDescriptor { size_in_pixels: size_px, pixels_per_point: ui.pixels_per_point };
        let mut encoder =
            device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("window") });
        let mut commands = {
            let queue = gpu.queue.lock_within(QUEUE_PATIENCE)?;
            for id in self.freed.drain(..) {
                self.egui.free_texture(&id);
            }
            self.freed.extend(self.unsent.free.drain());
            for (id, deltas) in self.unsent.set.drain() {
                for delta in &deltas {
                    self.egui.update_texture(device, queue.for_uploads(), id, delta);
                }
            }
            self.egui.update_buffers(device, queue.for_uploads(), &mut encoder, &ui.primitives, &screen)
        };
        let mut pass = encoder
            .begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("window"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: target,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(self.empty()),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            })
            .forget_lifetime();
        if let (Some(pipeline), Some((images, mirror))) = (&mut self.mirror, mirror) {
            pipeline.draw(device, &mut pass, size_px, images, mirror);
        }
        self.egui.render(&mut pass, &ui.primitives, &screen);
        drop(pass);
        commands.push(encoder.finish());
        Some(commands)
    }

    /// [`EMPTY`] as a clear value: the hardware encodes it for sRGB formats.
    fn empty(&self) -> wgpu::Color {
        let linear = |c: f64| if self.format.is_srgb() { linear_from_srgb(c) } else { c };
        let [r, g, b] = EMPTY.map(linear);
        wgpu::Color { r, g, b, a: 1.0 }
    }
}

impl Drop for Painter {
    fn drop(&mut self) {
        // egui insists that nobody forgets its textures; these go with the GPU's.
        self.unsent.clear();
    }
}

impl Drop for EguiPicture {
    fn drop(&mut self) {
        // A picture that is not painted, for the GPU is lost.
        self.textures.clear();
    }
}

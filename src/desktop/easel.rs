//! What egui paints textures with that are seen in the headset.

use super::QUEUE_PATIENCE;
use super::painter::{EguiPicture, Painter};
use super::style;
use egui::{Event, Rect, Ui, Vec2};
use render::gpu::Gpu;
use std::sync::Arc;

/// Pixels a point of egui: letters of the text are about half a degree high where cards stand.
pub(super) const PIXELS_PER_POINT: f32 = 3.0;
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// A painter of textures of one size, on one GPU.
pub(super) struct Easel {
    gpu: Arc<Gpu>,
    size_px: [u32; 2],
    context: egui::Context,
    painter: Painter,
}

impl Easel {
    /// An easel for textures of `size_px`; `None` if the GPU is lost.
    pub(super) fn new(gpu: &Arc<Gpu>, size_px: [u32; 2]) -> Option<Self> {
        let context = egui::Context::default();
        style::apply(&context);
        let painter = gpu.unless_lost(|| Painter::new(&gpu.device, FORMAT)).ok()?;
        Some(Self { gpu: Arc::clone(gpu), size_px, context, painter })
    }

    /// The GPU that textures are painted on.
    pub(super) fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// Width, height of the textures.
    pub(super) fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// Paints a texture of its own: the one before may be on its way to the eyes. `None` if the GPU's queue cannot be had, or
    /// the GPU is lost.
    pub(super) fn paint(
        &mut self,
        events: Vec<Event>,
        contents: impl FnMut(&mut Ui),
    ) -> Option<wgpu::Texture> {
        let size = Vec2::from(self.size_px.map(|px| px as f32 / PIXELS_PER_POINT));
        let screen_rect = Some(Rect::from_min_size(egui::Pos2::ZERO, size));
        let mut input = egui::RawInput { screen_rect, events, ..Default::default() };
        if let Some(viewport) = input.viewports.get_mut(&egui::ViewportId::ROOT) {
            viewport.native_pixels_per_point = Some(PIXELS_PER_POINT);
        }
        let output = self.context.run_ui(input, contents);
        let picture = EguiPicture::new(&self.context, output);
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC;
        let painter = &mut self.painter;
        let painted = self.gpu.unless_lost(|| {
            let texture = self.gpu.texture("card", self.size_px, FORMAT, usage);
            let target = texture.create_view(&Default::default());
            let commands = painter.record(&self.gpu, &target, self.size_px, None, picture)?;
            self.gpu.queue.lock_within(QUEUE_PATIENCE)?.submit(commands);
            Some(texture)
        });
        painted.ok().flatten()
    }
}

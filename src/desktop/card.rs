//! The card that is seen in the headset while there is no scan: what is loading, how far, what went wrong and what to do.
//! egui paints it into a texture, on a thread of its own, whenever what it says has changed.

use super::notice;
use super::painter::{EguiPicture, Painter};
use super::style;
use crate::walk::link::{CardEnd, LoadState};
use base::task::CancelToken;
use egui::{CentralPanel, Frame, Margin, Rect, RichText, Ui, Vec2};
use render::gpu::Gpu;
use std::sync::Arc;
use std::time::Duration;

/// Size of the card's texture, pixels.
const SIZE_PX: [u32; 2] = [1152, 640];
/// Pixels a point of egui: letters of the text are about half a degree high at the card's place.
const PIXELS_PER_POINT: f32 = 3.0;
/// Pause between two looks at what there is to say.
const LOOK_EVERY: Duration = Duration::from_millis(100);
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// Paints the card of a walk until `stop` is requested.
pub fn paint(walk: &CardEnd, stop: &CancelToken) {
    let mut easel: Option<Easel> = None;
    while !stop.is_cancelled() {
        if let Some(gpu) = walk.gpu().filter(|gpu| gpu.lost().is_none()) {
            let easel = match &mut easel {
                Some(easel) if Arc::ptr_eq(&easel.gpu, &gpu) => easel,
                // The card of another GPU cannot be shown on this one.
                other => other.insert(Easel::new(&gpu)),
            };
            let load = walk.load();
            if easel.said.as_ref() != Some(&load)
                && let Some(card) = easel.paint(&load.names(), &load)
            {
                walk.set_card(&gpu, card);
                easel.said = Some(load);
            }
        }
        std::thread::sleep(LOOK_EVERY);
    }
}

/// What a card is painted with, on one GPU.
struct Easel {
    gpu: Arc<Gpu>,
    context: egui::Context,
    painter: Painter,
    /// What the last card says.
    said: Option<LoadState>,
}

impl Easel {
    fn new(gpu: &Arc<Gpu>) -> Self {
        let context = egui::Context::default();
        style::apply(&context);
        Self { gpu: Arc::clone(gpu), context, painter: Painter::new(&gpu.device, FORMAT), said: None }
    }

    /// A card that says how loading stands, in a texture of its own: the one before may be on its way to the eyes.
    /// `Some(None)` if there is nothing to say, `None` if the GPU's queue cannot be had.
    fn paint(&mut self, scan: &str, load: &LoadState) -> Option<Option<wgpu::Texture>> {
        if load.doing.is_none() && load.error.is_none() {
            return Some(None);
        }
        let size = Vec2::from(SIZE_PX.map(|px| px as f32 / PIXELS_PER_POINT));
        let mut input = egui::RawInput {
            screen_rect: Some(Rect::from_min_size(egui::Pos2::ZERO, size)),
            ..Default::default()
        };
        if let Some(viewport) = input.viewports.get_mut(&egui::ViewportId::ROOT) {
            viewport.native_pixels_per_point = Some(PIXELS_PER_POINT);
        }
        let output = self.context.run_ui(input, |ui| contents(ui, scan, load));
        let picture = EguiPicture::new(&self.context, output);
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let card = self.gpu.texture("card", SIZE_PX, FORMAT, usage);
        let target = card.create_view(&Default::default());
        let commands = self.painter.record(&self.gpu, &target, SIZE_PX, None, picture)?;
        self.gpu.queue.lock_within(super::QUEUE_PATIENCE)?.submit(commands);
        Some(Some(card))
    }
}

pub(super) fn contents(ui: &mut Ui, scan: &str, load: &LoadState) {
    let frame = Frame::new().inner_margin(Margin::same(24)).fill(style::card().fill.to_opaque());
    CentralPanel::default().frame(frame).show(ui, |ui| {
        if let Some(error) = &load.error {
            notice::failure(ui, error, "Take the headset off, and start again with another file.");
        } else if let Some(doing) = &load.doing {
            ui.label(RichText::new(scan).heading());
            ui.add_space(12.0);
            notice::progress(ui, doing);
        }
    });
}

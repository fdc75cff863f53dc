//! The card that is seen in the headset while there is no scan: what is loading, how far, what went wrong and what to do.
//! egui paints it into a texture, on a thread of its own, whenever what it says has changed.

use super::easel::Easel;
use super::notice;
use super::style;
use crate::walk::link::{LoadState, PaintEnd};
use crate::walk::simulated::SIMULATED;
use base::task::CancelToken;
use egui::{CentralPanel, Frame, Margin, RichText, Ui};
use std::sync::Arc;
use std::time::Duration;

/// Size of the card's texture, pixels.
const SIZE_PX: [u32; 2] = [1152, 640];
/// Pause between two looks at what there is to say.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// Paints the card of a walk until `stop` is requested.
pub fn paint(walk: &PaintEnd, stop: &CancelToken) {
    let mut easel: Option<Easel> = None;
    let mut said: Option<(LoadState, bool)> = None;
    while !stop.is_cancelled() {
        if let Some(gpu) = walk.gpu().filter(|gpu| gpu.lost().is_none()) {
            if easel.as_ref().is_none_or(|easel| !Arc::ptr_eq(easel.gpu(), &gpu)) {
                // The card of another GPU cannot be shown on this one.
                (easel, said) = (Easel::new(&gpu, SIZE_PX), None);
            }
            // Who looks at the window is told there, and nobody wears the simulated headset.
            let news = (walk.load(), walk.runtime() != SIMULATED);
            if let Some(easel) = easel.as_mut().filter(|_| said.as_ref() != Some(&news))
                && let Some(card) = card(easel, &news.0, news.1)
            {
                walk.set_card(&gpu, card);
                said = Some(news);
            }
        }
        std::thread::sleep(LOOK_EVERY);
    }
}

/// A card that says how loading stands. `Some(None)` if there is nothing to say, `None` if the GPU's queue cannot be had.
fn card(easel: &mut Easel, load: &LoadState, is_worn: bool) -> Option<Option<wgpu::Texture>> {
    let has_words = load.doing.is_some() || load.error.is_some() || is_empty(load);
    if !(is_worn && has_words) {
        return Some(None);
    }
    easel.paint(Vec::new(), |ui| contents(ui, &load.names(), load)).map(Some)
}

/// True while the user has named no scan.
fn is_empty(load: &LoadState) -> bool {
    load.scan.as_ref().is_some_and(|scan| scan.files.is_empty())
}

pub(super) fn contents(ui: &mut Ui, scan: &str, load: &LoadState) {
    let frame = Frame::new().inner_margin(Margin::same(24)).fill(style::card().fill.to_opaque());
    CentralPanel::default().frame(frame).show(ui, |ui| {
        if let Some(error) = &load.error {
            notice::failure(ui, error, "Take the headset off, and open another scan in the window.");
        } else if let Some(doing) = &load.doing {
            ui.label(RichText::new(scan).heading());
            ui.add_space(12.0);
            notice::progress(ui, doing);
        } else if is_empty(load) {
            ui.label(RichText::new("No scan is open").heading());
            ui.label("Choose one in scanwalk's window on the desktop.");
        }
    });
}

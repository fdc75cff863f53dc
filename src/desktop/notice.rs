//! What must be seen even without the panel: loading, why it failed, and that a second Esc quits.

use super::numbers;
use super::style::{self, BAD, FAINT, GOOD, WARN};
use crate::walk::action::Action;
use crate::walk::link::{HeadsetState, LoadState};
use base::task::Done;
use egui::{Align2, Area, Id, ProgressBar, Rect, RichText, Ui};
use std::time::{Duration, Instant};

/// Draws what there is to say, within this part of the window. `picture` is true if the eyes already show something.
pub(super) fn show(ui: &mut Ui, within: Rect, load: &LoadState, picture: bool, leave_pending: bool) {
    if let Some(error) = &load.error {
        failed(ui, within, error);
    } else if let Some(doing) = &load.doing {
        loading(ui, within, doing, picture);
    }
    if leave_pending {
        card(ui, within, "leave", Align2::CENTER_BOTTOM, -70.0, |ui| ui.label("Press Esc again to quit"));
    }
}

/// How long a notice stays.
const TOLD_FOR: Duration = Duration::from_secs(8);

/// Draws what the frame thread told last, for a while, within this part of the window.
pub(super) fn told(ui: &mut Ui, within: Rect, notice: Option<&(Instant, String)>, now: Instant) {
    if let Some((_, text)) = notice.filter(|(at, _)| now.saturating_duration_since(*at) < TOLD_FOR) {
        card(ui, within, "told", Align2::CENTER_TOP, 16.0, |ui| ui.label(text));
    }
}

/// True if the card that stays says the same.
pub(super) fn is_said(headset: &HeadsetState, text: &str) -> bool {
    headset.waiting_because.as_deref().is_some_and(|because| text.contains(because))
}

/// States of a session in which nobody sees the walk.
const UNSEEN: [&str; 4] = ["IDLE", "READY", "SYNCHRONIZED", "STOPPING"];

/// States of a session in which somebody does.
const SEEN: [&str; 2] = ["VISIBLE", "FOCUSED"];

/// Draws why the walk waits for the headset that it had, with a button to look for it at once; or that nobody wears the one
/// that there is; or that it keeps the frames, which have stalled.
pub(super) fn waiting(ui: &mut Ui, headset: &HeadsetState, is_stalled: bool) -> Option<Action> {
    let said = if UNSEEN.contains(&headset.session) {
        ["Nobody wears the headset", "Put it on to walk in it."]
    } else if is_stalled && SEEN.contains(&headset.session) {
        ["The headset's software does not answer", "Esc, twice, leaves all the same."]
    } else {
        [""; 2]
    };
    let because = headset.waiting_because.as_deref();
    if because.is_none() && said == [""; 2] {
        return None;
    }
    let area = Area::new(Id::unique("waiting")).anchor(Align2::RIGHT_TOP, [-16.0, 16.0]);
    let shown = area.show(ui.ctx(), |ui| {
        let contents = style::card().show(ui, |ui| {
            ui.set_max_width(300.0);
            let Some(because) = because else {
                ui.label(RichText::new(said[0]).color(WARN));
                ui.label(said[1]);
                return false;
            };
            ui.label(RichText::new("Waiting for the headset").color(WARN));
            ui.label(because);
            ui.button("Look for it now").clicked()
        });
        contents.inner
    });
    shown.inner.then_some(Action::LookForHeadset)
}

fn loading(ui: &mut Ui, within: Rect, doing: &Done, picture: bool) {
    // The text stands in the middle while there is nothing else to look at.
    let (align, y) = if picture { (Align2::CENTER_BOTTOM, -16.0) } else { (Align2::CENTER_CENTER, 0.0) };
    card(ui, within, "loading", align, y, |ui| {
        ui.set_width(260.0);
        progress(ui, doing);
    });
}

/// Draws what is done and how far it is, as wide as there is room.
pub(super) fn progress(ui: &mut Ui, doing: &Done) {
    if doing.total == 0 {
        ui.label(format!("{} …", title(doing.what)));
        return;
    }
    let fraction = doing.fraction();
    ui.horizontal(|ui| {
        ui.label(format!("{} …", title(doing.what)));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(RichText::new(format!("{:.0} %", (100.0 * fraction).floor())).color(FAINT));
        });
    });
    ui.add(ProgressBar::new(fraction as f32).desired_height(5.0).fill(GOOD));
    let count = |count| -> String {
        if doing.unit == "bytes" { numbers::bytes(count) } else { numbers::count(count) }
    };
    let unit = if doing.unit == "bytes" { "" } else { doing.unit };
    let text = format!("{} of {} {unit}", count(doing.done), count(doing.total));
    ui.label(RichText::new(text.trim_end()).color(FAINT));
}

/// Returns the text with a capital first letter.
fn title(what: &str) -> String {
    let mut title = what.to_owned();
    if let Some(first) = title.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    title
}

fn failed(ui: &mut Ui, within: Rect, error: &str) {
    card(ui, within, "failed", Align2::CENTER_CENTER, 0.0, |ui| {
        ui.set_max_width(within.width().min(500.0) - 60.0);
        failure(ui, error, "Open another scan (Ctrl+O), or drop one on this window.");
    });
}

/// Draws why there is no scan, and what to do.
pub(super) fn failure(ui: &mut Ui, error: &str, what_to_do: &str) {
    ui.label(RichText::new("The scan could not be loaded").heading().color(BAD));
    ui.add_space(2.0);
    ui.label(error);
    ui.add_space(2.0);
    ui.label(RichText::new(what_to_do).color(FAINT));
}

fn card<R>(
    ui: &mut Ui,
    within: Rect,
    name: &str,
    align: Align2,
    y: f32,
    contents: impl FnOnce(&mut Ui) -> R,
) {
    let area = Area::new(Id::unique(name)).constrain_to(within).anchor(align, [0.0, y]);
    let area = area.interactable(false);
    area.show(ui.ctx(), |ui| style::card().show(ui, contents));
}

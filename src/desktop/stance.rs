//! The part of the panel that tells how the user is in the scan, and changes it.

use super::parts::{fact, fold};
use super::{Widgets, keys, numbers, widget};
use crate::walk::action::{Action, Stance};
use egui::{Grid, Ui};

/// Draws the part; returns the action that the user asked for in it.
pub(super) fn show(ui: &mut Ui, stance: &Stance, widgets: &Widgets) -> Option<Action> {
    let mut asked = None;
    fold(ui, "Moving", true, |ui| {
        Grid::new("moving").num_columns(2).spacing([12.0, 5.0]).show(ui, |ui| {
            let take_for = |kind| asked = Some(Action::TakeFor(kind));
            widget::row(ui, widgets, "locomotion.seen_as", stance.kind, take_for);
        });
        fact(ui, "You", if stance.is_walking { "walk on floors" } else { "fly" });
        fact(ui, "Scan", &numbers::scale(stance.scale));
        if stance.raised_m != 0.0 {
            fact(ui, "Raised by", &format!("{:+.2} m", stance.raised_m));
        }
        if stance.num_places > 0 {
            fact(ui, "Places kept", &stance.num_places.to_string());
        }
        let shown = [
            (if stance.is_walking { "Fly" } else { "Walk" }, Action::ToggleWalking),
            if stance.scale == 1.0 { ("Model", Action::ShowModel) } else { ("Life size", Action::LifeSize) },
            ("Keep place", Action::SavePlace),
            ("Next place", Action::NextPlace),
            ("Start", Action::Reset),
        ];
        ui.horizontal_wrapped(|ui| {
            let can_go = |action: &Action| *action != Action::NextPlace || stance.num_places > 0;
            for (title, action) in shown.into_iter().filter(|(_, action)| can_go(action)) {
                let button = ui.button(title);
                let button = match keys::binding_of(&action) {
                    Some(binding) => {
                        button.on_hover_text(format!("{} ({})", binding.does, binding.labels().join(", ")))
                    }
                    None => button,
                };
                if button.clicked() {
                    asked = Some(action);
                }
            }
        });
    });
    asked
}

//! The part of the panel that changes how the picture looks.

use super::parts::fold;
use super::style::FAINT;
use super::{Widget, Widgets, widget};
use crate::walk::action::Action;
use crate::walk::appearance::QualityPreset;
use crate::walk::state::Snapshot;
use egui::{Grid, RichText, Ui};

/// Draws the part; returns the action that the user asked for in it.
pub(super) fn show(ui: &mut Ui, state: &Snapshot, widgets: &Widgets) -> Option<Action> {
    let mut asked = None;
    let mut appearance = state.appearance;
    fold(ui, "Picture", true, |ui| {
        ui.horizontal(|ui| {
            ui.label(RichText::new("Preset").color(FAINT)).on_hover_text(
                "Settings that belong together: how many points are drawn, and how they are blended. The size of \
                 the headset's images stays until the next start.",
            );
            // The three names are as wide as the panel.
            (ui.spacing_mut().item_spacing.x, ui.spacing_mut().button_padding.x) = (1.0, 6.0);
            for preset in QualityPreset::ALL {
                let title = Widget::title_of(preset.name());
                if ui.selectable_label(state.preset == Some(preset), title).clicked() {
                    asked = Some(Action::SetPreset(preset));
                }
            }
        });
        Grid::new("picture").num_columns(2).spacing([12.0, 5.0]).show(ui, |ui| {
            let draw = &mut appearance.draw;
            widget::row(ui, widgets, "frame.quality", draw.quality, |quality| draw.quality = quality);
        });
    });
    fold(ui, "Surround", false, |ui| {
        Grid::new("surround").num_columns(2).spacing([12.0, 5.0]).show(ui, |ui| {
            let is_shown = appearance.shows_surround;
            widget::row(ui, widgets, "surround.show", is_shown, |show| appearance.shows_surround = show);
            if !is_shown {
                let background = &mut appearance.draw.background;
                widget::row(ui, widgets, "frame.background", *background, |color| *background = color);
                return;
            }
            let surround = &mut appearance.surround;
            widget::row(ui, widgets, "surround.sky", surround.sky, |color| surround.sky = color);
            widget::row(ui, widgets, "surround.horizon", surround.horizon, |color| surround.horizon = color);
            widget::row(ui, widgets, "surround.ground", surround.ground, |color| surround.ground = color);
        });
    });
    if appearance != state.appearance {
        asked = Some(Action::SetAppearance(appearance));
    }
    asked
}

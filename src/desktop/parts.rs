//! What the panel is made of: parts that can be folded, facts, choices.

use super::style::{FAINT, caption};
use super::{Widget, Widgets};
use egui::{Align, Layout, RichText, Ui};

/// Draws the line between two parts.
pub(super) fn section(ui: &mut Ui) {
    ui.add_space(3.0);
    ui.separator();
    ui.add_space(1.0);
}

/// Draws a part that can be folded.
pub(super) fn fold(ui: &mut Ui, title: &str, open: bool, contents: impl FnOnce(&mut Ui)) {
    section(ui);
    // The count in a title may change, so the section is known by the title's first word.
    let name = title.split(' ').next().unwrap_or(title).to_string();
    egui::CollapsingHeader::new(caption(title))
        .id_salt(name)
        .default_open(open)
        .show_unindented(ui, contents);
}

/// Draws the name of the setting with this key and a choice of its value on one line.
pub(super) fn combo<T: PartialEq + Copy>(
    ui: &mut Ui,
    widgets: &Widgets,
    key: &'static str,
    value: &mut T,
    all: &[(&str, T)],
) {
    // A key without a widget is a mistake of whoever draws the row, which every test of the panel shows.
    let Widget { title, help, .. } = widgets.get(key).expect("a setting");
    ui.horizontal(|ui| {
        ui.label(RichText::new(title).color(FAINT)).on_hover_text(help);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let shown = all.iter().find(|(_, choice)| choice == value).map_or("as set", |(title, _)| *title);
            egui::ComboBox::from_id_salt(key).selected_text(shown).show_ui(ui, |ui| {
                for (title, choice) in all {
                    ui.selectable_value(value, *choice, *title);
                }
            });
        });
    });
}

/// Draws a name and its value on one line. A long value is cut; pointing at it shows the whole.
pub(super) fn fact(ui: &mut Ui, name: &str, value: &str) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(name).color(FAINT));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.add(egui::Label::new(value).truncate()).on_hover_text(value);
        });
    });
}

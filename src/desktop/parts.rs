//! What the panel is made of: parts that can be folded, and facts.

use super::style::{FAINT, caption};
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

/// Draws a name and its value on one line. A long value is cut; pointing at it shows the whole.
pub(super) fn fact(ui: &mut Ui, name: &str, value: &str) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(name).color(FAINT));
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.add(egui::Label::new(value).truncate()).on_hover_text(value);
        });
    });
}

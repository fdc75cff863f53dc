//! The help over the picture: every binding of the one table.

use super::controls::WindowState;
use super::keys::BINDINGS;
use super::style::{self, FAINT};
use egui::{Align2, Area, Color32, CornerRadius, Frame, Grid, Id, Margin, Order, RichText, ScrollArea, Ui};

/// Width of the help's contents, points.
const WIDTH: f32 = 430.0;

/// Draws the help if the view wants it.
pub(super) fn show(ui: &mut Ui, view: &mut WindowState) {
    if !view.help {
        return;
    }
    let height = ui.ctx().content_rect().height() - 40.0;
    let area = Area::new(Id::unique("help"))
        .default_size([WIDTH, height])
        .order(Order::Foreground)
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0]);
    area.show(ui.ctx(), |ui| {
        let frame = style::card().inner_margin(Margin::symmetric(22, 18));
        // Lines of small text stand on nothing else.
        frame.fill(frame.fill.to_opaque()).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.heading("Keys and mouse");
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    view.help &= !ui.small_button("Close").clicked();
                });
            });
            ui.add_space(8.0);
            let height = (height - 90.0).max(60.0);
            ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
                Grid::new("bindings").num_columns(2).spacing([28.0, 6.0]).show(ui, |ui| {
                    for binding in BINDINGS {
                        ui.horizontal(|ui| {
                            ui.spacing_mut().item_spacing.x = 4.0;
                            for label in binding.labels() {
                                key_cap(ui, &label);
                            }
                        });
                        ui.label(binding.does);
                        ui.end_row();
                    }
                });
                ui.add_space(6.0);
                ui.label(RichText::new("Keys by their place on a US keyboard.").small().color(FAINT));
            });
        });
    });
}

fn key_cap(ui: &mut Ui, label: &str) {
    Frame::new()
        .fill(Color32::from_gray(48))
        .corner_radius(CornerRadius::same(4))
        .inner_margin(Margin::symmetric(6, 1))
        .show(ui, |ui| ui.label(RichText::new(label).monospace()));
}

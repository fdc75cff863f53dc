//! Colors and measures of everything that egui draws: dark, small, calm.

use egui::{Color32, CornerRadius, FontFamily, FontId, Frame, Margin, RichText, Stroke, TextStyle, vec2};
use timing::STAGES;

/// Color of ordinary text.
pub(super) const TEXT: Color32 = Color32::from_rgb(222, 226, 232);
/// Color of names beside figures.
pub(super) const FAINT: Color32 = Color32::from_rgb(146, 153, 164);
/// Color of times within the budget, and of what is chosen.
pub(super) const GOOD: Color32 = Color32::from_rgb(86, 180, 233);
/// Color of warnings.
pub(super) const WARN: Color32 = Color32::from_rgb(240, 190, 80);
/// Color of times over the budget, and of errors.
pub(super) const BAD: Color32 = Color32::from_rgb(240, 110, 96);
/// Color of a card, behind its text.
const FILL: Color32 = Color32::from_rgba_premultiplied(17, 19, 23, 238);
/// Color of a card's edge.
const EDGE: Color32 = Color32::from_rgba_premultiplied(26, 27, 29, 30);

/// Color of each stage; color-blind people can tell them apart too.
pub(super) const STAGE_COLORS: [Color32; STAGES.len()] = [
    Color32::from_rgb(150, 156, 168),
    Color32::from_rgb(0, 158, 115),
    Color32::from_rgb(204, 121, 167),
    Color32::from_rgb(86, 180, 233),
    Color32::from_rgb(213, 94, 0),
    Color32::from_rgb(230, 170, 50),
    Color32::from_rgb(90, 100, 190),
];

/// Gives an egui context this look.
pub(super) fn apply(context: &egui::Context) {
    context.set_theme(egui::Theme::Dark);
    context.all_styles_mut(|style| {
        let font = |size: f32| FontId::new(size, FontFamily::Proportional);
        style.text_styles = [
            (TextStyle::Heading, font(17.0)),
            (TextStyle::Body, font(13.0)),
            (TextStyle::Button, font(13.0)),
            (TextStyle::Small, font(11.0)),
            (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
        ]
        .into();
        style.spacing.item_spacing = vec2(8.0, 4.0);
        style.spacing.button_padding = vec2(8.0, 3.0);
        style.spacing.interact_size.y = 18.0;
        style.interaction.selectable_labels = false;
        let visuals = &mut style.visuals;
        visuals.override_text_color = Some(TEXT);
        visuals.weak_text_color = Some(FAINT);
        visuals.window_fill = FILL;
        visuals.panel_fill = FILL;
        visuals.window_stroke = Stroke::new(1.0, EDGE);
        visuals.selection.bg_fill = Color32::from_rgb(30, 82, 116);
        visuals.selection.stroke = Stroke::new(1.0, Color32::WHITE);
        visuals.slider_trailing_fill = true;
        visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, EDGE);
    });
}

/// The frame round panel, notices and help.
pub(super) fn card() -> Frame {
    Frame::new()
        .fill(FILL)
        .stroke(Stroke::new(1.0, EDGE))
        .corner_radius(CornerRadius::same(8))
        .inner_margin(Margin::symmetric(14, 12))
}

/// Formats a section's name.
pub(super) fn caption(text: &str) -> RichText {
    RichText::new(text).small().color(FAINT)
}

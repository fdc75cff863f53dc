//! The live plot: GPU time of each stage, stacked, against the budget.

use super::history::{HISTORY_S, History};
use super::style::{BAD, FAINT, STAGE_COLORS};
use egui::{Color32, Stroke, Ui};
use egui_plot::{AxisHints, FilledArea, GridMark, HLine, LineStyle, Plot, PlotUi, Points};
use timing::STAGES;

/// Height of the plot in points.
const HEIGHT: f32 = 116.0;

/// Draws the plot, as wide as the panel.
pub(super) fn show(ui: &mut Ui, history: &History) {
    let top_ms = history.plot_top_ms();
    let budget_ms = history.newest().map(|row| f64::from(row.budget_ms)).filter(|ms| *ms > 0.0);
    let stack = Stack::of(history);
    let step_ms = grid_step(top_ms);
    let marks = move |_| {
        (0..=(top_ms / step_ms) as u32)
            .map(|i| GridMark { value: f64::from(i) * step_ms, step_size: step_ms })
            .collect::<Vec<_>>()
    };
    let axis = AxisHints::new_y()
        .formatter(|mark, _| format!("{}", mark.value))
        .label("")
        .tick_label_color(FAINT)
        .tick_label_font(egui::FontId::proportional(10.0))
        .min_thickness(22.0);
    Plot::new("frame times")
        .height(HEIGHT)
        .show_axes([false, true])
        .custom_y_axes(vec![axis])
        .y_grid_spacer(marks)
        .show_grid([false, true])
        .grid_color(Color32::from_gray(90))
        .show_background(false)
        .set_margin_fraction(egui::Vec2::ZERO)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .allow_double_click_reset(false)
        .show_x(false)
        .show_y(false)
        .label_formatter(|_| None)
        .cursor_color(Color32::TRANSPARENT)
        .show(ui, |plot| {
            plot.set_plot_bounds_x(-HISTORY_S..=0.0);
            plot.set_plot_bounds_y(0.0..=top_ms);
            stack.draw(plot, top_ms);
            if let Some(budget_ms) = budget_ms {
                let stroke = Stroke::new(1.0, Color32::from_gray(235));
                plot.hline(
                    HLine::new("budget", budget_ms)
                        .stroke(stroke)
                        .style(LineStyle::dashed_dense())
                        .allow_hover(false),
                );
            }
        });
}

/// The stages' times on top of each other.
#[derive(Debug, Default, PartialEq)]
struct Stack {
    /// Seconds before the newest frame, ≤ 0.
    age_s: Vec<f64>,
    /// Upper edge of each stage, milliseconds.
    tops_ms: [Vec<f64>; STAGES.len()],
    /// Ages of the frames after which a display period passed without a new one.
    missed_s: Vec<f64>,
}

impl Stack {
    fn of(history: &History) -> Self {
        let mut stack = Self::default();
        for (age_s, row) in history.aged() {
            stack.age_s.push(age_s);
            let mut top_ms = 0.0;
            for (tops_ms, ms) in stack.tops_ms.iter_mut().zip(row.stage_ms) {
                top_ms += if ms.is_finite() { f64::from(ms) } else { 0.0 };
                tops_ms.push(top_ms);
            }
            if row.missed_periods > 0 {
                stack.missed_s.push(age_s);
            }
        }
        stack
    }

    fn draw(&self, plot: &mut PlotUi<'_>, top_ms: f64) {
        if self.age_s.len() < 2 {
            return;
        }
        let floor = vec![0.0; self.age_s.len()];
        for (stage, tops_ms) in self.tops_ms.iter().enumerate() {
            let below_ms = if stage == 0 { &floor } else { &self.tops_ms[stage - 1] };
            plot.add(
                FilledArea::new(STAGES[stage], &self.age_s, below_ms, tops_ms)
                    .fill_color(STAGE_COLORS[stage])
                    .allow_hover(false),
            );
        }
        let marks: Vec<[f64; 2]> = self.missed_s.iter().map(|age_s| [*age_s, top_ms * 0.97]).collect();
        plot.points(Points::new("missed", marks).color(BAD).radius(2.0).allow_hover(false));
    }
}

/// A round step that gives two to five lines.
fn grid_step(top_ms: f64) -> f64 {
    let power = 10f64.powf((top_ms / 5.0).max(1e-3).log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|step| top_ms / step <= 5.0).unwrap_or(top_ms)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desktop::history::tests::row;
    use std::time::Instant;
    use timing::FrameRow;

    #[test]
    fn stages_stand_on_each_other_and_absent_times_count_nothing() {
        let mut history = History::default();
        history.push(row(0, 1.0, 10.0), Instant::now());
        let mut odd = FrameRow { missed_periods: 2, ..row(1, 1.5, 10.0) };
        odd.stage_ms[2] = f32::NAN;
        history.push(odd, Instant::now());
        let stack = Stack::of(&history);
        assert_eq!(stack.age_s, [-0.5, 0.0]);
        assert_eq!(stack.missed_s, [0.0]);
        let tops: Vec<[f64; 2]> = stack.tops_ms.iter().map(|t| [t[0], t[1]]).collect();
        let wanted = [[0.5, 0.5], [1.0, 1.0], [1.5, 1.0], [7.5, 7.0], [8.5, 8.0], [9.5, 9.0], [10.0, 9.5]];
        assert_eq!(tops.len(), wanted.len());
        for (got, wanted) in tops.iter().zip(wanted) {
            assert!(got.iter().zip(wanted).all(|(g, w)| (g - w).abs() < 1e-6), "{tops:?}");
        }
    }

    #[test]
    fn grid_steps_are_round_and_few() {
        for (top_ms, step_ms) in [(15.5, 5.0), (22.2, 5.0), (33.3, 10.0), (111.0, 50.0), (5.0, 1.0)] {
            assert_eq!(grid_step(top_ms), step_ms);
        }
        for top_ms in [1e-9, 0.1, 7.0, 1e6] {
            assert!((0.0..=5.0).contains(&(top_ms / grid_step(top_ms))));
        }
    }
}

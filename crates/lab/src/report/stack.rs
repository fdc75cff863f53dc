//! Stacked plot of the stages along the walk: where the GPU's time goes, and when that changes.

use super::axis::Axis;
use super::markup::Markup;
use super::page;
use super::reduce::{columns, held};
use super::svg::{Path, Plot};
use super::timeline::{SIDES, time_axis};
use timing::{FrameLogFile, STAGES};

const HEIGHT: f64 = 200.0;
/// Colors that `page.css` has: one for each of our stages, and one for those of other versions.
const NUM_COLORS: usize = STAGES.len() + 1;

/// Class that gives a stage its color. Each of our stages has one of its own, whatever version wrote the log.
fn class(stage: &str, at: usize) -> String {
    let ours = STAGES.iter().position(|name| *name == stage);
    format!("s{}", ours.unwrap_or(STAGES.len() + at) % NUM_COLORS)
}

/// The figure, as high as the plot of all frames.
pub(super) fn stack(log: &FrameLogFile, top_ms: f64) -> Markup {
    let time = time_axis(log);
    let axes = [time, Axis::linear(0.0, top_ms)];
    let mut plot = Plot::new("GPU milliseconds of the stages along the walk", axes, SIDES, HEIGHT);
    // Areas need no more than half as many columns as a large screen may show.
    let num = plot.num_columns() / 2;
    let means = |stage: usize| -> Vec<f64> {
        let times = log.frames.iter().map(|frame| (time.place(frame.time_s), frame.stage_ms[stage]));
        held(columns(times, num)).iter().map(|column| column.map_or(0.0, |c| c.mean().max(0.0))).collect()
    };
    plot.mark_x("seconds");
    plot.mark_y(6, "ms");
    let mut below = vec![0.0; num];
    for (at, name) in log.stages.iter().enumerate() {
        let above: Vec<f64> = below.iter().zip(means(at)).map(|(below, ms)| below + ms).collect();
        plot.path(&class(name, at), between(&plot, &below, &above));
        below = above;
    }
    let classes: Vec<String> = log.stages.iter().enumerate().map(|(at, name)| class(name, at)).collect();
    let keys = classes.iter().map(String::as_str).zip(log.stages.iter().map(String::as_str));
    let caption = "Mean GPU milliseconds of each stage, the first at the bottom. Means: single long frames show in \
                   the plot of all frames only.";
    page::figure([plot.finish(), page::keys(keys)], caption)
}

/// The area between two lines.
fn between(plot: &Plot, below: &[f64], above: &[f64]) -> Path {
    let mut path = Path::default();
    let num = below.len();
    for (at, ms) in above.iter().enumerate() {
        path.line_to(plot.at_column(at, num, *ms));
    }
    for (at, ms) in below.iter().enumerate().rev() {
        path.line_to(plot.at_column(at, num, *ms));
    }
    path.close();
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_has_a_color_of_its_own() {
        let style = include_str!("page.css");
        let has = |number: usize| style.contains(&format!("svg .s{number}, "));
        assert!((0..NUM_COLORS).all(has) && !has(NUM_COLORS));
        let ours: Vec<String> = STAGES.iter().map(|stage| class(stage, 0)).collect();
        assert_eq!(ours.last(), Some(&format!("s{}", STAGES.len() - 1)));
        assert!(!ours.contains(&class("a stage of another version", 0)));
    }
}

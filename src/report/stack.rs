//! The stages on top of each other along the walk: where the GPU's time goes, and when that changes.

use super::axis::Axis;
use super::markup::Markup;
use super::page;
use super::reduce::{Column, held};
use super::svg::{Path, Plot};
use super::timeline::{SIDES, along_time, time_axis};
use crate::timing::{FrameLogFile, STAGES};

const HEIGHT: f64 = 200.0;
const NUM_COLORS: usize = 8;

/// The class that gives a stage its color: ours have one each, whatever version wrote the log.
fn class(stage: &str, at: usize) -> String {
    let ours = STAGES.iter().position(|name| *name == stage);
    format!("s{}", ours.unwrap_or(STAGES.len() + at) % NUM_COLORS)
}

/// The figure.
pub(super) fn stack(log: &FrameLogFile) -> Markup {
    let draft = Plot::new("", [time_axis(log), Axis::linear(0.0, 1.0)], SIDES, HEIGHT);
    // Half as many columns as the screen may show: areas need no more.
    let halved = |columns: Vec<Option<Column>>| -> Vec<f64> {
        held(columns).iter().step_by(2).map(|column| column.map_or(0.0, |c| c.mean().max(0.0))).collect()
    };
    let means: Vec<Vec<f64>> = (0..log.stages.len())
        .map(|stage| halved(along_time(&draft, &log.frames, |frame| frame.stage_ms[stage])))
        .collect();
    let num = means.first().map_or(0, Vec::len);
    let tops = (0..num).map(|at| means.iter().map(|stage| stage[at]).sum::<f64>());
    let axis = Axis::linear(0.0, 1.05 * tops.fold(0.0, f64::max));
    let mut plot =
        Plot::new("GPU milliseconds of the stages along the walk", [time_axis(log), axis], SIDES, HEIGHT);
    plot.mark_x("seconds");
    plot.mark_y(5);
    let mut below = vec![0.0; num];
    for (at, (name, stage)) in log.stages.iter().zip(&means).enumerate() {
        let above: Vec<f64> = below.iter().zip(stage).map(|(below, ms)| below + ms).collect();
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

//! GPU and CPU time of every frame along the walk, with the budget, the frames over it, the missed displays, and the states of
//! the headset's session as bands behind them.

use super::axis::Axis;
use super::markup::Markup;
use super::page;
use super::reduce::{PixelColumn, columns, held};
use super::summary::Summary;
use super::svg::{Path, Plot, RIGHT};
use base::words::counted;
use timing::{FrameLogFile, LoggedFrame, Phase};

/// Room for marks beside every plot along the time, the same for all, so that their time axes line up.
pub(super) const SIDES: [f64; 2] = [82.0, RIGHT];
/// Colors that `page.css` has for bands; of more states, some share one.
const NUM_BANDS: usize = 8;
const HEIGHT: f64 = 240.0;
/// How far marks of missed displays reach up from the time axis, in units.
const MISSED_UNITS: f64 = 10.0;

/// Time axis from the first frame to the last, whatever the order of the rows.
pub(super) fn time_axis(log: &FrameLogFile) -> Axis {
    let times = || log.frames.iter().map(|frame| frame.time_s);
    Axis::linear(times().fold(f64::INFINITY, f64::min), times().fold(f64::NEG_INFINITY, f64::max))
}

/// A figure of the frames in each pixel column of a plot along the time.
pub(super) fn along_time(
    plot: &Plot,
    frames: &[LoggedFrame],
    figure: impl Fn(&LoggedFrame) -> f64,
) -> Vec<Option<PixelColumn>> {
    let time = plot.x_axis();
    columns(frames.iter().map(|frame| (time.place(frame.time_s), figure(frame))), plot.num_columns())
}

/// A line through columns that looks as if it went through every frame.
pub(super) fn through(plot: &Plot, columns: &[Option<PixelColumn>]) -> Path {
    let mut path = Path::default();
    for (at, column) in columns.iter().enumerate() {
        let Some(PixelColumn { first, low, high, last, .. }) = column else { continue };
        let mut before = None;
        for value in [first, high, low, last] {
            if before != Some(value) {
                path.line_to(plot.at_column(at, columns.len(), *value));
            }
            before = Some(value);
        }
    }
    path
}

/// Figure of the times of every frame.
pub(super) fn timeline(log: &FrameLogFile, summary: &Summary) -> Markup {
    let top_ms = summary.plotted_ms();
    let mut plot = Plot::new(
        "GPU and CPU milliseconds of every frame along the walk",
        [time_axis(log), Axis::linear(0.0, top_ms)],
        SIDES,
        HEIGHT,
    );
    let states = bands(&mut plot, log, top_ms);
    plot.mark_x("seconds");
    plot.mark_y(6, "ms");
    // A frame that nobody was to see took the CPU no work of ours.
    let cpu = |frame: &LoggedFrame| if frame.phase == Phase::Unseen { f64::NAN } else { cpu_ms(frame) };
    plot.path("cpu", through(&plot, &along_time(&plot, &log.frames, cpu)));
    let frames = along_time(&plot, &log.frames, |frame| frame.gpu_ms);
    plot.path("frames", through(&plot, &frames));
    let over =
        along_time(&plot, &log.frames, |frame| if frame.over_budget { frame.gpu_ms } else { f64::NAN });
    let budgets = held(along_time(&plot, &log.frames, |frame| frame.budget_ms));
    plot.path("over", risen(&plot, &over, &budgets));
    plot.path("budget", steps(&plot, &budgets));
    let missed = along_time(&plot, &log.frames, |frame| frame.missed_periods as f64);
    plot.path("missed", missed_marks(&plot, &missed));
    let keys = [
        ("good", "a frame's GPU time"),
        ("cpu", "its CPU time, to record and to submit"),
        ("over", "the part of it over the budget, and the budget, dashed"),
        ("missed", "displays without a new image"),
    ];
    let states = states.iter().map(|(class, name)| (class.as_str(), name.as_str()));
    page::figure([plot.finish(), page::keys(keys.into_iter().chain(states))], &caption(log, top_ms))
}

/// What the frame thread works on a frame, without its waiting for the headset.
fn cpu_ms(frame: &LoggedFrame) -> f64 {
    let [_, record_ms, submit_ms] = frame.cpu_ms;
    record_ms + submit_ms
}

/// Draws the states of the headset's session as bands; returns their classes and names. One that stays the same has none.
fn bands(plot: &mut Plot, log: &FrameLogFile, top_ms: f64) -> Vec<(String, String)> {
    if log.sessions.len() < 2 {
        return Vec::new();
    }
    let states = log.sessions.iter().enumerate();
    let keys: Vec<_> = states.map(|(at, name)| (format!("band{}", at % NUM_BANDS), name.clone())).collect();
    let session = |frame: &LoggedFrame| frame.session.map_or(f64::NAN, f64::from);
    let columns = held(along_time(plot, &log.frames, session));
    let state = |column: &Option<PixelColumn>| column.map(|column| column.last as usize);
    let mut begin = 0;
    for run in columns.chunk_by(|a, b| state(a) == state(b)) {
        let end = begin + run.len();
        if let Some((class, name)) = state(&run[0]).and_then(|state| keys.get(state)) {
            let corners = [plot.at_edge(begin, columns.len(), 0.0), plot.at_edge(end, columns.len(), top_ms)];
            plot.bar(class, corners, name);
        }
        begin = end;
    }
    keys
}

fn caption(log: &FrameLogFile, top_ms: f64) -> String {
    let beyond = log.frames.iter().filter(|frame| frame.gpu_ms > top_ms);
    let (num, longest_ms) = beyond.fold((0, 0.0_f64), |(num, ms), frame| (num + 1, ms.max(frame.gpu_ms)));
    let drawn = "Milliseconds of each frame, by its time in the walk. Where a pixel has several frames, the lines span the \
                 shortest and the longest of them. Behind them: states of the headset's session, as OpenXR names them, \
                 where there were several; simulated: there was none.";
    match num {
        0 => drawn.into(),
        1 => format!("{drawn} One frame goes beyond the top: {longest_ms:.1} ms."),
        _ => format!("{drawn} {} go beyond the top, up to {longest_ms:.1} ms.", counted(num, "frame")),
    }
}

/// Lines from the budget up to the longest frame over it, one a column.
fn risen(plot: &Plot, over: &[Option<PixelColumn>], budgets: &[Option<PixelColumn>]) -> Path {
    let mut path = Path::default();
    for (at, (over, budget)) in over.iter().zip(budgets).enumerate() {
        if let Some((over, budget)) = over.as_ref().zip(budget.as_ref()) {
            path.move_to(plot.at_column(at, budgets.len(), budget.low));
            path.line_to(plot.at_column(at, budgets.len(), over.high));
        }
    }
    path
}

/// A line that stays until the next value, with corners only where it changes.
pub(super) fn steps(plot: &Plot, columns: &[Option<PixelColumn>]) -> Path {
    let num = columns.len();
    let mut path = Path::default();
    let mut before: Option<(usize, f64)> = None;
    for (at, column) in columns.iter().enumerate().filter_map(|(at, column)| Some((at, column.as_ref()?))) {
        let is_flat = column.low == column.high && before.is_some_and(|(_, value)| value == column.last);
        if !is_flat {
            if let Some((_, value)) = before {
                path.line_to(plot.at_column(at, num, value));
            }
            for value in [column.first, column.low, column.high, column.last] {
                path.line_to(plot.at_column(at, num, value));
            }
        }
        before = Some((at, column.last));
    }
    if let Some((at, value)) = before {
        path.line_to(plot.at_column(at, num, value));
    }
    path
}

/// A mark at the bottom for each column with a missed display.
fn missed_marks(plot: &Plot, missed: &[Option<PixelColumn>]) -> Path {
    let mut path = Path::default();
    for (at, _) in missed.iter().enumerate().filter(|(_, column)| column.is_some_and(|c| c.sum() > 0.0)) {
        let p = plot.at_column(at, missed.len(), 0.0);
        path.move_to(plot.above_bottom(p, 0.0));
        path.line_to(plot.above_bottom(p, MISSED_UNITS));
    }
    path
}

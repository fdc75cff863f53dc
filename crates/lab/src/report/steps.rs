//! Plots of values that change in steps along the walk, one lane each: phases, and what the governor gave up and gave
//! back.

use super::axis::{Axis, label};
use super::markup::Markup;
use super::page;
use super::reduce::held;
use super::svg::Plot;
use super::timeline::{SIDES, along_time, steps, time_axis};
use timing::{FrameLogFile, LoggedFrame, Phase};

/// Least height of a lane.
const HEIGHT: f64 = 46.0;
/// Height of a mark of a lane, with the room to the next.
const MARK: f64 = 15.0;

/// A figure of a frame; NaN where the log has none.
type Figure = fn(&LoggedFrame) -> f64;

/// Figure of the governor; `None` if the log says nothing of it.
pub(super) fn governor(log: &FrameLogFile) -> Option<Markup> {
    let scales: [(&str, Figure); 2] =
        [("LOD scale", |frame| frame.lod_scale), ("resolution scale", |frame| frame.resolution_scale)];
    let mut lanes: Vec<Markup> = Vec::new();
    for (name, figure) in scales {
        let values = || log.frames.iter().map(figure).filter(|value| !value.is_nan());
        if values().next().is_none() {
            continue;
        }
        let ends = [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)];
        lanes.push(lane(log, name, figure, &ends.map(|end| (end, label(end)))));
    }
    if !log.qualities.is_empty() {
        let marks = log.qualities.iter().enumerate().map(|(at, name)| (at as f64, name.clone()));
        let figure = |frame: &LoggedFrame| frame.quality.map_or(f64::NAN, f64::from);
        lanes.push(lane(log, "quality", figure, &marks.collect::<Vec<_>>()));
    }
    let caption = "What frames were drawn with. LOD scale: the factor on the pixels that a node needs to be drawn, 1 \
                   is all detail. Resolution scale: the factor on the width and height that are drawn, 1 is all \
                   pixels.";
    (!lanes.is_empty()).then(|| page::figure(lanes.into_iter().collect::<Markup>(), caption))
}

/// Figure of the phases, which shows when the walk begins; `None` if the log has a single phase.
pub(super) fn phases(log: &FrameLogFile) -> Option<Markup> {
    let place = |phase: Phase| Phase::ALL.iter().position(|other| *other == phase).unwrap_or_default() as f64;
    let first = log.frames.first()?.phase;
    if log.frames.iter().all(|frame| frame.phase == first) {
        return None;
    }
    let marks = Phase::ALL.map(|phase| (place(phase), phase.name().to_owned()));
    let caption = "What frames showed: waiting, no scan yet; arriving, a scan some of whose nodes were still to come beside \
                   them; walking. Figures are of the last of these. Unseen: the runtime wanted nothing drawn.";
    Some(page::figure(lane(log, "phase", |frame| place(frame.phase), &marks), caption))
}

/// Plots one figure along the time, with these values marked.
fn lane(
    log: &FrameLogFile,
    name: &str,
    figure: impl Fn(&LoggedFrame) -> f64,
    marks: &[(f64, String)],
) -> Markup {
    let of = |f: fn(f64, f64) -> f64, start| marks.iter().map(|(value, _)| *value).fold(start, f);
    let (low, high) = (of(f64::min, f64::INFINITY), of(f64::max, f64::NEG_INFINITY));
    // A line along the edge would look cut off.
    let margin = if high > low { 0.15 * (high - low) } else { 0.5 };
    let mut plot = Plot::new(
        name,
        [time_axis(log), Axis::linear(low - margin, high + margin)],
        SIDES,
        HEIGHT.max(MARK * marks.len() as f64),
    );
    plot.mark_x(name);
    for (value, text) in marks {
        plot.mark_y_at(*value, text);
    }
    let columns = held(along_time(&plot, &log.frames, figure));
    plot.path("step", steps(&plot, &columns));
    plot.finish()
}

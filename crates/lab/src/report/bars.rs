//! Horizontal bars with names: a time each, the range that it was measured in, and a mark to compare it with.

use super::axis::{Axis, Scale};
use super::markup::Markup;
use super::svg::{Path, Plot, room_for};

/// Units from one bar to the next.
const PITCH: f64 = 24.0;
/// Height of a bar, as a share of the pitch.
const BAR: f64 = 0.6;
/// Half the edge of the mark, in units.
const MARK: f64 = 5.0;

/// A bar.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bar {
    /// Name to the left of the bar.
    pub(super) name: String,
    /// Words to the right of the bar.
    pub(super) words: String,
    /// Length of the bar.
    pub(super) value: f64,
    /// Both ends of the line across the bar's end.
    pub(super) range: [f64; 2],
    /// Value of the mark, if there is one.
    pub(super) mark: Option<f64>,
}

/// An axis on which all of these bars can be read: logarithmic where they differ much.
pub(super) fn axis_of<'a>(bars: impl Iterator<Item = &'a Bar> + Clone) -> Axis {
    let values = bars.flat_map(|bar| [Some(bar.value), Some(bar.range[0]), Some(bar.range[1]), bar.mark]);
    Axis::spanning(values.flatten(), 20.0)
}

/// Plots the bars.
pub(super) fn bars(described: &str, unit: &str, axis: Axis, bars: &[Bar]) -> Markup {
    let num = bars.len() as f64;
    let sides = [
        room_for(bars.iter().map(|bar| bar.name.as_str())),
        room_for(bars.iter().map(|bar| bar.words.as_str())),
    ];
    let mut plot = Plot::new(described, [axis, Axis::linear(0.0, num)], sides, PITCH * num);
    let scale = if axis.scale() == Scale::Log { ", logarithmic" } else { "" };
    plot.mark_x(&format!("{unit}{scale}"));
    for (at, bar) in bars.iter().enumerate() {
        let middle = num - 0.5 - at as f64;
        let [below, above] = [middle - 0.5 * BAR, middle + 0.5 * BAR];
        let begin = [plot.left(), plot.at(bar.value, below)[1]];
        plot.bar("good", [begin, plot.at(bar.value, above)], &format!("{}: {}", bar.name, bar.words));
        plot.line("whisker", plot.at(bar.range[0], middle), plot.at(bar.range[1], middle));
        for end in bar.range {
            plot.line("whisker", plot.at(end, middle - 0.15), plot.at(end, middle + 0.15));
        }
        if let Some(mark) = bar.mark {
            plot.path("paper", diamond(plot.at(mark, middle)));
        }
        plot.write_left(middle, &bar.name);
        plot.write_beside(middle, &bar.words);
    }
    plot.finish()
}

fn diamond([x, y]: [f64; 2]) -> Path {
    let mut path = Path::default();
    for corner in [[x, y - MARK], [x + MARK, y], [x, y + MARK], [x - MARK, y]] {
        path.line_to(corner);
    }
    path.close();
    path
}

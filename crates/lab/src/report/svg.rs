//! Plots as inline SVG: a drawing area with axes, and paths in it. Colors come from the page's style sheet, by class.

use super::axis::{Axis, label};
use super::markup::Markup;
use std::fmt::Write;

/// Width of every plot in its own units; the page scales it.
const WIDTH: f64 = 720.0;
/// Room below the drawing area, for marks and the axis' name.
const BELOW: f64 = 34.0;
const ABOVE: f64 = 8.0;
/// Room at the right of a plot that writes nothing there.
pub(super) const RIGHT: f64 = 12.0;
/// Width of a character of a mark, at most.
const CHAR: f64 = 7.0;

/// Place and size of the drawing area.
#[derive(Clone, Copy, Debug)]
struct Area {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
}

/// A plot being drawn.
#[derive(Clone, Debug)]
pub(super) struct Plot {
    x: Axis,
    y: Axis,
    area: Area,
    /// Description for those who cannot see the plot.
    described: String,
    body: Markup,
}

impl Plot {
    /// An empty plot with these units of room to the left and to the right of its drawing area.
    pub(super) fn new(described: &str, [x, y]: [Axis; 2], [left, right]: [f64; 2], height: f64) -> Self {
        let area = Area { left, top: ABOVE, width: WIDTH - left - right, height };
        Self { x, y, area, described: described.into(), body: Markup::default() }
    }

    /// How many pixel columns the drawing area has on a large screen.
    pub(super) fn num_columns(&self) -> usize {
        2 * self.area.width as usize
    }

    /// The horizontal axis.
    pub(super) fn x_axis(&self) -> Axis {
        self.x
    }

    /// Converts a place, 0 at the left edge and 1 at the right, to units.
    fn across(&self, place: f64) -> f64 {
        self.area.left + place * self.area.width
    }

    fn x(&self, value: f64) -> f64 {
        self.across(self.x.place(value))
    }

    fn y(&self, value: f64) -> f64 {
        self.area.top + (1.0 - self.y.place(value)) * self.area.height
    }

    /// Draws marks of the horizontal axis, below, with lines through the drawing area.
    pub(super) fn mark_x(&mut self, name: &str) {
        let bottom = self.area.top + self.area.height;
        for tick in self.x.ticks(8) {
            let x = self.x(tick);
            self.line("grid", [x, self.area.top], [x, bottom]);
            // The first and the last would be cut off at the plot's edges.
            let text = label(tick);
            let half = 0.5 * CHAR * text.chars().count() as f64;
            self.write("mark middle", [x.clamp(half, WIDTH - half), bottom + 14.0], &text);
        }
        self.write("mark end", [self.area.left + self.area.width, bottom + 29.0], name);
    }

    /// Draws marks of the vertical axis, to the left.
    pub(super) fn mark_y(&mut self, num: usize, unit: &str) {
        for tick in self.y.ticks(num) {
            self.mark_y_at(tick, &format!("{} {unit}", label(tick)));
        }
    }

    /// Draws one mark of the vertical axis.
    pub(super) fn mark_y_at(&mut self, value: f64, text: &str) {
        let y = self.y(value);
        self.line("grid", [self.area.left, y], [self.area.left + self.area.width, y]);
        self.write("mark end", [self.area.left - 6.0, y + 4.0], text);
    }

    /// Draws a path, unless it is empty.
    pub(super) fn path(&mut self, class: &str, path: Path) {
        if !path.0.is_empty() {
            self.body.push(Markup::element("path", &[("class", &class), ("d", &path.0)], ""));
        }
    }

    /// Point of a path at these values.
    pub(super) fn at(&self, x: f64, y: f64) -> [f64; 2] {
        [self.x(x), self.y(y)]
    }

    /// Point of a path in the middle of one of `num` pixel columns.
    pub(super) fn at_column(&self, column: usize, num: usize, y: f64) -> [f64; 2] {
        [self.across((column as f64 + 0.5) / num as f64), self.y(y)]
    }

    /// Point of a path at the left edge of one of `num` pixel columns; at the right edge of all for column number `num`.
    pub(super) fn at_edge(&self, column: usize, num: usize, y: f64) -> [f64; 2] {
        [self.across(column as f64 / num.max(1) as f64), self.y(y)]
    }

    /// The point `units` above the bottom of the drawing area, below or above this point.
    pub(super) fn above_bottom(&self, [x, _]: [f64; 2], units: f64) -> [f64; 2] {
        [x, self.area.top + self.area.height - units]
    }

    /// Draws a box between two points, with words that appear when it is pointed at.
    pub(super) fn bar(&mut self, class: &str, [a, b]: [[f64; 2]; 2], words: &str) {
        let [x, y] = [0, 1].map(|i| rounded(a[i].min(b[i])));
        let [width, height] = [0, 1].map(|i| rounded((a[i] - b[i]).abs()));
        let words = Markup::element("title", &[], words);
        self.body.push(Markup::element(
            "rect",
            &[("class", &class), ("x", &x), ("y", &y), ("width", &width), ("height", &height)],
            words,
        ));
    }

    /// Draws a straight line.
    pub(super) fn line(&mut self, class: &str, a: [f64; 2], b: [f64; 2]) {
        let mut path = Path::default();
        path.move_to(a);
        path.line_to(b);
        self.path(class, path);
    }

    /// The drawing area's left edge.
    pub(super) fn left(&self) -> f64 {
        self.area.left
    }

    /// Writes words to the left of the drawing area.
    pub(super) fn write_left(&mut self, y: f64, text: &str) {
        let y = self.y(y) + 4.0;
        self.write("end", [self.area.left - 6.0, y], text);
    }

    /// Writes words to the right of the drawing area.
    pub(super) fn write_beside(&mut self, y: f64, text: &str) {
        let y = self.y(y) + 4.0;
        self.write("begin", [self.area.left + self.area.width + 8.0, y], text);
    }

    /// Writes words at a point; `class` says whether it is their beginning, `middle` or `end`.
    pub(super) fn write(&mut self, class: &str, [x, y]: [f64; 2], text: &str) {
        let [x, y] = [x, y].map(rounded);
        self.body.push(Markup::element("text", &[("class", &class), ("x", &x), ("y", &y)], text));
    }

    /// The finished drawing.
    pub(super) fn finish(self) -> Markup {
        let view_box = format!("0 0 {WIDTH} {}", self.area.top + self.area.height + BELOW);
        let attributes: [(&str, &dyn std::fmt::Display); 3] =
            [("viewBox", &view_box), ("role", &"img"), ("aria-label", &self.described)];
        let svg = Markup::element("svg", &attributes, self.body);
        Markup::element("div", &[("class", &"wide")], svg)
    }
}

/// Units of room for the longest of these marks.
pub(super) fn room_for<'a>(marks: impl IntoIterator<Item = &'a str>) -> f64 {
    let longest = marks.into_iter().map(|mark| mark.chars().count()).max().unwrap_or(0);
    (14.0 + CHAR * longest as f64).min(0.4 * WIDTH)
}

/// A path's commands, with coordinates to a tenth of a unit.
#[derive(Clone, Debug, Default)]
pub(super) struct Path(String);

impl Path {
    /// Begins a piece.
    pub(super) fn move_to(&mut self, p: [f64; 2]) {
        self.point('M', p);
    }

    /// Goes on to a point; begins a piece if there is none.
    pub(super) fn line_to(&mut self, p: [f64; 2]) {
        self.point(if self.0.is_empty() { 'M' } else { 'L' }, p);
    }

    /// Closes the piece: goes back to where it began.
    pub(super) fn close(&mut self) {
        self.0.push('Z');
    }

    fn point(&mut self, command: char, [x, y]: [f64; 2]) {
        // Writing to a string cannot fail.
        let _ = write!(self.0, "{command}{} {}", rounded(x), rounded(y));
    }
}

fn rounded(units: f64) -> f64 {
    (10.0 * units).round() / 10.0
}

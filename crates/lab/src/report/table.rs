//! A table, for the terminal and for the page.

use super::markup::Markup;
use std::fmt::{self, Display};

/// Rows of text in columns; each column has a name, and the first column names the rows.
#[derive(Clone, Debug, PartialEq)]
pub struct TextTable {
    head: Vec<String>,
    rows: Vec<Vec<String>>,
}

/// Least width of the first column and of the others, in characters.
const MIN_CHARS: [usize; 2] = [12, 9];

impl TextTable {
    /// A table without rows.
    pub(super) fn new(head: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self { head: head.into_iter().map(Into::into).collect(), rows: Vec::new() }
    }

    /// Adds a row; a row whose name is indented is a part of the row above.
    pub(super) fn row(&mut self, name: impl Into<String>, cells: impl IntoIterator<Item = String>) {
        self.rows.push(std::iter::once(name.into()).chain(cells).collect());
    }

    /// The table as HTML, in a box that scrolls where the screen is too narrow.
    pub(super) fn markup(&self) -> Markup {
        let cells = |tag: &str, row: &[String]| -> Markup {
            row.iter().map(|cell| Markup::element(tag, &[], cell.trim())).collect()
        };
        let head = Markup::element("tr", &[], cells("th", &self.head));
        let rows = self.rows.iter().map(|row| {
            let kind = if row[0].starts_with(' ') { "part" } else { "whole" };
            Markup::element("tr", &[("class", &kind)], cells("td", row))
        });
        let table =
            [Markup::element("thead", &[], head), Markup::element("tbody", &[], rows.collect::<Markup>())];
        Markup::element("div", &[("class", &"wide")], Markup::element("table", &[], table))
    }
}

impl Display for TextTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines = || std::iter::once(&self.head).chain(&self.rows);
        let width = |column: usize| {
            let longest = lines().filter_map(|line| line.get(column)).map(|cell| cell.chars().count()).max();
            let apart = if column == 0 { 1 } else { 2 };
            (longest.unwrap_or(0) + apart).max(MIN_CHARS[column.min(1)])
        };
        let widths: Vec<usize> = (0..self.head.len()).map(width).collect();
        for line in lines() {
            let mut text = String::new();
            for (column, (cell, width)) in line.iter().zip(&widths).enumerate() {
                text += &if column == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") };
            }
            writeln!(f, "{}", text.trim_end())?;
        }
        Ok(())
    }
}

/// Milliseconds to a microsecond; a dash where nothing was measured.
pub(super) fn ms(value: Option<f64>) -> String {
    value.filter(|ms| !ms.is_nan()).map_or_else(|| "-".into(), |ms| format!("{ms:.3}"))
}

/// A part of a whole in percent; a dash where there is no whole.
pub(super) fn percent(part: f64, whole: f64) -> String {
    if whole > 0.0 { format!("{:.2} %", 100.0 * part / whole) } else { "-".into() }
}

/// Each value once, in the order in which they first appear.
pub(crate) fn in_order<T: PartialEq>(values: impl Iterator<Item = T>) -> Vec<T> {
    let mut once = Vec::new();
    for value in values {
        if !once.contains(&value) {
            once.push(value);
        }
    }
    once
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up_and_grow() {
        let mut table = TextTable::new(["ms", "A", "B"]);
        table.row("GPU", [ms(Some(1.0)), ms(None)]);
        table.row("  a stage of a long name", ["123456789012".into(), percent(1.0, 0.0)]);
        let text = table.to_string();
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[1].starts_with("GPU ") && lines[1].ends_with('-'), "{text}");
        assert_eq!(lines[1].len(), lines[2].len(), "{text}");
        assert!(lines[1].contains("         1.000"), "as wide as the cell below: {text}");
        let markup = table.markup().into_string();
        assert!(markup.contains("<tr class=\"part\"><td>a stage"), "{markup}");
    }
}

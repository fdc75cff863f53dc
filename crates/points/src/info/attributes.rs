//! `scanwalk info --attributes`: what each attribute of the files holds, for people or as JSON.

use super::distinct;
use crate::column::Number;
use crate::tally::{self, Tallied, Tally};
use crate::{Header, ReadOptions, ScanError, Type};
use base::task::Task;
use base::words::{counted, grouped_by};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

/// What `--json` prints; the names are a contract.
#[derive(Debug, Serialize)]
struct AttributesDescription {
    points: u64,
    format: String,
    columns: Vec<ColumnDescription>,
    not_read: Vec<String>,
    warnings: Vec<String>,
}

/// An attribute, as `--json` prints it. Colors and directions have a smallest and a largest value for each of their three
/// numbers.
#[derive(Debug, Serialize)]
struct ColumnDescription {
    name: String,
    #[serde(rename = "type")]
    kind: String,
    points: u64,
    min: Value,
    max: Value,
    /// Points of each class that has any.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    classes: BTreeMap<usize, u64>,
}

/// Reads all attributes of the files to their ends, block by block, and says what they hold. Points that are withheld
/// count too.
///
/// # Errors
/// See [`crate::read()`].
pub fn attributes_text(
    paths: &[PathBuf],
    json: bool,
    options: &ReadOptions,
    task: &Task,
) -> Result<String, ScanError> {
    let tallied = tally::of_files(paths, options, task)?;
    if !json {
        return Ok(for_people(&tallied));
    }
    // Numbers, texts and lists of them always have a form in JSON.
    Ok(serde_json::to_string_pretty(&describe(&tallied)).expect("JSON") + "\n")
}

fn describe(tallied: &Tallied) -> AttributesDescription {
    let column = |tally: &Tally| {
        let [min, max] = [0, 1].map(|end| {
            let mut values: Vec<Value> =
                tally.ranges.iter().map(|range| json(tally.kind, range, end)).collect();
            if values.len() == 1 { values.remove(0) } else { Value::Array(values) }
        });
        ColumnDescription {
            name: tally.attribute.name().into_owned(),
            kind: tally.kind.name(),
            points: tally.num_points,
            min,
            max,
            classes: classes(tally).collect(),
        }
    };
    AttributesDescription {
        points: tallied.num_points,
        format: distinct(tallied.headers.iter().map(|header| header.format.clone())).join("; "),
        columns: tallied.tallies.iter().map(column).collect(),
        not_read: not_read(&tallied.headers),
        warnings: tallied.warnings.clone(),
    }
}

/// What the points of any of the files have that no column holds.
pub(super) fn not_read(headers: &[Header]) -> Vec<String> {
    distinct(headers.iter().flat_map(|header| header.schema.unread.iter().cloned()))
}

/// Classes that have points, and how many.
fn classes(tally: &Tally) -> impl Iterator<Item = (usize, u64)> + '_ {
    tally.classes.iter().copied().enumerate().filter(|(_, num_points)| *num_points > 0)
}

/// An end of a range; null if there is none, or if it is infinite.
fn json(kind: Type, range: &Option<[Number; 2]>, end: usize) -> Value {
    match range.map(|range| range[end]) {
        Some(Number::Whole(whole)) if kind == Type::Bool => (whole != 0).into(),
        // Every type of whole numbers is in the range of one of these two.
        Some(Number::Whole(whole)) => match i64::try_from(whole) {
            Ok(whole) => whole.into(),
            Err(_) => (whole as u64).into(),
        },
        Some(Number::Float(float)) => float.into(),
        None => Value::Null,
    }
}

fn for_people(tallied: &Tallied) -> String {
    let AttributesDescription { points, format, not_read, warnings, .. } = describe(tallied);
    let mut rows = vec![["attribute", "type", "points", "smallest", "largest"].map(String::from)];
    rows.extend(tallied.tallies.iter().map(|tally| {
        let [low, high] = [0, 1].map(|end| {
            let words = tally.ranges.iter().map(|range| words(tally.kind, range, end));
            words.collect::<Vec<_>>().join(" ")
        });
        let num_points = grouped_by(tally.num_points, ',');
        [tally.attribute.name().into_owned(), tally.kind.name(), num_points, low, high]
    }));
    let widths = [0, 1, 2, 3, 4].map(|at| rows.iter().map(|row| row[at].chars().count()).max().unwrap_or(0));
    let [name_width, kind_width, points_width, low_width, high_width] = widths;
    let mut text = String::new();
    // Writing to a string cannot fail.
    let mut line = |name: &str, value: String| {
        let _ = if value.is_empty() { Ok(()) } else { writeln!(text, "{name:<11} {value}") };
    };
    line("points", grouped_by(points, ','));
    line("format", format);
    for [name, kind, num_points, low, high] in &rows {
        line(
            "",
            format!(
                "{name:<name_width$}  {kind:<kind_width$}  {num_points:>points_width$}  {low:>low_width$}  \
                 {high:>high_width$}"
            ),
        );
    }
    let classes = tallied.tallies.iter().flat_map(classes);
    let classes = classes.map(|(class, num)| format!("{class} ({})", counted(grouped_by(num, ','), "point")));
    line("classes", classes.collect::<Vec<_>>().join(", "));
    line("not read", not_read.join(", "));
    warnings.into_iter().for_each(|warning| line("warning", warning));
    text
}

/// An end of a range as people read it.
fn words(kind: Type, range: &Option<[Number; 2]>, end: usize) -> String {
    match range.map(|range| range[end]) {
        Some(Number::Whole(whole)) if kind == Type::Bool => if whole == 0 { "no" } else { "yes" }.into(),
        Some(Number::Whole(whole)) => whole.to_string(),
        Some(Number::Float(float)) => digits(float),
        None => "none".into(),
    }
}

/// As many digits as a float is known by: all of 32 bits, 12 of 64 bits, the last of which are those of scales.
fn digits(value: f64) -> String {
    let magnitude = value.abs().log10().floor();
    if value != 0.0 && !(-5.0..15.0).contains(&magnitude) {
        return format!("{value:e}");
    }
    let single = value as f32;
    if f64::from(single) == value {
        return single.to_string();
    }
    let text = format!("{value:.*}", (11.0 - magnitude).clamp(0.0, 16.0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn people_read_short_numbers() {
        for (value, text) in [
            (0.0, "0"),
            (-20.0, "-20"),
            (f64::from(0.1f32), "0.1"),
            (0.006 * 5.0, "0.03"),
            (-0.006 * 29999.0, "-179.994"),
            (413_665.233_6, "413665.2336"),
            (1e300, "1e300"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(digits(value), text, "{value}");
        }
    }
}

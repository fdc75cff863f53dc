//! Names the columns of a text that does not name them, by their number and by their values.

use crate::formats::plan::SKIPPED;

/// Largest value of 8 bits.
const WHITE_8: f64 = 255.0;
/// Whole numbers that do not reach this are no colors: classes, numbers of returns.
const LEAST_WHITE: f64 = 16.0;
/// Part of the rows that may have odd values.
const MOST_ODD: f64 = 0.05;
/// How far the length of a normal may be from 1.
const NORMAL_ERROR: f64 = 0.02;

/// Names for `num_columns` columns, of which these rows are a sample. In a PTS file an intensity comes before colors.
/// Columns without numbers are passed over.
pub(super) fn names(num_columns: usize, rows: &[Vec<f64>], is_pts: bool) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    let has_numbers = |at: usize| values(rows, at).any(|value| !value.is_nan());
    let mut place = ["x", "y", "z"].into_iter();
    while place.len() > 0 && names.len() < num_columns {
        let name = if has_numbers(names.len()) { place.next() } else { None };
        names.push(name.unwrap_or(SKIPPED).into());
    }
    let has_intensity = |names: &[String]| names.iter().any(|name| name == "intensity");
    let has_color = |names: &[String]| names.iter().any(|name| name == "r");
    while names.len() < num_columns {
        let at = names.len();
        let is_triple = |from: usize| from + 3 <= num_columns;
        if !has_numbers(at) {
            names.push(SKIPPED.into());
        } else if is_triple(at) && is_normal(rows, at) {
            names.extend(["nx", "ny", "nz"].map(str::to_owned));
        } else if is_triple(at)
            && !has_color(&names)
            && is_color(rows, at)
            && !is_shifted(rows, at, num_columns, is_pts)
        {
            names.extend(["r", "g", "b"].map(str::to_owned));
        } else if !has_intensity(&names) {
            names.push("intensity".into());
        } else {
            names.push(format!("column {}", at + 1));
        }
    }
    names.truncate(num_columns);
    names
}

/// True if a color may start in the column, but the next three columns are likelier: an intensity comes first in PTS, and
/// red, green and blue are closer to each other than to an intensity.
fn is_shifted(rows: &[Vec<f64>], at: usize, num_columns: usize, is_pts: bool) -> bool {
    if at + 4 > num_columns || !is_color(rows, at + 1) {
        return false;
    }
    let apart = |a: usize, b: usize| -> f64 {
        values(rows, a).zip(values(rows, b)).map(|(a, b)| (a - b).abs()).sum()
    };
    is_pts || apart(at + 2, at + 3) < apart(at, at + 1)
}

/// Values of a column.
fn values(rows: &[Vec<f64>], at: usize) -> impl Iterator<Item = f64> {
    rows.iter().map(move |row| row.get(at).copied().unwrap_or(f64::NAN))
}

/// True if the three columns from `at` on may be red, green and blue: whole numbers of 8 or 16 bits, or 0 to 1.
fn is_color(rows: &[Vec<f64>], at: usize) -> bool {
    let three = || (at..at + 3).flat_map(|at| values(rows, at)).filter(|value| !value.is_nan());
    let (low, high) = three().fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
    if low < 0.0 || low > high {
        return false;
    }
    let is_whole = three().all(|value| value.fract() == 0.0);
    let reaches = |least: f64| (at..at + 3).all(|at| values(rows, at).any(|value| value >= least));
    match is_whole {
        true if high <= WHITE_8 => high >= LEAST_WHITE || high == 0.0,
        // Three channels of 16 bits all reach beyond 8.
        true => high <= 65535.0 && reaches(WHITE_8 + 1.0),
        false => high <= 1.0,
    }
}

/// True if the three columns from `at` on have unit length, or are zeros, in nearly all rows.
fn is_normal(rows: &[Vec<f64>], at: usize) -> bool {
    let three = |row: &Vec<f64>| Some([*row.get(at)?, *row.get(at + 1)?, *row.get(at + 2)?]);
    let (mut num_unit, mut num_odd) = (0, 0);
    for [x, y, z] in rows.iter().filter_map(three) {
        let length = (x * x + y * y + z * z).sqrt();
        if (length - 1.0).abs() <= NORMAL_ERROR {
            num_unit += 1;
        } else if length != 0.0 && !length.is_nan() {
            num_odd += 1;
        }
    }
    num_unit > 0 && f64::from(num_odd) <= MOST_ODD * rows.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guessed(rows: &[&[f64]], is_pts: bool) -> String {
        let rows: Vec<Vec<f64>> = rows.iter().map(|row| [&[1e5, 2e5, 30.5], *row].concat()).collect();
        names(rows[0].len(), &rows, is_pts).join(" ")
    }

    #[test]
    fn columns_are_guessed_by_their_values() {
        for (rows, expected) in [
            (&[&[][..]][..], "x y z"),
            (&[&[0.5]], "x y z intensity"),
            (&[&[-1613.0, 70.0]], "x y z intensity column 5"),
            (&[&[200.0, 10.0, 0.0], &[9.0, 9.0, 9.0]], "x y z r g b"),
            (&[&[60000.0, 400.0, 300.0]], "x y z r g b"),
            (&[&[0.2, 1.0, 0.0], &[0.2, 0.3, 0.4]], "x y z r g b"),
            (&[&[0.6, -0.8, 0.0], &[0.0, 0.0, 1.0]], "x y z nx ny nz"),
            (&[&[0.0, 0.0, 1.0]], "x y z nx ny nz"),
            (&[&[1.0, 1.0, 2.0]], "x y z intensity column 5 column 6"),
            (&[&[0.5, 200.0, 10.0, 0.0]], "x y z intensity r g b"),
            (&[&[200.0, 10.0, 0.0, 0.5]], "x y z r g b intensity"),
            (&[&[200.0, 190.0, 180.0, 20.0]], "x y z r g b intensity"),
            (&[&[20.0, 200.0, 190.0, 180.0]], "x y z intensity r g b"),
            (&[&[200.0, 10.0, 0.0, 0.6, 0.0, 0.8]], "x y z r g b nx ny nz"),
            (&[&[0.6, 0.0, 0.8, 200.0, 10.0, 0.0]], "x y z nx ny nz r g b"),
            (&[&[200.0, 10.0, 0.0, 0.6, 0.0, 0.8, 4.0]], "x y z r g b nx ny nz intensity"),
        ] {
            assert_eq!(guessed(rows, false), expected);
        }
        assert_eq!(guessed(&[&[200.0, 190.0, 180.0, 20.0]], true), "x y z intensity r g b");
        let words = [vec![7.0, f64::NAN, 1.0, 2.0, f64::NAN, 5.0]];
        assert_eq!(names(6, &words, false).join(" "), "x - y z - intensity");
    }
}

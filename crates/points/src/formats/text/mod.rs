//! Text with one point a line: XYZ, TXT, CSV, ASC and PTS, with or without names of columns.
//!
//! What the columns are is found by a line of names, or else by their number and their values, and is shown; a user may
//! say it instead.

mod guess;
mod shape;
mod units;

use super::measured::{self};
use super::names;
use super::plan::{PlannedColor, RowPlan, SKIPPED, StoredColumn};
use super::rows::{Dialect, RowsAt, Separator, TextRowsFile};
use super::sniff::is_text;
use super::{Candidate, Dataset, Format, HEAD_BYTES, OpenHints, Take};
use crate::block::Trailer;
use crate::column::Type;
use crate::crs::{Angle, Axes};
use crate::source::Source;
use crate::{Attribute, Header, Projection, ScanError};
use base::task::Progress;
use base::words::counted;
use shape::TextShape;
use std::path::Path;

/// Bytes from the start that tell a text's shape.
const SHAPE_BYTES: u64 = 1 << 18;
/// Bytes that are looked at in each of some other places.
const SAMPLE_BYTES: u64 = 1 << 15;
/// Lines that tell the shape; fewer among a file's first bytes are so long that more must be seen.
const LEAST_LINES: usize = 3;
/// Places in a file that are looked at, in parts of its length.
const SAMPLED: [f64; 3] = [0.35, 0.65, 0.95];
/// Endings of texts that name what they are beside the names of the format.
const ENDINGS: [&str; 8] = ["xyzrgb", "xyzi", "xyzn", "xyb", "neu", "tsv", "dat", "pnt"];

/// Tables of points as text.
pub(super) struct Text;

impl Format for Text {
    fn names(&self) -> &'static [&'static str] {
        &["XYZ", "TXT", "CSV", "ASC", "PTS"]
    }

    fn probe(&self, candidate: &Candidate) -> bool {
        let head = candidate.head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(candidate.head);
        let is_all = (candidate.head.len() as u64) < HEAD_BYTES;
        let is_named_so = is_named_so(candidate.path);
        // The shape of a file that begins with long comments, or a long line of names, is found when it is opened.
        let is_more = || {
            let lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
            let mut lines = lines.filter(|line| !line.is_empty());
            !is_all
                && (lines.clone().count() < LEAST_LINES
                    || lines.all(|line| line.starts_with(b"#") || line.starts_with(b"//")))
        };
        !has_ending(candidate.path, &["ptx"])
            && is_text(head)
            && !is_known_comment(head)
            && (TextShape::of(candidate.head, is_all, is_named_so).is_some() || is_named_so && is_more())
    }

    fn open(&self, path: &Path, hints: &OpenHints) -> Result<Box<dyn Dataset>, ScanError> {
        let source = Source::open(path)?;
        let head = source.bytes(0, SHAPE_BYTES)?;
        let is_all = head.len() as u64 == source.len();
        let no_rows = || ScanError::NoPoints {
            path: path.to_owned(),
            reason:
                "it is text, but has no rows of three numbers and more; check that this is the file you mean"
                    .into(),
        };
        let mut shape = TextShape::of(&head, is_all, true).ok_or_else(no_rows)?;
        if !is_all {
            sample(&source, &mut shape)?;
        }
        let is_pts = shape.announced.is_some() || has_ending(path, &["pts"]);
        let plan = plan(path, &shape, hints, is_pts)?;
        let num_bytes = source.len().saturating_sub(shape.start as u64);
        let at = RowsAt {
            start: shape.start as u64,
            line_end: shape.line_end,
            dialect: shape.dialect,
            num_points: (num_bytes as f64 / shape.row_bytes).round() as u64,
            has_counts: is_pts,
            in_header: shape.announced,
        };
        let header = describe(path, &shape, &plan, is_pts, at.num_points);
        Ok(Box::new(TextFile { rows: TextRowsFile::new(source, at, plan.rows), header }))
    }
}

/// True for a comment that begins files of other formats.
fn is_known_comment(head: &[u8]) -> bool {
    head.starts_with(b"# vtk") || head.starts_with(b"# .PCD")
}

fn has_ending(path: &Path, endings: &[&str]) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    endings.iter().any(|known| ending.eq_ignore_ascii_case(known))
}

fn is_named_so(path: &Path) -> bool {
    has_ending(path, Text.names()) || has_ending(path, &ENDINGS)
}

/// Adds rows from other places of the file to the sample.
fn sample(source: &Source, shape: &mut TextShape) -> Result<(), ScanError> {
    for part in SAMPLED {
        let text = source.bytes((source.len() as f64 * part) as u64, SAMPLE_BYTES)?;
        // The first line and the last are not whole.
        let is_end = |byte: &u8| *byte == shape.line_end;
        let (Some(from), Some(to)) = (text.iter().position(is_end), text.iter().rposition(is_end)) else {
            continue;
        };
        let mut rows = shape::values(shape.dialect, text[from..to].split(is_end));
        rows.retain(|row| row.len() == shape.num_columns);
        shape.rows.extend(rows);
    }
    Ok(())
}

/// What the columns are.
struct Planned {
    rows: RowPlan,
    /// Names of columns that are not read.
    unread: Vec<String>,
    /// Sentences about what is odd, whose subject is the file.
    warnings: Vec<String>,
}

/// Decides what the columns are: by a user's names, by the file's, or by the values.
fn plan(path: &Path, shape: &TextShape, hints: &OpenHints, is_pts: bool) -> Result<Planned, ScanError> {
    let fail = |problem: String| ScanError::NoPoints { path: path.to_owned(), reason: problem };
    let said = hints.columns.names();
    let mut warnings = Vec::new();
    let mut names: Vec<String> = match &shape.names {
        _ if !said.is_empty() => {
            if said.len() > shape.num_columns {
                return Err(fail(format!(
                    "its rows have {}, and cloud.columns names {}: {}",
                    counted(shape.num_columns, "column"),
                    said.len(),
                    hints.columns
                )));
            }
            said.to_vec()
        }
        Some(names) => {
            let bare: Vec<&str> = names.iter().map(|name| units::bare(name)).collect();
            if names::place(&bare).is_some() {
                let plain = |name: &String| {
                    let bare = units::bare(name);
                    if names::is_coordinate(bare) { bare.to_owned() } else { name.clone() }
                };
                names.iter().map(plain).collect()
            } else if bare.iter().any(|name| names::is_coordinate(name))
                || is_named_so(path) && !is_table(path)
            {
                warnings.push(format!(
                    "names its columns {}, not x, y and z: {} are taken for these; cloud.columns says it better",
                    names.join(", "),
                    "the first three"
                ));
                guess::names(shape.num_columns, &shape.rows, is_pts)
            } else {
                return Err(fail(format!(
                    "its columns are {}, and none is named x, y or z: --set cloud.columns=x,y,z,- says which are",
                    names.join(", ")
                )));
            }
        }
        None => guess::names(shape.num_columns, &shape.rows, is_pts),
    };
    names.truncate(shape.num_columns);
    names.resize(shape.num_columns, SKIPPED.into());
    // Columns of words are not read.
    let mut unread = Vec::new();
    for (at, name) in names.iter_mut().enumerate() {
        let has_numbers = shape.rows.iter().any(|row| row.get(at).is_some_and(|value| !value.is_nan()));
        if !has_numbers && name != SKIPPED && !names::is_coordinate(name) {
            unread.push(std::mem::replace(name, SKIPPED.into()));
        }
    }
    let columns = names.into_iter().enumerate().map(|(at, name)| column(&shape.rows, at, name)).collect();
    // Names that a user says have a place, and so have guessed ones; those of a header may stand behind the last column.
    let plan = RowPlan::of(columns).ok_or_else(|| {
        fail(format!(
            "its rows have {}, fewer than it names; export it again",
            counted(shape.num_columns, "column")
        ))
    })?;
    Ok(Planned { rows: plan, unread, warnings })
}

/// True for a file of any table.
fn is_table(path: &Path) -> bool {
    has_ending(path, &["csv", "txt", "tsv", "dat"])
}

/// What a column of this name holds, judged by a sample of rows.
fn column(rows: &[Vec<f64>], at: usize, name: String) -> StoredColumn {
    let values = || rows.iter().filter_map(|row| row.get(at)).filter(|value| !value.is_nan());
    let is_whole = values().next().is_some() && values().all(|value| value.fract() == 0.0);
    let fits = |most: f64| is_whole && values().all(|value| (0.0..=most).contains(value));
    // Attributes that all files have in whole numbers of a type have it here too.
    let known = |kind: Type| !matches!(names::attribute(&name, kind), (Attribute::Named(_), _));
    let is_only = |kind: Type| known(kind) && !known(Type::F64);
    let kind = if is_only(Type::U8) && fits(255.0) {
        Type::U8
    } else if is_only(Type::U16) && fits(65535.0) {
        Type::U16
    } else {
        Type::F64
    };
    StoredColumn { name, kind, is_whole }
}

/// What a file says of itself.
fn describe(path: &Path, shape: &TextShape, planned: &Planned, is_pts: bool, num_points: u64) -> Header {
    let plan = &planned.rows;
    let (what, columns) = (if is_pts { "PTS" } else { "text" }, in_words(plan));
    let Dialect { separator, point } = shape.dialect;
    let commas = if point == b',' { ", with decimal commas" } else { "" };
    let unit = |at: usize| shape.names.as_ref().and_then(|names| units::of_name(names.get(at)?));
    let of_remarks = shape.remarks.iter().find_map(|remark| units::of_remark(remark));
    let [x, _, z] = plan.place;
    let unit_m = unit(x).or(of_remarks);
    let is_longitude =
        |name: &str| name.to_ascii_lowercase().starts_with("lon") || name.eq_ignore_ascii_case("lng");
    let axes = is_longitude(&plan.columns[x].name).then_some(Axes::Geographic(Angle::Degree));
    let is_blanks = separator == Separator::Blanks;
    let between = if is_blanks { String::new() } else { format!(", separated by {}", separator.words()) };
    Header {
        path: path.to_owned(),
        format: format!("{what}, columns {columns}{between}{commas}"),
        num_points,
        schema: plan.schema(planned.unread.clone()),
        unit_m,
        vertical_unit_m: unit(z).filter(|unit| unit_m.is_some_and(|unit_m| unit_m != *unit)),
        axes,
        warnings: planned.warnings.clone(),
        ..Header::default()
    }
}

/// The columns as they are understood: "x y z intensity r g b".
fn in_words(plan: &RowPlan) -> String {
    let role = |at: usize| {
        let three = |of: Option<[usize; 3]>, names: [&'static str; 3]| {
            of.and_then(|of| of.iter().position(|&other| other == at)).map(|number| names[number])
        };
        let colors = match plan.color {
            PlannedColor::Whole(of) | PlannedColor::Floats(of) => Some(of),
            _ => None,
        };
        three(Some(plan.place), ["x", "y", "z"])
            .or_else(|| three(colors, ["r", "g", "b"]))
            .or_else(|| three(plan.normal, ["nx", "ny", "nz"]))
            .or_else(|| (plan.intensity == Some(at)).then_some("intensity"))
    };
    let word = |at: usize| {
        let name = plan.columns[at].name.replace(char::is_whitespace, "_");
        role(at).map_or(name, str::to_owned)
    };
    (0..plan.columns.len()).map(word).collect::<Vec<String>>().join(" ")
}

/// An opened file.
#[derive(Debug)]
struct TextFile {
    rows: TextRowsFile,
    header: Header,
}

impl Dataset for TextFile {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&self, want: &Projection, take: &mut Take, progress: &Progress) -> Result<Trailer, ScanError> {
        measured::read(&self.rows, want, take, progress)
    }
}

#[cfg(test)]
mod tests;

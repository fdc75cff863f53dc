//! Rows of text, one point a line: the body of text files, and of PCD files whose data are ASCII.
//!
//! A file is cut into parts of about a megabyte; the lines that start in a part are its rows. Lines without words, comments
//! and lines that only count points are no rows; a line that cannot be read is left out and counted.

mod cells;
mod row;

pub(super) use cells::{Dialect, Separator};
pub(super) use row::of_bits;

use super::measured::{Measured, Part, RowsSeen};
use super::plan::RowPlan;
use crate::source::Source;
use crate::{Projection, ScanError};
use base::words::{agreeing, counted};
use row::RowTaker;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// Bytes of a part.
const PART_BYTES: u64 = 1 << 20;
/// Bytes that are read at once behind a part, to find the end of its last line.
const MORE_BYTES: u64 = 1 << 16;
/// Most bytes of a line; longer ones are damage.
const MOST_LINE_BYTES: u64 = 1 << 22;
/// Most characters of a bad row that are quoted.
const MOST_QUOTED: usize = 40;

/// The rows of an opened file.
#[derive(Debug)]
pub(super) struct TextRowsFile {
    source: Source,
    /// Byte of the first row.
    start: u64,
    /// Byte that ends a line.
    line_end: u8,
    dialect: Dialect,
    plan: RowPlan,
    /// Points to be expected.
    num_points: u64,
    /// True if a line of one whole number says how many rows follow.
    has_counts: bool,
    /// Points that such lines announce in each part.
    announced: Vec<AtomicU64>,
    /// Points that the header announces.
    in_header: Option<u64>,
}

/// Where rows are and how they are written.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowsAt {
    /// Byte of the first row.
    pub start: u64,
    /// Byte that ends a line.
    pub line_end: u8,
    pub dialect: Dialect,
    /// About how many points there are.
    pub num_points: u64,
    /// True if a line of one whole number says how many rows follow.
    pub has_counts: bool,
    /// Points that the header announces.
    pub in_header: Option<u64>,
}

impl TextRowsFile {
    /// The rows of a file, with columns by a plan.
    pub fn new(source: Source, at: RowsAt, plan: RowPlan) -> Self {
        let num_parts = source.len().saturating_sub(at.start).div_ceil(PART_BYTES);
        let announced = (0..num_parts).map(|_| AtomicU64::new(0)).collect();
        let RowsAt { start, line_end, dialect, num_points, has_counts, in_header } = at;
        Self { source, start, line_end, dialect, plan, num_points, has_counts, announced, in_header }
    }

    /// The text of the lines that start in a part, and the byte of the file where it starts.
    fn text(&self, part: usize) -> Result<(Vec<u8>, u64), ScanError> {
        let from = self.start + part as u64 * PART_BYTES;
        // The byte before tells whether a line starts with the part.
        let (at, num_before) = if part == 0 { (from, 0) } else { (from - 1, 1) };
        let mut text = self.source.bytes(at, PART_BYTES + num_before)?;
        let is_whole = |text: &[u8]| text.last() == Some(&self.line_end);
        while !is_whole(&text) {
            let next = at + text.len() as u64;
            let more = self.source.bytes(next, MORE_BYTES)?;
            let end = more.iter().position(|&byte| byte == self.line_end);
            text.extend_from_slice(&more[..end.map_or(more.len(), |end| end + 1)]);
            if more.is_empty() || text.len() as u64 > PART_BYTES + MOST_LINE_BYTES {
                break;
            }
        }
        if part == 0 {
            return Ok((text, at));
        }
        // A line that started before is another part's.
        let first = text.iter().position(|&byte| byte == self.line_end).map_or(text.len(), |end| end + 1);
        text.drain(..first);
        Ok((text, at + first as u64))
    }

    /// The line that byte `at` is in, and what stands there.
    fn quote(&self, at: u64) -> String {
        let (mut number, mut byte) = (1, 0);
        while byte < at {
            let Ok(text) = self.source.bytes(byte, PART_BYTES.min(at - byte)) else { break };
            if text.is_empty() {
                break;
            }
            number += text.iter().filter(|&&byte| byte == self.line_end).count() as u64;
            byte += text.len() as u64;
        }
        let text = self.source.bytes(at, 4 * MOST_QUOTED as u64).unwrap_or_default();
        let end = text.iter().position(|&byte| byte == self.line_end).unwrap_or(text.len());
        let text = String::from_utf8_lossy(text[..end].trim_ascii()).into_owned();
        format!("line {number}, {:?}", text.chars().take(MOST_QUOTED).collect::<String>())
    }

    /// Number of points that the file announces, in its header or in lines among its rows.
    fn num_announced(&self) -> Option<u64> {
        let in_lines = self.announced.iter().map(|num| num.load(Ordering::Relaxed));
        let in_lines = in_lines.fold(0, u64::saturating_add);
        self.in_header.map(|num| num.saturating_add(in_lines)).or((in_lines > 0).then_some(in_lines))
    }
}

impl Measured for TextRowsFile {
    fn path(&self) -> &Path {
        self.source.path()
    }

    fn num_points(&self) -> u64 {
        self.num_points
    }

    fn num_parts(&self) -> usize {
        self.announced.len()
    }

    fn decode(&self, part: usize, want: &Projection) -> Result<Part, ScanError> {
        let (text, at) = self.text(part)?;
        let plan = self.plan.projected(want);
        let mut taker = RowTaker::new(&plan, self.dialect, text.len() / 32);
        let (mut num_bad, mut first_bad, mut num_announced) = (0, None, 0u64);
        let mut from = 0;
        while from < text.len() {
            let end = text[from..].iter().position(|&byte| byte == self.line_end);
            let end = end.map_or(text.len(), |end| from + end);
            let line = &text[from..end];
            if !taker.take(line) && !is_passed_over(line) {
                match count(line).filter(|_| self.has_counts) {
                    Some(count) => num_announced = num_announced.saturating_add(count),
                    None => {
                        num_bad += 1;
                        first_bad.get_or_insert(at + from as u64);
                    }
                }
            }
            from = end + 1;
        }
        self.announced[part].store(num_announced, Ordering::Relaxed);
        Ok(Part { num_bad, first_bad, ..taker.part() })
    }

    fn judged(&self) -> super::measured::JudgedValues {
        self.plan.judged()
    }

    fn white(&self) -> Option<u16> {
        self.plan.white()
    }

    fn losses(&self, read: &RowsSeen) -> Vec<String> {
        let announced = self.num_announced().filter(|num| *num > read.num_read + read.num_bad);
        let (num, end) = (read.num_read, self.source.len());
        let announced = announced.map(|announced| {
            let announced = counted(announced, "point");
            format!("announces {announced}, but only {num} could be read (the file has {end} bytes)")
        });
        let bad = read.first_bad.map(|first| bad_rows(read.num_bad, &self.quote(first)));
        announced.into_iter().chain(bad).collect()
    }

    fn warnings(&self, read: &RowsSeen) -> Vec<String> {
        let fewer = self.num_announced().filter(|num| *num < read.num_read);
        let sentence = |announced: u64| {
            format!("announces {} and has {}: all are read", counted(announced, "point"), read.num_read)
        };
        fewer.map(sentence).into_iter().collect()
    }

    fn no_points(&self, read: &RowsSeen) -> ScanError {
        let reason = match read.first_bad {
            _ if read.num_read > 0 => "none has a place within 1e15 of zero; export it again".into(),
            Some(first) => {
                let columns = self.plan.columns.len();
                format!(
                    "none of its lines has {columns} numbers between {}, see {}; --set cloud.columns=x,y,z,- says what \
                     its columns are",
                    self.dialect.separator.words(),
                    self.quote(first)
                )
            }
            None => format!("no rows follow byte {}; get it again", self.start),
        };
        ScanError::NoPoints { path: self.source.path().to_owned(), reason }
    }
}

/// A sentence about lines that are no rows, of which the first is quoted.
pub(super) fn bad_rows(num_rows: u64, first: &str) -> String {
    let (lines, were) =
        (counted(num_rows, "line"), agreeing(num_rows, "was left out:", "were left out, first"));
    format!("has {lines} that could not be read and {were} {first}")
}

/// True for a line without words, and for a comment.
pub(super) fn is_passed_over(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    line.is_empty() || line.starts_with(b"#") || line.starts_with(b"//") || line.starts_with(b"%")
}

/// The number of a line that has nothing but a whole number.
pub(super) fn count(line: &[u8]) -> Option<u64> {
    std::str::from_utf8(line.trim_ascii()).ok()?.parse().ok()
}

//! What comes of reading everything behind the header, in either encoding.

use super::plan::{Kept, Plan, Purpose};
use super::rows::{NUM_SLOTS, Rows};
use crate::scan::ScanError;
use crate::scan::source::Source;
use std::io;

/// Rows, and what went wrong with others.
#[derive(Debug)]
pub(super) struct Body {
    pub rows: Rows,
    /// Lines of text that could not be read; the first, as the end of a sentence.
    pub num_bad_lines: u64,
    pub first_bad_line: Option<String>,
    /// Points whose lines are among these; they have no place.
    pub num_bad_points: u64,
    /// What was odd, as sentences whose subject is the file.
    pub warnings: Vec<String>,
}

impl Body {
    /// Nothing yet.
    pub fn new(plans: &[Plan]) -> Self {
        let points = plans.iter().find(|plan| matches!(plan.purpose, Purpose::Points(_)));
        let rows = Rows::new(points.map_or(0, |plan| plan.count));
        Self { rows, num_bad_lines: 0, first_bad_line: None, num_bad_points: 0, warnings: Vec::new() }
    }

    /// Makes room for points that the file is large enough for.
    ///
    /// # Errors
    /// No memory.
    pub fn reserve(&mut self, source: &Source, num_points: u64, has: Kept) -> Result<(), ScanError> {
        let fail = |_| ScanError::Memory { path: source.path().to_owned(), num_points };
        self.rows.reserve(num_points, has).map_err(fail)
    }

    /// Takes note that reading ended at byte `at`: by an error, or because the file ends.
    ///
    /// # Errors
    /// The error, if there are no points before it.
    pub fn fail(&mut self, source: &Source, at: u64, error: Option<io::Error>) -> Result<(), ScanError> {
        match error {
            Some(error) if self.rows.places.is_empty() => Err(ScanError::io(source.path(), Some(at), error)),
            Some(error) => {
                self.warnings.push(format!("could not be read to its end, from byte {at} on: {error}"));
                Ok(())
            }
            // That points or faces are missing is said when they are counted.
            None => Ok(()),
        }
    }

    /// Takes note of a line that cannot be read. A point's leaves a place that is none, so that faces count right.
    pub fn skip_line(&mut self, plan: &Plan, number: u64, line: &[u8]) {
        self.num_bad_lines += 1;
        self.first_bad_line.get_or_insert_with(|| {
            let line = String::from_utf8_lossy(line.trim_ascii());
            format!("line {number}, {:?}", line.chars().take(40).collect::<String>())
        });
        match plan.purpose {
            Purpose::Points(has) => {
                self.num_bad_points += 1;
                self.rows.push_point(has, &[f64::NAN; NUM_SLOTS]);
            }
            Purpose::Faces | Purpose::Strips => self.rows.num_faces += 1,
            Purpose::Unused => {}
        }
    }

    /// Adds what was read after this.
    pub fn append(&mut self, later: Self) {
        self.rows.append(later.rows);
        self.num_bad_lines += later.num_bad_lines;
        self.first_bad_line = self.first_bad_line.take().or(later.first_bad_line);
        self.num_bad_points += later.num_bad_points;
        self.warnings.extend(later.warnings);
    }
}

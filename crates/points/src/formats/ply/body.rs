//! One pass over everything behind the header, in either encoding: who takes in the rows, and what went wrong.

use super::reader::{Color, Purpose, RowReader, RowValues};
use crate::ScanError;
use crate::source::Source;
use std::io;

/// Takes in the rows of a pass.
pub(super) trait RowSink: Send + Sync + Sized {
    /// An empty sink for about `num_rows` rows, of which the first is point `first_point`.
    fn part(&self, first_point: u64, num_rows: usize) -> Self;

    /// Appends the rows that follow these.
    fn append(&mut self, later: Self);

    /// Takes in a point.
    fn point(&mut self, row: &RowValues);

    /// Takes note of a point that cannot be read, so that faces count right.
    fn bad_point(&mut self);

    /// Number of points taken in, including those that cannot be read or shown.
    fn num_points(&self) -> u64;

    /// Takes in a polygon.
    fn face(&mut self, _color: Color, _row: &RowValues) {}

    /// Takes in strips of triangles.
    fn strips(&mut self, _row: &RowValues) {}

    /// Takes note of a polygon or of strips that cannot be read.
    fn bad_face(&mut self) {}

    /// Takes in the box of a chunk.
    fn chunk(&mut self, _row: &RowValues) {}

    /// Progress that this many points are worth in this pass: all passes together are worth one per point.
    fn progress(num_points: u64) -> u64;
}

/// Called with a sink that has taken in more rows.
pub(super) type Emptied<'a, S> = dyn FnMut(&mut S) -> Result<(), ScanError> + Send + 'a;

/// What came of a pass so far.
pub(super) struct Body<'a, S> {
    pub sink: S,
    emptied: Option<&'a mut Emptied<'a, S>>,
    /// Number of rows of text that could not be read.
    pub num_bad_rows: u64,
    /// The first row of text that could not be read, as the end of a sentence.
    pub first_bad_row: Option<String>,
    /// What could not be read, as sentences whose subject is the file.
    pub losses: Vec<String>,
    /// What else was odd, as sentences whose subject is the file.
    pub warnings: Vec<String>,
}

impl<'a, S: RowSink> Body<'a, S> {
    /// A pass that has read nothing yet.
    pub fn new(sink: S) -> Self {
        let (losses, warnings) = (Vec::new(), Vec::new());
        Self { sink, emptied: None, num_bad_rows: 0, first_bad_row: None, losses, warnings }
    }

    /// A pass that has read nothing yet, and calls `emptied` whenever the sink has taken in more rows.
    pub fn emptied_by(sink: S, emptied: &'a mut Emptied<'a, S>) -> Self {
        Self { emptied: Some(emptied), ..Self::new(sink) }
    }

    /// Lets the sink be emptied; to be called when it has taken in more rows.
    ///
    /// # Errors
    /// The error of the function that empties the sink.
    pub fn empty(&mut self) -> Result<(), ScanError> {
        self.emptied.as_mut().map_or(Ok(()), |emptied| emptied(&mut self.sink))
    }

    /// Takes note that reading ended at byte `at`: by an error, or because the file ends.
    ///
    /// # Errors
    /// The error, if there are no points before it.
    pub fn fail(&mut self, source: &Source, at: u64, error: Option<io::Error>) -> Result<(), ScanError> {
        match error {
            Some(error) if self.sink.num_points() == 0 => Err(ScanError::io(source.path(), Some(at), error)),
            Some(error) => {
                self.losses.push(format!("could not be read to its end, from byte {at} on: {error}"));
                Ok(())
            }
            // Missing points or faces are reported when they are counted.
            None => Ok(()),
        }
    }
}

/// Hands a row to the method of the sink that is for its element.
#[inline]
pub(super) fn take(reader: &RowReader, row: &RowValues, sink: &mut impl RowSink) {
    match reader.purpose {
        Purpose::Points(_) => sink.point(row),
        Purpose::Faces(color) => sink.face(color, row),
        Purpose::Strips => sink.strips(row),
        Purpose::Chunks => sink.chunk(row),
        Purpose::Unused => {}
    }
}

/// Tells the sink that a row could not be read.
pub(super) fn take_bad(reader: &RowReader, sink: &mut impl RowSink) {
    match reader.purpose {
        Purpose::Points(_) => sink.bad_point(),
        Purpose::Faces(_) | Purpose::Strips => sink.bad_face(),
        Purpose::Chunks => sink.chunk(&RowValues::default()),
        Purpose::Unused => {}
    }
}

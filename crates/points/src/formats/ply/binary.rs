//! Reads rows of bytes: rows of one size in parallel spans, rows with lists one after the other.

use super::body::{Body, RowSink, take};
use super::reader::{Purpose, RowReader, RowValues};
use super::value::{Bytes, Record};
use crate::ScanError;
use crate::source::Source;
use base::task::{Cancelled, Progress};
use rayon::prelude::*;
use std::io::{self, BufReader};

/// Most rows of a span, which is a task for a core.
const SPAN_ROWS: u64 = 1 << 14;
/// Most bytes of a span, unless a single row has more.
const SPAN_BYTES: u64 = 1 << 20;
/// Spans per core that are read before they are appended.
const SPANS_PER_THREAD: u64 = 4;
/// Rows with lists that are read between two looks at whether to stop.
const ROWS_BETWEEN_LOOKS: u64 = 1 << 12;

/// Reads all whole rows that are there. They follow each other from `offset` on, in the order of `readers`.
///
/// # Errors
/// The user stops it, there is no memory, or nothing can be read.
pub(super) fn read<S: RowSink>(
    source: &Source,
    readers: &[RowReader],
    (offset, big_endian): (u64, bool),
    body: &mut Body<'_, S>,
    progress: &Progress,
) -> Result<(), ScanError> {
    let mut file = BinaryBody { source, big_endian, progress, body };
    let mut at = offset;
    for reader in readers {
        at = match (reader.row_bytes(), reader.purpose) {
            ((0, true), _) => at,
            ((row_bytes, true), Purpose::Unused) => at.saturating_add(reader.count.saturating_mul(row_bytes)),
            ((row_bytes, true), _) => file.read_fixed(reader, at, row_bytes)?,
            (_, _) => file.read_lists(reader, at)?,
        }
        .min(source.len());
    }
    Ok(())
}

struct BinaryBody<'a, 'b, S> {
    source: &'a Source,
    big_endian: bool,
    progress: &'a Progress,
    body: &'a mut Body<'b, S>,
}

impl<S: RowSink> BinaryBody<'_, '_, S> {
    /// Reads rows of `row_bytes` each, and returns where the next element starts.
    fn read_fixed(&mut self, reader: &RowReader, at: u64, row_bytes: u64) -> Result<u64, ScanError> {
        let num_rows = reader.count.min(self.source.len().saturating_sub(at) / row_bytes);
        let span_rows = (SPAN_BYTES / row_bytes).clamp(1, SPAN_ROWS);
        let group_rows = SPANS_PER_THREAD * rayon::current_num_threads() as u64 * span_rows;
        let rows = FixedRows {
            source: self.source,
            big_endian: self.big_endian,
            progress: self.progress,
            reader,
            at,
            row_bytes,
            first_point: self.body.sink.num_points(),
            empty: self.body.sink.part(0, 0),
        };
        let mut parsed = Vec::new();
        for first in (0..num_rows).step_by(group_rows as usize) {
            let before = std::mem::take(&mut parsed);
            let end = num_rows.min(first + group_rows);
            // One group is parsed while the group before is appended.
            let (now, appended) =
                rayon::join(|| rows.parse(first, end, span_rows), || self.append(&rows, before));
            if self.progress.is_cancelled() {
                return Err(Cancelled.into());
            }
            if !appended? {
                return Ok(u64::MAX);
            }
            parsed = now;
        }
        let is_whole = self.append(&rows, parsed)?;
        Ok(if is_whole { at.saturating_add(reader.count.saturating_mul(row_bytes)) } else { u64::MAX })
    }

    /// Appends spans. Returns false if one came short, because the file shrank since it was opened or the disk failed:
    /// later rows are not read then.
    fn append(&mut self, rows: &FixedRows<S>, parsed: Vec<RowSpan<S>>) -> Result<bool, ScanError> {
        for span in parsed {
            self.body.sink.append(span.part);
            self.body.empty()?;
            if span.num_rows < span.wanted {
                let at = rows.at + (span.first + span.num_rows) * rows.row_bytes;
                self.body.fail(self.source, at, span.error)?;
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Reads rows with lists, and returns where the next element starts.
    fn read_lists(&mut self, reader: &RowReader, at: u64) -> Result<u64, ScanError> {
        let mut values =
            Bytes::new(BufReader::with_capacity(1 << 18, self.source.reader(at)), self.big_endian);
        let mut row = RowValues::default();
        for number in 0..reader.count {
            if reader.read_row(&mut values, &mut row).is_none() {
                self.body.fail(self.source, at.saturating_add(values.num_bytes), values.error)?;
                return Ok(u64::MAX);
            }
            take(reader, &row, &mut self.body.sink);
            if number % ROWS_BETWEEN_LOOKS == 0 {
                self.body.empty()?;
                if matches!(reader.purpose, Purpose::Points(_)) {
                    self.progress.add(S::progress(ROWS_BETWEEN_LOOKS.min(reader.count - number)));
                }
                if self.progress.is_cancelled() {
                    return Err(Cancelled.into());
                }
            }
        }
        Ok(at.saturating_add(values.num_bytes))
    }
}

/// Rows of one size, to be read in spans.
struct FixedRows<'a, S> {
    source: &'a Source,
    big_endian: bool,
    progress: &'a Progress,
    reader: &'a RowReader,
    /// Byte of the first row.
    at: u64,
    row_bytes: u64,
    /// Number of the first row among the points.
    first_point: u64,
    /// Empty sink that parts are made of.
    empty: S,
}

/// What was read of a span of rows.
struct RowSpan<S> {
    part: S,
    /// Number of the span's first row.
    first: u64,
    num_rows: u64,
    wanted: u64,
    error: Option<io::Error>,
}

impl<S: RowSink> FixedRows<'_, S> {
    /// Parses the rows from `first` up to `end`.
    fn parse(&self, first: u64, end: u64, span_rows: u64) -> Vec<RowSpan<S>> {
        let starts: Vec<u64> = (first..end).step_by(span_rows as usize).collect();
        let spans = starts.into_par_iter().map_init(Default::default, |(buffer, row), start| {
            self.parse_span(start, span_rows.min(end - start), buffer, row)
        });
        spans.collect()
    }

    fn parse_span(&self, first: u64, wanted: u64, buffer: &mut Vec<u8>, row: &mut RowValues) -> RowSpan<S> {
        let part = self.empty.part(self.first_point + first, wanted as usize);
        let mut span = RowSpan { part, first, num_rows: 0, wanted, error: None };
        if self.progress.is_cancelled() {
            return span;
        }
        // A span is small, so the cast loses nothing.
        buffer.resize((wanted * self.row_bytes) as usize, 0);
        let num_bytes = match self.source.read_at(buffer, self.at + first * self.row_bytes) {
            Ok(num_bytes) => num_bytes,
            Err(error) => {
                span.error = Some(error);
                0
            }
        };
        for bytes in buffer[..num_bytes].chunks_exact(self.row_bytes as usize) {
            let mut values = Record { bytes, big_endian: self.big_endian };
            if self.reader.read_row(&mut values, row).is_none() {
                break;
            }
            take(self.reader, row, &mut span.part);
            span.num_rows += 1;
        }
        if matches!(self.reader.purpose, Purpose::Points(_)) {
            self.progress.add(S::progress(span.num_rows));
        }
        span
    }
}

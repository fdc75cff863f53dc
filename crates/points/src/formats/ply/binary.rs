//! Reads rows of bytes: rows of one size in parallel blocks, rows with lists one after the other.

use super::body::{Body, Sink, take};
use super::plan::{Plan, Purpose, Row};
use super::value::{Bytes, Record};
use crate::ScanError;
use crate::source::Source;
use base::task::{Cancelled, Progress};
use rayon::prelude::*;
use std::io::{self, BufReader};

/// Most rows of a block, which is a task for a core.
const BLOCK_ROWS: u64 = 1 << 14;
/// Most bytes of a block, unless a single row has more.
const BLOCK_BYTES: u64 = 1 << 20;
/// Blocks per core that are read before they are appended.
const BLOCKS_PER_THREAD: u64 = 4;
/// Rows with lists that are read between two looks at whether to stop.
const ROWS_BETWEEN_LOOKS: u64 = 1 << 12;

/// Reads all whole rows that are there. They follow each other from `offset` on, in the order of `plans`.
///
/// # Errors
/// The user stops it, there is no memory, or nothing can be read.
pub(super) fn read<S: Sink>(
    source: &Source,
    plans: &[Plan],
    (offset, big_endian): (u64, bool),
    body: &mut Body<'_, S>,
    progress: &Progress,
) -> Result<(), ScanError> {
    let mut file = File { source, big_endian, progress, body };
    let mut at = offset;
    for plan in plans {
        at = match (plan.row_bytes(), plan.purpose) {
            ((0, true), _) => at,
            ((row_bytes, true), Purpose::Unused) => at.saturating_add(plan.count.saturating_mul(row_bytes)),
            ((row_bytes, true), _) => file.read_fixed(plan, at, row_bytes)?,
            (_, _) => file.read_lists(plan, at)?,
        }
        .min(source.len());
    }
    Ok(())
}

struct File<'a, 'b, S> {
    source: &'a Source,
    big_endian: bool,
    progress: &'a Progress,
    body: &'a mut Body<'b, S>,
}

impl<S: Sink> File<'_, '_, S> {
    /// Reads rows of `row_bytes` each, and returns where the next element starts.
    fn read_fixed(&mut self, plan: &Plan, at: u64, row_bytes: u64) -> Result<u64, ScanError> {
        let num_rows = plan.count.min(self.source.len().saturating_sub(at) / row_bytes);
        let block_rows = (BLOCK_BYTES / row_bytes).clamp(1, BLOCK_ROWS);
        let group_rows = BLOCKS_PER_THREAD * rayon::current_num_threads() as u64 * block_rows;
        let blocks = Blocks {
            source: self.source,
            big_endian: self.big_endian,
            progress: self.progress,
            plan,
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
                rayon::join(|| blocks.parse(first, end, block_rows), || self.append(&blocks, before));
            if self.progress.is_cancelled() {
                return Err(Cancelled.into());
            }
            if !appended? {
                return Ok(u64::MAX);
            }
            parsed = now;
        }
        let is_whole = self.append(&blocks, parsed)?;
        Ok(if is_whole { at.saturating_add(plan.count.saturating_mul(row_bytes)) } else { u64::MAX })
    }

    /// Appends blocks. Returns false if one came short, because the file shrank since it was opened or the disk failed:
    /// later rows are not read then.
    fn append(&mut self, blocks: &Blocks<S>, parsed: Vec<Block<S>>) -> Result<bool, ScanError> {
        for block in parsed {
            self.body.sink.append(block.part);
            self.body.empty()?;
            if block.num_rows < block.wanted {
                let at = blocks.at + (block.first + block.num_rows) * blocks.row_bytes;
                self.body.fail(self.source, at, block.error)?;
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Reads rows with lists, and returns where the next element starts.
    fn read_lists(&mut self, plan: &Plan, at: u64) -> Result<u64, ScanError> {
        let mut values =
            Bytes::new(BufReader::with_capacity(1 << 18, self.source.reader(at)), self.big_endian);
        let mut row = Row::default();
        for number in 0..plan.count {
            if plan.read_row(&mut values, &mut row).is_none() {
                self.body.fail(self.source, at.saturating_add(values.num_bytes), values.error)?;
                return Ok(u64::MAX);
            }
            take(plan, &row, &mut self.body.sink);
            if number % ROWS_BETWEEN_LOOKS == 0 {
                self.body.empty()?;
                if matches!(plan.purpose, Purpose::Points(_)) {
                    self.progress.add(S::progress(ROWS_BETWEEN_LOOKS.min(plan.count - number)));
                }
                if self.progress.is_cancelled() {
                    return Err(Cancelled.into());
                }
            }
        }
        Ok(at.saturating_add(values.num_bytes))
    }
}

/// Rows of one size, to be read in blocks.
struct Blocks<'a, S> {
    source: &'a Source,
    big_endian: bool,
    progress: &'a Progress,
    plan: &'a Plan,
    /// Byte of the first row.
    at: u64,
    row_bytes: u64,
    /// Number of the first row among the points.
    first_point: u64,
    /// Empty sink that parts are made of.
    empty: S,
}

/// What was read of a block.
struct Block<S> {
    part: S,
    /// Number of the block's first row.
    first: u64,
    num_rows: u64,
    wanted: u64,
    error: Option<io::Error>,
}

impl<S: Sink> Blocks<'_, S> {
    /// Parses the rows from `first` up to `end`.
    fn parse(&self, first: u64, end: u64, block_rows: u64) -> Vec<Block<S>> {
        let starts: Vec<u64> = (first..end).step_by(block_rows as usize).collect();
        let blocks = starts.into_par_iter().map_init(Default::default, |(buffer, row), start| {
            self.parse_block(start, block_rows.min(end - start), buffer, row)
        });
        blocks.collect()
    }

    fn parse_block(&self, first: u64, wanted: u64, buffer: &mut Vec<u8>, row: &mut Row) -> Block<S> {
        let part = self.empty.part(self.first_point + first, wanted as usize);
        let mut block = Block { part, first, num_rows: 0, wanted, error: None };
        if self.progress.is_cancelled() {
            return block;
        }
        // A block is small, so the cast loses nothing.
        buffer.resize((wanted * self.row_bytes) as usize, 0);
        let num_bytes = match self.source.read_at(buffer, self.at + first * self.row_bytes) {
            Ok(num_bytes) => num_bytes,
            Err(error) => {
                block.error = Some(error);
                0
            }
        };
        for bytes in buffer[..num_bytes].chunks_exact(self.row_bytes as usize) {
            let mut values = Record { bytes, big_endian: self.big_endian };
            if self.plan.read_row(&mut values, row).is_none() {
                break;
            }
            take(self.plan, row, &mut block.part);
            block.num_rows += 1;
        }
        if matches!(self.plan.purpose, Purpose::Points(_)) {
            self.progress.add(S::progress(block.num_rows));
        }
        block
    }
}

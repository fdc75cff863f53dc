//! Rows of bytes: points of one size in parallel blocks, rows with lists one after the other.

use super::body::Body;
use super::plan::{Kept, Plan, Purpose};
use super::rows::Rows;
use super::value::Bytes;
use crate::progress::Progress;
use crate::scan::ScanError;
use crate::scan::source::Source;
use rayon::prelude::*;
use std::io::{self, BufReader};

/// Points of a block, a task for a core: so many at most, and so many bytes.
const BLOCK_ROWS: u64 = 1 << 14;
const BLOCK_BYTES: u64 = 1 << 20;
/// Blocks that are read before they are put behind the others: enough for many cores.
const GROUP_BLOCKS: u64 = 64;
/// Rows with lists between two looks at whether to stop.
const ROWS_BETWEEN_LOOKS: u64 = 1 << 12;

/// Reads all whole rows that are there; from `offset` on they follow each other in the order of `plans`.
///
/// # Errors
/// No memory, stopped, nothing readable at all.
pub(super) fn read(
    source: &Source,
    plans: &[Plan],
    offset: u64,
    big_endian: bool,
    progress: &Progress,
) -> Result<Body, ScanError> {
    let mut file = File { source, big_endian, progress, body: Body::new(plans) };
    let mut at = offset;
    for plan in plans {
        at = match (plan.row_bytes(), plan.purpose) {
            ((row_bytes, true), Purpose::Points(has)) => file.read_points(plan, has, at, row_bytes)?,
            ((row_bytes, true), _) => at.saturating_add(plan.count.saturating_mul(row_bytes)),
            (_, _) => file.read_lists(plan, at)?,
        }
        .min(source.len());
    }
    Ok(file.body)
}

struct File<'a> {
    source: &'a Source,
    big_endian: bool,
    progress: &'a Progress,
    body: Body,
}

impl File<'_> {
    /// Points of `row_bytes` each; returns where the next element starts.
    fn read_points(&mut self, plan: &Plan, has: Kept, at: u64, row_bytes: u64) -> Result<u64, ScanError> {
        let num_rows = plan.count.min(self.source.len().saturating_sub(at) / row_bytes);
        self.body.reserve(self.source, num_rows, has)?;
        let block_rows = (BLOCK_BYTES / row_bytes).clamp(1, BLOCK_ROWS);
        let group_rows = GROUP_BLOCKS * block_rows;
        for first in (0..num_rows).step_by(group_rows as usize) {
            let end = num_rows.min(first + group_rows);
            let starts: Vec<u64> = (first..end).step_by(block_rows as usize).collect();
            let blocks: Vec<(Rows, u64, Option<io::Error>)> = starts
                .into_par_iter()
                .map(|start| {
                    let wanted = block_rows.min(end - start);
                    let (rows, error) = self.read_block(plan, at + start * row_bytes, wanted * row_bytes);
                    self.progress.add(rows.places.len() as u64);
                    (rows, wanted, error)
                })
                .collect();
            if self.progress.stopped() {
                return Err(ScanError::Stopped);
            }
            for (rows, wanted, error) in blocks {
                let whole = rows.places.len() as u64 == wanted;
                self.body.rows.append(rows);
                if !whole {
                    // The file shrank since it was opened, or the disk failed: what follows has no place.
                    let num_read = self.body.rows.places.len() as u64;
                    self.body.fail(self.source, at + num_read * row_bytes, error)?;
                    return Ok(u64::MAX);
                }
            }
        }
        Ok(at.saturating_add(plan.count.saturating_mul(row_bytes)))
    }

    fn read_block(&self, plan: &Plan, at: u64, num_bytes: u64) -> (Rows, Option<io::Error>) {
        let mut rows = Rows::new(self.body.rows.num_points_announced);
        if self.progress.stopped() {
            return (rows, None);
        }
        // A block is small; the cast keeps it whole.
        let mut bytes = vec![0; num_bytes as usize];
        match self.source.read_at(&mut bytes, at) {
            Ok(num_read) => bytes.truncate(num_read),
            Err(error) => return (rows, Some(error)),
        }
        let mut values = Bytes::new(&bytes[..], self.big_endian);
        while plan.read_row(&mut values, &mut rows).is_some() {}
        (rows, None)
    }

    /// Rows with lists; returns where the next element starts.
    fn read_lists(&mut self, plan: &Plan, at: u64) -> Result<u64, ScanError> {
        let mut values =
            Bytes::new(BufReader::with_capacity(1 << 18, self.source.reader(at)), self.big_endian);
        for row in 0..plan.count {
            if plan.read_row(&mut values, &mut self.body.rows).is_none() {
                self.body.fail(self.source, at.saturating_add(values.num_bytes), values.error)?;
                return Ok(u64::MAX);
            }
            if row % ROWS_BETWEEN_LOOKS == 0 {
                if matches!(plan.purpose, Purpose::Points(_)) {
                    self.progress.add(ROWS_BETWEEN_LOOKS.min(plan.count - row));
                }
                if self.progress.stopped() {
                    return Err(ScanError::Stopped);
                }
            }
        }
        Ok(at.saturating_add(values.num_bytes))
    }
}

//! Rows of text, one a line; lines are parsed in parallel.

use super::body::Body;
use super::header::PlyHeader;
use super::plan::{Plan, Purpose};
use super::value::Words;
use crate::progress::Progress;
use crate::scan::ScanError;
use crate::scan::source::Source;
use rayon::prelude::*;

/// Text that is read before it is parsed.
const GROUP_BYTES: u64 = 4 << 20;
/// Lines of a task for a core.
const BLOCK_LINES: usize = 1 << 12;

/// A row and its line's number.
type Line<'a> = (u64, &'a [u8]);

/// Reads all whole rows that are there. Empty lines are no rows.
///
/// # Errors
/// No memory, stopped, nothing readable at all.
pub(super) fn read(
    source: &Source,
    header: &PlyHeader,
    plans: &[Plan],
    progress: &Progress,
) -> Result<Body, ScanError> {
    let mut body = Body::new(plans);
    for plan in plans {
        if let Purpose::Points(has) = plan.purpose {
            body.reserve(source, most_rows(plan, source.len().saturating_sub(header.body_offset)), has)?;
        }
    }
    let mut left = Left { plans, done: 0 };
    let (mut text, mut at, mut line) = (Vec::new(), header.body_offset, header.body_line);
    while left.num_rows() > 0 {
        let more = match source.bytes(at, GROUP_BYTES) {
            Ok(more) => more,
            Err(ScanError::Io { error, .. }) => {
                body.fail(source, at, Some(error))?;
                break;
            }
            Err(other) => return Err(other),
        };
        let at_end = more.is_empty();
        at += more.len() as u64;
        // Only what is new can have the last line end.
        let last_end = more.iter().rposition(|&byte| byte == header.line_end).map(|i| text.len() + i + 1);
        text.extend(more);
        let whole = if at_end { text.len() } else { last_end.unwrap_or(0) };
        let all = text[..whole].split(|&byte| byte == header.line_end);
        let mut rows: Vec<Line> = (line..).zip(all).filter(|(_, row)| !row.trim_ascii().is_empty()).collect();
        // A line without its end is whole if it is the very last: otherwise it was cut off, perhaps in a number.
        if at_end && left.num_rows() > rows.len() as u64 {
            rows.pop();
        }
        left.parse(&rows, &mut body, progress)?;
        line += text[..whole].iter().filter(|&&byte| byte == header.line_end).count() as u64;
        text.drain(..whole);
        if at_end {
            break;
        }
    }
    Ok(body)
}

/// Rows that so many bytes can hold: a digit and a blank a value.
pub(super) fn most_rows(plan: &Plan, num_bytes: u64) -> u64 {
    plan.count.min(num_bytes.div_ceil(2 * plan.num_properties().max(1)))
}

/// Elements whose rows are still to come.
struct Left<'a> {
    plans: &'a [Plan],
    /// Rows of the first that are done.
    done: u64,
}

impl Left<'_> {
    /// Rows that are announced and were not read.
    fn num_rows(&self) -> u64 {
        let counts = self.plans.iter().filter(|plan| plan.num_properties() > 0).map(|plan| plan.count);
        counts.fold(0u64, u64::saturating_add).saturating_sub(self.done)
    }

    /// Gives each line to its element.
    fn parse(&mut self, mut lines: &[Line], body: &mut Body, progress: &Progress) -> Result<(), ScanError> {
        while let Some((plan, later)) = self.plans.split_first() {
            let left = if plan.num_properties() > 0 { plan.count - self.done } else { 0 };
            let here = lines.len().min(usize::try_from(left).unwrap_or(usize::MAX));
            let (now, rest) = lines.split_at(here);
            let blocks: Vec<Body> = now
                .par_chunks(BLOCK_LINES)
                .map(|lines| parse_block(plan, lines, body.rows.num_points_announced, progress))
                .collect();
            if progress.stopped() {
                return Err(ScanError::Stopped);
            }
            blocks.into_iter().for_each(|block| body.append(block));
            lines = rest;
            self.done += here as u64;
            if here as u64 == left {
                (self.plans, self.done) = (later, 0);
            } else {
                break;
            }
        }
        Ok(())
    }
}

fn parse_block(plan: &Plan, lines: &[Line], num_points_announced: u64, progress: &Progress) -> Body {
    let mut body = Body::new(&[]);
    body.rows.num_points_announced = num_points_announced;
    if progress.stopped() {
        return body;
    }
    for (number, line) in lines {
        if plan.read_row(&mut Words(line), &mut body.rows).is_none() {
            body.skip_line(plan, *number, line);
        }
    }
    progress.add(body.rows.places.len() as u64);
    body
}

//! Reads uncompressed points: parts of a block, in parallel, parsed straight into their place.

use super::PointsRead;
use super::header::LasHeader;
use super::record::Extractor;
use crate::block::Block;
use crate::column::{self, Column, ColumnPart};
use crate::formats::Take;
use crate::source::Source;
use crate::stats::Stats;
use crate::{Attribute, Marks, Projection, ScanError};
use base::task::{Cancelled, Progress};
use rayon::prelude::*;
use std::io;

/// Points of a part: its records (1 MiB at most) stay in a core's cache from reading to the last column.
const PART_POINTS: usize = 1 << 14;
/// Fewest points of a block: fewer would not keep all cores at work.
const LEAST_BLOCK_POINTS: usize = 1 << 18;

/// Reads all whole records that are there.
///
/// # Errors
/// The user stops it, there is no memory, nothing can be read, or `take` fails.
pub(super) fn read(
    source: &Source,
    header: &LasHeader,
    extractor: &Extractor,
    want: &Projection,
    take: &mut Take,
    progress: &Progress,
) -> Result<PointsRead, ScanError> {
    let announced = num_points(source, header);
    let memory = || ScanError::Memory { path: source.path().to_owned(), num_points: announced };
    let records = Records { source, header, extractor, progress };
    let mut outcome = PointsRead::default();
    while outcome.num_points < announced {
        let left = announced - outcome.num_points;
        // The file is long enough for these points, which vouches for the memory.
        let num_wanted = left.min(want.block_points().max(LEAST_BLOCK_POINTS) as u64);
        let mut block =
            usize::try_from(num_wanted).ok().and_then(|num| records.zeros(num)).ok_or_else(memory)?;
        let error = records.fill(&mut block, outcome.num_points)?;
        let num_read = block.xyz.len() as u64;
        outcome.num_points += num_read;
        if let Some(error) = error {
            if outcome.num_points == 0 {
                return Err(ScanError::io(source.path(), None, error));
            }
            outcome.losses.push(format!("could be read up to point {} only: {error}", outcome.num_points));
        }
        if num_read > 0 {
            take(block)?;
        }
        if num_read < num_wanted {
            break;
        }
    }
    Ok(outcome)
}

/// Number of whole records from the points' start to the end of the file, or to something else that the header says
/// follows them. A header that counts fewer points is believed only if something else could follow them.
pub(super) fn num_points(source: &Source, header: &LasHeader) -> u64 {
    let record_bytes = u64::from(header.record_bytes).max(1);
    let available = source.len().saturating_sub(header.points_offset);
    let held = available / record_bytes;
    if header.announced_points >= held {
        return held;
    }
    let nothing_else =
        header.minor < 4 && header.points_end.is_none() && available.is_multiple_of(record_bytes);
    match (header.announced_points, header.points_end) {
        (_, None) if nothing_else => held,
        (0, end) => end.map_or(held, |end| (end - header.points_offset) / record_bytes).min(held),
        (announced, _) => announced,
    }
}

/// The records of a file, and what is wanted of them.
struct Records<'a> {
    source: &'a Source,
    header: &'a LasHeader,
    extractor: &'a Extractor,
    progress: &'a Progress,
}

/// A part of a block that is read by itself.
struct BlockPart<'a> {
    xyz: &'a mut [[i32; 3]],
    columns: Vec<ColumnPart<'a>>,
}

/// How reading a part of a block ended.
struct BlockPartEnd {
    num_read: usize,
    whole: bool,
    /// Marks of the points in the part, for each column; empty for columns of numbers.
    marks: Vec<Marks>,
    stats: Stats,
    error: Option<io::Error>,
}

impl Records<'_> {
    /// A block of zeros, or `None` if there is no memory for it.
    fn zeros(&self, num_points: usize) -> Option<Block> {
        let columns = self
            .extractor
            .columns()
            .map(|(attribute, kind)| Some((attribute, Column::zeros(kind, num_points)?)));
        let (xyz, columns) = (column::zeros(num_points)?, columns.collect::<Option<_>>()?);
        Some(Block { grid: self.header.grid, xyz, columns, stats: Stats::EMPTY })
    }

    /// Reads the points from number `first` on into a block, and shortens the block to the points before the first that
    /// could not be read (a disk error, a file that shrank meanwhile). Returns the disk error, if there was one.
    fn fill(&self, block: &mut Block, first: u64) -> Result<Option<io::Error>, ScanError> {
        let record_bytes = u64::from(self.header.record_bytes);
        let start = self.header.points_offset + first * record_bytes;
        let part_bytes = PART_POINTS as u64 * record_bytes;
        let intensity = block.columns.iter().position(|(attribute, _)| *attribute == Attribute::Intensity);
        let ends: Vec<BlockPartEnd> = parts(block)
            .into_par_iter()
            .enumerate()
            .map_init(Vec::new, |buffer, (number, part)| {
                let end = self.read_part(part, start + number as u64 * part_bytes, intensity, buffer);
                self.progress.add(end.num_read as u64);
                end
            })
            .collect();
        if self.progress.is_cancelled() {
            return Err(Cancelled.into());
        }
        let (mut num_points, mut failure) = (0, None);
        for end in ends {
            for ((_, column), marks) in block.columns.iter_mut().zip(&end.marks) {
                column.mark(marks, num_points);
            }
            num_points += end.num_read;
            block.stats = block.stats.union(end.stats);
            if !end.whole {
                failure = end.error;
                break;
            }
        }
        block.truncate(num_points);
        Ok(failure)
    }

    fn read_part(
        &self,
        mut part: BlockPart,
        offset: u64,
        intensity: Option<usize>,
        buffer: &mut Vec<u8>,
    ) -> BlockPartEnd {
        let (num_wanted, record_bytes) = (part.xyz.len(), usize::from(self.header.record_bytes));
        let mut end =
            BlockPartEnd { num_read: 0, whole: false, marks: Vec::new(), stats: Stats::EMPTY, error: None };
        if self.progress.is_cancelled() {
            return end;
        }
        buffer.resize(num_wanted * record_bytes, 0);
        let num_bytes = match self.source.read_at(buffer, offset) {
            Ok(num_bytes) => num_bytes,
            Err(error) => {
                end.error = Some(error);
                0
            }
        };
        end.num_read = num_bytes / record_bytes;
        end.whole = end.num_read == num_wanted;
        self.extractor.parse(&buffer[..end.num_read * record_bytes], part.xyz, &mut part.columns);
        let intensity = match intensity.map(|at| &part.columns[at]) {
            Some(ColumnPart::U16(values)) => &values[..end.num_read],
            _ => &[],
        };
        end.stats = Stats::of(&part.xyz[..end.num_read], intensity);
        end.marks = part.columns.into_iter().map(ColumnPart::into_marks).collect();
        end
    }
}

/// The parts of a block that are read by themselves.
fn parts(block: &mut Block) -> Vec<BlockPart<'_>> {
    let num_parts = block.xyz.len().div_ceil(PART_POINTS);
    let parts = block.xyz.chunks_mut(PART_POINTS).map(|xyz| BlockPart { xyz, columns: Vec::new() });
    let mut parts: Vec<BlockPart> = parts.collect();
    for (_, column) in &mut block.columns {
        let columns = column.parts(PART_POINTS, num_parts);
        parts.iter_mut().zip(columns).for_each(|(part, column)| part.columns.push(column));
    }
    parts
}

//! Uncompressed points: blocks of records, read and parsed in parallel, straight into their place.

use super::header::LasHeader;
use super::record::{Block, Kept, Layout};
use crate::source::Source;
use crate::stats::Stats;
use crate::{Columns, Points, ScanError};
use base::task::{Cancelled, Progress};
use rayon::prelude::*;
use std::io;
use std::ops::Range;

/// Points of a block: its records (1 MiB at most) stay in a core's cache from reading to the last column.
const BLOCK_POINTS: usize = 1 << 14;

/// Reads all whole records that are there.
///
/// # Errors
/// No memory, stopped, nothing readable at all.
pub(super) fn read(
    source: &Source,
    header: &LasHeader,
    layout: Layout,
    show_withheld: bool,
    progress: &Progress,
) -> Result<Columns, ScanError> {
    let announced = num_points(source, header);
    let mut points = columns(announced, &layout)
        .ok_or_else(|| ScanError::Memory { path: source.path().to_owned(), num_points: announced })?;
    let rgb = points.rgb.chunks_mut(BLOCK_POINTS).chain(std::iter::repeat_with(|| -> &mut [_] { &mut [] }));
    let blocks: Vec<_> = points
        .xyz
        .chunks_mut(BLOCK_POINTS)
        .zip(rgb)
        .zip(points.intensity.chunks_mut(BLOCK_POINTS))
        .map(|((xyz, rgb), intensity)| Block { xyz, rgb, intensity })
        .collect();
    let block_bytes = (BLOCK_POINTS * layout.record_bytes) as u64;
    let ends: Vec<_> = blocks
        .into_par_iter()
        .enumerate()
        .map_init(Vec::new, |buffer, (index, block)| {
            let offset = header.points_offset + index as u64 * block_bytes;
            let piece = Piece { source, layout: &layout, show_withheld, progress };
            let end = piece.read(block, offset, buffer);
            progress.add(end.num_read as u64);
            end
        })
        .collect();
    if progress.is_cancelled() {
        return Err(Cancelled.into());
    }
    join(source, points, ends)
}

/// Whole records between the points' start and the end of the file, as far as the header does not say that
/// something else follows. A header that counts too few is believed only if more than points could follow.
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

/// How blocks are read.
struct Piece<'a> {
    source: &'a Source,
    layout: &'a Layout,
    show_withheld: bool,
    progress: &'a Progress,
}

/// How far a block got.
struct BlockEnd {
    num_read: usize,
    whole: bool,
    kept: Kept,
    stats: Stats,
    error: Option<io::Error>,
}

impl Piece<'_> {
    fn read(&self, mut block: Block, offset: u64, buffer: &mut Vec<u8>) -> BlockEnd {
        let (layout, num_wanted) = (self.layout, block.xyz.len());
        if self.progress.is_cancelled() {
            let (kept, stats) = (Kept::default(), Stats::EMPTY);
            return BlockEnd { num_read: 0, whole: false, kept, stats, error: None };
        }
        buffer.resize(num_wanted * layout.record_bytes, 0);
        let (num_bytes, error) = match self.source.read_at(buffer, offset) {
            Ok(num_bytes) => (num_bytes, None),
            Err(error) => (0, Some(error)),
        };
        let num_read = num_bytes / layout.record_bytes;
        let records = &buffer[..num_read * layout.record_bytes];
        layout.parse(records, block.xyz, block.rgb, block.intensity);
        let kept = layout.sift(records, self.show_withheld, &mut block);
        let num_points = kept.num_points;
        let stats = Stats::of(&block.xyz[..num_points], &block.intensity[..num_points]);
        BlockEnd { num_read, whole: num_read == num_wanted, kept, stats, error }
    }
}

/// Keeps the points up to the first block that came short (a disk error, a file that shrank meanwhile).
fn join(source: &Source, mut points: Points, ends: Vec<BlockEnd>) -> Result<Columns, ScanError> {
    let mut columns = Columns::default();
    let (mut num_points, mut num_read) = (0, 0);
    for (number, end) in ends.into_iter().enumerate() {
        let Kept { num_points: num_kept, num_withheld, noise } = end.kept;
        close_up(&mut points, number * BLOCK_POINTS..number * BLOCK_POINTS + num_kept, num_points);
        points.noise.append(&noise, num_points);
        points.num_withheld += num_withheld;
        num_points += num_kept;
        num_read += end.num_read;
        columns.stats = columns.stats.union(end.stats);
        if let Some(error) = end.error {
            if num_read == 0 {
                return Err(ScanError::io(source.path(), None, error));
            }
            columns.losses.push(format!("could be read up to point {num_read} only: {error}"));
        }
        if !end.whole {
            break;
        }
    }
    points.xyz.truncate(num_points);
    points.rgb.truncate(num_points);
    points.intensity.truncate(num_points);
    columns.points = points;
    Ok(columns)
}

/// Moves a block's points to `to`, where those before it end: they need not have filled their blocks.
fn close_up(points: &mut Points, block: Range<usize>, to: usize) {
    if block.start == to {
        return;
    }
    points.xyz.copy_within(block.clone(), to);
    points.intensity.copy_within(block.clone(), to);
    if !points.rgb.is_empty() {
        points.rgb.copy_within(block, to);
    }
}

/// Columns of zeros, or `None` if there is no memory for them.
fn columns(num_points: u64, layout: &Layout) -> Option<Points> {
    let num_points = usize::try_from(num_points).ok()?;
    let num_colors = if layout.rgb_offset.is_some() { num_points } else { 0 };
    Some(Points {
        xyz: zeros([0; 3], num_points)?,
        rgb: zeros([0; 3], num_colors)?,
        intensity: zeros(0, num_points)?,
        ..Points::default()
    })
}

/// `vec![zero; len]`, which takes zeroed pages from the system untouched (they become real in parallel, as the
/// blocks are written), after asking whether they are to be had, which `vec!` cannot say.
fn zeros<T: Clone>(zero: T, len: usize) -> Option<Vec<T>> {
    Vec::<T>::new().try_reserve_exact(len).ok()?;
    Some(vec![zero; len])
}

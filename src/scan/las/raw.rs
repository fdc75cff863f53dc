//! Uncompressed points: blocks of records, read and parsed in parallel, straight into their place.

use super::header::LasHeader;
use super::record::Layout;
use crate::progress::Progress;
use crate::scan::source::Source;
use crate::scan::stats::Stats;
use crate::scan::{Columns, Points, ScanError};
use rayon::prelude::*;
use std::io;

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
            let end = block.read(source, offset, &layout, buffer, progress);
            progress.add(end.num_points as u64);
            end
        })
        .collect();
    if progress.stopped() {
        return Err(ScanError::Stopped);
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

/// One block's part of the columns.
struct Block<'a> {
    xyz: &'a mut [[i32; 3]],
    rgb: &'a mut [[u16; 3]],
    intensity: &'a mut [u16],
}

/// How far a block got.
struct BlockEnd {
    num_points: usize,
    whole: bool,
    stats: Stats,
    error: Option<io::Error>,
}

impl Block<'_> {
    fn read(
        self,
        source: &Source,
        offset: u64,
        layout: &Layout,
        buffer: &mut Vec<u8>,
        progress: &Progress,
    ) -> BlockEnd {
        if progress.stopped() {
            return BlockEnd { num_points: 0, whole: false, stats: Stats::EMPTY, error: None };
        }
        buffer.resize(self.xyz.len() * layout.record_bytes, 0);
        let (num_bytes, error) = match source.read_at(buffer, offset) {
            Ok(num_bytes) => (num_bytes, None),
            Err(error) => (0, Some(error)),
        };
        let num_points = num_bytes / layout.record_bytes;
        let records = &buffer[..num_points * layout.record_bytes];
        layout.parse(records, self.xyz, self.rgb, self.intensity);
        let rgb = &self.rgb[..num_points.min(self.rgb.len())];
        let stats = Stats::of(&self.xyz[..num_points], rgb, &self.intensity[..num_points]);
        BlockEnd { num_points, whole: num_points == self.xyz.len(), stats, error }
    }
}

/// Keeps the points up to the first block that came short (a disk error, a file that shrank meanwhile).
fn join(source: &Source, mut points: Points, ends: Vec<BlockEnd>) -> Result<Columns, ScanError> {
    let mut columns = Columns::default();
    let mut num_points = 0;
    for end in ends {
        num_points += end.num_points;
        columns.stats = columns.stats.union(end.stats);
        if let Some(error) = end.error {
            if num_points == 0 {
                return Err(ScanError::io(source.path(), None, error));
            }
            columns.warnings.push(format!("could be read up to point {num_points} only: {error}"));
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

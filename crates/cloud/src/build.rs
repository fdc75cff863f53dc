//! Scan to flat cloud: sort, cut into batches, quantize; every step on all cores.

use super::index::Index;
use super::quantize::{Cells, planes};
use super::{Batch, Cloud, morton};
use crate::format::{BATCH_POINTS, POINTS_PER_LOAD};
use base::space::{Bounds, Split};
use base::task::{Cancelled, Progress};
use glam::DVec3;
use points::{FARTHEST, Scan, Scene};
use rayon::prelude::*;

/// Why no cloud came of a scan.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum BuildError {
    /// The scan has no points.
    #[error("the scan holds no points")]
    Empty,
    /// The scan has more points than 32-bit ids reach: each point has two.
    #[error(
        "the scan has {0} points; more than 2 147 000 000 do not fit one cloud: open fewer files at once"
    )]
    TooMany(usize),
    /// The scan has more points than a sequential point tree holds.
    #[error(
        "the scan has {0} points; a sequential point tree holds 1 000 000 000: open fewer files at once, or use the octree"
    )]
    TooManyDiscs(usize),
    /// The scan has more points and triangles than a sequential point tree holds together.
    #[error(
        "the scan's {num_points} points and {num_triangles} triangles do not fit one sequential point tree: open fewer files at once, or use the octree"
    )]
    TooManyTriangles {
        /// Points of the scan.
        num_points: usize,
        /// Triangles of the scan.
        num_triangles: usize,
    },
    /// Coordinates beyond what f32 spans.
    #[error("the scan's box is {0} units wide: its coordinates or its scale are broken")]
    TooWide(String),
    /// The user asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Points of a cloud at most: ids have 32 bits, each point has two, and the gaps between batches need some.
const MAX_POINTS: usize = 2_147_000_000;
/// Longest edge of a cloud's box: readers accept coordinates up to [`FARTHEST`] to either side of the origin.
const MAX_EDGE: f64 = 2.0 * FARTHEST;

/// Morton code, with a further bit for strays, and number of a point in the scan.
pub type CodedPoint = (u64, u32);

/// Sorts the points of a scan by Morton code, cuts them into batches and quantizes them. Equal codes keep the files'
/// order; strays come last.
///
/// Peak memory above the scan: 16 B a point to sort, 16 B for the planes.
///
/// # Errors
/// See [`BuildError`].
pub fn build(scan: &Scan, progress: &Progress) -> Result<Cloud, BuildError> {
    build_rearranged(scan, BATCH_POINTS, |_, _| {}, progress)
}

/// Builds a cloud as [`build`] does, in batches of `batch_points`, a multiple of [`POINTS_PER_LOAD`] and at most
/// [`BATCH_POINTS`], after `rearrange` has brought the scene's points, and its strays, into another order.
///
/// # Errors
/// See [`BuildError`].
pub fn build_rearranged(
    scan: &Scan,
    batch_points: u32,
    rearrange: impl FnOnce(&mut [CodedPoint], &mut [CodedPoint]),
    progress: &Progress,
) -> Result<Cloud, BuildError> {
    debug_assert!(batch_points.is_multiple_of(POINTS_PER_LOAD) && batch_points <= BATCH_POINTS);
    let Checked { num_points, bounds, scene } = check(scan)?;
    let index = Index::new(scan);
    let mut sorted = sort(&index, &bounds, &scene.bounds);
    // A batch holds either points of the scene or strays: a box round both would be too large for the scene's
    // precision.
    let num_near = sorted.partition_point(|key| key.0 < FAR);
    let (near, strays) = sorted.split_at_mut(num_near);
    rearrange(near, strays);
    if progress.is_cancelled() {
        return Err(Cancelled.into());
    }
    let cut = BatchCut { size: batch_points as usize, num_near, num_points };
    let [mut hi, mut mid, mut lo, mut colors] = std::array::from_fn(|_| vec![0u32; cut.padded()]);
    let batches = cut
        .batches(&mut hi)
        .zip(cut.batches(&mut mid))
        .zip(cut.batches(&mut lo))
        .zip(cut.batches(&mut colors))
        .enumerate()
        .map_init(Vec::new, |positions, (number, (((hi, mid), lo), colors))| {
            let BatchRange { first, first_point, count } = cut.range(number);
            if progress.is_cancelled() {
                return Batch { first_point: 0, num_points: 0, min: DVec3::ZERO, cell: [0.0; 3] };
            }
            positions.clear();
            let mut bounds = Bounds::EMPTY;
            for (i, color) in colors.iter_mut().take(count).enumerate() {
                let (p, c) = index.point(sorted[first + i].1 as usize);
                bounds = bounds.with(p);
                positions.push(p);
                *color = c;
            }
            let cells = Cells::covering(&bounds);
            for (i, p) in positions.iter().enumerate() {
                [hi[i], mid[i], lo[i]] = planes(cells.quantize(*p));
            }
            progress.add(count as u64);
            Batch {
                first_point: first_point as u32,
                num_points: count as u32,
                min: cells.min,
                cell: cells.cell,
            }
        })
        .collect();
    if progress.is_cancelled() {
        return Err(Cancelled.into());
    }
    let (split, planes) = (Split::of(&scene.bounds, &bounds), [hi, mid, lo]);
    Ok(Cloud { split, bounds, scene, batches, planes, colors, num_points: num_points as u64 })
}

/// Size, box and scene of a scan that can become a cloud.
pub(super) struct Checked {
    pub num_points: usize,
    pub bounds: Bounds,
    pub scene: Scene,
}

/// Tells whether a scan can become a cloud, and finds its scene if nobody has.
pub(super) fn check(scan: &Scan) -> Result<Checked, BuildError> {
    let (num_points, bounds) = (scan.num_points(), scan.bounds());
    if num_points == 0 {
        return Err(BuildError::Empty);
    }
    if num_points > MAX_POINTS {
        return Err(BuildError::TooMany(num_points));
    }
    let edge = bounds.size().max_element();
    if !edge.is_finite() || edge > MAX_EDGE {
        return Err(BuildError::TooWide(format!("{edge:e}")));
    }
    let scene = if scan.scene.is_empty() { Scene::of(scan).0 } else { scan.scene.clone() };
    Ok(Checked { num_points, bounds, scene })
}

/// How ordered points are cut into batches: the scene's come first, the strays' begin at the next multiple of
/// [`POINTS_PER_LOAD`].
#[derive(Clone, Copy)]
struct BatchCut {
    /// Points of a batch.
    size: usize,
    num_near: usize,
    num_points: usize,
}

/// A batch's points: the number of the first in the order, its place in the planes, and their count.
struct BatchRange {
    first: usize,
    first_point: usize,
    count: usize,
}

impl BatchCut {
    /// Place in the planes at which the strays begin.
    fn far(self) -> usize {
        self.num_near.next_multiple_of(POINTS_PER_LOAD as usize)
    }

    /// Length of the planes.
    fn padded(self) -> usize {
        self.far() + (self.num_points - self.num_near).next_multiple_of(POINTS_PER_LOAD as usize)
    }

    /// Cuts a plane into one slice a batch.
    fn batches(self, plane: &mut [u32]) -> impl IndexedParallelIterator<Item = &mut [u32]> {
        let (near, far) = plane.split_at_mut(self.far());
        near.par_chunks_mut(self.size).chain(far.par_chunks_mut(self.size))
    }

    fn range(self, number: usize) -> BatchRange {
        let num_near_batches = self.num_near.div_ceil(self.size);
        if number < num_near_batches {
            let first = number * self.size;
            return BatchRange { first, first_point: first, count: self.size.min(self.num_near - first) };
        }
        let within = (number - num_near_batches) * self.size;
        let first = self.num_near + within;
        BatchRange { first, first_point: self.far() + within, count: self.size.min(self.num_points - first) }
    }
}

/// Bit that is added to the codes of strays. They have a grid of their own, so that they do not cost the scene its
/// precision.
pub(super) const FAR: u64 = 1 << (3 * morton::BITS);

/// Points by Morton code, strays last; equal codes keep the files' order.
pub(super) fn sort(index: &Index, bounds: &Bounds, scene: &Bounds) -> Vec<CodedPoint> {
    let (near, far) = (morton::MortonGrid::new(scene), morton::MortonGrid::new(bounds));
    let code = |p| if scene.contains(p) { near.code(p) } else { FAR | far.code(p) };
    let mut keys: Vec<CodedPoint> = (0..index.num_points as u32)
        .into_par_iter()
        .with_min_len(1 << 14)
        .map(|i| (code(index.position(i as usize)), i))
        .collect();
    keys.par_sort_unstable();
    keys
}

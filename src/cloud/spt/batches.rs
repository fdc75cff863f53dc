//! The list as a cloud: runs cut into batches, quantised, with a word for each disc's interval and size beside its
//! color.

use super::clusters::{Cone, cone_of};
use super::sequence::{MAX_SPREAD, Sequence, Shape, octave};
use super::steps::Scale;
use super::tree::PointTree;
use crate::cloud::quantize::{Cells, planes};
use crate::cloud::{Batch, BuildError, Cloud};
use crate::layout::{BATCH_POINTS, POINTS_PER_LOAD};
use crate::progress::Progress;
use crate::space::{Bounds, Split};
use rayon::prelude::*;
use std::ops::Range;

/// A batch ends with its octave, unless it is smaller than this: within an octave, points that follow each other are
/// neighbours.
const MIN_BATCH_POINTS: u32 = 2048;
/// Discs of a batch. Fewer than the GPU allows, for smaller boxes: a batch is all that is culled.
const MAX_BATCH_POINTS: u32 = 4096;
const _: () = assert!(MAX_BATCH_POINTS <= BATCH_POINTS);

/// A sequential point tree as the GPU wants it.
#[derive(Clone, Debug)]
pub struct SequentialCloud {
    /// The discs: their centres and mean colors.
    pub cloud: Cloud,
    /// Beside `cloud.colors`: [`Shape::word`]. Gaps hold zeros, intervals that no tolerance lies in.
    pub shapes: Vec<u32>,
    /// What the steps in `shapes` and `intervals` mean.
    pub scale: Scale,
    /// Of each batch: the smallest `min` and the largest `max` of its discs.
    pub intervals: Vec<[u8; 2]>,
    /// Batches whose discs face the same way.
    pub runs: Vec<BatchRun>,
    /// Points of the scan.
    pub num_points: u64,
}

/// A run of batches whose discs face the same way.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchRun {
    /// Its batches.
    pub batches: Range<u32>,
    /// Their box, world space.
    pub bounds: Bounds,
    /// The directions that lead away from all of its discs' fronts; `None` for discs that are seen from any side.
    pub behind: Option<Cone>,
}

/// What a batch is made of.
struct Plan {
    entries: Range<usize>,
    first_point: u32,
}

impl SequentialCloud {
    /// Quantises the discs of a tree. `progress` counts each of them.
    ///
    /// Peak memory above tree and list: 20 B a disc.
    ///
    /// # Errors
    /// See [`BuildError`].
    pub fn new(tree: &PointTree, sequence: &Sequence, progress: &Progress) -> Result<Self, BuildError> {
        let mut plans = Vec::new();
        let mut size = 0u64;
        let mut run_starts = Vec::new();
        for run in &sequence.runs {
            run_starts.push(plans.len() as u32);
            for entries in cut(&sequence.shapes, run.entries.clone()) {
                let num_points = entries.len() as u64;
                plans.push(Plan { entries, first_point: size as u32 });
                size += num_points.next_multiple_of(u64::from(POINTS_PER_LOAD));
            }
        }
        run_starts.push(plans.len() as u32);
        let num_points = tree.nodes.last().map_or(0, |root| root.num_points);
        if size > u64::from(u32::MAX / 2) {
            return Err(BuildError::TooManyDiscs(num_points as usize));
        }
        let mut columns = [(); 5].map(|()| vec![0u32; size as usize]);
        let filled = fill(tree, sequence, &plans, &mut columns, progress);
        if progress.stopped() {
            return Err(BuildError::Stopped);
        }
        let runs = sequence.runs.iter().zip(run_starts.windows(2)).map(|(run, starts)| {
            let batches = starts[0]..starts[1];
            let of_run = &filled[starts[0] as usize..starts[1] as usize];
            let bounds = of_run.iter().fold(Bounds::EMPTY, |b, (_, bounds)| b.union(*bounds));
            let behind = run.cluster.and_then(|cluster| cone_of(cluster).behind(f64::from(MAX_SPREAD)));
            BatchRun { batches, bounds, behind }
        });
        let runs = runs.collect();
        let [hi, mid, lo, colors, shapes] = columns;
        let intervals = plans.iter().map(|plan| interval(&sequence.shapes[plan.entries.clone()])).collect();
        let cloud = Cloud {
            split: Split::of(&tree.bounds),
            bounds: tree.bounds,
            batches: filled.into_iter().map(|(batch, _)| batch).collect(),
            planes: [hi, mid, lo],
            colors,
            num_points: sequence.nodes.len() as u64,
        };
        Ok(Self { cloud, shapes, scale: sequence.scale, intervals, runs, num_points: u64::from(num_points) })
    }
}

/// Smallest `min` and largest `max` of some discs.
fn interval(shapes: &[Shape]) -> [u8; 2] {
    shapes.iter().fold([u8::MAX, 0], |[min, max], shape| [min.min(shape.min), max.max(shape.max)])
}

/// A run's entries, batch by batch.
fn cut(shapes: &[Shape], run: Range<usize>) -> Vec<Range<usize>> {
    let mut batches = Vec::new();
    let mut start = run.start;
    for entry in run.clone() {
        let (num_points, next) = ((entry + 1 - start) as u32, shapes[..run.end].get(entry + 1));
        let falls = next.is_none_or(|next| octave(next.max) < octave(shapes[entry].max));
        if num_points == MAX_BATCH_POINTS || falls && num_points >= MIN_BATCH_POINTS || entry + 1 == run.end {
            batches.push(start..entry + 1);
            start = entry + 1;
        }
    }
    batches
}

/// Fills the planes, the colors and the shapes, and tells each batch with its true box.
fn fill(
    tree: &PointTree,
    sequence: &Sequence,
    plans: &[Plan],
    columns: &mut [Vec<u32>; 5],
    progress: &Progress,
) -> Vec<(Batch, Bounds)> {
    let mut rest = columns.each_mut().map(|column| &mut column[..]);
    let mut slots = Vec::with_capacity(plans.len());
    for plan in plans {
        let count = plan.entries.len().next_multiple_of(POINTS_PER_LOAD as usize);
        slots.push(rest.each_mut().map(|column| {
            let (own, later) = std::mem::take(column).split_at_mut(count);
            *column = later;
            own
        }));
    }
    let of_batch = |(plan, [hi, mid, lo, colors, shapes]): (&Plan, [&mut [u32]; 5])| {
        let nodes = &sequence.nodes[plan.entries.clone()];
        let positions = || nodes.iter().map(|&node| tree.position(node as usize));
        let bounds = positions().fold(Bounds::EMPTY, Bounds::with);
        let cells = Cells::covering(&bounds);
        if !progress.stopped() {
            for (i, (p, &node)) in positions().zip(nodes).enumerate() {
                [hi[i], mid[i], lo[i]] = planes(cells.quantize(p));
                colors[i] = tree.nodes[node as usize].color;
                shapes[i] = sequence.shapes[plan.entries.start + i].word();
            }
            progress.add(nodes.len() as u64);
        }
        let (first_point, num_points) = (plan.first_point, nodes.len() as u32);
        (Batch { first_point, num_points, min: cells.min, cell: cells.cell }, bounds)
    };
    plans.par_iter().zip(slots).map(of_batch).collect()
}

//! The list as a cloud: its parts as batches, quantized, with a word for each disc's interval and size beside its
//! color; and triangles, cut into batches of their own.

use super::clusters::{Cone, cone_of};
use super::meshlets::{Meshlet, meshlets};
use super::parts::MAX_DISCS;
use super::sequence::{DiscShape, ListPart, MAX_SPREAD, Sequence};
use super::steps::StepScale;
use super::tree::PointTree;
use crate::format::{BATCH_POINTS, POINTS_PER_LOAD};
use crate::quantize::{Cells, planes};
use crate::{Batch, BuildError, Cloud};
use base::space::{Bounds, Split};
use base::task::{Cancelled, Progress};
use rayon::prelude::*;
use std::ops::Range;

const _: () = assert!(MAX_DISCS <= BATCH_POINTS as usize);

/// A sequential point tree as the GPU wants it.
#[derive(Clone, Debug)]
pub struct SequentialCloud {
    /// The discs: their centers and mean colors. After them the triangles' corners.
    pub cloud: Cloud,
    /// One word beside each of `cloud.colors`: [`DiscShape::word`] for a disc; in a batch of triangles corner |
    /// corner≪8 | corner≪16 | step≪24, a triangle that is drawn below that step. Gaps hold zeros, which no tolerance
    /// draws.
    pub shapes: Vec<u32>,
    /// What the steps in `shapes` and `intervals` mean.
    pub scale: StepScale,
    /// Interval of each batch: the smallest `min` and the largest `max` of its discs, or 0 and the largest step of its
    /// triangles.
    pub intervals: Vec<[u8; 2]>,
    /// Batches whose discs face the same way; the last run is of triangles, if there are any.
    pub runs: Vec<BatchRun>,
    /// Points of the scan.
    pub num_points: u64,
}

/// A run of batches whose discs face the same way.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchRun {
    /// Its batches.
    pub batches: Range<u32>,
    /// Box of its batches, world space.
    pub bounds: Bounds,
    /// The directions that lead away from all of its discs' fronts; `None` for discs that are seen from any side,
    /// as triangles are.
    pub behind: Option<Cone>,
    /// True if its batches are of triangles.
    pub has_triangles: bool,
}

/// Entries of a batch before they are quantized.
struct BatchEntries<'a> {
    /// Nodes of its entries.
    nodes: &'a [u32],
    beside: Beside<'a>,
    first_point: u32,
}

/// Words that stand beside the entries of a batch.
enum Beside<'a> {
    Discs(&'a [DiscShape]),
    Triangles(&'a Meshlet),
}

impl Beside<'_> {
    fn word(&self, entry: usize) -> u32 {
        match self {
            Self::Discs(shapes) => shapes[entry].word(),
            Self::Triangles(meshlet) => meshlet.words[entry],
        }
    }

    /// Smallest `min` and largest `max`.
    fn interval(&self) -> [u8; 2] {
        match self {
            Self::Discs(shapes) => {
                shapes.iter().fold([u8::MAX, 0], |[min, max], shape| [min.min(shape.min), max.max(shape.max)])
            }
            Self::Triangles(meshlet) => [0, meshlet.max],
        }
    }
}

/// Batches one after the other.
#[derive(Default)]
struct AllEntries<'a> {
    batches: Vec<BatchEntries<'a>>,
    /// Words of a column that holds all batches.
    size: u64,
}

impl<'a> AllEntries<'a> {
    fn push(&mut self, nodes: &'a [u32], beside: Beside<'a>) {
        self.batches.push(BatchEntries { nodes, beside, first_point: self.size as u32 });
        self.size += (nodes.len() as u64).next_multiple_of(u64::from(POINTS_PER_LOAD));
    }
}

impl SequentialCloud {
    /// Quantizes the discs and the triangles of a tree. `progress` counts each disc and each corner.
    ///
    /// Peak memory above tree and list: 20 B a disc, and 40 B a triangle.
    ///
    /// # Errors
    /// See [`BuildError`].
    pub fn new(tree: &PointTree, sequence: &Sequence, progress: &Progress) -> Result<Self, BuildError> {
        let meshlets = meshlets(tree, &sequence.scale);
        let mut all = AllEntries::default();
        for part in &sequence.parts {
            let entries = part.entries.clone();
            all.push(&sequence.nodes[entries.clone()], Beside::Discs(&sequence.shapes[entries]));
        }
        meshlets.iter().for_each(|meshlet| all.push(&meshlet.nodes, Beside::Triangles(meshlet)));
        let AllEntries { batches: of_batches, size } = all;
        let num_points = tree.nodes.last().map_or(0, |root| root.num_points);
        if size > u64::from(u32::MAX / 2) {
            let num_points = num_points as usize;
            return Err(match tree.triangles.len() {
                0 => BuildError::TooManyDiscs(num_points),
                num_triangles => BuildError::TooManyTriangles { num_points, num_triangles },
            });
        }
        let mut columns = [(); 5].map(|()| vec![0u32; size as usize]);
        let filled = fill(tree, &of_batches, &mut columns, progress);
        if progress.is_cancelled() {
            return Err(Cancelled.into());
        }
        let bounds_of = |batches: &Range<u32>| {
            let of_run = &filled[batches.start as usize..batches.end as usize];
            of_run.iter().fold(Bounds::EMPTY, |b, (_, bounds)| b.union(*bounds))
        };
        let of_cluster = |end: &mut u32, parts: &[ListPart]| {
            let batches = *end..*end + parts.len() as u32;
            *end = batches.end;
            let behind = parts[0].cluster.and_then(|cluster| cone_of(cluster).behind(f64::from(MAX_SPREAD)));
            Some(BatchRun { bounds: bounds_of(&batches), batches, behind, has_triangles: false })
        };
        let clusters = sequence.parts.chunk_by(|a, b| a.cluster == b.cluster);
        let of_discs = clusters.scan(0, of_cluster);
        let batches = of_batches.len() as u32 - meshlets.len() as u32..of_batches.len() as u32;
        let of_triangles = (!batches.is_empty()).then(|| BatchRun {
            bounds: bounds_of(&batches),
            batches,
            behind: None,
            has_triangles: true,
        });
        let runs = of_discs.chain(of_triangles).collect();
        let [hi, mid, lo, colors, shapes] = columns;
        let intervals = of_batches.iter().map(|entries| entries.beside.interval()).collect();
        let cloud = Cloud {
            split: Split::of(&tree.scene.bounds, &tree.bounds),
            bounds: tree.bounds,
            scene: tree.scene.clone(),
            batches: filled.into_iter().map(|(batch, _)| batch).collect(),
            planes: [hi, mid, lo],
            colors,
            num_points: of_batches.iter().map(|entries| entries.nodes.len() as u64).sum(),
        };
        Ok(Self { cloud, shapes, scale: sequence.scale, intervals, runs, num_points: u64::from(num_points) })
    }
}

/// Fills the planes, the colors and the shapes, and returns each batch with its true box.
fn fill(
    tree: &PointTree,
    of_batches: &[BatchEntries],
    columns: &mut [Vec<u32>; 5],
    progress: &Progress,
) -> Vec<(Batch, Bounds)> {
    let mut rest = columns.each_mut().map(|column| &mut column[..]);
    let mut slots = Vec::with_capacity(of_batches.len());
    for entries in of_batches {
        let count = entries.nodes.len().next_multiple_of(POINTS_PER_LOAD as usize);
        slots.push(rest.each_mut().map(|column| {
            let (own, later) = std::mem::take(column).split_at_mut(count);
            *column = later;
            own
        }));
    }
    let of_batch = |(entries, [hi, mid, lo, colors, shapes]): (&BatchEntries, [&mut [u32]; 5])| {
        let nodes = entries.nodes;
        let positions = || nodes.iter().map(|&node| tree.position(node as usize));
        let bounds = positions().fold(Bounds::EMPTY, Bounds::with);
        let cells = Cells::covering(&bounds);
        if !progress.is_cancelled() {
            for (i, (p, &node)) in positions().zip(nodes).enumerate() {
                [hi[i], mid[i], lo[i]] = planes(cells.quantize(p));
                colors[i] = tree.nodes[node as usize].color;
                shapes[i] = entries.beside.word(i);
            }
            progress.add(nodes.len() as u64);
        }
        let (first_point, num_points) = (entries.first_point, nodes.len() as u32);
        (Batch { first_point, num_points, min: cells.min, cell: cells.cell }, bounds)
    };
    of_batches.par_iter().zip(slots).map(of_batch).collect()
}

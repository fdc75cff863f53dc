//! From a tree of drafts to a hierarchy of nodes, and then to their points, block after block, the root first.

use super::keys::{Cube, Placed, Root};
use super::tree::{Draft, Octant};
use super::{GRID_BITS, Hierarchy, Node, NodeBlock, TakeNodes};
use crate::format::{BATCH_POINTS, COORDINATE_BITS, PAGE_POINTS, POINTS_PER_LOAD, SPACING_EXPONENT_SHIFT};
use crate::index::Index;
use crate::quantize::{Cells, planes};
use crate::{Batch, BuildError};
use base::space::{Bounds, Split};
use base::task::{Cancelled, Progress};
use points::Scene;
use rayon::prelude::*;
use std::ops::Range;

/// Number of points, about, that are put in place before they are handed over.
const RUN_POINTS: usize = 1 << 20;
/// Keys of a block: blocks without a key of the wanted level are passed over.
const BLOCK_KEYS: usize = 64;

/// Sorted keys and the points that they stand for.
pub(super) struct PlacedKeys<'a> {
    pub index: &'a Index<'a>,
    /// Keys in sorted order, with filtered colors.
    pub keys: &'a [Placed],
    /// Level of the node that owns each key.
    pub levels: &'a [u8],
}

/// A hierarchy and where the points of its nodes come from.
pub(super) struct NodeLayout {
    pub hierarchy: Hierarchy,
    /// Keys and cells of each node.
    origins: Vec<(Range<usize>, Cells)>,
    /// Octants of all leaves, in the keys' order.
    octants: Vec<Octant>,
}

impl NodeLayout {
    /// Lays the nodes out breadth first.
    pub fn new(root: &Root, bounds: Bounds, scene: Scene, draft: Draft) -> Result<Self, BuildError> {
        let num_points = draft.keys.len();
        let hierarchy = Hierarchy {
            split: Split::of(&scene.bounds, &bounds),
            bounds,
            scene,
            nodes: Vec::new(),
            batches: Vec::new(),
            num_points: num_points as u64,
        };
        let mut layout = Self { hierarchy, origins: Vec::new(), octants: Vec::new() };
        let mut end = 0u64;
        let mut generation = vec![(None, draft)];
        while !generation.is_empty() {
            let first_child = layout.origins.len() + generation.len();
            let mut next = Vec::new();
            for (parent, draft) in generation {
                let number = layout.origins.len() as u32;
                let children = first_child + next.len()..first_child + next.len() + draft.children.len();
                let node = node(root, &draft, parent, children, end as u32);
                end += u64::from(draft.num_points.next_multiple_of(PAGE_POINTS));
                if end > u64::from(u32::MAX / 2) {
                    return Err(BuildError::TooMany(num_points));
                }
                layout.push(node, draft.cube, draft.keys.clone(), root);
                layout.octants.extend(draft.octants);
                next.extend(draft.children.into_iter().map(|child| (Some(number), child)));
            }
            generation = next;
        }
        layout.octants.sort_unstable_by_key(|octant| octant.keys.start);
        debug_assert!(follow(&layout.octants, num_points), "every key is in one octant");
        Ok(layout)
    }

    /// Adds a node and its batches, all of about the same size.
    fn push(&mut self, mut node: Node, cube: Cube, keys: Range<usize>, root: &Root) {
        let cells = root.cells(cube);
        let Hierarchy { nodes, batches, .. } = &mut self.hierarchy;
        let first_batch = batches.len() as u32;
        let num_batches = node.num_points.div_ceil(BATCH_POINTS).max(1);
        let size = node.num_points.div_ceil(num_batches).next_multiple_of(POINTS_PER_LOAD);
        let mut done = 0;
        while done < node.num_points {
            let num_points = size.min(node.num_points - done);
            let first_point = node.first_point + done;
            batches.push(Batch { first_point, num_points, min: cells.min, cell: cells.cell });
            done += num_points;
        }
        node.batches = first_batch..batches.len() as u32;
        nodes.push(node);
        self.origins.push((keys, cells));
    }
}

fn node(root: &Root, draft: &Draft, parent: Option<u32>, children: Range<usize>, first_point: u32) -> Node {
    let Cube { level, number } = draft.cube;
    let edge = root.edge(level);
    Node {
        level,
        cube: number,
        min: root.min(draft.cube),
        edge,
        parent,
        children: children.start as u32..children.end as u32,
        batches: 0..0,
        first_point,
        num_points: draft.num_points,
        num_points_within: draft.keys.len() as u32,
        octant_spacing: draft.octant_spacing.map(|s| if edge > 0.0 { (s / edge) as f32 } else { 0.0 }),
        spacing_step: draft.spacing_step as f32,
        crowd: draft.crowd,
        sample_spacing: (draft.sample_cells / f64::from(1u32 << GRID_BITS)) as f32,
    }
}

/// Hands over the points of all nodes, run after run, in the order of the nodes.
pub(super) fn fill<E: From<BuildError>>(
    placed: &PlacedKeys,
    layout: NodeLayout,
    progress: &Progress,
    take: TakeNodes<E>,
) -> Result<Hierarchy, E> {
    let NodeLayout { hierarchy, origins, octants } = layout;
    for run in runs(&hierarchy.nodes) {
        let block = |number: usize| {
            let (node, (keys, cells)) = (&hierarchy.nodes[number], &origins[number]);
            let mut block = NodeBlock::empty(number, node.num_points as usize);
            if !progress.is_cancelled() {
                block.fill(placed, &octants, node, keys.clone(), cells);
                progress.add(u64::from(node.num_points));
            }
            block
        };
        let blocks = run.into_par_iter().map(block).collect();
        if progress.is_cancelled() {
            return Err(BuildError::from(Cancelled).into());
        }
        take(&hierarchy, blocks)?;
    }
    Ok(hierarchy)
}

/// True if the octants cover all keys, one after the other, without a gap.
fn follow(octants: &[Octant], num_keys: usize) -> bool {
    let starts = octants.iter().map(|octant| octant.keys.start).chain([num_keys]);
    let ends = [0].into_iter().chain(octants.iter().map(|octant| octant.keys.end));
    starts.eq(ends)
}

/// The root, then consecutive nodes with about [`RUN_POINTS`].
fn runs(nodes: &[Node]) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let (mut first, mut num_points) = (0, 0);
    for (number, node) in nodes.iter().enumerate() {
        num_points += node.num_points as usize;
        if number == 0 || num_points >= RUN_POINTS || number + 1 == nodes.len() {
            runs.push(first..number + 1);
            (first, num_points) = (number + 1, 0);
        }
    }
    runs
}

impl NodeBlock {
    /// A block with room for `num_points` points.
    fn empty(node: usize, num_points: usize) -> Self {
        let column = || vec![0; num_points];
        Self { node, planes: [column(), column(), column()], colors: column(), filtered_colors: column() }
    }

    /// Fills in a node's points. `octants` are those of all leaves.
    fn fill(
        &mut self,
        placed: &PlacedKeys,
        octants: &[Octant],
        node: &Node,
        keys: Range<usize>,
        cells: &Cells,
    ) {
        let Self { planes: [hi, mid, lo], colors, filtered_colors, .. } = self;
        // An inner node that has taken every point below has no children either: its points stand for themselves.
        let is_own = node.children.is_empty();
        let bounds = node.exponent_bounds();
        let mut octants = &octants[octants.partition_point(|octant| octant.keys.end <= keys.start)..];
        for (at, number) in owned(placed.levels, keys, node.level as u8).enumerate() {
            let key = &placed.keys[number];
            let point = key.point as usize;
            let cells = cells.quantize(placed.index.position(point));
            [hi[at], mid[at], lo[at]] = planes(cells);
            if node.spacing_step > 1.0 {
                octants = &octants[octants.iter().take_while(|octant| octant.keys.end <= number).count()..];
                let spacing = octants.first().map_or(0.0, |octant| octant.spacing);
                hi[at] |= node.spacing_exponent(bounds, octant(cells), spacing) << SPACING_EXPONENT_SHIFT;
            }
            colors[at] = if is_own { key.color } else { placed.index.color(point) };
            filtered_colors[at] = key.color;
        }
    }
}

/// The octant of its node's cube that a cell lies in.
fn octant(cells: [u32; 3]) -> usize {
    let [x, y, z] = cells.map(|cell| (cell >> (COORDINATE_BITS - 1)) as usize);
    x | y << 1 | z << 2
}

/// Keys of a range that a node of `level` owns. Most of an inner node's range belongs to nodes below it, so
/// blocks without any are passed over.
fn owned(levels: &[u8], range: Range<usize>, level: u8) -> impl Iterator<Item = usize> {
    let first = range.start;
    levels[range].chunks(BLOCK_KEYS).enumerate().filter(move |(_, block)| block.contains(&level)).flat_map(
        move |(number, block)| {
            let start = first + number * BLOCK_KEYS;
            (start..).zip(block).filter(move |(_, l)| **l == level).map(|(key, _)| key)
        },
    )
}

//! A layered point cloud: an additive octree whose inner nodes hold a thinned sample of their subtree and whose
//! leaves hold the rest; every point is stored once [2022 §3.5].
//!
//! ```text
//!  Scan ──keys──▶ Morton-sorted keys ──tree──▶ Hierarchy (a subtree = a range of keys) ──fill──▶ NodeBlocks
//!                                        │ bottom-up: sample                    breadth first, root down
//!                                        ▼
//!                              filtered colors, level of each key
//! ```
//!
//! No hash tables are needed: once the points are sorted by Morton code, each cube of the octree is a run of neighbors,
//! found by bisection, and so is each cell of a node's sampling grid. A node samples the samples of its children (all
//! points of a leaf), takes them out of the children, and hands them on to its parent; the work shrinks by a factor
//! from level to level. The result does not depend on the number of threads.
//!
//! What an inner node guarantees:
//! - **Spread**: no two of its points share a cell of its grid of 128³, and no two are closer than half a cell,
//!   [`Node::cell`] / 2. In a cell, the point nearest to the center is taken. If that makes more than
//!   [`MAX_NODE_POINTS`], some are dropped, evenly.
//! - **Filter**: its points' filtered colors average all points of its cube, each counted once. A cell's points count
//!   for the cell's sample. If that sample is dropped because another is too close, they count for the nearest that was
//!   kept; if it is dropped because there are too many, for the one before it on the curve.
//!
//! Leaves keep whatever is left, at most [`LEAF_POINTS`], and at most [`MAX_CROWD`] in a cell of a grid of 128³,
//! unless the points cannot be told apart by [`MAX_LEVEL`] halvings (duplicates): then as many batches as are needed.

mod fill;
mod keys;
mod sample;
mod spacing;
#[cfg(test)]
mod tests;
mod tree;

use super::build::{Checked, check};
use super::format::PAGE_POINTS;
use super::index::Index;
use super::{Batch, BuildError, Cloud};
use base::space::{Bounds, Split};
use base::task::{Cancelled, Progress};
use glam::DVec3;
use points::{Scan, Scene};
use std::ops::Range;

/// Deepest level; the root is level 0. A far point makes the root's cube large: that of a 2³²th of it still tells the
/// steps of a file's grid apart.
pub const MAX_LEVEL: u32 = 31;
/// A cube with more points than this is split.
pub const LEAF_POINTS: usize = 30_000;
/// An inner node takes no more points than this.
pub const MAX_NODE_POINTS: usize = 50_000;
/// Points of a leaf that may share a cell of its grid: at 50 pixels an edge, a pixel and the depth tolerance
/// reach over some tens of cells, and a pixel's packed sums hold 1023 points.
pub const MAX_CROWD: u32 = 16;
/// Bits an axis of a node's sampling grid: 128³ cells.
const GRID_BITS: u32 = 7;

/// A cube of the octree and its own points.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Halvings from the root's cube.
    pub level: u32,
    /// Number of the cube along each axis at its level, below 2^level: with the level, the node's path.
    pub cube: [u32; 3],
    /// Smallest corner of the cube, world space.
    pub min: DVec3,
    /// Edge of the cube, world units; 0 if all points of the cloud are in one place.
    pub edge: f64,
    /// The node that it is a part of; `None` for the root. A cube between them, in which one point would have
    /// stood for all, is left out, so the parent may be more than one level up.
    pub parent: Option<u32>,
    /// Its children in Morton order, as a range of nodes; empty for a leaf.
    pub children: Range<u32>,
    /// Its points, as a range of batches.
    pub batches: Range<u32>,
    /// First of its points in the planes, a multiple of [`crate::format::PAGE_POINTS`]; they follow one another without
    /// gaps.
    pub first_point: u32,
    /// Points of its own.
    pub num_points: u32,
    /// Points of the cloud in its cube: its own, those of all nodes below, and those that nodes above took.
    pub num_points_within: u32,
    /// Estimated distance of neighbors among all points in each octant of its cube, as a share of `edge`; in an inner
    /// node, the distance where they lie closest. 0 in an octant without points. Octant number: x | y≪1 | z≪2.
    pub octant_spacing: [f32; 8],
    /// A sample's neighbors lie `spacing_step`ⁿ times as far apart as its octant's spacing says, 0 ≤ n ≤ 3: see
    /// [`crate::format::SPACING_EXPONENT_SHIFT`]. 1 for a leaf.
    pub spacing_step: f32,
    /// Largest number of its points that share a cell of a grid of 128³; 1 for an inner node.
    pub crowd: u32,
    /// How far apart its samples lie on a surface, together with those that nodes above took of its cube, as a share of
    /// `edge`: 1 / 128, or more if some were dropped because there were too many. 0 for a leaf.
    pub sample_spacing: f32,
}

impl Node {
    /// Edge of a cell of the sampling grid, world units. A leaf's points may lie closer together, or further apart.
    #[must_use]
    pub fn cell(&self) -> f64 {
        self.edge / f64::from(1u32 << GRID_BITS)
    }

    /// Distances of neighbors, in multiples of the octant's spacing, from which on a point's exponent is 1, 2 and 3.
    /// Between two steps the upper one is taken from 0.3 of the way on: a point drawn too small leaves gaps, one drawn
    /// too large only blurs.
    fn exponent_bounds(&self) -> [f64; 3] {
        let step = f64::from(self.spacing_step);
        [0, 1, 2].map(|exponent| step.powf(0.3) * step.powi(exponent))
    }

    /// The exponent of a point in an octant whose neighbors lie `spacing` world units apart; 0 if that is not known.
    fn spacing_exponent(&self, bounds: [f64; 3], octant: usize, spacing: f64) -> u32 {
        let least = f64::from(self.octant_spacing[octant]) * self.edge;
        bounds.iter().filter(|&bound| spacing > least * bound).count() as u32
    }

    /// Octant of this node's cube that a node below lies in.
    #[must_use]
    pub fn octant_of(&self, below: &Node) -> usize {
        octant_of(self.level, below.level, below.cube)
    }
}

/// Octant of a cube at `level` that a cube of a deeper level lies in.
fn octant_of(level: u32, below: u32, cube: [u32; 3]) -> usize {
    let bit = |axis: usize| (cube[axis] >> (below - level - 1) & 1) as usize;
    bit(0) | bit(1) << 1 | bit(2) << 2
}

/// The nodes of a layered point cloud without their points.
#[derive(Clone, Debug)]
pub struct Hierarchy {
    /// How world positions become the GPU's pairs of f32.
    pub split: Split,
    /// True box of the points, world space.
    pub bounds: Bounds,
    /// The scan's scene.
    pub scene: Scene,
    /// Breadth first: the root, its children, their children; siblings follow one another in Morton order.
    /// Parents stand before children, so that any prefix of the nodes can be drawn.
    pub nodes: Vec<Node>,
    /// Batches of all nodes, one node after the other; a batch's box is its node's cube.
    pub batches: Vec<Batch>,
    /// Points in all nodes.
    pub num_points: u64,
}

impl Hierarchy {
    /// True if points lie so close in some leaf, or in the only node, that a pixel may get more of them than
    /// packed sums hold.
    #[must_use]
    pub fn is_crowded(&self) -> bool {
        is_crowded(&self.nodes)
    }
}

/// The points of one node, as the GPU wants them.
#[derive(Clone, Debug)]
pub struct NodeBlock {
    /// The node's number.
    pub node: usize,
    /// Coordinate planes, coarse to fine, as in [`Cloud::planes`].
    pub planes: [Vec<u32>; 3],
    /// The points' own colors.
    pub colors: Vec<u32>,
    /// The points' filtered colors, as in [`Octree::filtered_colors`].
    pub filtered_colors: Vec<u32>,
}

/// Takes each run of nodes as it comes.
pub type TakeNodes<'a, E> = &'a mut dyn FnMut(&Hierarchy, Vec<NodeBlock>) -> Result<(), E>;

/// A layered point cloud, whole in memory.
#[derive(Clone, Debug)]
pub struct Octree {
    /// All points, node by node, each node cut into batches that share its cube as their box. As it stands this
    /// is a flat cloud too: drawn whole, it shows every point once. Its colors are the points' own.
    pub cloud: Cloud,
    /// Beside `cloud.colors`: the average of what a point stands for while nothing below its node is drawn.
    /// Equal to the own color in leaves.
    pub filtered_colors: Vec<u32>,
    /// Nodes as in [`Hierarchy::nodes`].
    pub nodes: Vec<Node>,
}

impl Octree {
    /// See [`Hierarchy::is_crowded`].
    #[must_use]
    pub fn is_crowded(&self) -> bool {
        is_crowded(&self.nodes)
    }

    /// An octree with room for all points of a hierarchy.
    fn empty(hierarchy: &Hierarchy) -> Self {
        let Hierarchy { split, bounds, scene, nodes, batches, num_points } = hierarchy.clone();
        let size = num_words(&nodes);
        let plane = || vec![0u32; size];
        let planes = [plane(), plane(), plane()];
        let cloud = Cloud { split, bounds, scene, batches, planes, colors: plane(), num_points };
        Self { cloud, filtered_colors: plane(), nodes }
    }

    /// Puts a node's points in their place.
    fn put(&mut self, block: &NodeBlock) {
        let node = &self.nodes[block.node];
        let place = node.first_point as usize..(node.first_point + node.num_points) as usize;
        let Cloud { planes: [hi, mid, lo], colors, .. } = &mut self.cloud;
        let NodeBlock { planes: [block_hi, block_mid, block_lo], .. } = block;
        for (column, points) in [
            (hi, block_hi),
            (mid, block_mid),
            (lo, block_lo),
            (colors, &block.colors),
            (&mut self.filtered_colors, &block.filtered_colors),
        ] {
            column[place.clone()].copy_from_slice(points);
        }
    }
}

/// Words of a plane that holds all of these nodes.
#[must_use]
pub fn num_words(nodes: &[Node]) -> usize {
    nodes.last().map_or(0, |n| (n.first_point + n.num_points).next_multiple_of(PAGE_POINTS)) as usize
}

/// See [`Hierarchy::is_crowded`].
#[must_use]
pub fn is_crowded(nodes: &[Node]) -> bool {
    nodes.len() == 1 || nodes.iter().any(|node| node.crowd > MAX_CROWD)
}

/// Builds the octree of a scan, on all cores, and hands its points over node by node, the root first.
///
/// `progress` counts each point twice: once sorted into the tree, once put in its place. `take` gets runs of nodes in
/// the hierarchy's order, the first of them the root alone. It is called on this thread, between two runs: hand the
/// work on if it takes long.
///
/// Peak memory above the scan: 17 B a point for the keys while the tree is built; then 9, and the blocks of a run.
///
/// # Errors
/// See [`BuildError`]; and what `take` gives.
pub fn build_nodes<E: From<BuildError>>(
    scan: &Scan,
    progress: &Progress,
    take: TakeNodes<E>,
) -> Result<Hierarchy, E> {
    let Checked { bounds, scene, .. } = check(scan)?;
    let index = Index::new(scan);
    let root = keys::Root::new(&bounds);
    let mut keys = keys::sorted(&index, &root);
    if progress.is_cancelled() {
        return Err(BuildError::from(Cancelled).into());
    }
    let mut levels = vec![0; keys.len()];
    let draft = tree::OctreeBuilder { index: &index, root, progress }.build(&mut keys, &mut levels);
    if progress.is_cancelled() {
        return Err(BuildError::from(Cancelled).into());
    }
    // Codes are not needed any more: their half of the memory is freed.
    let mut keys: Vec<keys::Placed> = keys.into_iter().map(keys::Placed::from).collect();
    keys.shrink_to_fit();
    let placed = fill::PlacedKeys { index: &index, keys: &keys, levels: &levels };
    fill::fill(&placed, fill::NodeLayout::new(&root, bounds, scene, draft)?, progress, take)
}

/// Builds the octree of a scan as [`build_nodes`] does and keeps all of it in memory, 20 B a point more.
///
/// # Errors
/// See [`BuildError`].
pub fn build_octree(scan: &Scan, progress: &Progress) -> Result<Octree, BuildError> {
    let mut octree: Option<Octree> = None;
    build_nodes(scan, progress, &mut |hierarchy, blocks| {
        let octree = octree.get_or_insert_with(|| Octree::empty(hierarchy));
        blocks.iter().for_each(|block| octree.put(block));
        Ok::<(), BuildError>(())
    })?;
    octree.ok_or(BuildError::Empty)
}

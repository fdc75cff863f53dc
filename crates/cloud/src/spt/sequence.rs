//! The tree as a list: an interval of tolerance for each disc, sorted [SPT §3.6, 3.7].

use super::clusters::{NUM_CLUSTERS, cluster_of};
use super::mesh;
use super::parts::{self, DiscEntry};
use super::steps::{ENDLESS, StepScale};
use super::tree::PointTree;
use rayon::prelude::*;
use std::ops::Range;

/// When a disc is drawn, and how large: everything that the GPU's test needs beside the position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DiscShape {
    /// Step of tolerance from which on it is drawn: the disc's own error, and its onset; see [`super::mesh`].
    pub min: u8,
    /// Step below which it is drawn: the error of its parent and the overlap; [`ENDLESS`] for the root.
    pub max: u8,
    /// The disc's diameter, as a step.
    pub diameter: u8,
}

impl DiscShape {
    /// True if the disc is drawn where the tolerance is at `step` ([`StepScale::step_below`]).
    #[must_use]
    pub fn is_drawn(self, step: u8) -> bool {
        self.min <= step && step < self.max
    }

    /// The GPU's word: min | max≪8 | diameter≪16.
    #[must_use]
    pub fn word(self) -> u32 {
        u32::from_le_bytes([self.min, self.max, self.diameter, 0])
    }
}

/// A batch of the list: discs that are culled together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListPart {
    /// Cluster of its discs' normals; `None` for discs that may be seen from any side.
    pub cluster: Option<u8>,
    /// Its entries in the list.
    pub entries: Range<usize>,
}

/// A point tree as a list.
#[derive(Clone, Debug)]
pub struct Sequence {
    /// What the shapes' steps mean.
    pub scale: StepScale,
    /// Number of each entry's node. Nodes that no tolerance draws have none.
    pub nodes: Vec<u32>,
    /// When each entry is drawn, and how large.
    pub shapes: Vec<DiscShape>,
    /// Parts, which have each entry once. They are sorted by cluster, those without one last, then by the octave of the
    /// largest `max`, falling.
    pub parts: Vec<ListPart>,
}

/// Discs whose points' normals lie further apart than this, in radians, have no side. The more is allowed, the fewer
/// clusters face away.
pub const MAX_SPREAD: f32 = 0.15;
/// Cluster number of discs without a side: they come last.
pub(super) const NO_CLUSTER: u8 = NUM_CLUSTERS as u8;

impl Sequence {
    /// Flattens a tree. `max_slope` is the most that the tolerance may grow by on a way of length 1
    /// ([`super::MAX_TOLERANCE_SLOPE`]); with 0, intervals do not overlap, which is right where the tolerance is the
    /// same everywhere.
    ///
    /// Memory: 7 B a node to keep, 16 to sort.
    #[must_use]
    pub fn new(tree: &PointTree, max_slope: f64) -> Self {
        let largest = tree.nodes.last().map_or(0.0, |root| root.diameter);
        let scale = StepScale::up_to(largest);
        let onsets = mesh::onsets(tree, &scale);
        let shape = |number: usize| {
            let shape = shape(tree, &scale, max_slope, number);
            let onset = onsets.get(number).copied().unwrap_or(0);
            let radius = 0.5 * f64::from(tree.nodes[number].diameter);
            DiscShape { min: shape.min.max(mesh::first_step(&scale, onset, radius, max_slope)), ..shape }
        };
        let cluster = |node: u32| {
            let node = &tree.nodes[node as usize];
            if node.spread <= MAX_SPREAD { cluster_of(node.normal) } else { NO_CLUSTER }
        };
        // Entries are sorted by octave, the largest first, then in Morton order.
        let key = |number: usize| {
            let DiscShape { min, max, .. } = shape(number);
            (min < max).then(|| u64::from(u8::MAX - octave(max)) << 32 | number as u64)
        };
        let mut keys: Vec<u64> = (0..tree.nodes.len()).into_par_iter().filter_map(key).collect();
        keys.par_sort_unstable();
        let nodes: Vec<u32> = keys.into_par_iter().map(|key| key as u32).collect();
        let shapes: Vec<DiscShape> = nodes.par_iter().map(|&node| shape(node as usize)).collect();
        let entries: Vec<DiscEntry> = nodes.into_iter().zip(shapes).collect();
        let (entries, parts) = parts::parts(entries, &cluster);
        let (nodes, shapes) = entries.into_iter().unzip();
        Self { scale, nodes, shapes, parts }
    }
}

/// Octave of a step, which entries are sorted by: eight steps are an octave.
pub(super) fn octave(step: u8) -> u8 {
    step >> 3
}

/// A node's interval and size. An interval ends where the parent's begins, and later by what the tolerance may grow on
/// the way from the parent's center to the node's: so a parent that is just too near to be drawn never leaves a hole
/// [SPT §3.6].
fn shape(tree: &PointTree, scale: &StepScale, max_slope: f64, number: usize) -> DiscShape {
    let node = &tree.nodes[number];
    let max = tree.parent(number).map_or(ENDLESS, |parent| {
        let begin = scale.length(scale.step(tree.nodes[parent].error));
        let distance = (tree.position(parent) - tree.position(number)).length();
        let overlap = max_slope * distance;
        scale.step(if overlap > 0.0 { (f64::from(begin) + overlap) as f32 } else { begin })
    });
    DiscShape { min: scale.step(node.error), max, diameter: scale.step(node.diameter) }
}

//! From sorted keys to a tree: down by bisection, up by sampling.

use super::keys::{CodeFrame, Cube, Root, SortKey, recode};
use super::octant_of;
use super::sample::{Sample, Sampler};
use super::spacing::{Spacing, spacing};
use super::{GRID_BITS, LEAF_POINTS, MAX_CROWD, MAX_LEVEL, MAX_NODE_POINTS};
use crate::index::Index;
use base::task::Progress;
use rayon::prelude::*;
use std::cell::RefCell;
use std::ops::Range;

/// Subtrees with fewer points are built by one thread.
const PARALLEL_POINTS: usize = 1 << 16;

/// Points that an octant of a leaf needs before their spacing means anything.
const MIN_SURFACE_POINTS: usize = 16;
/// Largest ratio that is told of the spacings within an octant: beyond it, the least spacing counts as larger.
const MAX_SPACING_RATIO: f64 = 64.0;

thread_local! {
    static SAMPLER: RefCell<Sampler> = RefCell::new(Sampler::new());
}

/// A node before its points have a place.
#[derive(Debug)]
pub(super) struct Draft {
    pub cube: Cube,
    /// Keys of all points in the cube.
    pub keys: Range<usize>,
    /// Points of its own.
    pub num_points: u32,
    /// The least distance of neighbors in each octant, world units; 0 for an octant of a leaf that has few points.
    pub octant_spacing: [f64; 8],
    /// See [`super::Node::spacing_step`].
    pub spacing_step: f64,
    /// How far apart all points in the cube lie.
    apart: Apart,
    /// Octants of leaves: its own, or those of children that are no nodes since all their points were taken.
    pub octants: Vec<Octant>,
    /// Largest number of its points in a cell of its grid.
    pub crowd: u32,
    /// Spacing of its samples in cells of its grid, 1 or more; 0 for a leaf.
    pub sample_cells: f64,
    /// Children in Morton order.
    pub children: Vec<Draft>,
}

/// Candidates that a subtree offers to its parent.
#[derive(Debug)]
enum Offer {
    /// Every point of a leaf.
    All,
    /// The samples of an inner node.
    Samples(Vec<Sample>),
}

/// The keys of a subtree and the levels of the nodes that own them.
struct SubtreeKeys<'k> {
    /// Number of its first key.
    first: usize,
    keys: &'k mut [SortKey],
    levels: &'k mut [u8],
}

impl<'k> SubtreeKeys<'k> {
    fn reborrow(&mut self) -> SubtreeKeys<'_> {
        SubtreeKeys { first: self.first, keys: self.keys, levels: self.levels }
    }

    fn range(&self) -> Range<usize> {
        self.first..self.first + self.keys.len()
    }

    /// Splits the keys into runs whose codes agree above the lowest `bits`.
    fn split(self, bits: u32) -> Vec<SubtreeKeys<'k>> {
        let mut parts = Vec::with_capacity(8);
        let mut rest = self;
        while let Some(first) = rest.keys.first() {
            let cube = first.code >> bits;
            let count = rest.keys.partition_point(|key| key.code >> bits == cube);
            let (keys, later_keys) = rest.keys.split_at_mut(count);
            let (levels, later_levels) = rest.levels.split_at_mut(count);
            parts.push(SubtreeKeys { first: rest.first, keys, levels });
            rest = SubtreeKeys { first: rest.first + count, keys: later_keys, levels: later_levels };
        }
        parts
    }

    /// The keys of a range, each as a sample of itself.
    fn each(&self, range: &Range<usize>) -> impl Iterator<Item = Sample> {
        let keys = &self.keys[range.start - self.first..range.end - self.first];
        keys.iter().zip(range.clone()).map(|(key, number)| Sample::of(key, number))
    }
}

/// Everything that stays the same while a tree is built.
pub(super) struct OctreeBuilder<'a> {
    pub index: &'a Index<'a>,
    pub root: Root,
    pub progress: &'a Progress,
}

impl OctreeBuilder<'_> {
    /// The tree over sorted keys, at least one. Afterwards `levels` says of each key which of the nodes on its path
    /// owns it, and its color is the filtered one. The result is worthless if `progress` is cancelled.
    pub fn build(&self, keys: &mut [SortKey], levels: &mut [u8]) -> Draft {
        let frame = CodeFrame::new(&self.root, Cube::ROOT);
        let part = SubtreeKeys { first: 0, keys, levels };
        if self.root.edge(0) == 0.0 {
            return self.leaf(&frame, 0, part).0;
        }
        self.subtree(&frame, 0, part).0
    }

    fn subtree(&self, frame: &CodeFrame, level: u32, mut part: SubtreeKeys) -> (Draft, Offer) {
        if level == MAX_LEVEL || self.progress.is_cancelled() {
            return self.leaf(frame, level, part);
        }
        // A leaf that is dense in one place would be drawn whole wherever it is drawn at all.
        let is_leaf = || spacing(part.keys, frame.bits_below(level)).crowd <= MAX_CROWD;
        if part.keys.len() <= LEAF_POINTS && is_leaf() {
            return self.leaf(frame, level, part);
        }
        if !frame.serves(level) {
            return self.reframed(frame, level, part);
        }
        let cell_bits = frame.bits_below(level) - 3 * GRID_BITS;
        if part.keys[0].code >> cell_bits == part.keys[part.keys.len() - 1].code >> cell_bits {
            // One sample would stand for all: the node would show nothing that its parent does not.
            return self.subtree(frame, level + 1, part);
        }
        // The cube is read now: building the children may leave the codes of a frame further down.
        let cube = frame.cube(part.keys[0].code, level);
        let is_small = part.keys.len() < PARALLEL_POINTS;
        let parts = part.reborrow().split(frame.bits_below(level + 1));
        let below = |part: SubtreeKeys| self.subtree(frame, level + 1, part);
        let below: Vec<(Draft, Offer)> = if is_small {
            parts.into_iter().map(below).collect()
        } else {
            parts.into_par_iter().map(below).collect()
        };
        self.inner(frame, cube, part, below)
    }

    fn leaf(&self, frame: &CodeFrame, level: u32, part: SubtreeKeys) -> (Draft, Offer) {
        self.progress.add(part.keys.len() as u64);
        part.levels.fill(level as u8);
        let bits = frame.bits_below(level);
        let Spacing { share, crowd } = spacing(part.keys, bits);
        let edge = self.root.edge(level);
        let octants = octants(part.keys, part.first, bits, edge);
        let mut octant_spacing = [0.0; 8];
        for (number, octant) in &octants {
            octant_spacing[*number] = octant.spacing;
        }
        let octants: Vec<Octant> = octants.into_iter().map(|(_, octant)| octant).collect();
        let draft = Draft {
            cube: frame.cube(part.keys[0].code, level),
            keys: part.range(),
            num_points: part.keys.len() as u32,
            octant_spacing,
            spacing_step: 1.0,
            apart: Apart::of_leaf(share * edge, &octants),
            octants,
            crowd,
            sample_cells: 0.0,
            children: Vec::new(),
        };
        (draft, Offer::All)
    }

    /// Builds a subtree that its frame's codes are too short for, in a frame of its own.
    fn reframed(&self, outer: &CodeFrame, level: u32, mut part: SubtreeKeys) -> (Draft, Offer) {
        let cube = outer.cube(part.keys[0].code, level);
        let frame = CodeFrame::new(&self.root, cube);
        recode(part.keys, self.index, &frame);
        let (draft, offer) = self.subtree(&frame, level, part.reborrow());
        let mut samples = match offer {
            Offer::All => part.each(&part.range()).collect(),
            Offer::Samples(samples) => samples,
        };
        for sample in &mut samples {
            let point = part.keys[sample.key as usize - part.first].point;
            sample.code = outer.code(self.index.position(point as usize));
        }
        (draft, Offer::Samples(samples))
    }

    /// Makes a node over its children and takes its samples from them.
    fn inner(
        &self,
        frame: &CodeFrame,
        cube: Cube,
        part: SubtreeKeys,
        below: Vec<(Draft, Offer)>,
    ) -> (Draft, Offer) {
        let level = cube.level;
        let feed = |offer: &mut dyn FnMut(usize, &Sample)| {
            for (number, (child, offered)) in below.iter().enumerate() {
                match offered {
                    Offer::All => part.each(&child.keys).for_each(|sample| offer(number, &sample)),
                    Offer::Samples(samples) => samples.iter().for_each(|sample| offer(number, sample)),
                }
            }
        };
        let node_bits = frame.bits_below(level);
        let sampled = SAMPLER.with_borrow_mut(|sampler| sampler.sample(node_bits, MAX_NODE_POINTS, feed));
        for sample in &sampled.samples {
            let at = sample.key as usize - part.first;
            part.levels[at] = level as u8;
            part.keys[at].color = sample.color();
        }
        let (octant_spacing, spacing_step) = spacing_below(level, &below);
        let apart = Apart::of(below.iter().map(|(child, _)| (child.keys.len(), child.apart)));
        let mut children: Vec<Draft> = below.into_iter().map(|(child, _)| child).collect();
        for (child, taken) in children.iter_mut().zip(sampled.num_taken) {
            child.num_points -= taken;
        }
        // A child whose points were all taken and that has no children is no node any more.
        let is_node = |child: &Draft| child.num_points > 0 || !child.children.is_empty();
        let (children, taken): (Vec<Draft>, Vec<Draft>) = children.into_iter().partition(is_node);
        // On a surface, half as many points lie √2 times as far apart.
        let sample_cells = (sampled.num_spread as f64 / sampled.samples.len() as f64).sqrt();
        let draft = Draft {
            cube,
            keys: part.range(),
            num_points: sampled.samples.len() as u32,
            octant_spacing,
            spacing_step,
            apart,
            octants: taken.into_iter().flat_map(|child| child.octants).collect(),
            crowd: 1,
            sample_cells,
            children,
        };
        (draft, Offer::Samples(sampled.samples))
    }
}

/// Points of a leaf that lie in one octant of its cube.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Octant {
    /// Numbers of their keys.
    pub keys: Range<usize>,
    /// Mean distance of neighbors, world units; 0 where points are too few to tell of a surface.
    pub spacing: f64,
}

/// How far apart the points of a cube lie, world units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Apart {
    /// Least and most spacing in those octants of leaves that tell of a surface; `None` if there are none.
    surfaces: Option<(f64, f64)>,
    /// Mean spacing of all points.
    mean: f64,
}

impl Apart {
    fn of_leaf(mean: f64, octants: &[Octant]) -> Self {
        let surfaces = octants.iter().map(|octant| octant.spacing).filter(|&spacing| spacing > 0.0);
        Self { surfaces: surfaces.map(|spacing| (spacing, spacing)).reduce(hull), mean }
    }

    /// Joins the spacings of parts, given with their numbers of points.
    fn of(parts: impl Iterator<Item = (usize, Self)>) -> Self {
        let (mut surfaces, mut sum, mut num) = (None, 0.0, 0);
        for (part_num, part) in parts {
            surfaces = surfaces.into_iter().chain(part.surfaces).reduce(hull);
            sum += part.mean * part_num as f64;
            num += part_num;
        }
        Self { surfaces, mean: sum / num as f64 }
    }
}

/// The smallest range that covers both ranges.
fn hull(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0.min(b.0), a.1.max(b.1))
}

/// The octants of a leaf that have points, and their numbers, from the codes of its points, in order.
fn octants(keys: &[SortKey], first: usize, bits: u32, edge: f64) -> Vec<(usize, Octant)> {
    // The points are all in one place, or codes have no bits left for octants.
    if bits < 3 || edge == 0.0 {
        return vec![(0, Octant { keys: first..first + keys.len(), spacing: 0.0 })];
    }
    let bits = bits - 3;
    let mut end = first;
    let parts = keys.chunk_by(|a, b| a.code >> bits == b.code >> bits);
    let octant = |part: &[SortKey]| {
        let start = end;
        end += part.len();
        // A few points tell nothing of a surface.
        let is_surface = part.len() >= MIN_SURFACE_POINTS;
        let spacing = if is_surface { spacing(part, bits).share * 0.5 * edge } else { 0.0 };
        ((part[0].code >> bits & 7) as usize, Octant { keys: start..end, spacing })
    };
    parts.map(octant).collect()
}

/// The least distance of neighbors in each octant of an inner node, and its spacing step, which is the cube root of the
/// largest ratio within an octant. A node at `level` has at most one part in each octant.
fn spacing_below(level: u32, below: &[(Draft, Offer)]) -> ([f64; 8], f64) {
    let (mut octants, mut ratio) = ([0.0; 8], 1.0f64);
    for (part, _) in below {
        let Apart { surfaces, mean } = part.apart;
        let (least, most) = surfaces.unwrap_or((mean, mean));
        let least = least.max(most / MAX_SPACING_RATIO);
        octants[octant_of(level, part.cube.level, part.cube.number)] = least;
        if least > 0.0 {
            ratio = ratio.max(most / least);
        }
    }
    (octants, ratio.cbrt())
}

#[cfg(test)]
mod tests {
    use super::{Apart, Octant};

    #[test]
    fn surfaces_span_from_the_least_to_the_most_distance() {
        let leaf = |mean: f64, spacings: &[f64]| {
            let octants = spacings.iter().map(|&spacing| Octant { keys: 0..0, spacing });
            Apart::of_leaf(mean, &octants.collect::<Vec<_>>())
        };
        let dense = leaf(1.5, &[1.0, 2.0, 0.0]);
        let sparse = leaf(10.0, &[10.0]);
        // Points too few to tell of a surface count only where there are no others.
        let lone = leaf(50.0, &[0.0, 0.0]);
        assert_eq!((dense.surfaces, lone.surfaces), (Some((1.0, 2.0)), None));
        let all = Apart::of([(300, dense), (100, sparse), (4, lone)].into_iter());
        assert_eq!(all.surfaces, Some((1.0, 10.0)));
        assert!((Apart::of([(3, lone), (1, leaf(10.0, &[]))].into_iter()).mean - 40.0).abs() < 1e-9);
    }
}

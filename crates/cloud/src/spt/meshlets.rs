//! Triangles in batches: each a few neighbors of about one size with the corners that they share.
//!
//! A corner is a point of its batch like any other; the word beside point i is triangle i of the batch. Corners that
//! several batches share stand in each.

use super::mesh::Triangle;
use super::sequence::octave;
use super::steps::StepScale;
use super::tree::PointTree;
use crate::format::{SECOND_CORNER_SHIFT, SIDE_SHIFT, THIRD_CORNER_SHIFT, WORKGROUP_SIZE};
use rayon::prelude::*;
use std::collections::HashMap;

/// Triangles of a batch at most: one a thread.
const MAX_TRIANGLES: usize = WORKGROUP_SIZE as usize;
/// A batch ends with its octave, unless it has fewer triangles than this.
const MIN_TRIANGLES: usize = MAX_TRIANGLES / 2;
/// Corners of a batch at most: their numbers have 8 bits.
const MAX_CORNERS: usize = 256;

/// A batch of triangles.
#[derive(Debug, Default)]
pub(super) struct Meshlet {
    /// Nodes of the corners; the last one is repeated if there are more triangles than corners.
    pub nodes: Vec<u32>,
    /// A word for each triangle: corners, 8 bits each, and the step of its longest side ≪ 24. There are as many words
    /// as nodes; those beyond the triangles are 0, a size that no tolerance is below.
    pub words: Vec<u32>,
    /// The largest step of the triangles.
    pub max: u8,
}

/// The triangles of a tree by falling octave of their sizes, and in Morton order of a corner inside of each.
pub(super) fn meshlets(tree: &PointTree, scale: &StepScale) -> Vec<Meshlet> {
    let key = |(number, triangle): (usize, &Triangle)| {
        let falling = u8::MAX - octave(scale.step(triangle.side));
        let [a, b, c] = triangle.corners;
        (falling, a.min(b).min(c), number as u32)
    };
    let mut keys: Vec<(u8, u32, u32)> = tree.triangles.par_iter().enumerate().map(key).collect();
    keys.par_sort_unstable();
    let mut meshlets = Vec::new();
    let mut open = Open::default();
    for (i, &(falling, _, number)) in keys.iter().enumerate() {
        let triangle = &tree.triangles[number as usize];
        if open.is_full_for(triangle) {
            meshlets.push(open.close());
        }
        open.add(triangle, scale.step(triangle.side));
        let falls = keys.get(i + 1).is_none_or(|next| next.0 > falling);
        if falls && (open.meshlet.words.len() >= MIN_TRIANGLES || i + 1 == keys.len()) {
            meshlets.push(open.close());
        }
    }
    meshlets
}

/// A batch that more triangles may join.
#[derive(Default)]
struct Open {
    meshlet: Meshlet,
    /// Where each node stands among the corners.
    places: HashMap<u32, u32>,
}

impl Open {
    fn is_full_for(&self, triangle: &Triangle) -> bool {
        let num_new = triangle.corners.iter().filter(|corner| !self.places.contains_key(corner)).count();
        self.meshlet.words.len() == MAX_TRIANGLES || self.places.len() + num_new > MAX_CORNERS
    }

    fn add(&mut self, triangle: &Triangle, step: u8) {
        let [a, b, c] = triangle.corners.map(|node| {
            *self.places.entry(node).or_insert_with(|| {
                self.meshlet.nodes.push(node);
                self.meshlet.nodes.len() as u32 - 1
            })
        });
        self.meshlet
            .words
            .push(a | b << SECOND_CORNER_SHIFT | c << THIRD_CORNER_SHIFT | u32::from(step) << SIDE_SHIFT);
        self.meshlet.max = self.meshlet.max.max(step);
    }

    /// Closes the batch, which has a triangle, and begins an empty one.
    fn close(&mut self) -> Meshlet {
        self.places.clear();
        let mut meshlet = std::mem::take(&mut self.meshlet);
        let size = meshlet.nodes.len().max(meshlet.words.len());
        let last = meshlet.nodes.last().copied().unwrap_or(0);
        meshlet.nodes.resize(size, last);
        meshlet.words.resize(size, 0);
        meshlet
    }
}

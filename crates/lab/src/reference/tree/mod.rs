//! CPU reference of what only a sequential point tree has: its cull, its discs and its triangles.

pub mod cull;
pub mod tolerance;
pub mod triangles;

use crate::technique::tree::{DiscBatch, Run, TreeUniform};
use bytemuck::Zeroable;
use cloud::spt::{SequentialCloud, StepScale};
use render::layout::ViewUniform;

/// A sequential point tree as the stages see it, in one chunk.
#[derive(Clone, Debug)]
pub struct Tree<'a> {
    /// The frame's tolerance, and the tree's lengths.
    pub uniform: TreeUniform,
    /// The tree's runs.
    pub runs: Vec<Run>,
    /// The tree's batches.
    pub batches: Vec<DiscBatch>,
    /// Intervals and sizes of discs, and words of triangles.
    pub shapes: &'a [u32],
}

impl<'a> Tree<'a> {
    /// Makes the tree, with no tolerance yet.
    #[must_use]
    pub fn new(tree: &'a SequentialCloud) -> Self {
        let batches = tree.cloud.batches.iter().enumerate();
        Self {
            uniform: TreeUniform { step_base: tree.scale.base, ..TreeUniform::zeroed() },
            runs: tree.runs.iter().map(Run::new).collect(),
            batches: batches.map(|(number, batch)| DiscBatch::new(tree, number, batch.first_point)).collect(),
            shapes: &tree.shapes,
        }
    }

    /// Scale of the tree's lengths.
    #[must_use]
    pub fn scale(&self) -> StepScale {
        StepScale { base: self.uniform.step_base }
    }
}

/// A disc: CPU reference of `spt/discs.inc.wgsl`.
#[derive(Clone, Copy)]
pub(super) struct ChosenDisc {
    /// The first step of tolerance that the disc is drawn at, and the first beyond.
    interval: (u8, u8),
    /// Diameter in world units.
    pub diameter: f32,
}

impl ChosenDisc {
    pub fn of(tree: &Tree, point: u32) -> Self {
        let [from, until, diameter, _] = tree.shapes[point as usize].to_le_bytes();
        Self { interval: (from, until), diameter: tree.scale().length(diameter) }
    }

    pub fn is_chosen(&self, view: &ViewUniform, tree: &Tree, eye: usize, p_in_head: [f32; 3]) -> bool {
        let from_eye = std::array::from_fn(|i| p_in_head[i] - view.eyes[eye].eye_in_head[i]);
        let step = tree.scale().step_below(tolerance::of(view, &tree.uniform, eye, from_eye));
        self.interval.0 <= step && step < self.interval.1
    }
}

//! The points' sort keys, and the cubes that they fall into.

use crate::format::COORDINATE_BITS;
use crate::index::Index;
use crate::morton::{self, MortonGrid};
use crate::quantize::{Cells, cell_edge};
use base::space::Bounds;
use glam::DVec3;
use rayon::prelude::*;

/// A point while the tree is built.
#[derive(Clone, Copy, Debug)]
pub(super) struct SortKey {
    /// Morton code in its frame.
    pub code: u64,
    /// Number in the [`Index`].
    pub point: u32,
    /// Its own color; once an inner node has taken it, the filtered one.
    pub color: u32,
}

/// A key whose place is known, in half the memory. It is aligned as a key is, so that a list of keys can be converted
/// in place.
#[derive(Clone, Copy, Debug)]
#[repr(align(8))]
pub(super) struct Placed {
    /// Number in the [`Index`].
    pub point: u32,
    /// As [`SortKey::color`].
    pub color: u32,
}

impl From<SortKey> for Placed {
    fn from(SortKey { point, color, .. }: SortKey) -> Self {
        Self { point, color }
    }
}

/// The root's cube, from which all others come by halving.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    min: DVec3,
    /// Edge of one of its 2³⁰ cells, 12 bits of mantissa, so that all nodes' cells have no more.
    cell: f32,
}

/// A cube of the octree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cube {
    pub level: u32,
    pub number: [u32; 3],
}

impl Cube {
    pub const ROOT: Self = Self { level: 0, number: [0; 3] };
}

impl Root {
    pub fn new(bounds: &Bounds) -> Self {
        Self { min: bounds.min, cell: cell_edge(bounds.size().max_element()) }
    }

    /// Edge of the cubes of a level; halving is exact.
    pub fn edge(&self, level: u32) -> f64 {
        f64::from(self.cell) * (f64::from(COORDINATE_BITS) - f64::from(level)).exp2()
    }

    pub fn min(&self, cube: Cube) -> DVec3 {
        self.min + DVec3::from_array(cube.number.map(f64::from)) * self.edge(cube.level)
    }

    /// The cells in which a node's points are quantized.
    pub fn cells(&self, cube: Cube) -> Cells {
        Cells { min: self.min(cube), cell: [self.cell / (1u32 << cube.level) as f32; 3] }
    }
}

/// The cube that codes are relative to. 21 bits an axis do not reach from the root to the grid cells of its
/// deepest nodes, so codes are made anew [`CodeFrame::LEVELS`] further down.
#[derive(Clone, Copy, Debug)]
pub(super) struct CodeFrame {
    cube: Cube,
    grid: MortonGrid,
}

impl CodeFrame {
    /// Levels below a frame's cube that its codes serve: a node of the last of them still has 4 bits an axis
    /// below its grid cells, to tell which point is nearest to a cell's center.
    pub const LEVELS: u32 = morton::BITS - super::GRID_BITS - 4;

    pub fn new(root: &Root, cube: Cube) -> Self {
        Self { cube, grid: MortonGrid::of_cube(root.min(cube), root.edge(cube.level)) }
    }

    pub fn code(&self, p_in_world: DVec3) -> u64 {
        self.grid.code(p_in_world)
    }

    /// True if the codes tell the grid cells of nodes of that level.
    pub fn serves(&self, level: u32) -> bool {
        level - self.cube.level <= Self::LEVELS
    }

    /// Bits of a code below the cubes of `level`.
    pub fn bits_below(&self, level: u32) -> u32 {
        3 * (morton::BITS + self.cube.level - level)
    }

    /// The cube of `level` that a code lies in.
    pub fn cube(&self, code: u64, level: u32) -> Cube {
        let inside = code >> self.bits_below(level);
        let depth = level - self.cube.level;
        let number = std::array::from_fn(|axis| {
            // `depth` bits, and the frame's own number has the rest of at most 21.
            self.cube.number[axis] << depth | morton::compact(inside >> axis) as u32
        });
        Cube { level, number }
    }
}

/// All points by Morton code in the root's cube; equal codes keep the files' order.
pub(super) fn sorted(index: &Index, root: &Root) -> Vec<SortKey> {
    let frame = CodeFrame::new(root, Cube::ROOT);
    let mut keys: Vec<SortKey> = (0..index.num_points as u32)
        .into_par_iter()
        .with_min_len(1 << 14)
        .map(|point| {
            let (p, color) = index.point(point as usize);
            SortKey { code: frame.code(p), point, color }
        })
        .collect();
    sort(&mut keys);
    keys
}

/// Gives the keys codes of another frame and the order that follows.
pub(super) fn recode(keys: &mut [SortKey], index: &Index, frame: &CodeFrame) {
    keys.par_iter_mut().with_min_len(1 << 14).for_each(|key| {
        key.code = frame.code(index.position(key.point as usize));
    });
    sort(keys);
}

fn sort(keys: &mut [SortKey]) {
    keys.par_sort_unstable_by_key(|key| (key.code, key.point));
}

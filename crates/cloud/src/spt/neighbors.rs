//! The leaves' normals and diameters, from each point's neighbors.
//!
//! Points are taken in cubes of a few; the cubes round one of them, found by bisection among the codes, hold the
//! neighbors of all its points. The result depends on neither threads nor chance.

use super::cubes::CubeKeys;
use super::tree::{Leaf, NO_SIDE};
use super::{CodedPoint, SortedPoints, normals};
use crate::build::FAR;
use crate::morton::{BITS, compact, spread};
use base::task::Progress;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Points that one thread takes at once.
const TASK_POINTS: usize = 1 << 14;
/// Points of a cube that is not cut further.
const CUBE_POINTS: usize = 16;
/// Points of a cube that are looked at; if it holds more, evenly spread ones.
const MAX_CANDIDATES: usize = 64;
/// Neighbors that a normal is estimated from.
const NORMAL_NEIGHBORS: usize = 12;
/// Which neighbor tells how far apart points lie: on a square grid, the four nearest are equally far.
const SPACING_NEIGHBOR: usize = 4;
/// Diameter of a leaf's disc in multiples of its spacing: it must reach over the diagonal, and points lie
/// irregularly.
pub(super) const OVERLAP: f32 = 1.5;
/// Largest diameter of a leaf in multiples of its nearest neighbor's. A point that lies further from its neighbors is a
/// stray and no part of a surface, and would be drawn as a large disc.
const STRAY: f32 = 1.5;
/// Share of points whose diameters are taken as they are. The others, at the rims of what the scanner saw and in loose
/// ends, get the widest of these.
const HONEST: f64 = 0.99;

/// A normal and a diameter for each of the sorted points. The result is worthless if `progress` is cancelled.
pub(super) fn leaves(sorted: &SortedPoints, progress: &Progress) -> Vec<Leaf> {
    let mut tasks = Vec::new();
    CubeKeys::root(&sorted.keys).cut(&sorted.keys, TASK_POINTS, &mut |cube| tasks.push(cube));
    let of_task = |task: &CubeKeys| {
        let mut search = Search { sorted, candidates: Vec::new(), nearest: Vec::new() };
        let mut leaves = Vec::with_capacity(task.keys.len());
        if !progress.is_cancelled() {
            task.cut(&sorted.keys, CUBE_POINTS, &mut |cube| search.cube(&cube, &mut leaves));
            progress.add(task.keys.len() as u64);
        }
        leaves
    };
    let leaves: Vec<(Leaf, u32)> = tasks.par_iter().map(of_task).collect::<Vec<_>>().concat();
    let trimmed = |&(leaf, nearest): &(Leaf, u32)| match leaves.get(nearest as usize) {
        // Duplicates of one point tell nothing of the surface round them.
        Some((beside, _)) if beside.diameter > 0.0 => {
            Leaf { diameter: leaf.diameter.min(STRAY * beside.diameter), ..leaf }
        }
        _ => leaf,
    };
    let mut leaves: Vec<Leaf> = leaves.par_iter().map(trimmed).collect();
    limit(&mut leaves);
    leaves
}

/// Gives the few widest leaves the diameter of the widest honest one.
fn limit(leaves: &mut [Leaf]) {
    let mut diameters: Vec<f32> = leaves.iter().map(|leaf| leaf.diameter).collect();
    let at = (HONEST * diameters.len() as f64) as usize;
    if at < diameters.len() {
        let widest = *diameters.select_nth_unstable_by(at, f32::total_cmp).1;
        leaves.iter_mut().for_each(|leaf| leaf.diameter = leaf.diameter.min(widest));
    }
}

/// Buffers of a thread to find neighbors with.
struct Search<'a> {
    sorted: &'a SortedPoints<'a>,
    /// Points of a cube and those round it: number of the key, and position relative to the cube's first point.
    candidates: Vec<(usize, Vec3)>,
    /// Nearest candidates of a point: squared distance, and number among the candidates.
    nearest: Vec<(f32, u32)>,
}

impl Search<'_> {
    /// Appends the leaves of a cube's points.
    fn cube(&mut self, cube: &CubeKeys, leaves: &mut Vec<(Leaf, u32)>) {
        let keys = &self.sorted.keys;
        let position = |number: usize| self.sorted.index.position(keys[number].1 as usize);
        let origin = position(cube.keys.start);
        let relative = |number: usize| (position(number) - origin).as_vec3();
        self.candidates.clear();
        around(keys, cube, &mut |range| {
            let stride = range.len().div_ceil(MAX_CANDIDATES);
            self.candidates.extend(range.step_by(stride).map(|number| (number, relative(number))));
        });
        for number in cube.keys.clone() {
            leaves.push(self.leaf(number, relative(number)));
        }
    }

    /// A point's leaf and the key of its nearest neighbor; its own key if it has none.
    fn leaf(&mut self, number: usize, p: Vec3) -> (Leaf, u32) {
        self.nearest.clear();
        let others = self.candidates.iter().enumerate().filter(|(_, (other, _))| *other != number);
        self.nearest.extend(others.map(|(i, (_, q))| (q.distance_squared(p), i as u32)));
        // If distances are equal, the earlier candidate comes first.
        let order = |a: &(f32, u32), b: &(f32, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        if self.nearest.len() > NORMAL_NEIGHBORS {
            self.nearest.select_nth_unstable_by(NORMAL_NEIGHBORS, order);
            self.nearest.truncate(NORMAL_NEIGHBORS);
        }
        self.nearest.sort_unstable_by(order);
        let telling = self.nearest[..self.nearest.len().min(SPACING_NEIGHBOR)].last();
        let spacing = telling.map_or(0.0, |(distance_sq, _)| distance_sq.sqrt());
        let nearest = self.nearest.first().map_or(number, |&(_, i)| self.candidates[i as usize].0);
        let mut points = [DVec3::ZERO; NORMAL_NEIGHBORS + 1];
        points[0] = p.as_dvec3();
        for (point, &(_, i)) in points[1..].iter_mut().zip(&self.nearest) {
            *point = self.candidates[i as usize].1.as_dvec3();
        }
        let normal = normals::least_spread(&points[..=self.nearest.len()]);
        let leaf = Leaf { normal: normals::pack(normal), diameter: OVERLAP * spacing, spread: NO_SIDE };
        (leaf, nearest as u32)
    }
}

/// The keys of a cube, and of each of the 26 cubes round it that has any.
fn around(keys: &[CodedPoint], cube: &CubeKeys, each: &mut dyn FnMut(Range<usize>)) {
    each(cube.keys.clone());
    if cube.bits > 3 * BITS {
        // The cube holds all keys.
        return;
    }
    // A stray has neighbors among strays only.
    let first = keys[cube.keys.start].0;
    let (prefix, far) = ((first & !FAR) >> cube.bits, (first & FAR) >> cube.bits);
    let cell = [0, 1, 2].map(|axis| compact(prefix >> axis) as i64);
    let num_cells = 1i64 << (BITS - cube.bits / 3);
    let steps = (-1..=1).flat_map(|x| (-1..=1).flat_map(move |y| (-1..=1).map(move |z| [x, y, z])));
    for step in steps.filter(|step| *step != [0, 0, 0]) {
        let [x, y, z] = std::array::from_fn(|axis| cell[axis] + step[axis]);
        if [x, y, z].iter().any(|v| !(0..num_cells).contains(v)) {
            continue;
        }
        let code = far | spread(x as u64) | spread(y as u64) << 1 | spread(z as u64) << 2;
        let start = keys.partition_point(|key| key.0 >> cube.bits < code);
        let rest = &keys[start..];
        if rest.first().is_some_and(|key| key.0 >> cube.bits == code) {
            each(start..start + rest.partition_point(|key| key.0 >> cube.bits == code));
        }
    }
}

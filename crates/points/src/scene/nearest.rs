//! Finds how far positions are from their neighbors by a kd-tree, which works with any range of distances.

use glam::DVec3;
use rayon::prelude::*;

/// Most positions of a leaf.
const LEAF: usize = 8;
/// Most positions that one thread sorts alone.
const TASK: usize = 1 << 12;

/// The distance of each position to its `number`th nearest other one; infinite if there are fewer.
pub(super) fn distances(positions: &[DVec3], number: usize) -> Vec<f64> {
    let mut nodes: Vec<KdNode> = positions.iter().map(|&p| KdNode { p, axis: 0 }).collect();
    sort(&mut nodes);
    let distance = |&p: &DVec3| {
        // The nearest of all is the position itself.
        let mut nearest = NearestSearch { p, squares: vec![f64::INFINITY; number + 1] };
        nearest.search(&nodes);
        nearest.farthest().sqrt()
    };
    positions.par_iter().map(distance).collect()
}

/// A position, which is the middle one of a run of more than [`LEAF`], and the axis along which the positions before it
/// are below it, and those behind it above.
struct KdNode {
    p: DVec3,
    axis: usize,
}

fn sort(nodes: &mut [KdNode]) {
    if nodes.len() <= LEAF {
        return;
    }
    let (low, high) = nodes.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), node| {
        (low.min(node.p), high.max(node.p))
    });
    let axis = (high - low).max_position();
    let middle = nodes.len() / 2;
    let is_large = nodes.len() > TASK;
    let (below, node, above) = nodes.select_nth_unstable_by(middle, |a, b| a.p[axis].total_cmp(&b.p[axis]));
    node.axis = axis;
    if is_large {
        rayon::join(|| sort(below), || sort(above));
    } else {
        sort(below);
        sort(above);
    }
}

/// A search for the nearest positions, with the squares of the distances that have been found, ascending.
struct NearestSearch {
    p: DVec3,
    squares: Vec<f64>,
}

impl NearestSearch {
    fn farthest(&self) -> f64 {
        self.squares.last().copied().unwrap_or(0.0)
    }

    fn search(&mut self, nodes: &[KdNode]) {
        if nodes.len() <= LEAF {
            nodes.iter().for_each(|node| self.look_at(node));
            return;
        }
        let middle = nodes.len() / 2;
        let node = &nodes[middle];
        let above = self.p[node.axis] - node.p[node.axis];
        let (near, far) = if above < 0.0 {
            (&nodes[..middle], &nodes[middle + 1..])
        } else {
            (&nodes[middle + 1..], &nodes[..middle])
        };
        self.search(near);
        self.look_at(node);
        if above * above < self.farthest() {
            self.search(far);
        }
    }

    fn look_at(&mut self, node: &KdNode) {
        let square = self.p.distance_squared(node.p);
        if square < self.farthest() {
            let at = self.squares.partition_point(|&nearer| nearer <= square);
            self.squares.pop();
            self.squares.insert(at, square);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbors_are_those_that_a_look_at_all_pairs_finds() {
        // Positions lie evenly in a cube, on a plane, in a line, and each twice as far as the one before.
        let at =
            |i: usize| [0.754_877_666, 0.569_840_291, 0.430_159_709].map(|step| (i as f64 * step).fract());
        let shapes: [fn(usize, DVec3) -> DVec3; 4] = [
            |_, p| p,
            |_, p| p.with_z(7.0),
            |i, _| DVec3::Y * i as f64,
            |i, p| p * 2f64.powi(i as i32 % 120),
        ];
        for shape in shapes {
            for num in [1, 2, 9, 500] {
                let positions: Vec<DVec3> =
                    (0..num).map(|i| shape(i, DVec3::from_array(at(i + 1)))).collect();
                for number in [1, 4] {
                    let slow = positions.iter().map(|p| {
                        let mut all: Vec<f64> = positions.iter().map(|q| p.distance_squared(*q)).collect();
                        all.sort_unstable_by(f64::total_cmp);
                        all.get(number).map_or(f64::INFINITY, |square| square.sqrt())
                    });
                    assert_eq!(distances(&positions, number), slow.collect::<Vec<f64>>(), "{num} {number}");
                }
            }
        }
    }
}

//! The one grid for all nodes of a scan of Potree 1, each of which counts from its own corner.
//!
//! A node's position is a whole number of steps (`scale`) from the smallest corner of its box. The boxes halve the
//! root's cube, so corners need not be whole steps apart. The grid's step is therefore the scale divided by a power of
//! two, up to 2¹⁰: corners down to level 10 lie on it if the cube's edge is a whole number of steps, as converters make
//! it from a scan that was stored in such steps, and no other corner moves by more than half of it, a 2 048th of the
//! scale. Scans of more than 2²¹ steps have a coarser grid; what holds always is half a step of the grid.

use super::tree::{NodeName, NodeTree};
use crate::Grid;
use base::space::Bounds;
use glam::DVec3;

/// Most times that the scale is halved.
const MOST_HALVED: i32 = 10;
/// Times that the scale is doubled at most: enough for any box of finite numbers.
const MOST_DOUBLED: i32 = 2000;
/// Grid coordinates that the box may reach.
const REACH: f64 = i32::MAX as f64;

/// The grid of a scan's nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct PotreeGrid {
    pub grid: Grid,
    /// Edges of the root's box in steps.
    edges: DVec3,
    /// How often the scale is halved to a step; negative if it is doubled.
    halved: i32,
}

impl PotreeGrid {
    /// The grid of nodes in this root box, whose positions count in steps of this scale.
    pub fn of(root: Bounds, scale: f64) -> Self {
        let edge = root.size().max_element();
        let step = |halved: i32| scale * 2f64.powi(-halved);
        let fits = |halved: &i32| edge / step(*halved) < REACH && step(*halved).is_normal();
        let halved = (-MOST_DOUBLED..=MOST_HALVED).rev().find(fits).unwrap_or(-MOST_DOUBLED);
        let edges = root.size() / step(halved);
        Self { grid: Grid { scale: DVec3::splat(step(halved)), offset: root.min }, edges, halved }
    }

    /// The grid coordinates of a node's smallest corner.
    pub fn corner(&self, key: NodeName) -> [i64; 3] {
        (NodeTree::low_corner(key) * self.edges).to_array().map(|steps| steps.round() as i64)
    }

    /// The grid coordinates of a position in the node with this corner; `None` beyond the grid's end.
    #[inline]
    pub fn place(&self, corner: [i64; 3], stored: [i32; 3]) -> Option<[i32; 3]> {
        let mut placed = [0; 3];
        for axis in 0..3 {
            // The type says that there is a sign, but there is none.
            let steps = i64::from(stored[axis] as u32);
            let steps = match self.halved {
                halved @ 0.. => steps << halved,
                halved => rounded(steps, halved.unsigned_abs()),
            };
            placed[axis] = i32::try_from(corner[axis] + steps).ok()?;
        }
        Some(placed)
    }
}

/// A number that is not negative, halved this often and rounded.
fn rounded(number: i64, halved: u32) -> i64 {
    if halved > 40 { 0 } else { (number + (1 << halved >> 1)) >> halved }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Where the format says that a stored position is, as its viewer computes it: box after box, halved.
    fn as_the_format_says(root: Bounds, scale: f64, key: NodeName, stored: [i32; 3]) -> DVec3 {
        let (mut min, mut max) = (root.min, root.max);
        for digit in key.digits() {
            let half = 0.5 * (max - min);
            for (axis, bit) in [(0, 2), (1, 1), (2, 0)] {
                if digit >> bit & 1 == 1 { min[axis] += half[axis] } else { max[axis] -= half[axis] }
            }
        }
        min + scale * DVec3::from_array(stored.map(|c| f64::from(c as u32)))
    }

    fn cube(min: [f64; 3], edge: f64) -> Bounds {
        let min = DVec3::from_array(min);
        Bounds { min, max: min + edge }
    }

    /// Distance along an axis between where a position is put and where the format has it.
    fn moved(root: Bounds, scale: f64, key: NodeName, stored: [i32; 3]) -> Option<f64> {
        let grid = PotreeGrid::of(root, scale);
        let placed = grid.place(grid.corner(key), stored)?;
        Some(
            (grid.grid.p_in_world(placed) - as_the_format_says(root, scale, key, stored)).abs().max_element(),
        )
    }

    fn key() -> impl Strategy<Value = NodeName> {
        proptest::collection::vec(0..8u8, 0..20)
            .prop_map(|digits| digits.iter().fold(NodeName::ROOT, |key, &digit| key.child(digit).unwrap()))
    }

    proptest! {
        #[test]
        fn nothing_moves_by_more_than_half_a_step(
            min in [-1e7..1e7, -1e7..1e7, -1e3..1e3f64],
            edge in prop_oneof![1e-3..1e3f64, 1e3..1e7f64, Just(0.0)],
            scale in prop_oneof![Just(0.001), Just(0.01), 1e-5..1.0f64],
            key in key(),
            part: [u32; 3],
        ) {
            let root = cube(min, edge);
            let edge = root.size().max_element();
            let node_edge = edge * 0.5f64.powi(i32::from(key.level()));
            let most_steps = (node_edge / scale) as u32;
            let stored = part.map(|part| (f64::from(part) / 2f64.powi(32) * f64::from(most_steps)) as u32 as i32);
            let grid = PotreeGrid::of(root, scale);
            let step = grid.grid.scale.x;
            // Half a step, and the last bits of coordinates.
            let most = 0.5 * step + 8.0 * f64::EPSILON * (root.min.abs().max_element() + edge);
            // Where the scale is doubled, positions are rounded too.
            let most = if step > scale { 2.0 * most } else { most };
            let moved = moved(root, scale, key, stored);
            prop_assert!(moved.is_some_and(|moved| moved <= most), "{moved:?} {most} {step}");
            if edge / scale < 2e6 {
                prop_assert!(step <= scale / 1024.0);
            }
        }

        #[test]
        fn cubes_of_whole_steps_are_exact(
            origin in [-100_000_000..100_000_000i64, 0..900_000_000i64, -10_000..10_000i64],
            edge in 1..2_000_000i64,
            key in key(),
            stored in [0..100_000i32, 0..100_000i32, 0..100_000i32],
        ) {
            // The numbers are those of a scan in millimeters, with the last bits that a converter's differences leave.
            let min = origin.map(|c| c as f64 * 0.001);
            let root = Bounds {
                min: DVec3::from_array(min),
                max: DVec3::from_array(origin.map(|c| (c + edge) as f64 * 0.001)),
            };
            let grid = PotreeGrid::of(root, 0.001);
            prop_assert_eq!(grid.halved, 10);
            let key = key.digits().take(10).fold(NodeName::ROOT, |key, digit| key.child(digit).unwrap());
            let Some(placed) = grid.place(grid.corner(key), stored) else { return Ok(()) };
            let low = NodeTree::low_corner(key);
            for axis in 0..3 {
                let exact = (low[axis] * 1024.0) as i64 * edge + i64::from(stored[axis]) * 1024;
                prop_assert_eq!(i64::from(placed[axis]), exact);
            }
        }
    }

    #[test]
    fn the_bounds_can_be_broken_and_far_positions_have_no_place() {
        let root = cube([0.0; 3], 10.0007);
        let key = NodeName::parse("r7").unwrap();
        let at = |grid: &PotreeGrid| {
            let placed = grid.place(grid.corner(key), [1; 3]).unwrap();
            (grid.grid.p_in_world(placed) - as_the_format_says(root, 0.001, key, [1; 3])).abs().max_element()
        };
        let fine = PotreeGrid::of(root, 0.001);
        let coarse = PotreeGrid {
            grid: Grid { scale: DVec3::splat(0.001), ..fine.grid },
            edges: root.size() / 0.001,
            halved: 0,
        };
        assert!(at(&fine) < 5e-7 && at(&coarse) > 1e-4);
        assert_eq!(fine.place(fine.corner(key), [-1, 0, 0]), None);
        let huge = PotreeGrid::of(cube([0.0; 3], 1e300), 0.001);
        assert_eq!(huge.place(huge.corner(NodeName::ROOT), [7; 3]), Some([0; 3]));
        assert!(huge.grid.scale.is_finite());
    }
}

//! How far apart the points of a leaf lie, from the cells of ever finer grids that they fill.

use super::GRID_BITS;
use super::keys::SortKey;

/// Finest grid looked at: 2^this cells an axis.
const MAX_DEPTH: usize = 10;
/// Points that a filled cell holds on average where its grid still shows the surface rather than the points.
const POINTS_PER_CELL: usize = 4;
/// Cells that a surface meets, on average over its directions, for each cell face of its area.
const CELLS_PER_FACE: f64 = 1.5;

/// How close the points of a leaf lie, as their sorted codes tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spacing {
    /// Mean distance of neighbors, taking the points for a surface, as a share of the cube's edge.
    pub share: f64,
    /// Largest number of points in one cell of the sampling grid.
    pub crowd: u32,
}

/// Estimates the spacing from the sorted codes of a cube's points, whose lowest `bits` tell the place in the cube.
pub(super) fn spacing(keys: &[SortKey], bits: u32) -> Spacing {
    // Two successive keys that lie in different cells from a depth on begin a new filled cell at that depth.
    let mut begun = [0usize; MAX_DEPTH + 1];
    let (mut crowd, mut run) = (1u32, 1u32);
    for pair in keys.windows(2) {
        let difference = (pair[0].code ^ pair[1].code) & ((1u64 << bits) - 1);
        let depth = difference.checked_ilog2().map_or(u32::MAX, |bit| (bits - 1 - bit) / 3 + 1);
        if let Some(count) = begun.get_mut(depth as usize) {
            *count += 1;
        }
        run = if depth <= GRID_BITS { 1 } else { run + 1 };
        crowd = crowd.max(run);
    }
    let (mut filled, mut cells, mut depth) = (1, 1, 0);
    for (deeper, count) in begun.iter().enumerate().skip(1) {
        filled += count;
        if filled * POINTS_PER_CELL > keys.len() {
            break;
        }
        (cells, depth) = (filled, deeper);
    }
    let area = cells as f64 / CELLS_PER_FACE / f64::from(1u32 << (2 * depth));
    Spacing { share: (area / keys.len() as f64).sqrt(), crowd }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::morton::MortonGrid;
    use glam::DVec3;

    fn keys(points: impl Iterator<Item = DVec3>) -> Vec<SortKey> {
        let grid = MortonGrid::of_cube(DVec3::ZERO, 1.0);
        let mut keys: Vec<SortKey> = points
            .enumerate()
            .map(|(i, p)| SortKey { code: grid.code(p), point: i as u32, color: 0 })
            .collect();
        keys.sort_by_key(|key| key.code);
        keys
    }

    #[test]
    fn a_tilted_sheet_tells_its_spacing() {
        for (num, slope) in [(100, 0.0), (100, 0.7), (30, 0.3), (170, 1.0)] {
            let at = move |i: usize, j: usize| {
                let (u, v) = ((i as f64 + 0.5) / num as f64, (j as f64 + 0.5) / num as f64);
                DVec3::new(u, v, 0.01 + 0.98 * slope * u)
            };
            let sheet = (0..num).flat_map(|i| (0..num).map(move |j| at(i, j)));
            let truth = (1.0f64 + slope * slope).powf(0.25) / num as f64;
            let share = spacing(&keys(sheet), 63).share;
            assert!((0.6..1.6).contains(&(share / truth)), "{num} {slope}: {share} for {truth}");
        }
    }

    #[test]
    fn duplicates_are_a_crowd() {
        let apart = keys((0..50).map(|i| DVec3::splat((f64::from(i) + 0.5) / 50.0)));
        assert_eq!(spacing(&apart, 63).crowd, 1);
        let together = keys((0..50).map(|i| DVec3::splat(if i < 20 { 0.3 } else { f64::from(i) / 50.0 })));
        assert_eq!(spacing(&together, 63).crowd, 20);
    }

    #[test]
    fn one_point_fills_its_cube() {
        assert!(spacing(&keys([DVec3::splat(0.5)].into_iter()), 63).share > 0.5);
    }
}

//! Feet on the floor: whoever walks goes up and down with it, over steps and slopes. Where no floor is within a step, be it a
//! hole in the scan or the edge of a cliff, they walk on through the air at the same height: nothing stops them, and nobody
//! falls.

use super::floors::{Floors, STEP_M};
use glam::{DVec2, DVec3};

/// Longest way that is looked at at once, meters: a step of a staircase is as deep.
const STRIDE_M: f64 = 0.2;
/// Most looks a frame: whoever is faster than a car misses some steps.
const MOST_LOOKS: usize = 40;
/// Seconds in which two thirds of a step are taken; after a tenth of a second next to nothing is left of it.
const RISE_S: f64 = 0.04;
/// What is left of a step that is no longer worth a move, meters.
const NOTHING_M: f64 = 0.0005;

/// The height that feet are on their way to.
#[derive(Clone, Copy, Debug, Default)]
pub struct Feet {
    /// Height of the floor, world space; `None` while they are where they belong.
    level: Option<f64>,
}

impl Feet {
    /// Takes in that the user has been taken elsewhere.
    pub fn forget(&mut self) {
        self.level = None;
    }

    /// Follows the floor from one place of the feet to another at the same height, both in world space. Lengths of the user
    /// are `units_per_m` world units long.
    pub fn walk(&mut self, floors: &Floors, from: DVec3, to: DVec2, units_per_m: f64) {
        let way = to - from.truncate();
        let num_looks =
            (way.length() / (STRIDE_M * units_per_m)).ceil().clamp(1.0, MOST_LOOKS as f64) as usize;
        let step = STEP_M * units_per_m;
        let mut level = self.level.unwrap_or(from.z);
        for look in 1..=num_looks {
            let at = from.truncate() + way * (look as f64 / num_looks as f64);
            if let Some(floor) = floors.nearest(at.extend(level), step, step) {
                level = floor.height;
            }
        }
        self.level = Some(level);
    }

    /// Height by which feet at `height` rise within `seconds`, world units.
    pub fn rise(&mut self, height: f64, seconds: f64, units_per_m: f64) -> f64 {
        let Some(level) = self.level else { return 0.0 };
        let left = level - height;
        if left.abs() <= NOTHING_M * units_per_m {
            self.level = None;
            return left;
        }
        left * (1.0 - (-seconds / RISE_S).exp())
    }
}

#[cfg(test)]
mod tests {
    use super::super::floors::made_up::{MadeScan, grid};
    use super::*;

    const FRAME_S: f64 = 1.0 / 90.0;

    /// Walks along x at 1.5 meters a second; returns places and heights, in meters.
    fn walked(floors: &Floors, from: DVec3, length_m: f64, units_per_m: f64) -> Vec<[f64; 2]> {
        let (mut feet, mut at) = (Feet::default(), from);
        let step = 1.5 * FRAME_S * units_per_m;
        let mut places = Vec::new();
        for _ in 0..(length_m / 1.5 / FRAME_S) as usize {
            let to = at.truncate() + DVec2::X * step;
            feet.walk(floors, at, to, units_per_m);
            at = to.extend(at.z);
            at.z += feet.rise(at.z, FRAME_S, units_per_m);
            places.push([at.x, at.z].map(|value| value / units_per_m));
        }
        places
    }

    #[test]
    fn feet_go_up_stairs_smoothly_and_stay_up() {
        for units_per_m in [1.0, 1.0 / 0.3048, 1000.0] {
            let mut made = MadeScan::new(DVec3::new(0.0, 0.0, 0.0), units_per_m);
            made.level([0.0, 0.0], [3.0, 3.0], 0.0, 0.03);
            made.stairs([3.0, 0.0], 3.0, 10, 0.17, 0.28, 0.03);
            made.level([5.8, 0.0], [9.0, 3.0], 1.7, 0.03);
            let floors = made.floors();
            let start = DVec3::new(1.0, 1.5, 0.0) * units_per_m;
            let places = walked(&floors, start, 7.0, units_per_m);
            let heights: Vec<f64> = places.iter().map(|[_, z]| *z).collect();
            let most = heights.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
            assert!(most < 0.06, "{units_per_m}: {most}");
            assert!((heights.last().unwrap() - 1.7).abs() < 0.01, "{:?}", heights.last());
            assert!(heights[0].abs() < 0.005, "{}", heights[0]);
        }
    }

    #[test]
    fn nobody_falls_off_a_cliff_or_into_a_hole() {
        let mut made = MadeScan::new(DVec3::new(5e5, 4e6, 300.0), 1.0);
        made.level([0.0, 0.0], [4.0, 4.0], 2.0, 0.03);
        made.level([0.0, 0.0], [12.0, 4.0], 0.0, 0.03);
        // Behind a gap the upper floor goes on.
        made.level([7.0, 0.0], [12.0, 4.0], 2.1, 0.03);
        let floors = made.floors();
        let places = walked(&floors, made.p([1.0, 2.0, 2.0]), 9.0, 1.0);
        for [x, z] in places {
            let (x, z) = (x - 5e5, z - 300.0);
            let expected = if x < 7.0 { 2.0 } else { 2.1 };
            assert!((z - expected).abs() < 0.01 || (6.9..7.4).contains(&x), "{x}: {z}");
        }
    }

    #[test]
    fn strays_lift_nobody() {
        let mut made = MadeScan::new(DVec3::ZERO, 1.0);
        made.level([0.0, 0.0], [8.0, 4.0], 0.0, 0.03);
        for [x, y, z] in grid([0.5, 0.5, 0.1], [7.5, 3.5, 2.0], 0.4) {
            made.add([x, y, z]);
        }
        let floors = made.floors();
        let places = walked(&floors, DVec3::new(0.5, 2.0, 0.0), 6.0, 1.0);
        assert!(places.iter().all(|[_, z]| z.abs() < 0.01), "{places:?}");
    }
}

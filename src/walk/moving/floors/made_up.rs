//! Made-up scans for tests of floors: level floors, slopes, stairs and walls, with noise from a seed.

use super::Floors;
use base::random::Rng;
use base::task::Progress;
use glam::DVec3;
use points::{Grid, Scan, ScanBuilder};

/// Steps of the coordinates, meters: a tenth of a millimeter.
const STEP_M: f64 = 1e-4;

/// A scan in the making, in meters from an origin.
pub struct MadeScan {
    origin: DVec3,
    units_per_m: f64,
    points_m: Vec<[f64; 3]>,
    random: Rng,
    /// Noise of the points' heights, meters to each side.
    pub noise_m: f64,
}

/// Places all over a box, `apart` from each other along each axis.
pub fn grid(low: [f64; 3], high: [f64; 3], apart: f64) -> Vec<[f64; 3]> {
    let num = |axis: usize| ((high[axis] - low[axis]) / apart).round().max(0.0) as usize + 1;
    let at = |axis: usize, number: usize| low[axis] + apart * number as f64;
    let plane =
        |z: usize| (0..num(1)).flat_map(move |y| (0..num(0)).map(move |x| [at(0, x), at(1, y), at(2, z)]));
    (0..num(2)).flat_map(plane).collect()
}

impl MadeScan {
    pub fn new(origin: DVec3, units_per_m: f64) -> Self {
        Self { origin, units_per_m, points_m: Vec::new(), random: Rng::new(7, 0), noise_m: 0.004 }
    }

    /// A place in world space.
    pub fn p(&self, p_m: [f64; 3]) -> DVec3 {
        self.origin + DVec3::from_array(p_m) * self.units_per_m
    }

    /// A number from −1 to 1.
    pub fn uniform(&mut self) -> f64 {
        self.random.between(-1.0, 1.0)
    }

    pub fn add(&mut self, p_m: [f64; 3]) {
        self.points_m.push(p_m);
    }

    /// A surface over a rectangle, whose height is a function of the place; points are `apart` from each other.
    pub fn surface(&mut self, low: [f64; 2], high: [f64; 2], apart: f64, height: impl Fn(f64, f64) -> f64) {
        for [x, y, _] in grid([low[0], low[1], 0.0], [high[0], high[1], 0.0], apart) {
            let [dx, dy, dz] = [(); 3].map(|()| self.uniform());
            let (x, y) = (x + 0.4 * apart * dx, y + 0.4 * apart * dy);
            self.points_m.push([x, y, height(x, y) + self.noise_m * dz]);
        }
    }

    pub fn level(&mut self, low: [f64; 2], high: [f64; 2], height: f64, apart: f64) {
        self.surface(low, high, apart, |_, _| height);
    }

    /// Stairs along x from a place on the floor, with risers.
    pub fn stairs(&mut self, from: [f64; 2], width: f64, num: usize, rise: f64, tread: f64, apart: f64) {
        for step in 0..num {
            let (x, z) = (from[0] + tread * step as f64, rise * (step + 1) as f64);
            self.level([x, from[1]], [x + tread, from[1] + width], z, apart);
            for [x, y, z] in grid([x, from[1], z - rise], [x, from[1] + width, z], apart) {
                self.add([x, y, z]);
            }
        }
    }

    /// A wall between two places, from one height to another.
    pub fn wall(&mut self, from: [f64; 2], to: [f64; 2], heights: [f64; 2], apart: f64) {
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        for [along, z, _] in grid([0.0, heights[0], 0.0], [length, heights[1], 0.0], apart) {
            let part = along / length;
            let off = self.noise_m * self.uniform();
            let at = |axis: usize| from[axis] + (to[axis] - from[axis]) * part + off;
            self.points_m.push([at(0), at(1), z]);
        }
    }

    /// Walls round a rectangle.
    pub fn walls(&mut self, low: [f64; 2], high: [f64; 2], heights: [f64; 2], apart: f64) {
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
        for side in 0..4 {
            self.wall(corners[side], corners[(side + 1) % 4], heights, apart);
        }
    }

    pub fn scan(&self) -> Scan {
        let scale = STEP_M * self.units_per_m;
        let steps = |p: &[f64; 3]| p.map(|value| (value / STEP_M).round() as i32);
        let grid = Grid { scale: DVec3::splat(scale), offset: self.origin };
        ScanBuilder::new(grid, self.points_m.iter().map(steps).collect()).scan()
    }

    pub fn floors(&self) -> Floors {
        Floors::of(&self.scan(), self.units_per_m, &Progress::hidden()).expect("nobody cancels")
    }
}

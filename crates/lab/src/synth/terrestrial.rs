//! A terrestrial laser scanner on two stations in the courtyard.
//!
//! A mirror turns about a horizontal axis while the head turns about the vertical one. Therefore the points come in
//! columns of constant azimuth, from −60° (below is the tripod) up to the zenith. Rays go out at equal angles, so the
//! density falls with the square of the distance. Ranges are noisier the farther they are. Some rays hit two surfaces
//! at edges and give a point between them, as with real scanners.

use super::Viewpoint;
use super::courtyard::Courtyard;
use super::device::MeasuringDevice;
use super::material::{Material, rgb};
use super::plan::{LinePlan, Thin};
use super::record::{WrittenFormat, WrittenLayout, WrittenRecord};
use super::span::{Hit, Ray};
use base::random::Rng;
use glam::DVec3;
use points::Grid;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

/// World position of the fountain's foot: coordinates as large as national grids have them.
const ORIGIN: DVec3 = DVec3::new(500_000.0, 4_000_000.0, 100.0);
/// Place of the scanner's mirror on each station, in courtyard coordinates: on the paving, and in the hall's doorway,
/// each 1.6 m above the floor.
const STATIONS: [DVec3; 2] = [DVec3::new(-4.2, -1.2, 1.6), DVec3::new(15.28, 0.15, 1.75)];
/// Azimuth at which each station begins.
const START: [f64; 2] = [0.4, 2.1];
/// Lowest elevation.
const LOWEST: f64 = -PI / 3.0;
/// Angle from the lowest elevation to the zenith.
const SWEEP: f64 = PI / 3.0 + PI / 2.0;
/// Range of the scanner; farther surfaces send too little light back.
const RANGE_M: f64 = 150.0;
/// Pulses a second.
const PULSES_PER_S: f64 = 1e6;
/// GPS seconds: start of the first station, and time between the starts of the stations.
const TIMES_S: [f64; 2] = [330_000_000.0, 900.0];
/// Trial columns of a station, and rays in each column.
const TRIALS: [u32; 2] = [360, 90];

const fn place(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(ORIGIN.x + x, ORIGIN.y + y, ORIGIN.z + z)
}

/// Good places to stand.
pub const VIEWPOINTS: [Viewpoint; 6] = [
    Viewpoint { name: "overview", eye: place(-10.6, -8.0, 5.6), target: place(2.2, 1.6, 1.6) },
    Viewpoint { name: "court", eye: place(-5.2, -1.5, 1.75), target: place(4.0, 2.0, 2.3) },
    Viewpoint { name: "arcade", eye: place(13.9, -4.8, 1.85), target: place(11.4, 3.0, 2.0) },
    Viewpoint { name: "hall", eye: place(16.3, -3.6, 1.85), target: place(20.4, 1.6, 1.25) },
    Viewpoint { name: "stair", eye: place(-2.0, -0.6, 1.7), target: place(-6.2, 8.6, 3.0) },
    Viewpoint { name: "terrace", eye: place(-7.6, 10.2, 6.3), target: place(4.0, -2.0, 1.0) },
];

/// The scanner and its plan.
pub struct Scanner {
    court: &'static Courtyard,
    plan: LinePlan,
}

impl Scanner {
    /// Makes a scanner that will measure this many points in all.
    pub fn new(points: u64) -> Self {
        // The share of each direction's rays that return anything is the same every time.
        static WEIGHTS: OnceLock<Vec<u32>> = OnceLock::new();
        let court = Courtyard::get();
        let weights = WEIGHTS.get_or_init(|| try_out(court)).clone();
        let rays = points as f64 * f64::from(TRIALS[1]) * weights.len() as f64
            / weights.iter().map(|w| f64::from(*w)).sum::<f64>();
        // Angles are equal both ways: columns / rows = full circle / sweep.
        let columns = (rays / STATIONS.len() as f64 * TAU / SWEEP).sqrt().ceil() as u64;
        Self { court, plan: LinePlan::new(points, STATIONS.len() as u64, columns, weights) }
    }

    fn ray(&self, station: usize, column: f64, row: f64) -> Ray {
        let clockwise = START[station] - TAU * column;
        let ((sin_a, cos_a), (sin_e, cos_e)) = (libm::sincos(clockwise), libm::sincos(LOWEST + SWEEP * row));
        Ray { origin: STATIONS[station], direction: DVec3::new(cos_e * cos_a, cos_e * sin_a, sin_e) }
    }

    /// Collects all that one column hits with `rows` rays: the row, the surface and its material.
    fn column(&self, station: usize, column: f64, rows: u64, hits: &mut Vec<(u64, Hit, Material)>) {
        hits.clear();
        for row in 0..rows {
            let ray = self.ray(station, column, (row as f64 + 0.5) / rows as f64);
            if let Some((hit, material)) = self.court.nearest(&ray, RANGE_M) {
                hits.push((row, hit, material));
            }
        }
    }
}

/// Hits of the trial columns, by which the points are shared out.
fn try_out(court: &Courtyard) -> Vec<u32> {
    let bins = (0..STATIONS.len() * TRIALS[0] as usize).into_par_iter();
    let probe = Scanner { court: Courtyard::get(), plan: LinePlan::new(1, 1, 1, vec![1]) };
    bins.map(|bin| {
        let (station, column) = (bin / TRIALS[0] as usize, bin % TRIALS[0] as usize);
        let column = (column as f64 + 0.5) / f64::from(TRIALS[0]);
        let hit = |row: &u32| {
            let ray = probe.ray(station, column, (f64::from(*row) + 0.5) / f64::from(TRIALS[1]));
            court.nearest(&ray, RANGE_M).is_some()
        };
        (0..TRIALS[1]).filter(hit).count() as u32
    })
    .collect()
}

impl MeasuringDevice for Scanner {
    fn layout(&self) -> WrittenLayout {
        WrittenLayout {
            format: WrittenFormat::Rgb7,
            grid: Grid { scale: DVec3::splat(0.0001), offset: ORIGIN },
        }
    }

    fn plan(&self) -> &LinePlan {
        &self.plan
    }

    fn measure(&self, line: u64, num_points: u64, rng: &mut Rng, out: &mut Vec<WrittenRecord>) {
        let (pass, number) = self.plan.pass_and_line(line);
        let (station, lines) = (pass as usize, self.plan.lines_per_pass() as f64);
        let column = (number as f64 + 0.5) / lines;
        let share = f64::from(self.plan.weight(line).max(1)) / f64::from(TRIALS[1]);
        let mut rows = (num_points as f64 / share * 1.01).ceil() as u64 + 1;
        let mut hits = Vec::new();
        self.column(station, column, rows, &mut hits);
        // Rows get closer where a direction sees more sky than the trial did. This ends, since the lowest third of
        // every column meets the ground.
        while (hits.len() as u64) < num_points {
            rows += rows / 8 + 1;
            self.column(station, column, rows, &mut hits);
        }
        let grid = self.layout().grid;
        let start = TIMES_S[0] + TIMES_S[1] * pass as f64;
        let column_s = SWEEP / TAU * lines / PULSES_PER_S;
        let mut thin = Thin::new(num_points, hits.len() as u64);
        let mut last: Option<(u64, DVec3)> = None;
        for (row, hit, material) in &hits {
            let part = (*row as f64 + 0.5) / rows as f64;
            let ray = self.ray(station, column, part);
            let neighbor = last.filter(|(r, _)| r + 1 == *row).map(|(_, p)| p);
            last = Some((*row, ray.at(hit.t)));
            if thin.next(1) == 0 {
                continue;
            }
            let range = hit.t + neighbor.map_or(0.0, |p| mixed(p, &ray, hit, rng));
            let noisy = range + (0.0012 + 0.000_08 * range) * rng.normal();
            let p = ORIGIN + ray.at(noisy);
            out.push(WrittenRecord {
                xyz: WrittenRecord::snap(&grid, p),
                intensity: intensity(hit, &ray, material, rng),
                return_number: 1,
                num_returns: 1,
                class: 0,
                forward: true,
                scan_angle_deg: 0.0,
                source: station as u16 + 1,
                gps_time: start + (number as f64 + part) * column_s,
                rgb: self.photo(&ray, hit, material, rng),
            });
        }
    }
}

impl Scanner {
    /// The surface's color as the scanner's camera has it: 16 bits, overexposed softly.
    fn photo(&self, ray: &Ray, hit: &Hit, material: &Material, rng: &mut Rng) -> [u16; 3] {
        let color = self.court.color(ray.at(hit.t), hit.normal, material);
        let haze = rgb(196, 208, 220);
        let color = color + (haze - color) * (hit.t / 900.0).min(1.0);
        let grain = 1.0 + 0.012 * rng.normal();
        // The curve is straight up to 0.8, then bends toward 1.
        let expose = |c: f64| if c < 0.8 { c } else { 1.0 - 0.04 / (c - 0.6) };
        (color * grain).to_array().map(|c| (65_535.0 * expose(c.max(0.0)).clamp(0.0, 1.0)).round() as u16)
    }
}

/// Length by which a beam measures farther (or nearer) than `hit`: sometimes, if it grazes an edge, it measures
/// something between the edge's two surfaces. `neighbor` is what the ray before met.
fn mixed(neighbor: DVec3, ray: &Ray, hit: &Hit, rng: &mut Rng) -> f64 {
    let off_plane = (neighbor - ray.at(hit.t)).dot(hit.normal).abs();
    let gap = neighbor.distance(ray.origin) - hit.t;
    let grazes = off_plane > 0.08 && gap.abs() < 4.0;
    if grazes && rng.unit() < 0.05 { gap * rng.unit() } else { 0.0 }
}

/// Intensity of the light that returns: less from dark, slanted and far surfaces.
fn intensity(hit: &Hit, ray: &Ray, material: &Material, rng: &mut Rng) -> u16 {
    let facing = hit.normal.dot(ray.direction).abs();
    let far = 1.0 / (1.0 + (hit.t / 30.0) * (hit.t / 30.0));
    let value = material.reflectance() * (0.25 + 0.75 * facing) * far * (1.0 + 0.03 * rng.normal());
    (60_000.0 * value).clamp(1.0, 65_535.0) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_turn_clockwise_and_their_points_rise() {
        let scanner = Scanner::new(20_000);
        let plan = scanner.plan();
        for pass in 0..2 {
            let station = STATIONS[pass as usize];
            let mut last_turn = -1.0;
            for number in 0..plan.lines_per_pass() {
                let line = pass * plan.lines_per_pass() + number;
                let count = plan.first_point(line + 1) - plan.first_point(line);
                let mut points = Vec::new();
                scanner.measure(line, count, &mut Rng::new(9, line), &mut points);
                assert_eq!(points.len() as u64, count);
                let from_station =
                    |r: &WrittenRecord| scanner.layout().grid.p_in_world(r.xyz) - ORIGIN - station;
                let mut last_rise = -2.0;
                for d in points.iter().map(from_station) {
                    // Snapping to the file's grid moves the angles a little.
                    let rise = d.z / d.length();
                    assert!(rise > last_rise - 2e-4, "{rise} after {last_rise}");
                    last_rise = rise;
                    if d.truncate().length() > 1.0 {
                        let turn = (START[pass as usize] - d.y.atan2(d.x)).rem_euclid(TAU);
                        assert!(turn > last_turn - 2e-4, "{turn} after {last_turn}");
                        last_turn = last_turn.max(turn);
                    }
                }
            }
            assert!(last_turn > 0.95 * TAU);
        }
    }

    #[test]
    fn stations_stand_free_at_eye_height() {
        for (station, floor) in STATIONS.iter().zip([0.0, 0.15]) {
            let down = Ray { origin: *station, direction: DVec3::NEG_Z };
            let (hit, _) = Courtyard::get().nearest(&down, RANGE_M).unwrap();
            assert!((hit.t - (station.z - floor)).abs() < 1e-9);
            assert!((hit.t - 1.6).abs() < 1e-9);
        }
    }
}

//! An airborne laser scanner over 1 km² of land: strips flown to and fro, a mirror that swings across.
//!
//! A pulse that meets a crown comes back up to three times: from the leaves, from deeper in, from the ground.

use super::Viewpoint;
use super::device::MeasuringDevice;
use super::landscape::{Cover, Landscape, SIZE_M};
use super::plan::{LinePlan, Thin};
use super::record::{WrittenFormat, WrittenLayout, WrittenRecord};
use super::span::Ray;
use base::random::Rng;
use glam::DVec3;
use points::Grid;
use rayon::prelude::*;
use std::sync::OnceLock;

/// World position of the land's south-west corner.
const ORIGIN: DVec3 = DVec3::new(452_000.0, 5_412_000.0, 280.0);
/// Height of the aircraft above the valley.
const FLIGHT_M: f64 = 650.0;
/// Number of strips; their middles are 200 m apart.
const NUM_STRIPS: u64 = 5;
/// Half the width that a strip covers; neighboring strips overlap.
const HALF_SWATH_M: f64 = 122.0;
/// Speed of the aircraft.
const SPEED_M_PER_S: f64 = 60.0;
/// GPS seconds: start of the first strip, and time from each strip's start to the next one's.
const TIMES_S: [f64; 2] = [330_010_000.0, 240.0];
/// Trial bins of a strip, and pulses in each bin.
const TRIALS: [u32; 2] = [50, 300];

const fn place(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(ORIGIN.x + x, ORIGIN.y + y, ORIGIN.z + z)
}

/// Good places to look from.
pub const VIEWPOINTS: [Viewpoint; 2] = [
    Viewpoint { name: "overview", eye: place(300.0, 60.0, 230.0), target: place(540.0, 560.0, 0.0) },
    Viewpoint { name: "village", eye: place(490.0, 500.0, 48.0), target: place(580.0, 690.0, 8.0) },
];

/// The aircraft and its plan.
pub struct Aircraft {
    land: &'static Landscape,
    plan: LinePlan,
}

/// A return of a pulse, before it becomes a record.
struct Echo {
    p: DVec3,
    class: u8,
    strength: f64,
    color: DVec3,
}

impl Aircraft {
    /// Makes an aircraft that will measure this many points in all.
    pub fn new(points: u64) -> Self {
        static LAND: OnceLock<(Landscape, Vec<u32>)> = OnceLock::new();
        let (land, weights) = LAND.get_or_init(|| {
            let land = Landscape::new();
            let weights = try_out(&land);
            (land, weights)
        });
        let returns = weights.iter().map(|w| f64::from(*w)).sum::<f64>()
            / (f64::from(TRIALS[1]) * weights.len() as f64);
        // Pulses are equally far apart along and across: lines / pulses a line = length / width of a strip.
        let pulses = points as f64 / returns / NUM_STRIPS as f64;
        let lines = (pulses * SIZE_M / (2.0 * HALF_SWATH_M)).sqrt().ceil() as u64;
        Self { land, plan: LinePlan::new(points, NUM_STRIPS, lines, weights.clone()) }
    }
}

/// Unit vector toward the sun, which stands high in the south-east.
fn to_sun() -> DVec3 {
    DVec3::new(0.48, -0.42, 0.77).normalize()
}

/// The ray of a pulse at a place `along` and `across` its strip, from 0 to 1. Strips are flown eastwards and westwards
/// by turns.
fn pulse(strip: u64, along: f64, across: f64) -> Ray {
    let forward = strip.is_multiple_of(2);
    let x = SIZE_M * if forward { along } else { 1.0 - along };
    let middle = SIZE_M * (strip as f64 + 0.5) / NUM_STRIPS as f64;
    let side = HALF_SWATH_M * (2.0 * across - 1.0);
    let direction = DVec3::new(0.0, side, -FLIGHT_M).normalize();
    Ray { origin: DVec3::new(x, middle, FLIGHT_M), direction }
}

/// Collects the returns of a pulse, nearest first; calm water often returns nothing.
fn echoes(land: &Landscape, ray: &Ray, rng: &mut Rng, out: &mut Vec<Echo>) {
    out.clear();
    let at_height = |z: f64| ray.at((z - ray.origin.z) / ray.direction.z);
    // The beam is steep and the land is smooth: a few steps find where they meet.
    let mut ground = at_height(10.0);
    for _ in 0..4 {
        ground = at_height(land.top(ground.truncate()).0);
    }
    let (z, cover) = land.top(ground.truncate());
    ground.z = z;
    if let Some((enter, exit, tree)) = land.crown(ray, ground.truncate())
        && rng.unit() < 0.86
    {
        let mut depth = rng.unit() * rng.unit();
        for _ in 0..2 {
            let p = ray.at(enter + depth.min(1.0) * (exit - enter));
            if p.z < z + 0.3 {
                break;
            }
            let class = if p.z - z < 2.0 { 4 } else { 5 };
            out.push(Echo { p, class, strength: 0.45, color: tree.color(p, to_sun()) });
            depth += 0.15 + 0.7 * rng.unit();
            if depth > 1.0 || rng.unit() < 0.35 {
                break;
            }
        }
        if rng.unit() < 0.42 {
            return;
        }
    }
    let class = cover as u8;
    if cover == Cover::Water && rng.unit() < 0.7 {
        return;
    }
    let color = land.color(ground.truncate(), z, cover, to_sun());
    let strength = if cover == Cover::Water { 0.06 } else { 0.2 + 0.5 * color.y } / (1.0 + out.len() as f64);
    // Some pulses end in grass and crops.
    let grass = cover == Cover::Ground && out.is_empty() && rng.unit() < 0.12;
    let lift = if grass { 0.1 + 0.5 * rng.unit() } else { 0.0 };
    out.push(Echo { p: ground + lift * DVec3::Z, class: if grass { 3 } else { class }, strength, color });
}

/// Returns of trial pulses in each bin of each strip, by which the points are shared out.
fn try_out(land: &Landscape) -> Vec<u32> {
    let bins = (0..NUM_STRIPS * u64::from(TRIALS[0])).into_par_iter();
    bins.map(|bin| {
        let (strip, place) = (bin / u64::from(TRIALS[0]), bin % u64::from(TRIALS[0]));
        let (mut rng, mut found, mut count) = (Rng::new(1, bin), Vec::new(), 0);
        for _ in 0..TRIALS[1] {
            let along = (place as f64 + rng.unit()) / f64::from(TRIALS[0]);
            echoes(land, &pulse(strip, along, rng.unit()), &mut rng, &mut found);
            count += found.len() as u32;
        }
        count
    })
    .collect()
}

impl MeasuringDevice for Aircraft {
    fn layout(&self) -> WrittenLayout {
        WrittenLayout {
            format: WrittenFormat::Rgb7,
            grid: Grid { scale: DVec3::splat(0.001), offset: ORIGIN },
        }
    }

    fn plan(&self) -> &LinePlan {
        &self.plan
    }

    fn measure(&self, line: u64, num_points: u64, rng: &mut Rng, out: &mut Vec<WrittenRecord>) {
        let returns = f64::from(self.plan.weight(line).max(1)) / f64::from(TRIALS[1]);
        let mut pulses = (1.02 * num_points as f64 / returns).ceil() as u64 + 1;
        let start = rng.clone();
        let first = out.len();
        loop {
            *rng = start.clone();
            let all = self.sweep(line, pulses, rng);
            let total: u64 = all.iter().map(|(_, _, echoes)| echoes.len() as u64).sum();
            // If too few returns came back, more pulses are sent. This ends, since every line crosses dry land.
            if total < num_points {
                pulses += pulses / 8 + 1;
                continue;
            }
            let mut thin = Thin::new(num_points, total);
            for (part, ray, echoes) in &all {
                let stay = thin.next(echoes.len() as u64) as usize;
                self.store(line, *part, ray, &echoes[..stay], rng, out);
            }
            debug_assert_eq!((out.len() - first) as u64, num_points);
            return;
        }
    }
}

impl Aircraft {
    /// One swing of the mirror: for each pulse its place in the line, the ray, and what came back.
    fn sweep(&self, line: u64, pulses: u64, rng: &mut Rng) -> Vec<(f64, Ray, Vec<Echo>)> {
        let (strip, number) = self.plan.pass_and_line(line);
        let mut all = Vec::with_capacity(pulses as usize);
        for i in 0..pulses {
            let part = (i as f64 + 0.5) / pulses as f64;
            let along = (number as f64 + part) / self.plan.lines_per_pass() as f64;
            // The mirror swings to and fro.
            let across = if number.is_multiple_of(2) { part } else { 1.0 - part };
            let ray = pulse(strip, along, across);
            let mut echoes = Vec::new();
            self::echoes(self.land, &ray, rng, &mut echoes);
            all.push((part, ray, echoes));
        }
        all
    }

    /// Appends the returns of a pulse; the weakest may have been lost.
    fn store(
        &self,
        line: u64,
        part: f64,
        ray: &Ray,
        echoes: &[Echo],
        rng: &mut Rng,
        out: &mut Vec<WrittenRecord>,
    ) {
        let (strip, number) = self.plan.pass_and_line(line);
        let (grid, lines) = (self.layout().grid, self.plan.lines_per_pass() as f64);
        let left = if strip.is_multiple_of(2) { 1.0 } else { -1.0 };
        let angle = -left * libm::atan2(ray.direction.y, -ray.direction.z).to_degrees();
        for (i, echo) in echoes.iter().enumerate() {
            let p = echo.p + 0.025 * rng.normal() * ray.direction;
            let strength = 42_000.0 * echo.strength * (1.0 + 0.06 * rng.normal());
            let color = echo.color * (1.0 + 0.02 * rng.normal());
            out.push(WrittenRecord {
                xyz: WrittenRecord::snap(&grid, ORIGIN + p),
                intensity: strength.clamp(1.0, 65_535.0) as u16,
                return_number: i as u8 + 1,
                num_returns: echoes.len() as u8,
                class: echo.class,
                forward: number.is_multiple_of(2),
                scan_angle_deg: angle as f32,
                source: strip as u16 + 1,
                gps_time: TIMES_S[0]
                    + TIMES_S[1] * strip as f64
                    + SIZE_M / SPEED_M_PER_S * (number as f64 + part) / lines,
                rgb: color.to_array().map(|c| (65_535.0 * c.clamp(0.0, 1.0)).round() as u16),
            });
        }
    }
}

//! Light of a scene: the sun with its shadows, and the light of the sky and of sunlit surfaces, kept as a coarse grid
//! of probes.

use super::bvh::Bvh;
use super::span::Ray;
use base::random::Rng;
use base::space::Bounds;
use glam::DVec3;
use rayon::prelude::*;

/// Color and strength of the sun's light.
pub const SUN_COLOR: DVec3 = DVec3::new(1.12, 1.0, 0.80);
/// Color of the light of sky and walls.
pub const SKY_COLOR: DVec3 = DVec3::new(0.74, 0.82, 0.98);
/// Distance beyond which nothing throws a shadow.
const REACH_M: f64 = 80.0;
/// Distance between neighboring probes.
const PROBE_STEP_M: f64 = 1.0;
/// Rays that a probe sends out.
const PROBE_RAYS: u32 = 32;

/// Light of sky and walls at one place: strength toward every direction to first order, so that
/// irradiance / π at unit normal n is `mean + 2·n·slope`.
#[derive(Clone, Copy, Debug)]
struct Probe {
    mean: f64,
    slope: DVec3,
    /// True if the probe is not in a wall.
    free: bool,
}

/// Sun and probes.
#[derive(Clone, Debug)]
pub struct Light {
    to_sun: DVec3,
    min: DVec3,
    num: [usize; 3],
    probes: Vec<Probe>,
}

impl Light {
    /// Lights the scene in `around`.
    pub fn new(scene: &Bvh, to_sun: DVec3, around: Bounds) -> Self {
        let num = (around.size() / PROBE_STEP_M).ceil().to_array().map(|n| n as usize + 1);
        let count = num[0] * num[1] * num[2];
        let probes = (0..count).into_par_iter().map(|i| {
            let cell = [i % num[0], i / num[0] % num[1], i / num[0] / num[1]];
            let p = around.min + PROBE_STEP_M * DVec3::from_array(cell.map(|c| c as f64));
            gather(scene, to_sun, p, &mut Rng::new(0, i as u64))
        });
        Self { to_sun, min: around.min, num, probes: probes.collect() }
    }

    /// Light that falls on a surface at `p` with unit normal `normal`; `thin` lets the sun shine through
    /// from behind, as leaves do.
    pub fn at(&self, scene: &Bvh, p: DVec3, normal: DVec3, thin: bool) -> DVec3 {
        let toward = normal.dot(self.to_sun);
        let facing = if thin { (0.25 + 0.75 * toward).max(0.35 * -toward) } else { toward };
        let sun = if facing <= 0.0 {
            0.0
        } else {
            let start = p + 1e-3 * normal;
            let clear = !scene.blocked(&Ray { origin: start, direction: self.to_sun }, REACH_M);
            if clear { facing } else { 0.0 }
        };
        exposed(sun * SUN_COLOR + self.ambient(p, normal) * SKY_COLOR)
    }

    /// Strength of sky and walls at `p`, seen half a step in front of the surface; only free probes count.
    fn ambient(&self, p: DVec3, normal: DVec3) -> f64 {
        let g = (p + 0.5 * PROBE_STEP_M * normal - self.min) / PROBE_STEP_M;
        let cell = g.floor();
        let f = g - cell;
        let (mut sum, mut weights) = (0.0, 0.0);
        for corner in 0..8_usize {
            let bit = |axis: usize| (corner >> axis & 1) as f64;
            let at = |axis: usize| (cell[axis] + bit(axis)).clamp(0.0, (self.num[axis] - 1) as f64) as usize;
            let probe = &self.probes[at(0) + self.num[0] * (at(1) + self.num[1] * at(2))];
            let weight: f64 = (0..3).map(|a| if bit(a) > 0.0 { f[a] } else { 1.0 - f[a] }).product();
            if probe.free {
                sum += weight * (probe.mean + 2.0 * normal.dot(probe.slope)).max(0.0);
                weights += weight;
            }
        }
        // No probe is free deep in a corner, where some light still arrives.
        0.05 + if weights > 1e-3 { sum / weights } else { 0.1 }
    }
}

/// Light as the camera shows it, which takes dark places at a longer exposure too and lifts them.
fn exposed(light: DVec3) -> DVec3 {
    let dark = light.y / 0.15;
    light * (1.0 + 3.2 / (1.0 + dark * dark))
}

/// Looks round from `p`: sky is bright, sunlit surfaces reflect, the rest is dim.
fn gather(scene: &Bvh, to_sun: DVec3, p: DVec3, rng: &mut Rng) -> Probe {
    let (mut mean, mut slope) = (0.0, DVec3::ZERO);
    for _ in 0..PROBE_RAYS {
        let direction = rng.direction();
        let seen = match scene.nearest(&Ray { origin: p, direction }, REACH_M) {
            None => 0.55 + 0.25 * direction.z,
            Some((hit, _)) => {
                let origin = p + (hit.t - 1e-3) * direction;
                let facing = hit.normal.dot(to_sun);
                let sunlit = facing > 0.0 && !scene.blocked(&Ray { origin, direction: to_sun }, REACH_M);
                0.09 + if sunlit { 0.5 * facing } else { 0.0 }
            }
        };
        mean += seen / f64::from(PROBE_RAYS);
        slope += seen / f64::from(PROBE_RAYS) * direction;
    }
    Probe { mean, slope, free: !scene.contains(p) }
}

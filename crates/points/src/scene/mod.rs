//! The scene of a scan: what a person means by it, without the strays that stretch its box.
//!
//! Strays are points that empty space, large against the scene, parts from it: a bird, a scanner's zeros, noise
//! above the clouds, a file that was given by mistake. They are drawn like all others, but where a walk begins, what a
//! picture shows, how fast one flies and how far ramps of colors reach goes by the scene alone, found once, here.

mod cluster;
mod fog;
mod nearest;
#[cfg(test)]
mod random;
mod rays;
mod scattered;
mod sites;

pub(crate) use cluster::find;

use super::{PlacedStation, Scan, ScanFile, color};
use base::space::Bounds;
use glam::DVec3;
use rayon::prelude::*;

/// Points looked at, of all files together.
const NUM_SAMPLES: usize = 1 << 17;
/// Fewest points looked at of each file, if it has as many.
const NUM_FILE_SAMPLES: usize = 64;
/// Where not all points are looked at, points within this many edges of the samples' box belong to the scene.
const MARGIN: f64 = 0.25;
/// Nothing is astray if nothing lies further away than this many edges.
const FAR: f64 = 1.0;

/// Edge of a scene in world units below which it is a point: no scan is smaller, and a f32 still holds its square.
const SMALLEST: f64 = 1e-18;

/// What a person means by a scan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// True box of the scene's points, in world space.
    pub bounds: Bounds,
    /// World positions of some of the scene's points, at most about 130 000, evenly from the files.
    pub samples: Vec<DVec3>,
    /// Points of the scene, as far as the samples tell.
    pub num_points: u64,
    /// Where the scan was measured and photographed from, within the scene.
    pub stations: Vec<PlacedStation>,
}

impl Scene {
    /// The scene of a scan, and sentences about files that lie far away from it.
    #[must_use]
    pub fn of(scan: &Scan) -> (Self, Vec<String>) {
        let num_points = scan.num_points();
        let looked_at = |noise| -> Vec<Vec<DVec3>> {
            scan.files.par_iter().map(|file| samples(file, num_points, noise)).collect()
        };
        let mut samples = looked_at(false);
        let is_all_noise = samples.iter().all(Vec::is_empty);
        if is_all_noise {
            samples = looked_at(true);
        }
        let boxes: Vec<Bounds> =
            samples.par_iter().map(|samples| find(samples.clone()).unwrap_or_default()).collect();
        let (larger, warnings) = sites::larger(scan, &boxes);
        let mut num_scene_points = 0;
        for (file, samples) in samples.iter_mut().enumerate() {
            let bounds = if larger.contains(&file) { boxes[file] } else { Bounds::EMPTY };
            samples.retain(|&p| bounds.contains(p));
            num_scene_points += (samples.len() * run(num_points, scan.files[file].points.xyz.len())) as u64;
        }
        let (mut samples, is_all) = (samples.concat(), run(num_points, usize::MAX) == 1);
        let around = find(samples.clone()).unwrap_or_default();
        let files: Vec<&ScanFile> = larger.into_iter().map(|file| &scan.files[file]).collect();
        let margin = if is_all { 0.0 } else { MARGIN };
        let bounds = exact(&files, &around, margin, is_all_noise);
        samples.retain(|&p| bounds.contains(p));
        let of_file = |file: &ScanFile| -> Vec<PlacedStation> {
            file.stations.iter().filter_map(|station| station.placed(&file.world_from_file)).collect()
        };
        let mut stations: Vec<PlacedStation> = scan.files.iter().flat_map(of_file).collect();
        // Scanners and cameras stand at the edge of what they see, and drones above it.
        let reach = bounds.grown(bounds.edge());
        stations.retain(|station| reach.contains(station.p_in_world));
        (Self { bounds, samples, num_points: num_scene_points, stations }, warnings)
    }

    /// The scene of points of which all are samples.
    #[must_use]
    pub fn around(samples: Vec<DVec3>) -> Self {
        let stations = Vec::new();
        Self { bounds: Bounds::around(&samples), num_points: samples.len() as u64, samples, stations }
    }

    /// The part of the scene whose samples are kept.
    #[must_use]
    pub fn part(&self, is_kept: impl Fn(&DVec3) -> bool) -> Self {
        let samples: Vec<DVec3> = self.samples.iter().filter(|p| is_kept(p)).copied().collect();
        let points_per_sample = self.num_points as f64 / self.samples.len().max(1) as f64;
        let part = Self::around(samples);
        let num_points = (points_per_sample * part.samples.len() as f64) as u64;
        Self { num_points, stations: self.stations.clone(), ..part }
    }

    /// The values along an axis below which a quarter, half and three quarters of the scene's points are; `None` if it
    /// has no points.
    #[must_use]
    pub fn quarters(&self, axis: usize) -> Option<[f64; 3]> {
        let mut values: Vec<f64> = self.samples.iter().map(|p| p[axis]).collect();
        let last = values.len().checked_sub(1)?;
        Some([1, 2, 3].map(|quarter| *values.select_nth_unstable_by(last * quarter / 4, f64::total_cmp).1))
    }

    /// True if all points are in one place, or so near to each other that they might as well be: the GPU's numbers have
    /// no room for a picture of them.
    #[must_use]
    pub fn is_a_point(&self) -> bool {
        self.bounds.edge() < SMALLEST
    }

    /// True if the scene has no points.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }
}

impl Scan {
    /// The scan with its scene, and with ramps that reach over it.
    #[must_use]
    pub(super) fn with_scene(mut self) -> Self {
        let (scene, warnings) = Scene::of(&self);
        let of_ranges = color::share_ranges(&mut self.files, &scene.bounds);
        self.scene = scene;
        self.warnings.extend(warnings.into_iter().chain(of_ranges));
        self
    }
}

/// Length of the runs of a file's points, of each of which one point is looked at.
fn run(num_points: usize, num_file_points: usize) -> usize {
    (num_points / NUM_SAMPLES).min(num_file_points / NUM_FILE_SAMPLES).max(1)
}

/// Positions from all over a file of a scan of `num_points`, with or without noise. One of each run of equal length is
/// taken, not always the same one, because scanners write columns of equal length too.
fn samples(file: &ScanFile, num_points: usize, with_noise: bool) -> Vec<DVec3> {
    let xyz = &file.points.xyz;
    let run = run(num_points, xyz.len());
    let golden = |number: usize| (number as f64 * 0.618_033_988_749_895).fract();
    let at = |number: usize| (number * run + (golden(number) * run as f64) as usize).min(xyz.len() - 1);
    let numbers = (0..xyz.len().div_ceil(run)).map(at);
    let numbers = numbers.filter(|&number| with_noise || !file.points.noise.get(number));
    numbers.map(|number| file.grid.p_in_world(xyz[number])).collect()
}

/// The box of all points, with or without noise, if none is far from the box of samples; otherwise of the points within
/// a margin of that box.
fn exact(files: &[&ScanFile], samples: &Bounds, margin: f64, with_noise: bool) -> Bounds {
    let all = files.iter().fold(Bounds::EMPTY, |bounds, file| bounds.union(file.bounds));
    let far = samples.grown(FAR * samples.edge());
    let counts = |file: &ScanFile, number| with_noise || !file.points.noise.get(number);
    let has_noise = !with_noise && files.iter().any(|file| file.points.noise.count() > 0);
    if !has_noise && far.contains(all.min) && far.contains(all.max) {
        return all;
    }
    let margin = if far.contains(all.min) && far.contains(all.max) { FAR } else { margin };
    let near = samples.grown(margin * samples.edge());
    let of_file = |file: &&ScanFile| {
        let counted = file.points.xyz.par_iter().enumerate().filter(|(number, _)| counts(file, *number));
        let positions = counted.map(|(_, &xyz)| file.grid.p_in_world(xyz));
        let inside = positions.filter(|&p| near.contains(p));
        inside.fold(|| Bounds::EMPTY, Bounds::with).reduce(|| Bounds::EMPTY, Bounds::union)
    };
    files.iter().map(of_file).fold(Bounds::EMPTY, Bounds::union)
}

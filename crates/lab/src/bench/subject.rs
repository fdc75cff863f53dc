//! The scan that is measured with, in any order, and the places that it is drawn from.

use super::BenchOptions;
use crate::order::Order;
use crate::synth::{self, SynthKind, SynthOptions};
use anyhow::Result;
use base::output::Output;
use base::space::{Bounds, Eye, Fov, Pose, View};
use base::task::{Progress, Task};
use cloud::Cloud;
use cloud::octree::{Octree, build_octree};
use cloud::spt::{SequentialCloud, build_spt};
use glam::DVec3;
use points::{self, ReadOptions, Scan};
use std::path::{Path, PathBuf};

/// Seed of made-up scans, always the same.
const SEED: u64 = 1;
const NEAR_M: f64 = 0.05;
/// Vertical field of view of pictures with one eye.
const FOV_Y_DEG: f64 = 60.0;
/// Half angles of a headset's left eye in degrees: outer, inner, up, down.
const HEADSET_DEG: [f64; 4] = [50.0, 45.0, 48.0, 50.0];
const EYE_DISTANCE_M: f64 = 0.063;

/// The model that is measured with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// Made up: a terrestrial scan.
    Courtyard,
    /// Made up: an aerial scan.
    Landscape,
    /// Made up: photogrammetry.
    Statue,
    /// The user's scan.
    Scan,
}

impl Model {
    /// The name in rows.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Courtyard => "courtyard",
            Self::Landscape => "landscape",
            Self::Statue => "statue",
            Self::Scan => "scan",
        }
    }
}

/// Where the camera stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// `overview`, `close-up`, `outside-frustum`; made-up scans have further places with names of their own.
    pub name: &'static str,
    /// Position of the camera in world space.
    pub eye: DVec3,
    /// Position in world space that the camera looks at.
    pub target: DVec3,
}

/// A scan to measure with.
pub struct Subject {
    /// The model that it is.
    pub model: Model,
    scan: Scan,
    places: Vec<Camera>,
}

impl Subject {
    /// Makes up a scan of this many points.
    ///
    /// # Errors
    /// If there is no room for its file, or if the task is cancelled.
    pub fn made_up(model: Model, points: u64, task: &Task) -> Result<Self> {
        let (kind, inside) = match model {
            Model::Landscape => (SynthKind::Aerial, "village"),
            Model::Statue => (SynthKind::Photogrammetry, "face"),
            Model::Courtyard | Model::Scan => (SynthKind::Terrestrial, "hall"),
        };
        let folder = tempfile::tempdir()?;
        let out = folder.path().join("made-up.las");
        let output = Output::new(&out, synth::SCAN)?;
        synth::write(&SynthOptions { kind, out: output, points, seed: SEED }, task)?;
        let scan = points::read(&[out], &ReadOptions::AS_FILES_SAY, task)?;
        let own =
            || synth::viewpoints(kind).iter().map(|p| Camera { name: p.name, eye: p.eye, target: p.target });
        let place = |name| own().find(|place| place.name == name).map(|place| (place.eye, place.target));
        // A made-up scan has places of both names, so the default is never taken.
        let both = place("overview").zip(place(inside)).unwrap_or_default();
        let mut places = places(&scan.scene.bounds, both.0, both.1);
        places.extend(own().filter(|place| place.name != "overview"));
        Ok(Self { model, scan, places })
    }

    /// The places of these names, in their order.
    #[must_use]
    pub fn places(&self, names: &[&str]) -> Vec<Camera> {
        names
            .iter()
            .filter_map(|name| self.places.iter().find(|place| place.name == *name).copied())
            .collect()
    }

    /// Reads a scan from a file.
    ///
    /// # Errors
    /// If it cannot be read or is empty.
    pub fn read(path: &Path, options: &BenchOptions, task: &Task) -> Result<Self> {
        let paths: [PathBuf; 1] = [path.to_owned()];
        let scan = points::read(&paths, &options.read, task)?;
        let cloud = Order::Original.build(&scan, &Progress::silent(task.cancel_token()))?;
        let [overview, inside] = (options.eyes)(&cloud.scene, scan.unit_m.unwrap_or(1.0));
        let (center, ahead) = (cloud.scene.bounds.center(), inside + DVec3::Y);
        let places = places(&scan.scene.bounds, (overview, center), (inside, ahead));
        Ok(Self { model: Model::Scan, scan, places })
    }

    /// Points of the scan.
    #[must_use]
    pub fn num_points(&self) -> u64 {
        self.scan.num_points() as u64
    }

    /// The flat cloud of all points in an order.
    ///
    /// # Errors
    /// If the task is cancelled.
    pub fn flat(&self, order: Order, task: &Task) -> Result<Cloud> {
        let sorting = task.begin("sorting", "points", self.num_points());
        Ok(order.build(&self.scan, &sorting)?)
    }

    /// The flat cloud of all points in Morton order, in batches of `batch_points`.
    ///
    /// # Errors
    /// If the task is cancelled.
    pub fn in_batches(&self, batch_points: u32, task: &Task) -> Result<Cloud> {
        let sorting = task.begin("sorting", "points", self.num_points());
        Ok(cloud::build_rearranged(&self.scan, batch_points, |_, _| {}, &sorting)?)
    }

    /// The sequential point tree.
    ///
    /// # Errors
    /// If the task is cancelled.
    pub fn sequential(&self, task: &Task) -> Result<SequentialCloud> {
        // Progress counts points twice and discs once.
        let building = task.begin("building the point tree", "points", 7 * self.num_points() / 2);
        Ok(build_spt(&self.scan, false, &building)?)
    }

    /// The octree.
    ///
    /// # Errors
    /// If the task is cancelled.
    pub fn layered(&self, task: &Task) -> Result<Octree> {
        let building = task.begin("building the octree", "points", 2 * self.num_points());
        Ok(build_octree(&self.scan, &building)?)
    }
}

fn places(bounds: &Bounds, overview: (DVec3, DVec3), inside: (DVec3, DVec3)) -> Vec<Camera> {
    let (eye, target) = overview;
    let away = (eye - target).normalize_or(DVec3::NEG_Y);
    let outside = bounds.center() + away * bounds.size().length();
    vec![
        Camera { name: "overview", eye, target },
        Camera { name: "close-up", eye: inside.0, target: inside.1 },
        Camera { name: "outside-frustum", eye: outside, target: outside + away },
    ]
}

impl Camera {
    /// The view of one eye at this place.
    #[must_use]
    pub fn mono(&self, size_px: [u32; 2]) -> View {
        let [width, height] = size_px.map(f64::from);
        let fov = Fov::symmetric(FOV_Y_DEG.to_radians(), width / height);
        let world_from_view = Pose::look_at(self.eye, self.target, DVec3::Z);
        View { eyes: vec![Eye { world_from_view, fov, size_px, gaze_in_view: Eye::AHEAD }], near: NEAR_M }
    }

    /// The view of both eyes of a headset at this place.
    #[must_use]
    pub fn stereo(&self, size_px: [u32; 2]) -> View {
        let head = Pose::look_at(self.eye, self.target, DVec3::Z);
        let [outer, inner, up, down] = HEADSET_DEG.map(f64::to_radians);
        let left = Fov::from_angles(-outer, inner, up, -down);
        let eye = |side: f64, fov| {
            let sideways = Pose { position: DVec3::X * side * 0.5 * EYE_DISTANCE_M, ..Pose::IDENTITY };
            Eye { world_from_view: head.then(&sideways), fov, size_px, gaze_in_view: Eye::AHEAD }
        };
        View { eyes: vec![eye(-1.0, left), eye(1.0, left.mirrored())], near: NEAR_M }
    }
}

//! The scans that are drawn, and the places that they are drawn from.

use crate::real_scans::{self, ROOM};
use crate::{made_up, reading};
use anyhow::{Context, Result, ensure};
use base::space::{Eye, Fov, Pose, View};
use base::task::Progress;
use cloud::octree::{Octree, build_octree};
use cloud::{self, Cloud};
use glam::DVec3;
use lab::synth::{self, SynthKind, Viewpoint};
use points::Scan;

/// Angle of an eye's image from the axis to each of its edges, in degrees.
const HALF_FOV_DEG: f64 = 45.0;
const NEAR_M: f64 = 0.05;
const SEED: u64 = 1;
/// Names of the made-up scans' viewpoints: of the whole, and close up.
const PLACES: [&str; 4] = ["overview", "hall", "village", "face"];
/// A viewpoint in the room, across it.
const ROOM_PLACES: [Viewpoint; 1] =
    [Viewpoint { name: "room", eye: DVec3::new(6.0, 5.0, 2.4), target: DVec3::new(9.0, 8.0, 2.2) }];
/// The contestants get one point in this many of the real scan. It has no denser scan beside it, so it is the truth
/// itself.
const ROOM_SHARE: usize = 4;

/// What is wrong where the real room is not.
const NO_FOLDER: &str = "SCANWALK_TEST_DATA names no folder of real scans";

/// Where the scan comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScanSource {
    /// A made-up scan.
    Synth(SynthKind),
    /// A real room.
    Room,
}

/// All sources.
pub const SOURCES: [ScanSource; 4] = [
    ScanSource::Synth(SynthKind::Terrestrial),
    ScanSource::Synth(SynthKind::Aerial),
    ScanSource::Synth(SynthKind::Photogrammetry),
    ScanSource::Room,
];

/// A scan as the contestants draw it.
pub struct DrawnScan {
    /// All points, in Morton order.
    pub cloud: Cloud,
    /// The same points as an octree.
    pub octree: Octree,
}

impl DrawnScan {
    /// # Errors
    /// If the scan is empty.
    pub fn new(scan: Scan) -> Result<Self> {
        let cloud = flat(&scan)?;
        Ok(Self { cloud, octree: build_octree(&scan, &Progress::hidden())? })
    }
}

impl ScanSource {
    /// Name in lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Synth(SynthKind::Terrestrial) => "terrestrial",
            Self::Synth(SynthKind::Aerial) => "aerial",
            Self::Synth(SynthKind::Photogrammetry) => "photogrammetry",
            Self::Room => "room",
        }
    }

    /// Viewpoints of the scan.
    pub fn places(self) -> Vec<Viewpoint> {
        match self {
            Self::Synth(kind) => {
                synth::viewpoints(kind).iter().filter(|place| PLACES.contains(&place.name)).copied().collect()
            }
            Self::Room => ROOM_PLACES.to_vec(),
        }
    }

    /// Those of these sources whose name contains `part`.
    ///
    /// # Errors
    /// If a real scan among them is not here: none is left out in silence.
    pub fn named(sources: &[Self], part: &str) -> Result<Vec<Self>> {
        Self::named_among(sources, part, real_scans::named_folder().is_some())
    }

    fn named_among(sources: &[Self], part: &str, has_real_scans: bool) -> Result<Vec<Self>> {
        let named = sources.iter().copied().filter(|source| source.name().contains(part));
        let named: Vec<Self> = named.collect();
        let is_lacking = named.contains(&Self::Room) && !has_real_scans;
        ensure!(!is_lacking, "{NO_FOLDER}; set it, or choose other scans by their names with --scan");
        Ok(named)
    }

    /// The scan that the contestants get, of `points` points if it is made up.
    ///
    /// # Errors
    /// If it cannot be made or read.
    pub fn scan(self, points: u64) -> Result<Scan> {
        match self {
            Self::Synth(kind) => made_up::scan(kind, points, SEED),
            Self::Room => Ok(thinned(room()?)),
        }
    }

    /// The scan that the truth is drawn from, of `points` points if it is made up.
    ///
    /// # Errors
    /// If it cannot be made or read.
    pub fn dense_scan(self, points: u64) -> Result<Scan> {
        match self {
            Self::Synth(kind) => made_up::scan(kind, points, SEED),
            Self::Room => room(),
        }
    }
}

/// All points of a scan, in Morton order.
///
/// # Errors
/// If the scan is empty.
pub fn flat(scan: &Scan) -> Result<Cloud> {
    Ok(cloud::build(scan, &Progress::hidden())?)
}

/// The view of one eye of somebody who stands at a viewpoint, looking ahead.
pub fn view(place: &Viewpoint, size_px: [u32; 2]) -> View {
    let half = HALF_FOV_DEG.to_radians();
    let eye = Eye {
        world_from_view: Pose::look_at(place.eye, place.target, DVec3::Z),
        fov: Fov::from_angles(-half, half, half, -half),
        size_px,
        gaze_in_view: Eye::AHEAD,
    };
    View { eyes: vec![eye], near: NEAR_M }
}

fn room() -> Result<Scan> {
    let folder = real_scans::named_folder().context(NO_FOLDER)?;
    Ok(reading::file(&folder.join(ROOM))?)
}

/// Keeps one point in [`ROOM_SHARE`], in the file's order.
fn thinned(mut scan: Scan) -> Scan {
    fn thin<T: Copy>(column: &mut Vec<T>) {
        *column = column.iter().copied().step_by(ROOM_SHARE).collect();
    }
    for file in &mut scan.files {
        thin(&mut file.points.xyz);
        thin(&mut file.points.rgb);
        thin(&mut file.points.intensity);
    }
    scan
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_real_scan_that_is_not_here_is_an_error() {
        let named = |part, has_real_scans| ScanSource::named_among(&SOURCES, part, has_real_scans);
        assert_eq!(named("", true).unwrap(), SOURCES);
        assert_eq!(named("aerial", false).unwrap(), [ScanSource::Synth(SynthKind::Aerial)]);
        let error = named("", false).unwrap_err().to_string();
        assert!(error.contains("SCANWALK_TEST_DATA") && error.contains("--scan"), "{error}");
    }
}

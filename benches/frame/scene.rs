//! The made-up scan that is drawn, and the places that it is drawn from.

use anyhow::Result;
use base::space::{Eye, Fov, Pose, View};
use glam::DVec3;
use kit::made_up;
use kit::quality::scene::DrawnScan;
use lab::synth::{self, SynthKind, Viewpoint};

/// Names of the viewpoints: one of the whole, and one inside, where culling matters.
const VIEWPOINTS: [&str; 2] = ["overview", "hall"];
/// Angles of an eye's image in degrees, as headsets have them: outer, inner, up and down.
const FOV_DEG: [f64; 4] = [50.0, 45.0, 48.0, 50.0];
/// Distance between the eyes.
const EYE_DISTANCE_M: f64 = 0.063;
const NEAR_M: f64 = 0.05;
const SEED: u64 = 1;

/// A courtyard as a scanner sees it, of exactly this many points: the same place whatever their number, only denser.
///
/// # Errors
/// If there is no room for its file.
pub fn courtyard(points: u64) -> Result<DrawnScan> {
    DrawnScan::new(made_up::scan(SynthKind::Terrestrial, points, SEED)?)
}

/// The viewpoints to draw from.
pub fn viewpoints() -> impl Iterator<Item = &'static Viewpoint> {
    synth::viewpoints(SynthKind::Terrestrial).iter().filter(|place| VIEWPOINTS.contains(&place.name))
}

/// The view of both eyes of somebody who stands at a viewpoint.
pub fn view(place: &Viewpoint, size_px: [u32; 2]) -> View {
    let head = Pose::look_at(place.eye, place.target, DVec3::Z);
    let [outer, inner, up, down] = FOV_DEG.map(f64::to_radians);
    let eye = |side: f64, fov| {
        let sideways = Pose { position: DVec3::X * side * 0.5 * EYE_DISTANCE_M, ..Pose::IDENTITY };
        Eye { world_from_view: head.then(&sideways), fov, size_px, gaze_in_view: Eye::AHEAD }
    };
    let left = eye(-1.0, Fov::from_angles(-outer, inner, up, -down));
    let right = eye(1.0, Fov::from_angles(-inner, outer, up, -down));
    View { eyes: vec![left, right], near: NEAR_M }
}

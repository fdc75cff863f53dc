//! The simulated headset through which holes are looked for: its settings, and its left eye. The test of holes
//! (`tests/gpu/holes.rs`) has this file too, since the kit cannot name the program.

use base::space::View;
use kit::quality::holes::{self, EMPTY_RGB};
use lab::synth::Viewpoint;
use scanwalk::config::{self, ConfigError};
use scanwalk::resolve::Plan;

/// The plan of the settings of these presets, then of `sets`, in which empty pixels have a color of their own.
pub fn plan(presets: &[&str], sets: &[String]) -> Result<Plan, ConfigError> {
    let presets: Vec<String> = presets.iter().map(|&name| name.to_owned()).collect();
    let mut plan = Plan::of(&config::load(&presets, None, sets)?);
    plan.draw.options.background = EMPTY_RGB;
    Ok(plan)
}

/// The left eye at a place, with `share` of the width and height that it would have.
pub fn left_eye(plan: &Plan, place: &Viewpoint, share: f64) -> View {
    let share = share * plan.headset.resolution_scale;
    holes::left_eye(place, plan.simulated.left_fov, (plan.simulated.size_px, share), plan.draw.near)
}

//! The range of every setting, in one place.

use super::{Config, FoveaConfig, HeadsetConfig, LocomotionConfig, SimulatedConfig};
use std::ops::RangeInclusive;

/// Largest edge of an image or window: what Vulkan drivers draw to.
const MAX_EDGE_PX: u32 = 16_384;

/// A setting whose value makes no sense.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Problem {
    /// Dotted key.
    pub key: &'static str,
    /// Continues a sentence that starts with the key.
    pub problem: String,
}

/// Checks every value that its type leaves too much freedom.
pub(super) fn check(config: &Config) -> Result<(), Problem> {
    let units = [("cloud.unit", config.cloud.unit), ("cloud.vertical_unit", config.cloud.vertical_unit)];
    for (key, unit) in units {
        number(key, unit.metres().unwrap_or(1.0), 1e-9..=1e9)?;
    }
    number("frame.near_m", config.frame.near_m, 1e-6..=1e6)?;
    rings(&config.fovea)?;
    for threshold in config.lod.threshold_px {
        // Below, a pixel could get more points than `color` can add up; see layout::SumsForm.
        number("lod.threshold_px", threshold, 50.0..=10_000.0)?;
    }
    number("lod.error_px", config.lod.error_px, 0.1..=16.0)?;
    number("governor.budget", config.governor.budget, 0.1..=1.0)?;
    let HeadsetConfig { resolution_scale, .. } = config.headset;
    number("headset.resolution_scale", resolution_scale, 0.05..=4.0)?;
    simulated(&config.simulated)?;
    let LocomotionConfig { speed, fast, snap_deg, look_deg_per_px } = config.locomotion;
    number("locomotion.speed", speed, 0.0..=1e6)?;
    number("locomotion.fast", fast, 1.0..=1000.0)?;
    number("locomotion.snap_deg", snap_deg, 1.0..=180.0)?;
    number("locomotion.look_deg_per_px", look_deg_per_px, -10.0..=10.0)?;
    size("window.size", config.window.size)
}

fn rings(fovea: &FoveaConfig) -> Result<(), Problem> {
    for angle in fovea.ring_deg {
        number("fovea.ring_deg", angle, 0.0..=89.0)?;
    }
    if fovea.ring_deg[0] > fovea.ring_deg[1] {
        let problem = format!("is {:?}, but the inner ring must end first", fovea.ring_deg);
        return Err(Problem { key: "fovea.ring_deg", problem });
    }
    Ok(())
}

fn simulated(simulated: &SimulatedConfig) -> Result<(), Problem> {
    let SimulatedConfig { size_px, fov_deg, eye_distance_m, cant_deg, refresh_hz, eye_height_m } = *simulated;
    size("simulated.size_px", size_px)?;
    for angle in fov_deg {
        number("simulated.fov_deg", angle, -89.0..=89.0)?;
    }
    let [outwards, inwards, up, down] = fov_deg;
    if outwards + inwards < 1.0 || up + down < 1.0 {
        let problem = "leaves less than a degree to see: outwards + inwards and up + down must be more";
        return Err(Problem { key: "simulated.fov_deg", problem: problem.into() });
    }
    number("simulated.eye_distance_m", eye_distance_m, 0.0..=10.0)?;
    number("simulated.cant_deg", cant_deg, -60.0..=60.0)?;
    number("simulated.refresh_hz", refresh_hz, 1.0..=1000.0)?;
    number("simulated.eye_height_m", eye_height_m, -1000.0..=1000.0)
}

/// A number in a range; NaN and the infinities are in none.
fn number(key: &'static str, value: f64, range: RangeInclusive<f64>) -> Result<(), Problem> {
    if range.contains(&value) {
        return Ok(());
    }
    let problem = format!("is {value}, but must be from {} to {}", range.start(), range.end());
    Err(Problem { key, problem })
}

/// Both edges of an image in range.
fn size(key: &'static str, edges: [u32; 2]) -> Result<(), Problem> {
    if edges.iter().all(|edge| (1..=MAX_EDGE_PX).contains(edge)) {
        return Ok(());
    }
    let problem = format!("is {edges:?}, but each edge must be from 1 to {MAX_EDGE_PX}");
    Err(Problem { key, problem })
}

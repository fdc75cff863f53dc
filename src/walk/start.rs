//! Where a walk begins: inside a place, before an object, above a landscape.

use super::locomotion::Start;
use crate::cloud::Cloud;
use glam::DVec3;

/// Below this many metres across, a scan is an object: stand before it.
const OBJECT_M: f64 = 4.0;
/// Above this many metres across, it is a landscape: look at it from its edge, from above.
const LANDSCAPE_M: f64 = 250.0;

/// The starting place for a cloud whose world unit is `unit_m` metres.
#[must_use]
pub fn start(cloud: &Cloud, unit_m: f64) -> Start {
    let bounds = cloud.scene.bounds;
    let center = bounds.center();
    let extent = bounds.size().truncate().max_element().max(bounds.size().z * 0.25);
    let extent_m = extent * unit_m;
    let units_per_m = 1.0 / unit_m;
    // From the south, so far back that a view of 60 degrees holds the scan, a little above.
    let back = 0.9 * extent + bounds.size().z;
    let overview = DVec3::new(center.x, center.y - back, center.z + 0.15 * back - 1.7 * units_per_m);
    let floor_in_world = if extent_m < OBJECT_M {
        let distance = 0.5 * extent + (0.8 * extent_m).max(0.6) * units_per_m;
        DVec3::new(center.x, center.y - distance, center.z - 1.6 * units_per_m)
    } else if extent_m > LANDSCAPE_M {
        overview
    } else {
        DVec3::new(center.x, center.y, floor(cloud, center, 0.1 * extent).unwrap_or(bounds.min.z))
    };
    Start { floor_in_world, yaw: 0.0, units_per_m, extent_m, overview: (overview, 0.0) }
}

/// Height of the floor round `center`: a low percentile of the points within `radius`, so that neither stray
/// points below nor furniture matter. None if there are no points.
fn floor(cloud: &Cloud, center: DVec3, radius: f64) -> Option<f64> {
    let near = cloud.scene.samples.iter().filter(|p| (**p - center).truncate().length() < radius);
    let mut heights: Vec<f64> = near.map(|p| p.z).collect();
    let low = heights.len() / 20;
    (!heights.is_empty()).then(|| *heights.select_nth_unstable_by(low, f64::total_cmp).1)
}

//! A tunnel as round as a tube. Its floor is level nowhere, unlike a room's, and still one can stand on it. The same
//! surface seen from outside is a pipe; but a scan of a pipe has the ground below it, and a closed pipe has ends.

use glam::{DVec2, DVec3};
use points::Scene;

/// Least radius of a tube that one can stand in, meters.
const LEAST_RADIUS_M: f64 = 1.2;
/// Least length of a tube that one can stand in, in radii.
const LEAST_LENGTH: f64 = 6.0;
/// Share of the points at either end of an axis that may be strays.
const STRAY_SHARE: f64 = 0.01;
/// Least share of the points that are on the tube.
const ROUND_SHARE: f64 = 0.9;
/// Largest distance from the tube of points that are on it, in radii.
const ROUND: f64 = 0.15;
/// Distance from the axis, in radii, below which points would be of the tube's ends.
const HOLLOW: f64 = 0.6;
/// Largest share of the points that may be nearer to the axis than [`HOLLOW`].
const MOST_INSIDE: f64 = 0.003;

/// The middle of a tube's floor, world space, and the direction in which it leads; `None` if the scene is no tube that lies
/// level, straight and open, with nothing around it.
pub(super) fn floor(scene: &Scene, units_per_m: f64) -> Option<(DVec3, DVec2)> {
    let middle = DVec3::new(scene.quarters(0)?[1], scene.quarters(1)?[1], 0.0);
    let ahead = longest(scene.samples.iter().map(|&p| (p - middle).truncate()));
    let along = range(scene.samples.iter().map(|&p| (p - middle).truncate().dot(ahead)));
    let aside = range(scene.samples.iter().map(|&p| (p - middle).truncate().perp_dot(ahead)));
    let height = range(scene.samples.iter().map(|p| p.z));
    let radius = 0.5 * (height[1] - height[0]);
    let axis = DVec2::new(0.5 * (aside[0] + aside[1]), height[0] + radius);
    if radius < LEAST_RADIUS_M * units_per_m || along[1] - along[0] < LEAST_LENGTH * radius {
        return None;
    }
    let away = |p: &DVec3| DVec2::new((*p - middle).truncate().perp_dot(ahead), p.z).distance(axis) / radius;
    let share = |is: &dyn Fn(f64) -> bool| {
        scene.samples.iter().filter(|p| is(away(p))).count() as f64 / scene.samples.len() as f64
    };
    let is_tube = share(&|away| (away - 1.0).abs() <= ROUND) >= ROUND_SHARE
        && share(&|away| away < HOLLOW) <= MOST_INSIDE;
    // `right` points to the right of `ahead`.
    let right = -ahead.perp();
    let at = middle.truncate() + ahead * 0.5 * (along[0] + along[1]) + right * axis.x;
    is_tube.then(|| (at.extend(height[0]), ahead))
}

/// The direction in which places round zero are spread most.
fn longest(places: impl Iterator<Item = DVec2>) -> DVec2 {
    let (xx, xy, yy) =
        places.fold((0.0, 0.0, 0.0), |(xx, xy, yy), p| (xx + p.x * p.x, xy + p.x * p.y, yy + p.y * p.y));
    DVec2::from_angle(0.5 * (2.0 * xy).atan2(xx - yy))
}

/// The values between which all lie except for strays.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut values: Vec<f64> = values.collect();
    let Some(last) = values.len().checked_sub(1) else { return [0.0; 2] };
    let tail = (STRAY_SHARE * values.len() as f64) as usize;
    [tail, last - tail].map(|at| *values.select_nth_unstable_by(at, f64::total_cmp).1)
}

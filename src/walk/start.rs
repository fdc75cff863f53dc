//! Where a walk begins: inside a place, before an object, above a landscape's edge.

use super::part::part;
use super::surroundings::{Standing, standing};
use super::tube;
use crate::overview::{self, Lens};
use base::space::{Bounds, Fov, Pose};
use glam::DVec3;
use points::Scene;

/// Least spread of a landscape in meters, which is twice the width of the middle half of its points along the longer
/// axis. A landscape is looked at from its edge, from above.
const LANDSCAPE_M: f64 = 250.0;
/// Least length that a long thin scene is cut to, meters, to be looked at.
const PART_M: f64 = 40.0;
/// Least length that a long thin scene is cut to, meters, to find a place in it.
const NEAR_PART_M: f64 = 20.0;
/// Length in meters below which nobody sees much of a scene, so that it is shown larger, as by a magnifying glass.
const SMALLEST_M: f64 = 0.02;
/// Length in meters at which a scene shorter than [`SMALLEST_M`] is shown.
const SHOWN_M: f64 = 0.3;
/// Rough height of the eye above the floor, meters.
const EYE_M: f64 = 1.6;
/// Least distance at which one stands before an object, meters.
const BEFORE_M: f64 = 0.4;
/// Angle that one sees without turning one's head, degrees.
const SEEN_DEG: f64 = 60.0;

/// Where a walk begins, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// The floor below the viewer.
    pub floor_in_world: DVec3,
    /// Direction of view about the world's vertical, radians; 0 looks along +y (north), positive to the left.
    pub yaw: f64,
    /// World units a meter.
    pub units_per_m: f64,
    /// Factor by which the scan is shown larger than it is, as by a magnifying glass.
    pub magnified: f64,
    /// Longest horizontal extent of the scan in meters: it sets the default speed.
    pub extent_m: f64,
    /// Place and yaw from which the whole scan is seen.
    pub overview: (DVec3, f64),
    /// Box of the scene.
    pub bounds: Bounds,
    /// True if the place has walls all around: one walks there.
    pub is_inside: bool,
}

/// World units a meter of the user's in a scene whose world unit is `unit_m` meters, where it is shown as large as life.
#[must_use]
pub fn units_per_m(scene: &Scene, unit_m: f64) -> f64 {
    if scene.is_a_point() { 1.0 / unit_m } else { scale(&scene.bounds, unit_m).0 }
}

/// The starting place for a scene whose world unit is `unit_m` meters.
#[must_use]
pub fn start(scene: &Scene, unit_m: f64) -> Start {
    let bounds = scene.bounds;
    let (units_per_m, magnified) =
        if scene.is_a_point() { (1.0 / unit_m, 1.0) } else { scale(&bounds, unit_m) };
    let extent = bounds.size().truncate().max_element().max(bounds.size().z * 0.25);
    let extent_m = extent / units_per_m;
    let overview = above_the_edge(&bounds, extent, units_per_m);
    let (floor_in_world, yaw, is_inside) = place(scene, units_per_m).unwrap_or((overview, 0.0, false));
    let overview = (overview, 0.0);
    Start { floor_in_world, yaw, units_per_m, magnified, extent_m, overview, bounds, is_inside }
}

/// The floor, the yaw, and whether walls are all around; `None` for a landscape. They are found from a part of a scene that is long and thin.
fn place(scene: &Scene, units_per_m: f64) -> Option<(DVec3, f64, bool)> {
    if let Some((floor_in_world, ahead)) = tube::floor(scene, units_per_m) {
        return Some((floor_in_world, (-ahead.x).atan2(ahead.y), true));
    }
    let near = part(scene, NEAR_PART_M * units_per_m);
    let far = part(scene, PART_M * units_per_m);
    if spread(&near) / units_per_m > LANDSCAPE_M {
        let size = near.bounds.size();
        let is_part = near.samples.len() < scene.samples.len();
        return is_part.then(|| (above_the_edge(&near.bounds, size.max_element(), units_per_m), 0.0, false));
    }
    Some(match standing(&near, units_per_m) {
        Some(Standing { floor_in_world, enclosed: true }) => (floor_in_world, 0.0, true),
        Some(Standing { floor_in_world, .. }) => {
            (floor_in_world, toward(&near, floor_in_world, units_per_m), false)
        }
        None => (before(&far, units_per_m), 0.0, false),
    })
}

/// World units a meter of the viewer's, and the factor by which the scene is shown larger.
fn scale(bounds: &Bounds, unit_m: f64) -> (f64, f64) {
    let edge_m = bounds.edge() * unit_m;
    let magnified = if edge_m > 0.0 && edge_m < SMALLEST_M { SHOWN_M / edge_m } else { 1.0 };
    (1.0 / (unit_m * magnified), magnified)
}

/// A place south of a scene and a little above it, so far back that a view of 60 degrees holds the scene.
fn above_the_edge(bounds: &Bounds, extent: f64, units_per_m: f64) -> DVec3 {
    let center = bounds.center();
    let back = 0.9 * extent + bounds.size().z;
    DVec3::new(center.x, center.y - back, center.z + 0.15 * back - 1.7 * units_per_m)
}

/// The floor south of an object, so far away that it is seen whole. The eye is at the object's middle if it is small,
/// otherwise above the ground that it stands on.
fn before(scene: &Scene, units_per_m: f64) -> DVec3 {
    let bounds = scene.bounds;
    let eye_height = (0.5 * bounds.size().z).min(EYE_M * units_per_m);
    let target = bounds.center().with_z(bounds.min.z + eye_height);
    let north = Pose::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z).orientation;
    let lens = Lens { sideways: 0.0, fov: Fov::symmetric(SEEN_DEG.to_radians(), 1.0) };
    let eye = overview::place(scene, north, &[lens], Some(target));
    let nearest = bounds.min.y - BEFORE_M * units_per_m;
    eye.with_y(eye.y.min(nearest)) - DVec3::Z * EYE_M * units_per_m
}

/// Width of most of the scene, world units: a few points far away do not make a landscape.
fn spread(scene: &Scene) -> f64 {
    let width = |axis| scene.quarters(axis).map_or(0.0, |[low, _, high]| high - low);
    2.0 * width(0).max(width(1))
}

/// The yaw of somebody who looks to where most of a scene is, north if that is where they stand; see [`Start::yaw`].
fn toward(scene: &Scene, floor_in_world: DVec3, units_per_m: f64) -> f64 {
    let middle = |axis| scene.quarters(axis).map_or(0.0, |[_, middle, _]| middle - floor_in_world[axis]);
    let (x, y) = (middle(0), middle(1));
    if x.hypot(y) > units_per_m { (-x).atan2(y) } else { 0.0 }
}

#[cfg(test)]
#[path = "start_tests.rs"]
mod tests;

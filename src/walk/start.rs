//! Where a walk begins: inside a place, before an object, or with a landscape as a model.

use super::kind::ScanKind;
use super::moving::Standpoint;
use super::part::part;
use super::surroundings::{Standing, standing};
use super::tube;
use crate::overview::{self, Lens};
use base::space::{Bounds, Fov, Pose};
use glam::DVec3;
use points::{PlacedStation, Scene, StationKind};
use std::sync::{Arc, OnceLock};

/// Least spread of a landscape in meters, which is twice the width of the middle half of its points along the longer
/// axis.
const LANDSCAPE_M: f64 = 300.0;
/// Least spread in meters, and most points a square meter seen from above, of a scan that was made from the air: on the
/// ground one would stand among points that are a foot and more apart.
const FROM_THE_AIR: (f64, f64) = (50.0, 16.0);
/// Least length that a long thin scene is cut to, meters, to be looked at.
const PART_M: f64 = 40.0;
/// Least length that a long thin scene is cut to, meters, to find a place in it.
const NEAR_PART_M: f64 = 20.0;
/// Length in meters up to which an object is so small that it is shown larger.
const SMALL_M: f64 = 0.1;
/// Length in meters at which an object no longer than [`SMALL_M`] is shown.
const SHOWN_M: f64 = 1.0;
/// Height of an eye above the floor where no headset tells it, meters.
pub const EYE_HEIGHT_M: f64 = 1.7;
/// Rough height of the eye above the floor, meters.
const EYE_M: f64 = 1.6;
/// Least distance at which one stands before an object, meters.
const BEFORE_M: f64 = 0.4;
/// Angle that one sees without turning one's head, degrees.
const SEEN_DEG: f64 = 60.0;

/// Where a walk begins, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// What the scan is taken for. A landscape is brought before the viewer as a model, once they stand at
    /// [`Self::standpoint`].
    pub kind: ScanKind,
    /// Where the viewer stands, where they look, and how large the scan is shown.
    pub standpoint: Standpoint,
    /// True if sticks and keys walk there unless the user says otherwise: walls are all around.
    pub walks: bool,
    /// World units a meter where the scan is shown as large as life.
    pub units_per_m: f64,
    /// Longest horizontal extent of the scan in meters: it sets the default speed.
    pub extent_m: f64,
    /// The standpoint from which the whole scan is seen.
    pub overview: Standpoint,
    /// Box of the scene.
    pub bounds: Bounds,
}

/// The starts of each kind, in the order of [`ScanKind::ALL`], once they are known.
pub type StartsCell = Arc<OnceLock<[Start; 4]>>;

/// The starting place in a scene whose world unit is `unit_m` meters, if it is of this kind; `None`: of the kind that its
/// size, its floor and its walls tell.
#[must_use]
pub fn start(scene: &Scene, unit_m: f64, kind: Option<ScanKind>) -> Start {
    let units_per_m = 1.0 / unit_m;
    let bounds = scene.bounds;
    let extent = bounds.size().truncate().max_element().max(bounds.size().z * 0.25);
    let overview = level(above_the_edge(&bounds, extent, units_per_m));
    let (kind, at) = match kind {
        Some(kind) => (kind, of_kind(scene, units_per_m, kind)),
        None => told(scene, units_per_m),
    };
    let Beginning { standpoint, walks } = at.unwrap_or(Beginning { standpoint: overview, walks: false });
    Start { kind, standpoint, walks, units_per_m, extent_m: extent / units_per_m, overview, bounds }
}

/// Where one stands, and whether one walks from there.
#[derive(Clone, Copy)]
struct Beginning {
    standpoint: Standpoint,
    walks: bool,
}

impl Beginning {
    /// Where one flies from.
    fn flying(standpoint: Standpoint) -> Self {
        Self { standpoint, walks: false }
    }

    /// A place with walls all around, or an open place, where one looks to where most of the scene is.
    fn standing(scene: &Scene, at: Standing, units_per_m: f64) -> Self {
        let yaw = if at.enclosed { at.yaw } else { toward(scene, at.floor_in_world, units_per_m) };
        Self { standpoint: Standpoint { yaw, ..level(at.floor_in_world) }, walks: at.enclosed }
    }
}

/// What a scene is of, and where one begins in it; `None` for the standpoint that sees all of it.
fn told(scene: &Scene, units_per_m: f64) -> (ScanKind, Option<Beginning>) {
    if let Some(inside) = in_tube(scene, units_per_m) {
        return (ScanKind::Interior, Some(inside));
    }
    let near = part(scene, NEAR_PART_M * units_per_m);
    if spread(&near) / units_per_m > LANDSCAPE_M || is_from_the_air(&near, units_per_m) {
        return (ScanKind::Landscape, edge_of_part(scene, &near, units_per_m));
    }
    match standing(&near, units_per_m, None).map(|at| at_station(&near, at, units_per_m)) {
        Some(at) => {
            let kind = if at.in_room { ScanKind::Interior } else { ScanKind::Outdoors };
            (kind, Some(Beginning::standing(&near, at, units_per_m)))
        }
        None => (ScanKind::Object, Some(before(scene, units_per_m))),
    }
}

/// Where one begins in a scene that is of this kind; `None` for the standpoint that sees all of it.
fn of_kind(scene: &Scene, units_per_m: f64, kind: ScanKind) -> Option<Beginning> {
    let near = part(scene, NEAR_PART_M * units_per_m);
    let at = |enclosed| Some(at_station(&near, standing(&near, units_per_m, enclosed)?, units_per_m));
    let begin = |at| Beginning::standing(&near, at, units_per_m);
    Some(match kind {
        ScanKind::Interior => {
            in_tube(scene, units_per_m).or_else(|| at(Some(true)).map(begin)).unwrap_or_else(|| {
                let middle = near.bounds.center().with_z(near.bounds.min.z);
                Beginning { standpoint: level(middle), walks: true }
            })
        }
        ScanKind::Outdoors => {
            let outside = at(None).filter(|at| !at.in_room).or_else(|| at(Some(false)));
            outside.map_or_else(|| before(scene, units_per_m), begin)
        }
        ScanKind::Landscape => return edge_of_part(scene, &near, units_per_m),
        ScanKind::Object => before(scene, units_per_m),
    })
}

/// A place where one can stand, moved to the scanner's station that is nearest to the middle, if there is one.
fn at_station(scene: &Scene, at: Standing, units_per_m: f64) -> Standing {
    let middle = [0, 1].map(|axis| scene.quarters(axis).map_or(0.0, |[_, middle, _]| middle));
    let away = |p: DVec3| (p.x - middle[0]).hypot(p.y - middle[1]);
    scene
        .stations
        .iter()
        .filter(|station| station.kind == StationKind::Scanner && scene.bounds.contains(station.p_in_world))
        .min_by(|a, b| away(a.p_in_world).total_cmp(&away(b.p_in_world)))
        .map_or(at, |nearest| at.at_station(scene, units_per_m, nearest.p_in_world))
}

/// Where one stands at each of the scan's stations, in its order: upright, with the eye where the scanner or the camera was.
#[must_use]
pub fn stations(scene: &Scene, unit_m: f64) -> Vec<Standpoint> {
    let units_per_m = 1.0 / unit_m;
    let standpoint = |station: &PlacedStation| {
        let eye = station.p_in_world;
        let yaw = match station.looks_in_world {
            Some(looks) if looks.x != 0.0 || looks.y != 0.0 => (-looks.x).atan2(looks.y),
            _ => toward(scene, eye, units_per_m),
        };
        Standpoint { yaw, ..level(eye - DVec3::Z * EYE_HEIGHT_M * units_per_m) }
    };
    scene.stations.iter().map(standpoint).collect()
}

/// A standpoint that looks north, where the scan is as large as life.
fn level(floor_in_world: DVec3) -> Standpoint {
    Standpoint { floor_in_world, yaw: 0.0, scale: 1.0 }
}

/// The inside of a tunnel that is as round as a tube.
fn in_tube(scene: &Scene, units_per_m: f64) -> Option<Beginning> {
    let (floor_in_world, ahead) = tube::floor(scene, units_per_m)?;
    let standpoint = Standpoint { yaw: (-ahead.x).atan2(ahead.y), ..level(floor_in_world) };
    Some(Beginning { standpoint, walks: true })
}

/// The standpoint above the edge of the part that a long and thin scene was cut to; `None` if it was not cut.
fn edge_of_part(scene: &Scene, near: &Scene, units_per_m: f64) -> Option<Beginning> {
    let is_part = near.samples.len() < scene.samples.len();
    let extent = near.bounds.size().max_element();
    is_part.then(|| Beginning::flying(level(above_the_edge(&near.bounds, extent, units_per_m))))
}

/// A place south of a scene and a little above it, so far back that a view of 60 degrees holds the scene.
fn above_the_edge(bounds: &Bounds, extent: f64, units_per_m: f64) -> DVec3 {
    let center = bounds.center();
    let back = 0.9 * extent + bounds.size().z;
    DVec3::new(center.x, center.y - back, center.z + 0.15 * back - EYE_HEIGHT_M * units_per_m)
}

/// The standpoint south of an object, so far away that it is seen whole. The eye is at the object's middle if it is small,
/// otherwise above the ground that it stands on. Objects that are no longer than [`SMALL_M`] are shown larger.
fn before(scene: &Scene, units_per_m: f64) -> Beginning {
    let edge_m = scene.bounds.edge() / units_per_m;
    let scale = if edge_m > 0.0 && edge_m <= SMALL_M { SHOWN_M / edge_m } else { 1.0 };
    let units_per_m = units_per_m / scale;
    let far = part(scene, PART_M * units_per_m);
    let bounds = far.bounds;
    let eye_height = (0.5 * bounds.size().z).min(EYE_M * units_per_m);
    let target = bounds.center().with_z(bounds.min.z + eye_height);
    let north = Pose::look_at(DVec3::ZERO, DVec3::Y, DVec3::Z).orientation;
    let lens = Lens { sideways: 0.0, fov: Fov::symmetric(SEEN_DEG.to_radians(), 1.0) };
    let eye = overview::place(&far, north, &[lens], Some(target));
    let nearest = bounds.min.y - BEFORE_M * units_per_m;
    let floor_in_world = eye.with_y(eye.y.min(nearest)) - DVec3::Z * EYE_M * units_per_m;
    Beginning::flying(Standpoint { scale, ..level(floor_in_world) })
}

/// Width of most of the scene, world units: a few points far away do not make a landscape.
fn spread(scene: &Scene) -> f64 {
    let width = |axis| scene.quarters(axis).map_or(0.0, |[low, _, high]| high - low);
    2.0 * width(0).max(width(1))
}

/// True if the scene is wide and so thinly covered as only scanners in the air cover it, which leave no stations.
fn is_from_the_air(scene: &Scene, units_per_m: f64) -> bool {
    if scene.stations.iter().any(|station| station.kind == StationKind::Scanner) {
        return false;
    }
    let (least_spread_m, most_per_m2) = FROM_THE_AIR;
    let size_m = scene.bounds.size() / units_per_m;
    let per_m2 = scene.num_points as f64 / (size_m.x * size_m.y);
    spread(scene) / units_per_m > least_spread_m && per_m2 < most_per_m2
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

//! What x, y and z of a file are: lengths on a map, angles, or lengths from the earth's center. The file's coordinate
//! system says which. Its coordinates decide where there is no system, and where they cannot be what the system says.

use super::crs::{Angle, Axes};
use super::earth::Geodetic;
use super::world::{Project, median, samples};
use super::{Header, ReadOptions, ScanFile};
use base::space::Bounds;
use glam::DVec3;

/// What the axes of a file are.
pub(super) fn of(file: &ScanFile, header: &Header, options: &ReadOptions) -> Axes {
    match options.project {
        Project::Off => Axes::Planar,
        Project::Degrees => Axes::Geographic(Angle::Degree),
        Project::Geocentric => Axes::Geocentric,
        Project::Auto => {
            let stated = header.axes.and_then(|axes| on_earth(file, header, axes));
            // A stated unit of length says that the coordinates are lengths.
            let may_be = |axes: &Axes| *axes == Axes::Geocentric || options.unit.meters().is_none();
            let evident = || evident_axes(file, header.is_on_fixed_grid).filter(may_be);
            stated.or_else(evident).unwrap_or(Axes::Planar)
        }
    }
}

/// Smallest grid step, in degrees, that nobody stores a scan in: 111 m.
const NO_STEP_DEG: f64 = 1e-3;

/// Returns the axes of a file's coordinate system if the file's points can be there: some files name a system that is
/// not theirs. Latitude comes first where x and y fit only in that order.
fn on_earth(file: &ScanFile, header: &Header, axes: Axes) -> Option<Axes> {
    let middle = median(samples(file).collect());
    match axes {
        Axes::Planar => None,
        Axes::Geographic(angle) | Axes::LatitudeFirst(angle) => {
            let turn = std::f64::consts::TAU / angle.radians();
            let step = file.grid.scale.abs();
            if header.is_on_fixed_grid && step.x.min(step.y) >= NO_STEP_DEG * turn / 360.0 {
                return None;
            }
            let are =
                |longitude: f64, latitude: f64| longitude.abs() <= turn && latitude.abs() <= 0.25 * turn;
            let is_swapped = || are(middle.y, middle.x).then_some(Axes::LatitudeFirst(angle));
            are(middle.x, middle.y).then_some(Axes::Geographic(angle)).or_else(is_swapped)
        }
        Axes::Geocentric => {
            (-20e3..100e3).contains(&Geodetic::of_geocentric(middle).height_m).then_some(Axes::Geocentric)
        }
    }
}

/// Returns the axes that a file must have, whatever it says, where its coordinates leave no doubt.
fn evident_axes(file: &ScanFile, is_on_fixed_grid: bool) -> Option<Axes> {
    let Bounds { min, max } = file.bounds;
    let (size, middle) = (file.bounds.size(), file.bounds.center());
    let across = size.x.max(size.y);
    // Longitudes go to 180, or on to 360.
    let are = |longitude: [f64; 2], latitude: [f64; 2]| {
        longitude[0] >= -180.0 && longitude[1] <= 360.0 && latitude[0] >= -90.0 && latitude[1] <= 90.0
    };
    let (x, y) = ([min.x, max.x], [min.y, max.y]);
    let in_order = match (are(x, y), are(y, x)) {
        (true, _) => Some(Axes::Geographic(Angle::Degree)),
        (false, true) => Some(Axes::LatitudeFirst(Angle::Degree)),
        (false, false) => None,
    };
    let has_extent = size.x > 0.0 && size.y > 0.0;
    // A degree is 111 km, so a scan in degrees looks like a needle: tall against its width, and far from zero against
    // its width. A grid of whole steps in meters lacks the decimals that degrees need, or has them for heights too.
    let (step, needle) = (file.grid.scale.abs(), size.z / across);
    let step_across = step.x.max(step.y);
    let is_far = middle.truncate().length() >= 1000.0 * across;
    let has_decimals = step_across <= 1e-5 && step.z >= 10.0 * step_across;
    let is_needle = across < 1.0 && is_far && needle >= if is_on_fixed_grid { 50.0 } else { 1000.0 };
    // Nobody stores lengths across to a thousandth of a millimeter and heights only to a tenth of one, nor heights of
    // land more finely than that. Land in degrees is always taller than wide, except a single plane.
    let is_degrees_grid = is_on_fixed_grid
        && step_across <= 1.1e-6
        && step.z >= (90.0 * step_across).max(9e-5)
        && (needle >= 3.0 || size.z == 0.0 && is_far);
    // Nobody stores the width of a thread to a ten thousandth of a millimeter.
    let is_thread = across < 1.0 && is_far && needle >= 10_000.0 && step_across <= 1.1e-7;
    if in_order.is_some() && has_extent && (is_needle && has_decimals || is_degrees_grid || is_thread) {
        return in_order;
    }
    // No survey has heights of 20 km. The middle may by chance be as far from zero as the ground is from the earth's
    // center, but not most points.
    let is_on_ground = |&p: &DVec3| (-1000.0..9000.0).contains(&Geodetic::of_geocentric(p).height_m);
    let places: Vec<DVec3> = samples(file).collect();
    let are_most = || 5 * places.iter().filter(|p| is_on_ground(p)).count() >= 4 * places.len();
    let middle = median(places.clone());
    let is_evident = middle.z.abs() > 20_000.0 && is_on_ground(&middle) && are_most();
    is_evident.then_some(Axes::Geocentric)
}

//! The whole scan as a model before the user, at the height of a table; and the limits of its size.

use super::place::{StagePlace, facing_in_stage};
use base::space::{Bounds, Pose};
use glam::{DQuat, DVec3};

/// Width of the model, meters.
const WIDTH_M: f64 = 2.0;
/// Height of the table, meters.
const TABLE_M: f64 = 0.75;
/// Distance of the model's edge from the head, meters.
const BEFORE_M: f64 = 0.4;
/// Least width at which the whole scan may be shown, meters.
const LEAST_WIDTH_M: f64 = 0.3;
/// Largest scale, and a width in meters that any scan may be shown at.
const LARGEST: [f64; 2] = [20.0, 4.0];

/// Width of a scan across, meters, as large as life.
fn width_m(bounds: &Bounds, life_units_per_m: f64) -> f64 {
    bounds.size().truncate().max_element() / life_units_per_m
}

/// Scale at which the scan is a model; scans that are smaller are not made larger.
#[must_use]
pub fn scale(bounds: &Bounds, life_units_per_m: f64) -> f64 {
    let width_m = width_m(bounds, life_units_per_m);
    if width_m > WIDTH_M { WIDTH_M / width_m } else { 1.0 }
}

/// The least and the greatest scale at which hands may show a scan.
#[must_use]
pub fn limits(bounds: &Bounds, life_units_per_m: f64) -> [f64; 2] {
    let width_m = width_m(bounds, life_units_per_m).max(1e-6);
    [(LEAST_WIDTH_M / width_m).min(0.5), (LARGEST[1] / width_m).max(LARGEST[0])]
}

/// Brings the scan before the user as a model. It keeps the side that the user faces, and stands on a table.
pub fn show(place: &mut StagePlace, bounds: &Bounds, stage_from_head: &Pose) {
    place.scale = scale(bounds, place.life_units_per_m());
    let ahead = DQuat::from_rotation_y(facing_in_stage(stage_from_head)) * DVec3::NEG_Z;
    let half_m = 0.5 * bounds.size().truncate().length() / place.units_per_m();
    // Whoever looks at a corner sees all of it.
    let at = stage_from_head.position + ahead * (BEFORE_M + half_m);
    let bottom = bounds.center().with_z(bounds.min.z);
    place.bring(at.with_y(TABLE_M), bottom);
}

/// The pitch at which a head that faces the model looks at its middle, radians.
#[must_use]
pub fn pitch(place: &StagePlace, bounds: &Bounds, stage_from_head: &Pose) -> f64 {
    let to = place.p_in_stage(bounds.center()) - stage_from_head.position;
    to.y.atan2(to.x.hypot(to.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn building() -> Bounds {
        let min = DVec3::new(5e5, 4e6, 100.0);
        Bounds { min, max: min + DVec3::new(40.0, 30.0, 9.0) / 0.3048 }
    }

    #[test]
    fn a_building_is_two_meters_wide_on_a_table_before_the_user() {
        let bounds = building();
        let mut place = StagePlace::new(bounds.center(), 0.7, 1.0 / 0.3048);
        let head = Pose { position: DVec3::new(0.5, 1.6, -0.4), orientation: DQuat::from_rotation_y(2.0) };
        show(&mut place, &bounds, &head);
        let units_per_m = place.units_per_m();
        assert!((bounds.size().x / units_per_m - 2.0).abs() < 1e-9 && place.yaw == 0.7);
        let head_in_world = place.p_in_world(head.position);
        assert!(((bounds.min.z - place.floor_in_world.z) / units_per_m - TABLE_M).abs() < 1e-6);
        let to = (bounds.center() - head_in_world).truncate() / units_per_m;
        assert!((to.length() - 1.25 - BEFORE_M).abs() < 1e-6, "{to}");
        let facing = place.facing(&head);
        assert!((to.normalize() - glam::DVec2::new(-facing.sin(), facing.cos())).length() < 1e-6);
    }

    #[test]
    fn small_things_stay_as_large_as_life() {
        let bounds = Bounds { min: DVec3::ZERO, max: DVec3::ONE };
        assert_eq!(scale(&bounds, 1.0), 1.0);
        assert_eq!(limits(&bounds, 1.0), [0.3, 20.0]);
        let [least, most] = limits(&building(), 1.0 / 0.3048);
        assert!((least - 0.3 / 40.0).abs() < 1e-9 && most == 20.0, "{least} {most}");
    }
}

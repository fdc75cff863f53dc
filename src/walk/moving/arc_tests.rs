//! Arcs over made-up floors: how far they go, where they land, and what stops them.

use super::super::floors::made_up::{MadeScan, grid};
use super::*;
use glam::DVec2;

const UTM: DVec3 = DVec3::new(5e5, 4e6, 300.0);

/// A unit vector at angles in degrees from +x and from the horizon.
fn toward(yaw_deg: f64, pitch_deg: f64) -> DVec3 {
    let (yaw, pitch) = (yaw_deg.to_radians(), pitch_deg.to_radians());
    (DVec2::from_angle(yaw) * pitch.cos()).extend(pitch.sin())
}

fn thrown(floors: &Floors, hand: DVec3, along: DVec3, units_per_m: f64) -> TeleportArc {
    arc(Ground::Floors(floors), hand, along, 0.5, speed_for(8.0), units_per_m)
}

/// Two stories with walls, whose upper one has an opening; a stair leads up.
fn house(units_per_m: f64) -> MadeScan {
    let mut made = MadeScan::new(UTM * units_per_m, units_per_m);
    made.level([0.0, 0.0], [12.0, 6.0], 0.0, 0.03);
    made.walls([0.0, 0.0], [12.0, 6.0], [0.0, 5.6], 0.03);
    made.level([0.0, 0.0], [8.0, 6.0], 2.7, 0.03);
    made.level([0.0, 0.0], [8.0, 6.0], 3.0, 0.03);
    made.stairs([9.0, 0.0], 1.5, 10, 0.17, 0.28, 0.03);
    made
}

#[test]
fn a_comfortable_hand_reaches_eight_meters() {
    for units_per_m in [1.0, 1.0 / 0.3048, 20.0] {
        let hand = UTM + DVec3::Z * HAND_M * units_per_m;
        let thrown = arc(Ground::Level(UTM.z), hand, toward(90.0, 30.0), 0.5, speed_for(8.0), units_per_m);
        let landing = thrown.landing.expect("a landing");
        let reached = (landing.floor_in_world - UTM).truncate().length() / units_per_m;
        assert!((reached - 8.0).abs() < 0.1, "{reached}");
        assert!((landing.floor_in_world.z, landing.yaw) == (UTM.z, 0.5));
        assert!(thrown.points()[0] == hand && *thrown.points().last().unwrap() == landing.floor_in_world);
        let longest = thrown.points().windows(2).map(|pair| pair[0].distance(pair[1])).fold(0.0, f64::max);
        assert!(longest < 0.5 * units_per_m, "{longest}");
    }
    // Straight up it comes down before the feet, into the sky it never does.
    let up = arc(Ground::Level(0.0), DVec3::Z, DVec3::Z, 0.0, 8.0, 1.0);
    assert!(up.landing.expect("a landing").floor_in_world.length() < 0.1);
    assert!(arc(Ground::Level(5.0), DVec3::Z, DVec3::X, 0.0, 3.0, 1.0).landing.is_none(), "it stays below");
}

#[test]
fn arcs_land_on_floors_and_stop_at_walls_and_ceilings() {
    for units_per_m in [1.0, 1.0 / 0.3048] {
        let made = house(units_per_m);
        let floors = made.floors();
        let at = |p: DVec3| (p - UTM * units_per_m) / units_per_m;
        let hand = |p_m: [f64; 3]| made.p(p_m);
        let mut num_landed = 0;
        for yaw in (0..360).step_by(24) {
            for pitch in [-60.0, -35.0, -10.0, 0.0, 10.0, 25.0, 45.0, 70.0] {
                let thrown =
                    thrown(&floors, hand([4.0, 3.0, 1.2]), toward(f64::from(yaw), pitch), units_per_m);
                for &p in thrown.points() {
                    let p = at(p);
                    let is_inside = p.x > -0.15 && p.x < 12.15 && p.y > -0.15 && p.y < 6.15 && p.z > -0.05;
                    assert!(is_inside && (p.z < 2.72 || p.x > 7.9), "{yaw} {pitch}: {p}");
                }
                let Some(landing) = thrown.landing else { continue };
                let p = at(landing.floor_in_world);
                num_landed += 1;
                let is_on_stairs = p.x > 8.9 && p.y < 1.6;
                assert!(is_on_stairs || p.z.abs() < 0.01, "{yaw} {pitch}: {p}");
            }
        }
        assert!(num_landed > 40, "{num_landed} of 120");
        // From the upper story one lands on its floor, and through its end on the lower one.
        let near = thrown(&floors, hand([4.0, 3.0, 4.2]), toward(0.0, -30.0), units_per_m).landing.unwrap();
        assert!((at(near.floor_in_world).z - 3.0).abs() < 0.01);
        let down = thrown(&floors, hand([7.0, 3.0, 4.2]), toward(0.0, -35.0), units_per_m).landing.unwrap();
        assert!(
            at(down.floor_in_world).z.abs() < 0.01 && at(down.floor_in_world).x > 8.0,
            "{:?}",
            at(down.floor_in_world)
        );
        // The landing is where the ball would come down on the plane of the floor.
        let flat = arc(
            Ground::Level(hand([0.0; 3]).z),
            hand([2.0, 3.0, 1.2]),
            toward(0.0, -20.0),
            0.0,
            speed_for(8.0),
            units_per_m,
        );
        let found = thrown(&floors, hand([2.0, 3.0, 1.2]), toward(0.0, -20.0), units_per_m);
        let [flat, found] = [flat, found].map(|arc| at(arc.landing.unwrap().floor_in_world));
        assert!(flat.distance(found) < 0.02, "{flat} {found}");
    }
}

#[test]
fn strays_stop_no_arc() {
    let mut made = MadeScan::new(UTM, 1.0);
    made.level([0.0, 0.0], [12.0, 4.0], 0.0, 0.03);
    for [x, y, z] in grid([0.2, 0.2, 0.3], [11.8, 3.8, 2.5], 0.37) {
        made.add([x, y, z]);
    }
    let floors = made.floors();
    for yaw in -5..=5 {
        for pitch in [-40.0, -20.0, 0.0, 15.0, 30.0] {
            let thrown = thrown(&floors, made.p([1.0, 2.0, 1.2]), toward(2.0 * f64::from(yaw), pitch), 1.0);
            let landing = thrown.landing.unwrap_or_else(|| panic!("{yaw} {pitch}"));
            assert!((landing.floor_in_world.z - UTM.z).abs() < 0.01, "{yaw} {pitch}");
        }
    }
}

#[test]
fn hills_catch_arcs_and_cliffs_do_not() {
    let mut made = MadeScan::new(UTM, 1.0);
    made.surface([0.0, 0.0], [10.0, 4.0], 0.04, |x, _| 0.4 * x);
    made.surface([10.0, 0.0], [12.0, 4.0], 0.04, |x, _| 4.0 + 3.0 * (x - 10.0));
    let floors = made.floors();
    let hand = made.p([1.0, 2.0, 1.6]);
    let landing = thrown(&floors, hand, toward(0.0, 15.0), 1.0).landing.expect("a hill");
    let p = landing.floor_in_world - UTM;
    assert!((p.z - 0.4 * p.x).abs() < 0.015, "{p}");
    let steep = thrown(&floors, made.p([8.5, 2.0, 4.6]), toward(0.0, 10.0), 1.0);
    assert!(steep.landing.is_none(), "too steep: {:?}", steep.landing);
}

#[test]
fn rays_point_at_floors_and_at_the_feet_of_walls() {
    let made = house(1.0);
    let floors = made.floors();
    let pointed = |from, along| pointed_at(&floors, made.p(from), along, 30.0, 1.0).map(|p| p - UTM);
    let floor = pointed([2.0, 3.0, 1.6], toward(0.0, -30.0)).expect("a floor");
    assert!(floor.z.abs() < 0.01 && (floor.x - 2.0 - 1.6 / 30f64.to_radians().tan()).abs() < 0.1, "{floor}");
    let foot = pointed([2.0, 3.0, 1.6], toward(90.0, 0.0)).expect("the foot of the wall");
    assert!(foot.z.abs() < 0.01 && foot.y > 5.5 && foot.y < 6.0, "{foot}");
    assert_eq!(pointed([11.0, 3.0, 4.0], toward(90.0, 70.0)), None, "the sky");
}

#[test]
fn an_arc_is_the_same_each_time() {
    let made = house(1.0);
    let floors = made.floors();
    let hand = made.p([4.0, 3.0, 4.2]);
    let all = || -> Vec<TeleportArc> {
        (0..100).map(|turn| thrown(&floors, hand, toward(3.6 * f64::from(turn), 20.0), 1.0)).collect()
    };
    assert!(all() == all());
}

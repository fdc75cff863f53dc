//! Floors of made-up scans: level, sloped, in stories, with stairs, holes, walls and strays, in several units and far from
//! zero; and of a real room.

use super::super::arc::{self, Ground};
use super::made_up::{MadeScan, grid};
use super::*;
use base::task::{CancelToken, Progress};

const UTM: DVec3 = DVec3::new(500_123.4, 4_000_567.8, 312.3);
/// World units a meter: meters, feet, millimeters.
const UNITS: [f64; 3] = [1.0, 1.0 / 0.3048, 1000.0];

/// Height of the floor nearest to a height, above the origin; all in meters.
fn height_m(floors: &Floors, made: &MadeScan, p_m: [f64; 3], units_per_m: f64) -> Option<f64> {
    let (p, zero) = (made.p(p_m), made.p([0.0; 3]).z);
    let floor = floors.nearest(p, 0.5 * units_per_m, 0.5 * units_per_m);
    floor.map(|floor| (floor.height - zero) / units_per_m)
}

#[test]
fn level_floors_are_exact_to_millimeters_in_all_units() {
    for units_per_m in UNITS {
        for (apart, noise_m) in [(0.01, 0.004), (0.03, 0.01), (0.08, 0.002)] {
            let mut made = MadeScan::new(UTM * units_per_m, units_per_m);
            made.noise_m = noise_m;
            made.level([0.0, 0.0], [4.0, 3.0], 0.123, apart);
            made.walls([0.0, 0.0], [4.0, 3.0], [0.123, 2.5], apart);
            let floors = made.floors();
            for [x, y, _] in grid([0.3, 0.3, 0.0], [3.7, 2.7, 0.0], 0.17) {
                let height = height_m(&floors, &made, [x, y, 0.2], units_per_m).expect("a floor");
                assert!((height - 0.123).abs() < 0.003, "{units_per_m} {apart} at {x} {y}: {height}");
            }
        }
    }
}

#[test]
fn slopes_are_floors_up_to_forty_degrees() {
    for (degrees, is_floor) in [(5f64, true), (20.0, true), (35.0, true), (50.0, false), (70.0, false)] {
        for direction in [0.0f64, 0.6, 2.1] {
            let grade = DVec2::from_angle(direction) * degrees.to_radians().tan();
            let mut made = MadeScan::new(UTM, 1.0);
            let plane = |x: f64, y: f64| grade.dot(DVec2::new(x - 2.0, y - 2.0));
            made.surface([0.0, 0.0], [4.0, 4.0], 0.02, plane);
            let floors = made.floors();
            for [x, y, _] in grid([1.2, 1.2, 0.0], [2.8, 2.8, 0.0], 0.23) {
                let z = plane(x, y);
                let p = made.p([x, y, z + 0.1]);
                let floor = floors.nearest(p, 0.3, 0.3);
                assert_eq!(floor.is_some(), is_floor, "{degrees} at {x} {y}: {floor:?}");
                if let Some(Floor { height, grade: found }) = floor {
                    assert!(
                        (height - UTM.z - z).abs() < 0.01,
                        "{degrees}: {} instead of {z}",
                        height - UTM.z
                    );
                    assert!((found - grade).length() < 0.08, "{found} instead of {grade}");
                }
            }
        }
    }
}

#[test]
fn each_story_has_its_floor_and_ceilings_are_none() {
    let mut made = MadeScan::new(UTM, 1.0);
    for story in 0..3 {
        let z = 3.0 * f64::from(story);
        made.level([0.0, 0.0], [5.0, 4.0], z, 0.03);
        made.level([0.0, 0.0], [5.0, 4.0], z + 2.7, 0.03);
    }
    made.walls([0.0, 0.0], [5.0, 4.0], [0.0, 8.7], 0.03);
    let floors = made.floors();
    for story in 0..3 {
        let z = 3.0 * f64::from(story);
        let p = made.p([2.2, 1.7, z + 1.2]);
        let below = floors.below(p, 5.0).expect("a floor");
        assert!((below.height - UTM.z - z).abs() < 0.003, "{}", below.height - UTM.z);
        // Upwards there is no floor before the next story's: a ceiling has no headroom.
        let above = floors.nearest(made.p([2.2, 1.7, z + 2.7]), 0.1, 0.1);
        let is_last = story == 2;
        assert_eq!(above.is_some(), is_last, "only the roof is free above: {above:?}");
    }
    let heights: Vec<f64> =
        floors.heights(DVec2::new(UTM.x + 2.2, UTM.y + 1.7), UTM.z - 1.0, UTM.z + 20.0).collect();
    let expected = [8.7, 6.0, 5.7, 3.0, 2.7, 0.0];
    assert_eq!(heights.len(), expected.len(), "{heights:?}");
    assert!(
        heights.iter().zip(expected).all(|(height, z)| (height - UTM.z - z).abs() < 0.003),
        "{heights:?}"
    );
    // Nobody stands in a wall, or outside.
    assert_eq!(floors.nearest(made.p([0.0, 2.0, 1.0]), 0.3, 0.3), None);
    assert_eq!(floors.below(made.p([9.0, 2.0, 1.0]), 50.0), None);
}

#[test]
fn steps_of_stairs_are_floors_at_their_own_heights() {
    for units_per_m in UNITS {
        let mut made = MadeScan::new(UTM * units_per_m, units_per_m);
        made.level([0.0, 0.0], [2.0, 2.0], 0.0, 0.02);
        made.stairs([2.0, 0.0], 2.0, 12, 0.18, 0.27, 0.02);
        let floors = made.floors();
        for step in 0..12 {
            let (middle, z) = (2.0 + 0.27 * (f64::from(step) + 0.5), 0.18 * f64::from(step + 1));
            for y in [0.6, 1.0, 1.37] {
                let height = height_m(&floors, &made, [middle, y, z], units_per_m).expect("a step");
                assert!((height - z).abs() < 0.01, "step {step}: {height} instead of {z}");
            }
        }
    }
}

#[test]
fn holes_in_the_scan_are_bridged_and_those_in_the_floor_are_not() {
    let mut made = MadeScan::new(UTM, 1.0);
    let is_hole = |x: f64, y: f64| (x - 2.0).hypot(y - 2.0) < 0.5;
    for [x, y, _] in grid([0.0, 0.0, 0.0], [4.0, 4.0, 0.0], 0.03) {
        if !is_hole(x, y) {
            made.add([x, y, 3.0]);
        }
    }
    let at_hole = |made: &MadeScan| {
        let floors = made.floors();
        height_m(&floors, made, [2.0, 2.0, 3.1], 1.0)
    };
    let bridged = at_hole(&made).expect("the scanner stood there");
    assert!((bridged - 3.0).abs() < 0.01, "{bridged}");
    // The floor below shows that it is an opening.
    made.level([0.0, 0.0], [4.0, 4.0], 0.0, 0.03);
    assert_eq!(at_hole(&made), None);
    let floors = made.floors();
    let below = floors.below(made.p([2.0, 2.0, 3.5]), 6.0).expect("the floor below");
    assert!((below.height - UTM.z).abs() < 0.003);
    // Beyond an edge nothing is bridged.
    assert_eq!(floors.nearest(made.p([4.6, 2.0, 3.0]), 0.3, 0.3), None);
}

#[test]
fn strays_are_neither_floors_nor_walls() {
    for (apart, share) in [(0.02, 0.01), (0.02, 0.03), (0.06, 0.02)] {
        let mut made = MadeScan::new(UTM, 1.0);
        made.level([0.0, 0.0], [6.0, 6.0], 0.0, apart);
        let num = (share * (6.0f64 / apart).powi(2)) as usize;
        for _ in 0..num {
            let [x, y, z] = [(); 3].map(|()| made.uniform());
            made.add([3.0 + 3.0 * x, 3.0 + 3.0 * y, 1.5 + 1.5 * z]);
        }
        let floors = made.floors();
        let mut num_wrong = 0;
        let places = grid([0.5, 0.5, 0.0], [5.5, 5.5, 0.0], 0.25);
        for &[x, y, _] in &places {
            let floor = floors.below(made.p([x, y, 2.8]), 4.0);
            num_wrong += usize::from(!floor.is_some_and(|floor| (floor.height - UTM.z).abs() < 0.01));
        }
        assert_eq!(num_wrong, 0, "{apart} {share}: of {}", places.len());
        let solid = grid([0.5, 0.5, 0.3], [5.5, 5.5, 2.7], 0.1).into_iter();
        let num_solid = solid.filter(|&p| floors.is_solid(made.p(p))).count();
        assert!(num_solid < 20, "{apart} {share}: {num_solid} of 65 000 places in the air");
    }
}

#[test]
fn walls_and_ceilings_are_solid_however_thinly_they_are_scanned() {
    for wall_apart in [0.02, 0.05, 0.08] {
        let mut made = MadeScan::new(UTM, 1.0);
        made.level([0.0, 0.0], [4.0, 4.0], 0.0, 0.015);
        made.wall([0.0, 2.0], [4.0, 2.0], [0.0, 2.5], wall_apart);
        made.level([0.0, 0.0], [4.0, 4.0], 2.5, wall_apart);
        let floors = made.floors();
        let on_wall = grid([0.3, 2.0, 0.3], [3.7, 2.0, 2.2], 0.1);
        let num_solid = on_wall.iter().filter(|&&p| floors.is_solid(made.p(p))).count();
        assert!(num_solid * 100 >= on_wall.len() * 98, "{wall_apart}: {num_solid} of {}", on_wall.len());
        assert!(floors.is_solid(made.p([1.0, 1.0, 2.5])) && !floors.is_solid(made.p([1.0, 1.0, 1.2])));
    }
}

/// An airborne scan has a few points a square meter, and trees.
#[test]
fn thin_scans_have_floors_too() {
    let mut made = MadeScan::new(UTM, 1.0);
    made.noise_m = 0.03;
    let height = |x: f64, y: f64| 0.15 * x + 3.0 * (0.05 * y).sin();
    made.surface([0.0, 0.0], [100.0, 100.0], 0.6, height);
    let floors = made.floors();
    assert!(floors.edge() > 0.3, "{}", floors.edge());
    for [x, y, _] in grid([5.0, 5.0, 0.0], [95.0, 95.0, 0.0], 9.7) {
        let found = height_m(&floors, &made, [x, y, height(x, y)], 1.0).expect("a floor");
        assert!((found - height(x, y)).abs() < 0.1, "{x} {y}: {found} instead of {}", height(x, y));
    }
}

#[test]
fn low_ceilings_and_tables_leave_no_room() {
    let mut made = MadeScan::new(UTM, 1.0);
    made.level([0.0, 0.0], [4.0, 4.0], 0.0, 0.02);
    made.level([1.0, 1.0], [2.0, 3.0], 0.75, 0.02);
    let floors = made.floors();
    assert_eq!(floors.nearest(made.p([1.5, 2.0, 0.0]), 0.2, 0.2), None, "below a table");
    assert!(floors.nearest(made.p([3.0, 2.0, 0.0]), 0.2, 0.2).is_some());
    assert!(floors.nearest(made.p([1.5, 2.0, 0.75]), 0.2, 0.2).is_some(), "one may climb on it");
}

#[test]
fn the_memory_has_a_limit_and_the_order_does_not_matter() {
    let mut made = MadeScan::new(UTM, 1.0);
    made.level([0.0, 0.0], [8.0, 8.0], 0.0, 0.02);
    made.walls([0.0, 0.0], [8.0, 8.0], [0.0, 3.0], 0.02);
    let scan = made.scan();
    let with_limit = |scan: &points::Scan, most: usize| {
        Floors::with_limit(scan, 1.0, most, &Progress::hidden()).expect("nobody cancels")
    };
    let small = with_limit(&scan, 3000);
    assert!(small.bytes() < 3000 * 20 + 4 * small.rows.len() && small.edge() > 0.15, "{}", small.edge());
    let p = made.p([3.1, 4.2, 0.1]);
    assert!((small.nearest(p, 0.3, 0.3).expect("a floor").height - UTM.z).abs() < 0.01);
    let mut reversed = scan.clone();
    reversed.files[0].points.xyz.reverse();
    let [one, other] = [&scan, &reversed].map(|scan| format!("{:?}", with_limit(scan, 20_000)));
    assert!(one == other, "the same floors, bit for bit");
}

#[test]
fn nothing_and_an_end_that_is_asked_for_are_no_trouble() {
    let none = Floors::none(1.0);
    assert!(none.is_empty() && none.below(DVec3::ZERO, 10.0).is_none() && !none.is_solid(DVec3::ZERO));
    let empty = MadeScan::new(UTM, 1.0).floors();
    assert!(empty.is_empty() && empty.nearest(UTM, 1.0, 1.0).is_none());
    let mut made = MadeScan::new(UTM, 1.0);
    made.add([0.0; 3]);
    let one = made.floors();
    assert!(one.nearest(UTM, 1.0, 1.0).is_none() && one.below(DVec3::INFINITY, 1.0).is_none());
    let stop = CancelToken::default();
    stop.cancel();
    assert!(Floors::of(&made.scan(), 1.0, &Progress::silent(&stop)).is_err());
}

/// Heights of floors of a real room are those of planes through the points nearby, laid by another way.
#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn a_real_room_has_its_floor_where_its_points_are() {
    let scan =
        kit::real_scans::read_in(&kit::real_scans::folder(), "laz-indoor-rooms/indoor-rooms.laz").unwrap();
    let floors = Floors::of(&scan, 1.0, &Progress::hidden()).expect("nobody cancels");
    assert!(floors.bytes() < 64 << 20 && floors.edge() < 0.11);
    let file = &scan.files[0];
    let points: Vec<DVec3> = file.points.xyz.iter().map(|&xyz| file.grid.p_in_world(xyz)).collect();
    let start = crate::walk::start::start(&scan.scene, 1.0, None);
    assert_eq!(start.kind, crate::walk::kind::ScanKind::Interior);
    // Hands at the start point all around, and down at floors at several distances.
    let hand = start.standpoint.floor_in_world + DVec3::Z * 1.3;
    let mut errors = Vec::new();
    for turn in 0..40 {
        for pitch_deg in [-65f64, -45.0, -25.0, -5.0, 10.0, 25.0] {
            let direction = DVec2::from_angle(0.157 * f64::from(turn));
            let pitch = pitch_deg.to_radians();
            let along = (direction * pitch.cos()).extend(pitch.sin());
            let arc = arc::arc(Ground::Floors(&floors), hand, along, 0.0, arc::speed_for(8.0), 1.0);
            let Some(landing) = arc.landing else { continue };
            let p = landing.floor_in_world;
            // Furniture and door sills within the circle would tell of another plane.
            let near: Vec<DVec3> = points
                .iter()
                .copied()
                .filter(|q| (*q - p).truncate().length() < 0.12 && (q.z - p.z).abs() < 0.06)
                .map(|q| q - p)
                .collect();
            // A hole of the scan has no points to compare with.
            if near.len() >= 100 {
                errors.push((plane_at_zero(&near).abs(), p));
            }
        }
    }
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(errors.len() >= 50, "{} landings", errors.len());
    assert!(errors.last().unwrap().0 < 0.01, "{:?}", errors.last());
}

/// Height at zero of the plane through points, of whose residuals the largest are left out three times.
fn plane_at_zero(points: &[DVec3]) -> f64 {
    let mut kept = points.to_vec();
    let mut plane = DVec3::ZERO;
    for _ in 0..4 {
        let (mut normal, mut right) = (glam::DMat3::ZERO, DVec3::ZERO);
        for p in &kept {
            let row = DVec3::new(1.0, p.x, p.y);
            normal += glam::DMat3::from_cols(row, row * p.x, row * p.y);
            right += row * p.z;
        }
        plane = normal.inverse() * right;
        let off = |p: &DVec3| (p.z - plane.dot(DVec3::new(1.0, p.x, p.y))).abs();
        kept.sort_by(|a, b| off(a).total_cmp(&off(b)));
        kept.truncate(kept.len() * 9 / 10);
    }
    plane.x
}

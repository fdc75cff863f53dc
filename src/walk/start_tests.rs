//! Where walks begin in scenes of every kind and size, near zero and far from it.

use super::*;
use crate::walk::action::Action;
use crate::walk::locomotion::{Locomotion, LocomotionOptions, StartsCell, head_of};
use crate::walk::moving::floors::FloorsCell;
use crate::walk::simulated::{SimulatedHeadset, SimulatedOptions};
use glam::DVec4;

/// A sequence that fills a square evenly.
fn square(num: usize) -> impl Iterator<Item = [f64; 2]> {
    (0..num).map(|i| [(i as f64 * 0.754_877_666_246_693).fract(), (i as f64 * 0.569_840_290_998_053).fract()])
}

fn scene(origin: DVec3, points: impl IntoIterator<Item = DVec3>) -> Scene {
    let samples: Vec<DVec3> = points.into_iter().map(|p| origin + p).collect();
    // As dense as a scanner on the ground makes it.
    Scene { num_points: 1000 * samples.len() as u64, ..Scene::around(samples) }
}

/// A floor of `x` by `y`, its middle at zero.
fn floor(x: f64, y: f64) -> Vec<DVec3> {
    square(8000).map(|[u, v]| DVec3::new((u - 0.5) * x, (v - 0.5) * y, 0.0)).collect()
}

/// Four walls round a floor of `x` by `y`.
fn walls(x: f64, y: f64, height: f64) -> Vec<DVec3> {
    let wall = |(i, [u, v]): (usize, [f64; 2])| match i % 4 {
        0 => DVec3::new((u - 0.5) * x, -0.5 * y, v * height),
        1 => DVec3::new((u - 0.5) * x, 0.5 * y, v * height),
        2 => DVec3::new(-0.5 * x, (u - 0.5) * y, v * height),
        _ => DVec3::new(0.5 * x, (u - 0.5) * y, v * height),
    };
    square(16_000).enumerate().map(wall).collect()
}

/// The surface of an egg that stands on z = 0.
fn egg(width: f64, height: f64) -> Vec<DVec3> {
    let at = |[u, v]: [f64; 2]| {
        let (turn, z) = (std::f64::consts::TAU * u, 2.0 * v - 1.0);
        let r = (1.0 - z * z).sqrt();
        DVec3::new(0.5 * width * r * turn.cos(), 0.5 * width * r * turn.sin(), 0.5 * height * (z + 1.0))
    };
    square(8000).map(at).collect()
}

/// The start that a scene tells itself.
fn begin(scene: &Scene, unit_m: f64) -> Start {
    start(scene, unit_m, None)
}

/// A headset that sees 90 degrees in both directions.
const HEADSET: SimulatedOptions = SimulatedOptions {
    size_px: [100, 100],
    left_fov: Fov { left: -1.0, right: 1.0, up: 1.0, down: -1.0 },
    eye_distance_m: 0.063,
    cant_rad: 0.0,
    refresh_hz: 90.0,
    eye_height_m: 1.7,
};
/// Part of the scene that both eyes of the simulated headset see at the start.
fn seen(scene: &Scene, start: Start) -> f64 {
    let eyes = SimulatedHeadset::eyes(&HEADSET);
    let (options, head) = (LocomotionOptions::sample(), head_of(&eyes));
    let mut walk =
        Locomotion::new(options, start, StartsCell::default(), FloorsCell::default(), Vec::new(), &head);
    walk.set_may_pitch(true);
    let view = walk.stage().view(&walk.world_from_head(&head_of(&eyes)), &eyes, [[100, 100]; 2], 0.05);
    let is_seen = |p: DVec3| {
        view.eyes.iter().all(|eye| {
            let q = (p - view.head_in_world()).extend(1.0);
            let [x, y, w] =
                eye.pixel_from_head(view.head_in_world()).map(|row| DVec4::from_array(row).dot(q));
            w > view.near && (0.0..100.0 * w).contains(&x) && (0.0..100.0 * w).contains(&y)
        })
    };
    scene.samples.iter().filter(|&&p| is_seen(p)).count() as f64 / scene.samples.len() as f64
}

const UTM: DVec3 = DVec3::new(5e5, 5e6, 300.0);

#[test]
fn an_object_is_seen_whole_from_outside() {
    for (width, height) in [(0.05, 0.04), (0.3, 0.2), (1.0, 2.0), (2.0, 0.5), (6.0, 9.0)] {
        for origin in [DVec3::ZERO, UTM] {
            let scene = scene(origin, egg(width, height));
            let start = begin(&scene, 1.0);
            let times = if width <= SMALL_M { SHOWN_M / width } else { 1.0 };
            let Standpoint { yaw, scale, .. } = start.standpoint;
            assert!((scale - times).abs() < 0.01 * times && yaw == 0.0, "{start:?}");
            let away = scene.bounds.min.y - start.standpoint.floor_in_world.y;
            assert!(start.kind == ScanKind::Object && away * scale > 0.39, "{width} {height}: {start:?}");
            assert!(seen(&scene, start) > 0.99, "{width} x {height}: {}", seen(&scene, start));
        }
    }
    // A statue and the ground round it are seen from outside, and so is a block of which only the outside of the
    // walls is known.
    let around = floor(5.0, 5.0).into_iter().filter(|p| p.length() > 0.9);
    let statue = scene(UTM, egg(2.0, 3.0).into_iter().chain(around));
    assert!(begin(&statue, 1.0).standpoint.floor_in_world.y < statue.bounds.min.y);
    let lid = floor(20.0, 12.0).into_iter().map(|p| p + DVec3::Z * 8.0);
    let block = scene(UTM, walls(20.0, 12.0, 8.0).into_iter().chain(lid));
    assert!(begin(&block, 1.0).standpoint.floor_in_world.y < block.bounds.min.y);
}

/// A wood of 200 m by 200: it is walked through if a scanner stood in it, and looked down at if one flew over it.
#[test]
fn what_was_scanned_from_the_air_is_seen_from_above() {
    let trees = square(12_000).map(|[u, v]| DVec3::new(u - 0.5, v - 0.5, 0.0) * 200.0);
    let trees = trees.enumerate().map(|(i, p)| p.with_z(20.0 * (i as f64 * 0.618).fract()));
    let wood = scene(UTM, floor(200.0, 200.0).into_iter().chain(trees));
    let kind = |per_m2: u64| begin(&Scene { num_points: 40_000 * per_m2, ..wood.clone() }, 1.0).kind;
    assert_eq!(kind(10), ScanKind::Landscape);
    assert_ne!(kind(1000), ScanKind::Landscape);
    // A small thing with few points is no landscape.
    let egg = Scene { num_points: 10, ..scene(UTM, egg(2.0, 3.0)) };
    assert_eq!(begin(&egg, 1.0).kind, ScanKind::Object);
}

#[test]
fn small_things_are_shown_a_meter_long_and_single_points_seen() {
    for (unit_m, edge) in [(1.0, 0.1), (1.0, 5e-3), (1.0, 5e-5), (1.0, 1e-7), (1e-3, 50.0)] {
        let scene = scene(DVec3::ZERO, egg(edge, 0.8 * edge));
        let start = begin(&scene, unit_m);
        let shown_m = start.standpoint.scale * scene.bounds.edge() * unit_m;
        assert!((shown_m - SHOWN_M).abs() < 1e-9 && seen(&scene, start) == 1.0, "{start:?}");
    }
    // A scan whose unit is known to be a millimeter is as large as life if it is 500 mm long.
    assert_eq!(begin(&scene(DVec3::ZERO, egg(500.0, 500.0)), 1e-3).standpoint.scale, 1.0);
    for num in [1, 500] {
        let scene = scene(UTM, vec![DVec3::ZERO; num]);
        assert_eq!(seen(&scene, begin(&scene, 1.0)), 1.0);
    }
}

/// Scanners see dust, reflections and passers-by in any room: single points, thin in the air and thick.
#[test]
fn points_in_the_air_of_a_room_put_nobody_out_of_it() {
    for (x, y, height) in [(4.0, 6.0, 2.7), (6.0, 4.0, 2.7), (12.0, 9.0, 3.5)] {
        let ceiling = floor(x, y).into_iter().map(|p| p + DVec3::Z * height);
        let room: Vec<DVec3> = floor(x, y).into_iter().chain(walls(x, y, height)).chain(ceiling).collect();
        for share in [0.001, 0.003, 0.01, 0.03] {
            let num = (share * room.len() as f64) as usize;
            // This sequence of three dimensions fills a box evenly.
            let at = |i: usize, step: f64| (i as f64 * step).fract();
            let in_air = (0..num).map(|i| {
                let [u, v, w] =
                    [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9].map(|step| at(i + 7, step));
                DVec3::new((u - 0.5) * x, (v - 0.5) * y, w * height)
            });
            let scene = scene(UTM, room.iter().copied().chain(in_air));
            let Start { kind, standpoint: Standpoint { floor_in_world, .. }, .. } = begin(&scene, 1.0);
            let what = format!("{x} x {y}, {share} in the air: {}", floor_in_world - UTM);
            let inside = scene.bounds.grown(-0.5);
            assert!(inside.contains(floor_in_world + DVec3::Z), "{what}");
            assert!((floor_in_world.z - UTM.z).abs() < 0.2, "{what}");
            assert_eq!(kind, ScanKind::Interior, "{what}");
        }
    }
}

#[test]
fn a_room_is_seen_from_its_floor() {
    let table = || square(500).map(|[u, v]| DVec3::new(u - 0.5, v - 0.5, 0.75));
    for (x, y, height) in [(2.6, 3.0, 2.4), (4.0, 6.0, 2.6), (30.0, 20.0, 7.0), (150.0, 100.0, 12.0)] {
        for ceiling in [false, true] {
            let above = floor(x, y).into_iter().map(|p| p + DVec3::Z * height);
            let above = above.filter(|_| ceiling);
            let points = floor(x, y).into_iter().chain(walls(x, y, height)).chain(above);
            let scene = scene(UTM, points.chain(table().filter(|_| x > 3.0)));
            let Start { kind, standpoint: Standpoint { floor_in_world, .. }, walks, .. } = begin(&scene, 1.0);
            // Wide walls without a ceiling are those of a yard.
            let room = if ceiling || x < 10.0 { ScanKind::Interior } else { ScanKind::Outdoors };
            assert_eq!((kind, walks), (room, true), "{x} x {y} x {height}");
            let inside = scene.bounds.grown(-0.5);
            let what = format!("{x} x {y} x {height}: {}", floor_in_world - UTM);
            assert!(inside.contains(floor_in_world.with_z(inside.center().z)), "{what}");
            assert!((floor_in_world.z - UTM.z).abs() < 0.01, "{what}");
            // The place is not in the table.
            let aside = (floor_in_world - UTM).truncate().abs().max_element();
            assert!(x <= 3.0 || aside > 0.5, "{what}");
        }
    }
    // A room in feet is treated alike.
    let feet = scene(UTM, floor(13.0, 20.0).into_iter().chain(walls(13.0, 20.0, 8.5)));
    let Standpoint { floor_in_world, .. } = begin(&feet, 0.3048).standpoint;
    assert!((floor_in_world - UTM).length() < 1.5, "{floor_in_world}");
}

#[test]
fn open_ground_is_stood_on_facing_what_there_is() {
    // Nobody scans the ground below a statue.
    let ground = floor(40.0, 30.0).into_iter().filter(|p| p.length() > 1.4).chain(egg(3.0, 5.0));
    let scene = scene(UTM, ground);
    let Standpoint { floor_in_world, yaw, .. } = begin(&scene, 1.0).standpoint;
    let to_middle = (UTM - floor_in_world).truncate();
    assert!((1.5..6.0).contains(&to_middle.length()), "{to_middle}");
    assert!((floor_in_world.z - UTM.z).abs() < 0.01);
    let ahead = glam::DVec2::new(-yaw.sin(), yaw.cos());
    assert!(ahead.dot(to_middle.normalize()) > 0.99, "{floor_in_world} {yaw}");
}

/// A scanner at a place.
fn scanner(p_in_world: DVec3) -> PlacedStation {
    PlacedStation { name: "1".into(), kind: StationKind::Scanner, p_in_world, looks_in_world: None }
}

#[test]
fn one_begins_where_a_scanner_stood() {
    let room = floor(9.0, 4.0).into_iter().chain(walls(9.0, 4.0, 2.7));
    let mut scene = scene(UTM, room);
    let without = begin(&scene, 1.0).standpoint;
    let stations = [DVec3::new(-3.8, 0.2, 1.5), DVec3::new(3.0, -1.0, 1.2), DVec3::new(70.0, 0.0, 1.5)];
    scene.stations = stations.map(|p| scanner(UTM + p)).to_vec();
    let Standpoint { floor_in_world, yaw, .. } = begin(&scene, 1.0).standpoint;
    // The nearest to the middle, on the floor, and not with the face to the wall.
    assert!((floor_in_world - UTM - DVec3::new(3.0, -1.0, 0.0)).length() < 1e-6, "{}", floor_in_world - UTM);
    let ahead = glam::DVec2::new(-yaw.sin(), yaw.cos());
    assert!(ahead.x < -0.9, "{ahead}");
    assert_ne!(without.floor_in_world, floor_in_world);
    // In the middle of a long room one looks along it.
    assert!(without.yaw.sin().abs() > 0.9, "{without:?}");
    // On an upper floor, the floor below is none.
    let storey = floor(9.0, 4.0).into_iter().map(|p| p + DVec3::Z * 3.0);
    let upper = walls(9.0, 4.0, 6.0).into_iter().chain(storey).chain(floor(9.0, 4.0));
    let mut house = self::scene(UTM, upper);
    house.stations = vec![scanner(UTM + DVec3::new(2.0, 0.0, 4.6))];
    let start = start(&house, 1.0, Some(ScanKind::Interior));
    assert!((start.standpoint.floor_in_world.z - UTM.z - 3.0).abs() < 0.01, "{:?}", start.standpoint);
}

#[test]
fn stations_are_places_to_stand() {
    let mut scene = scene(UTM, floor(9.0, 4.0));
    let camera = PlacedStation {
        kind: StationKind::Camera,
        looks_in_world: Some(DVec3::new(-0.8, 0.0, -0.6)),
        ..scanner(UTM + DVec3::new(1.0, 1.0, 5.0))
    };
    scene.stations = vec![scanner(UTM + DVec3::new(-3.0, 0.0, 1.7)), camera];
    let places = stations(&scene, 1.0);
    assert!((places[0].floor_in_world - UTM - DVec3::new(-3.0, 0.0, 0.0)).length() < 1e-6);
    assert!((places[1].floor_in_world.z - UTM.z - 3.3).abs() < 1e-6);
    assert!((places[1].yaw.to_degrees() - 90.0).abs() < 1e-6, "the camera looks west");
    // In feet, all is as high above the floor.
    let feet = stations(&scene, 0.3048);
    assert!((feet[1].floor_in_world.z - UTM.z - (5.0 - 1.7 / 0.3048)).abs() < 1e-6);
}

#[test]
fn a_landscape_is_a_model_on_a_table_and_is_come_down_to() {
    let hills = square(20_000)
        .map(|[u, v]| DVec3::new(1500.0 * u, 1000.0 * v, 40.0 * ((9.0 * u).sin() + (7.0 * v).cos())));
    let scene = scene(UTM, hills);
    let start = begin(&scene, 1.0);
    assert_eq!((start.kind, start.standpoint), (ScanKind::Landscape, start.overview));
    assert!(seen(&scene, start) > 0.97, "{}", seen(&scene, start));
    let head = head_of(&SimulatedHeadset::eyes(&HEADSET));
    let (starts, floors) = (StartsCell::default(), FloorsCell::default());
    let mut walk = Locomotion::new(LocomotionOptions::sample(), start, starts, floors, Vec::new(), &head);
    let width_m = scene.bounds.size().x / walk.stage().units_per_m();
    assert!((width_m - 2.0).abs() < 1e-9, "{width_m}");
    // Without floors to point at one comes down to where the whole is seen from; with floors see below.
    walk.apply(Action::LifeSize);
    assert_eq!(walk.stance().scale, 1.0);
    let eye = walk.world_from_head(&head).position;
    assert!(eye.y < scene.bounds.min.y && eye.z > scene.bounds.max.z, "{eye}");
    // A room with a view far through its windows is no landscape.
    let far = square(300).map(|[u, v]| DVec3::new(400.0 * (u - 0.5), 5.0 + 300.0 * v, 4.0 * v));
    let room = floor(8.0, 8.0).into_iter().chain(walls(8.0, 8.0, 3.0)).chain(far);
    let start = begin(&self::scene(UTM, room), 1.0);
    assert_eq!(start.kind, ScanKind::Interior);
    assert!((start.standpoint.floor_in_world - UTM).length() < 4.0);
}

#[test]
fn the_user_may_take_a_scan_for_another_kind() {
    let yard = floor(40.0, 30.0).into_iter().filter(|p| p.length() > 1.4).chain(egg(3.0, 5.0));
    let room = floor(6.0, 4.0).into_iter().chain(walls(6.0, 4.0, 2.7));
    for scene in [scene(UTM, yard), scene(UTM, room), scene(UTM, egg(0.05, 0.05))] {
        let starts = ScanKind::ALL.map(|kind| start(&scene, 1.0, Some(kind)));
        assert_eq!(starts.map(|start| start.kind), ScanKind::ALL);
        // What the scene tells is what the kind that it tells says.
        let told = begin(&scene, 1.0);
        let same = starts.into_iter().find(|start| start.kind == told.kind).expect("each kind");
        assert_eq!(same.standpoint, told.standpoint);
        let (cell, floors) = (StartsCell::default(), FloorsCell::default());
        let head = head_of(&SimulatedHeadset::eyes(&HEADSET));
        let options = LocomotionOptions::sample();
        let mut walk = Locomotion::new(options, told, Arc::clone(&cell), floors, Vec::new(), &head);
        let before = *walk.stage();
        walk.apply(Action::TakeFor(ScanKind::Landscape));
        assert_eq!(*walk.stage(), before, "nobody knows yet where to stand");
        cell.set(starts).expect("an empty cell");
        for kind in ScanKind::ALL {
            walk.apply(Action::TakeFor(kind));
            assert_eq!(walk.stance().kind, kind);
            assert!(walk.stance().is_walking || kind != ScanKind::Interior);
        }
        walk.apply(Action::TakeFor(told.kind));
        let (now, units_per_m) = (*walk.stage(), before.units_per_m());
        assert!((now.floor_in_world - before.floor_in_world).length() < 1e-6 * units_per_m, "{now:?}");
        assert_eq!((now.yaw, now.scale), (before.yaw, before.scale));
    }
}

/// The surfaces of a corridor of 5 by 3 along `at`, which gives a place and the direction there.
fn corridor(num: usize, at: impl Fn(f64) -> (glam::DVec2, glam::DVec2)) -> Vec<DVec3> {
    let point = |(i, [u, v]): (usize, [f64; 2])| {
        let (place, ahead) = at(u);
        let (aside, height) = match i % 4 {
            0 => (5.0 * (v - 0.5), 0.0),
            1 => (5.0 * (v - 0.5), 3.0),
            2 => (-2.5, 3.0 * v),
            _ => (2.5, 3.0 * v),
        };
        (place + ahead.perp() * aside).extend(height)
    };
    square(num).enumerate().map(point).collect()
}

#[test]
fn what_is_long_and_thin_is_walked_or_seen_from_near_by() {
    let straight = |turn: f64| {
        let ahead = glam::DVec2::from_angle(turn);
        move |u: f64| (ahead * 5000.0 * (u - 0.5), ahead)
    };
    let bend = |u: f64| {
        let ahead = glam::DVec2::from_angle(3.0 * u);
        (ahead.perp() * -1500.0, ahead)
    };
    for num in [20_000, 130_000] {
        let corridors = [0.0, 0.5, 0.785, 1.57].map(|turn| corridor(num, straight(turn)));
        for points in corridors.into_iter().chain([corridor(num, bend)]) {
            let scene = scene(UTM, points);
            let start = begin(&scene, 1.0);
            let eye = start.standpoint.floor_in_world + DVec3::Z * 1.7;
            let nearest = scene.samples.iter().map(|p| p.distance(eye)).fold(f64::INFINITY, f64::min);
            assert!(nearest < 100.0, "{num}: {nearest} away, at {}", start.standpoint.floor_in_world - UTM);
            assert!(
                (start.standpoint.floor_in_world.z - UTM.z).abs() < 3.0,
                "{}",
                start.standpoint.floor_in_world - UTM
            );
        }
    }
    // A strip of an aerial scan is still a landscape, but it is not seen from as far away as it is long.
    let strip = square(60_000).map(|[u, v]| DVec3::new(15_000.0 * u, 400.0 * v, 20.0 * (9.0 * u).sin()));
    let strip = scene(UTM, strip);
    let start = begin(&strip, 1.0);
    let away = strip.bounds.min.y - start.standpoint.floor_in_world.y;
    assert!(
        (200.0..4_000.0).contains(&away) && start.standpoint.floor_in_world.z > UTM.z,
        "{away}: {start:?}"
    );
    // Neither two buildings nor a wall are cut.
    let apart = |i: usize| DVec3::X * if i.is_multiple_of(2) { 0.0 } else { 300.0 };
    let two = walls(20.0, 20.0, 8.0).into_iter().enumerate().map(|(i, p)| p + apart(i));
    let wall = square(9000).map(|[u, v]| DVec3::new(30.0 * u, 0.0, 6.0 * v));
    for whole in [scene(UTM, two), scene(UTM, wall)] {
        assert!(seen(&whole, begin(&whole, 1.0)) > 0.99);
    }
}

#[test]
fn a_hollow_tower_in_the_open_is_seen_from_outside() {
    for (radius, num) in [(1.5, 4000), (2.0, 4000), (2.0, 40_000)] {
        let ground = square(num).map(|[u, v]| DVec3::new(20.0 * (u - 0.5), 20.0 * (v - 0.5), 0.0));
        let tower = square(num / 2).map(|[u, v]| {
            let turn = std::f64::consts::TAU * u;
            DVec3::new(radius * turn.cos(), radius * turn.sin(), 6.0 * v)
        });
        let places: Vec<DVec3> = ground.chain(tower).collect();
        // Strays that are as near as the scene is large belong to it: they are above and below it, and at the walls'
        // heights too.
        for strays in [0.0, 0.003, 0.01] {
            let strays = square((strays * num as f64) as usize).map(|[u, v]| {
                DVec3::new(24.0 * (u - 0.5), 24.0 * (v - 0.5), 19.0 * (7.0 * u + v).fract() - 8.0)
            });
            let scene = scene(UTM, places.iter().copied().chain(strays));
            let Standpoint { floor_in_world, yaw, .. } = begin(&scene, 1.0).standpoint;
            let to_tower = (UTM - floor_in_world).truncate();
            let what = format!("{radius} {num}: {}", floor_in_world - UTM);
            assert!((radius + 1.5..12.0).contains(&to_tower.length()), "{what}");
            assert!((floor_in_world.z - UTM.z).abs() < 0.01, "{what}");
            let ahead = glam::DVec2::new(-yaw.sin(), yaw.cos());
            assert!(ahead.dot(to_tower.normalize()) > 0.99, "{what} {yaw}");
        }
    }
}

/// A tube of `radius` and `length` along `turn`, open, lying on z = 0.
fn tube(radius: f64, length: f64, turn: f64) -> Vec<DVec3> {
    let (ahead, right) = (glam::DVec2::from_angle(turn), -glam::DVec2::from_angle(turn).perp());
    let at = |[u, v]: [f64; 2]| {
        let round = std::f64::consts::TAU * v;
        (ahead * length * (u - 0.5) + right * radius * round.sin()).extend(radius * (1.0 - round.cos()))
    };
    square(20_000).map(at).collect()
}

#[test]
fn a_round_tunnel_begins_inside_and_what_is_round_otherwise_is_none() {
    for (radius, length) in [(1.3, 20.0), (2.0, 15.0), (3.0, 60.0), (6.0, 400.0), (3.0, 5000.0)] {
        for turn in [0.0, 0.5, 0.785, 1.57, 2.4] {
            let ahead = glam::DVec2::from_angle(turn);
            // Rails lie in the tube, and there are a few strays.
            let rails = square(400).map(|[u, _]| (ahead * length * (u - 0.5)).extend(0.15 * radius));
            let strays = square(40).map(|[u, v]| DVec3::new(2.0 * radius * u, 0.0, 3.0 * radius * v));
            let scene = scene(UTM, tube(radius, length, turn).into_iter().chain(rails).chain(strays));
            let Standpoint { floor_in_world, yaw, .. } = begin(&scene, 1.0).standpoint;
            let at = floor_in_world - UTM;
            let what = format!("{radius} {length} {turn}: {at}");
            assert!(
                at.z.abs() < 0.05 * radius && at.truncate().perp_dot(ahead).abs() < 0.1 * radius,
                "{what}"
            );
            assert!(at.truncate().dot(ahead).abs() < 0.1 * length, "{what}");
            assert!(glam::DVec2::new(-yaw.sin(), yaw.cos()).dot(ahead).abs() > 0.99, "{what}: {yaw}");
        }
    }
    let lid = |x: f64, radius: f64| {
        square(500).map(move |[u, v]| {
            let (round, r) = (std::f64::consts::TAU * u, radius * v.sqrt());
            DVec3::new(x, r * round.sin(), radius - r * round.cos())
        })
    };
    let ground = floor(40.0, 30.0).into_iter();
    let standing = |p: DVec3| DVec3::new(p.z, p.y, p.x);
    for (what, points) in [
        ("a tank", tube(2.0, 14.0, 0.0).into_iter().chain(lid(-7.0, 2.0)).chain(lid(7.0, 2.0)).collect()),
        ("a can", tube(2.0, 8.0, 0.0)),
        ("a thin pipe", tube(0.6, 20.0, 0.0)),
        ("a column", tube(2.0, 20.0, 0.0).into_iter().map(standing).collect()),
        ("half a pipe", tube(3.0, 30.0, 0.0).into_iter().filter(|p| p.z > 2.0).collect()),
        (
            "a pipe over ground",
            tube(2.0, 20.0, 0.0).into_iter().map(|p| p + DVec3::Z).chain(ground).collect::<Vec<_>>(),
        ),
    ] {
        assert_eq!(tube::floor(&scene(UTM, points), 1.0), None, "{what}");
    }
}

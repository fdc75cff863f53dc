//! Scenes and strays of every kind that users have met, along the axes that they vary in.

use super::super::random::Random;
use super::find;
use base::space::Bounds;
use glam::DVec3;

impl Random {
    /// A position in the cube from −1 to 1.
    fn in_cube(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
    }

    fn direction(&mut self) -> DVec3 {
        loop {
            let p = self.in_cube();
            if (0.1..1.0).contains(&p.length()) {
                return p.normalize();
            }
        }
    }
}

/// A position on a floor and four walls round zero, of edge 1 and half as high.
fn building(random: &mut Random) -> DVec3 {
    let [u, v] = [random.next() - 0.5, random.next() - 0.5];
    let height = 0.5 * (v + 0.5);
    match (5.0 * random.next()) as u32 {
        0 => DVec3::new(u, v, 0.0),
        1 => DVec3::new(u, -0.5, height),
        2 => DVec3::new(u, 0.5, height),
        3 => DVec3::new(-0.5, u, height),
        _ => DVec3::new(0.5, u, height),
    }
}

#[derive(Clone, Copy, Debug)]
enum Strays {
    /// All strays in one place.
    Clump,
    /// Strays in seven places.
    Clumps,
    /// Strays all around, equally far away.
    Shell,
    /// Strays evenly through a cube.
    Dust,
    /// Each stray ten times as far away as the one before, up to 1e38.
    Rows,
    /// The same point over and over.
    Zeros,
    /// Strays above the scene.
    HighNoise,
}

const ALL: [Strays; 7] = [
    Strays::Clump,
    Strays::Clumps,
    Strays::Shell,
    Strays::Dust,
    Strays::Rows,
    Strays::Zeros,
    Strays::HighNoise,
];

impl Strays {
    /// Stray number `i`, in edges of the scene, `far` edges away.
    fn at(self, i: usize, far: f64, random: &mut Random) -> DVec3 {
        let direction = |number: usize| Random(number as u64).direction();
        match self {
            Self::Clump => direction(1) * far + random.in_cube(),
            Self::Clumps => direction(1 + i % 7) * far * (1 + i % 7) as f64 + random.in_cube(),
            Self::Shell => random.direction() * far,
            Self::Dust => random.in_cube() * far,
            Self::Rows => direction(i) * far * 10f64.powi((i % 34) as i32),
            Self::Zeros => DVec3::new(-3.0, -40.0, 0.01) * far,
            Self::HighNoise => {
                DVec3::new(random.next() - 0.5, random.next() - 0.5, far * (0.3 + 2.0 * random.next()))
            }
        }
    }
}

/// Asserts that the scene's own box is found: all of it, and at most an edge more, by strays that happen to be near.
fn assert_found(scene: &Bounds, found: Option<Bounds>, what: &str) {
    let found = found.expect("a scene");
    // f64 resolves a nanometer at coordinates of 5e6.
    let slack = 1e-8 + scene.edge();
    assert!(found.contains(scene.min) && found.contains(scene.max), "{what}: {found:?} cuts {scene:?}");
    let most = scene.grown(slack);
    assert!(most.contains(found.min) && most.contains(found.max), "{what}: {found:?} is more than {scene:?}");
}

#[test]
fn strays_of_any_kind_share_number_and_place_do_not_count() {
    let mut num_cases = 0;
    for num in [10, 150, 2_000, 100_000] {
        for share in [0.0, 1e-5, 0.001, 0.015, 0.1, 0.2] {
            let num_strays = (share * num as f64).ceil() as usize;
            for strays in ALL {
                for (edge, origin) in [
                    (5e-5, DVec3::ZERO),
                    (1.0, DVec3::ZERO),
                    (20.0, DVec3::new(5e5, 5e6, 300.0)),
                    (5e4, DVec3::ZERO),
                ] {
                    // The largest number is slow without optimization, so only some of its cases are run.
                    if num == 100_000 && (edge != 20.0 || ![1e-5, 0.2].contains(&share)) {
                        continue;
                    }
                    let random = &mut Random(num as u64);
                    let mut positions: Vec<DVec3> =
                        (0..num - num_strays).map(|_| origin + building(random) * edge).collect();
                    let scene = Bounds::around(&positions);
                    positions.extend((0..num_strays).map(|i| origin + strays.at(i, 50.0, random) * edge));
                    let what = format!("{num_strays} of {num} {strays:?}, edge {edge}");
                    assert_found(&scene, find(positions), &what);
                    num_cases += 1;
                }
            }
        }
    }
    assert!(num_cases > 400);
}

#[test]
fn a_layer_above_or_a_fog_beside_a_scene_does_not_count_where_a_building_does() {
    type Mapping = fn(DVec3, f64) -> DVec3;
    let places: [(&str, Mapping); 4] = [
        ("a layer above", |p, far| p.with_z(0.01 * p.z + far)),
        ("a layer below", |p, far| p.with_z(0.01 * p.z - far)),
        ("a fog", |p, far| 0.5 * p + DVec3::X * far),
        ("a wide fog", |p, far| p + DVec3::new(1.0, 0.8, 0.1) * far),
    ];
    for (what, at) in places {
        for num in [3_000, 50_000] {
            for far in [4.0, 8.0, 16.0, 50.0, 166.0] {
                let random = &mut Random(num as u64);
                let mut positions: Vec<DVec3> = (0..num * 82 / 100).map(|_| building(random)).collect();
                let scene = Bounds::around(&positions);
                positions.extend((0..num * 18 / 100).map(|_| at(0.5 * random.in_cube(), far)));
                assert_found(&scene, find(positions), &format!("{what} of {num} {far} away"));
            }
        }
    }
    let random = &mut Random(7);
    let two = (0..3_000).map(|i| building(random) + DVec3::X * if i % 100 < 18 { 16.0 } else { 0.0 });
    assert_whole(two.collect(), "a building beside");
}

#[test]
fn a_splat_with_floaters() {
    for (share, far) in [(0.03, 2e3), (0.1, 500.0), (0.2, 100.0)] {
        let random = &mut Random(3);
        let mut positions: Vec<DVec3> = (0..20_000).map(|_| random.direction() * random.next()).collect();
        let scene = Bounds::around(&positions);
        positions.extend((0..(share * 20_000.0) as usize).map(|_| random.in_cube() * far));
        assert_found(&scene, find(positions), &format!("{share} floaters up to {far}"));
    }
}

/// Asserts that nothing is cut: the box is the true one.
fn assert_whole(positions: Vec<DVec3>, what: &str) {
    let all = Bounds::around(&positions);
    assert_eq!(find(positions), Some(all), "{what}");
}

#[test]
fn honest_scenes_stay_whole() {
    let random = &mut Random(1);
    for num in [200, 3_000, 60_000] {
        for share in [0.5, 0.7, 0.9] {
            let at = |i: usize| if (i as f64) < share * num as f64 { 0.0 } else { 300.0 };
            let two = (0..num).map(|i| building(random) * 20.0 + DVec3::X * at(i));
            assert_whole(two.collect(), "two buildings");
        }
        let strip = (0..num).map(|_| random.in_cube() * DVec3::new(15_000.0, 200.0, 20.0));
        assert_whole(strip.collect(), "an aerial strip");
        // A mast needs more points than two, which could be birds.
        let mast = (0..num).map(|i| match i % (num / 30).min(100) {
            0 => DVec3::Z * 150.0 * random.next(),
            _ => building(random) * 20.0,
        });
        assert_whole(mast.collect(), "a mast");
        let line = (0..num).map(|i| DVec3::Y * i as f64);
        assert_whole(line.collect(), "a line");
        let plane = (0..num).map(|_| DVec3::new(random.next(), random.next(), 0.0));
        assert_whole(plane.collect(), "a plane");
        let blob = (0..num).map(|_| random.in_cube() + random.in_cube() + random.in_cube());
        assert_whole(blob.collect(), "a cloud without edges");
    }
}

#[test]
fn the_far_field_of_a_terrestrial_scan_belongs_to_it() {
    // A scanner stands 1.7 above flat ground and sees as many points at each degree of elevation, some on a wall near
    // by.
    for (num, reach) in [(3_000, 60.0), (50_000, 150.0), (100_000, 300.0)] {
        let random = &mut Random(2);
        let ground = (0..num).map(|i| {
            let azimuth = std::f64::consts::TAU * random.next();
            let direction = DVec3::new(azimuth.cos(), azimuth.sin(), 0.0);
            if i % 2 == 0 && direction.x > 0.0 {
                return direction * (8.0 / direction.x).min(9.0) + DVec3::Z * 4.0 * random.next();
            }
            let steepest = std::f64::consts::FRAC_PI_3;
            direction * (1.7 / (steepest * random.next()).tan()).min(reach * random.next().powf(0.2))
        });
        let positions: Vec<DVec3> = ground.collect();
        let (all, found) = (Bounds::around(&positions), find(positions).unwrap());
        assert!(found.edge() > 0.8 * all.edge(), "{num}: {found:?} of {all:?}");
    }
}

#[test]
fn few_points_are_all_the_scene() {
    assert_eq!(find(vec![]), None);
    let one = DVec3::new(5e5, 5e6, 7.0);
    assert_eq!(find(vec![one]), Some(Bounds { min: one, max: one }));
    assert_eq!(find(vec![one; 500]), Some(Bounds { min: one, max: one }));
    for num in 2..30 {
        for seed in 0..100 {
            let random = &mut Random(1000 * num + seed);
            assert_whole((0..num).map(|_| random.in_cube()).collect(), &format!("{num} points"));
        }
    }
    // Most points of a file may be zeros, where the scanner saw nothing.
    let mut random = Random(5);
    let seen: Vec<DVec3> = (0..300).map(|_| one + building(&mut random)).collect();
    let scene = Bounds::around(&seen);
    let with_zeros = seen.into_iter().chain(vec![DVec3::ZERO; 700]).collect();
    assert_eq!(find(with_zeros), Some(scene));
}

#[test]
fn the_comparison_can_fail() {
    let scene = Bounds { min: DVec3::ZERO, max: DVec3::ONE };
    for wrong in [scene.grown(-0.1), scene.grown(1.1)] {
        let caught = std::panic::catch_unwind(|| assert_found(&scene, Some(wrong), "wrong"));
        assert!(caught.is_err(), "{wrong:?}");
    }
}

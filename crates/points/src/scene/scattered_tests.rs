//! Halos of strays round scenes of every kind, by ratio of sizes, share, number of points and shape, and scans without
//! strays.

use super::super::cluster::find;
use super::super::random::{Random, SceneMaker, aerial, room};
use base::space::Bounds;
use glam::DVec3;
use std::f64::consts::TAU;

impl Random {
    /// A position that is normally distributed along each axis.
    fn bell(&mut self) -> DVec3 {
        DVec3::from_array(
            [0; 3].map(|_| (-2.0 * (1.0 - self.next()).ln()).sqrt() * (TAU * self.next()).cos()),
        )
    }
}

/// A floor with a slender tower.
fn tower(random: &mut Random) -> DVec3 {
    let turn = TAU * random.next();
    match random.next() {
        part if part < 0.67 => DVec3::new(random.next() - 0.5, random.next() - 0.5, 0.0),
        _ => DVec3::new(0.1 * turn.cos(), 0.1 * turn.sin(), 0.3 * random.next()),
    }
}

/// A corridor two hundred times as long as wide.
fn corridor(random: &mut Random) -> DVec3 {
    DVec3::new(room(random).x, 0.005 * room(random).x, 0.005 * room(random).z)
}

fn egg(random: &mut Random) -> DVec3 {
    0.5 * random.bell().normalize()
}

/// Flat ground, seen from one place above it with as many points at each degree of elevation, a near wall, and far
/// trees.
fn terrestrial(random: &mut Random) -> DVec3 {
    let turn = TAU * random.next();
    let direction = DVec3::new(turn.cos(), turn.sin(), 0.0);
    if random.next() < 0.4 && direction.x > 0.0 {
        return direction * (0.06 / direction.x).min(0.07) + DVec3::Z * 0.03 * random.next();
    }
    let reach = 0.0125 / (std::f64::consts::FRAC_PI_3 * random.next()).tan();
    if reach < 0.5 {
        direction * reach
    } else {
        direction * 0.5 * random.next() + DVec3::Z * 0.05 * random.next()
    }
}

/// A yard, and trees beyond its gate, ten times as far away as it is wide.
fn courtyard(random: &mut Random) -> DVec3 {
    if random.next() < 0.97 {
        return 0.1 * room(random);
    }
    let tree = (12.0 * random.next()).floor();
    let foot = DVec3::new(0.15 + 0.35 * (0.618 * tree).fract(), 0.4 * ((0.37 * tree).fract() - 0.5), 0.02);
    foot + 0.012 * random.next() * random.bell().normalize()
}

fn two_buildings(random: &mut Random) -> DVec3 {
    let at = if random.next() < 0.9 { 0.0 } else { 0.93 };
    0.07 * room(random) + DVec3::X * at
}

/// Scenes that are equally dense all over, or nearly so.
const COMPACT: [SceneMaker; 5] =
    [("room", room), ("tower", tower), ("aerial", aerial), ("corridor", corridor), ("egg", egg)];
/// Scenes with sparse parts.
const THIN: [SceneMaker; 3] =
    [("terrestrial", terrestrial), ("courtyard", courtyard), ("two buildings", two_buildings)];

#[derive(Clone, Copy, Debug)]
enum Halo {
    Bell,
    Ball,
    /// A halo that thins out from the middle on.
    Exponential,
    /// A halo as flat as what an aerial scanner sees.
    Disc,
}

impl Halo {
    fn at(self, size: f64, random: &mut Random) -> DVec3 {
        match self {
            Self::Bell => size * random.bell(),
            Self::Ball => size * 2.0 * random.next().cbrt() * random.bell().normalize(),
            Self::Exponential => size * -(1.0 - random.next()).ln() * random.bell().normalize(),
            Self::Disc => size * random.bell() * DVec3::new(1.0, 1.0, 0.02),
        }
    }
}

/// The box of a scene of `num` points, `share` of them astray, and the box that is found.
fn found((_, scene): SceneMaker, halo: Halo, num: usize, share: f64, size: f64) -> (Bounds, Bounds) {
    let random = &mut Random(num as u64);
    let num_strays = (share * num as f64).ceil() as usize;
    let mut positions: Vec<DVec3> = (num_strays..num).map(|_| scene(random)).collect();
    let bounds = Bounds::around(&positions);
    positions.extend((0..num_strays).map(|_| halo.at(size, random)));
    (bounds, find(positions).expect("a scene"))
}

/// True if all of the scene is found, and at most an edge around it.
fn is_found((scene, found): (Bounds, Bounds)) -> bool {
    let most = scene.grown(scene.edge());
    found.contains(scene.min)
        && found.contains(scene.max)
        && most.contains(found.min)
        && most.contains(found.max)
}

#[test]
fn a_halo_at_any_ratio_of_sizes_does_not_count() {
    let mut num_cases = 0;
    for scene in COMPACT {
        for halo in [Halo::Bell, Halo::Ball, Halo::Exponential, Halo::Disc] {
            for num in [150, 1_000, 6_000] {
                for share in [0.003, 0.03, 0.15, 0.2] {
                    for ratio in [2.0, 3.0, 4.0, 7.5, 50.0, 10_000.0] {
                        // So few points hide a halo that is dense within the scene.
                        let is_dense = matches!(halo, Halo::Exponential | Halo::Disc);
                        if is_dense && (num < 1_000 && ratio < 7.5 || ratio < 3.0) {
                            continue;
                        }
                        let boxes = found(scene, halo, num, share, ratio);
                        let what = format!("{} {halo:?} {num} {share} {ratio}", scene.0);
                        assert!(is_found(boxes), "{what}: {:.2?} of {:.2?}", boxes.1, boxes.0);
                        num_cases += 1;
                    }
                }
            }
        }
    }
    assert!(num_cases > 1_000);
}

#[test]
fn a_halo_of_many_points_does_not_count() {
    for ratio in [2.0, 7.5] {
        let boxes = found(COMPACT[1], Halo::Bell, 100_000, 0.15, ratio);
        assert!(is_found(boxes), "{ratio}: {boxes:?}");
    }
}

#[test]
fn a_few_tens_of_points_are_enough() {
    for scene in COMPACT {
        for ratio in [4.0, 15.0, 1_000.0] {
            let boxes = found(scene, Halo::Bell, 40, 0.1, ratio);
            assert!(is_found(boxes), "{} {ratio}: {boxes:?}", scene.0);
        }
    }
}

#[test]
fn thin_parts_may_get_lost_among_strays_but_the_view_stays_near() {
    for scene in THIN {
        for num in [1_000, 6_000] {
            for share in [0.03, 0.15] {
                for ratio in [2.0, 4.0, 50.0, 10_000.0] {
                    let (bounds, found) = found(scene, Halo::Bell, num, share, ratio);
                    let what = format!("{} {num} {share} {ratio}: {found:.2?} of {bounds:.2?}", scene.0);
                    assert!(bounds.grown(bounds.edge()).contains(found.min), "{what}");
                    assert!(bounds.grown(bounds.edge()).contains(found.max), "{what}");
                }
            }
        }
    }
}

/// Where a scanner stands in scenes of 1 by 1 by 0.5.
const EYE: DVec3 = DVec3::new(0.1, 0.05, 0.1);
/// Largest distance by which a scanner's points go astray.
const ASTRAY: f64 = 75.0;

#[derive(Clone, Copy, Debug)]
enum Rays {
    /// Strays to all sides, at any distance.
    Around,
    /// Strays into the sky.
    Up,
    /// Strays within a narrow part of the sky.
    Cone,
    /// Strays beyond the points of the scene: points behind a pane, or reflected by it.
    Beyond,
    /// As many strays from one to two times as far as from two to four times.
    Logarithmic,
    /// Many strays in each of hundreds of directions.
    Hundreds,
}

impl Rays {
    fn at(self, scene: fn(&mut Random) -> DVec3, random: &mut Random) -> DVec3 {
        let far = ASTRAY * random.next();
        let direction = random.bell().normalize();
        let away = match self {
            Self::Around => direction * far,
            Self::Up => direction.with_z(direction.z.abs()) * far,
            Self::Cone => (direction + DVec3::Z * 3.0).normalize() * far,
            Self::Beyond => {
                let away = scene(random) - EYE;
                away + away.normalize() * far
            }
            Self::Logarithmic => direction * 0.02 * (ASTRAY / 0.02).powf(random.next()),
            Self::Hundreds => Random((300.0 * random.next()) as u64).bell().normalize() * far,
        };
        EYE + away
    }
}

/// Rays touch the scene, so strays are as dense as its points where rays begin. (`rays_tests.rs` has thousands of
/// strays in each of a few directions.)
#[test]
fn strays_along_a_scanners_rays_do_not_count() {
    for scene in [COMPACT[0], COMPACT[1], COMPACT[2], THIN[0]] {
        for rays in [Rays::Around, Rays::Up, Rays::Cone, Rays::Beyond, Rays::Logarithmic, Rays::Hundreds] {
            for num in [3_000, 20_000] {
                for share in [0.01, 0.1] {
                    let random = &mut Random(num);
                    let num_strays = (share * num as f64) as u64;
                    let mut positions: Vec<DVec3> = (num_strays..num).map(|_| scene.1(random)).collect();
                    let bounds = Bounds::around(&positions);
                    positions.extend((0..num_strays).map(|_| rays.at(scene.1, random)));
                    let found = find(positions).expect("a scene");
                    let what = format!("{} {rays:?} {num} {share}: {found:.2?} of {bounds:.2?}", scene.0);
                    let most = bounds.grown(bounds.edge());
                    assert!(most.contains(found.min) && most.contains(found.max), "{what}");
                    // The scene's thin parts may get lost among strays.
                    assert!(found.edge() > 0.6 * bounds.edge() || scene.0 == THIN[0].0, "{what}");
                }
            }
        }
    }
}

#[test]
fn without_strays_thin_parts_stay() {
    for (name, scene) in COMPACT.into_iter().chain(THIN) {
        for num in [1_000, 6_000, 30_000] {
            for seed in 0..(30_000 / num as u64).min(10) {
                let random = &mut Random(1000 * seed + num as u64);
                let positions: Vec<DVec3> = (0..num).map(|_| scene(random)).collect();
                let all = Bounds::around(&positions);
                assert_eq!(find(positions), Some(all), "{name} {num}");
            }
        }
    }
}

#[test]
fn the_comparison_can_fail() {
    let scene = Bounds { min: DVec3::ZERO, max: DVec3::ONE };
    assert!(is_found((scene, scene.grown(0.5))));
    assert!(!is_found((scene, scene.grown(-0.1))) && !is_found((scene, scene.grown(1.1))));
}

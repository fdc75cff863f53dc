//! Strays on few rays from scenes of every kind, and scans without strays that reach far in one direction.

use super::super::cluster::find;
use super::super::random::{Random, SceneMaker, aerial, room};
use base::space::Bounds;
use glam::DVec3;
use std::f64::consts::TAU;

/// A position on flat ground, seen from one place above it with as many points at each degree of elevation.
fn terrestrial(random: &mut Random) -> DVec3 {
    let turn = TAU * random.next();
    let reach = 0.0125 / (std::f64::consts::FRAC_PI_3 * random.next()).tan();
    DVec3::new(turn.cos(), turn.sin(), 0.0) * reach.min(0.5 * random.next())
}

const SCENES: [SceneMaker; 3] = [("room", room), ("aerial", aerial), ("terrestrial", terrestrial)];

/// Where the points of a ray lie, as parts of its length.
#[derive(Clone, Copy, Debug)]
enum RaySpread {
    Even,
    /// Fewer points further away.
    Thinning,
    /// As many points from one to two times as far as from two to four times.
    Logarithmic,
    /// Points beyond a tenth of the length only.
    Beyond,
}

const SPREADS: [RaySpread; 4] =
    [RaySpread::Even, RaySpread::Thinning, RaySpread::Logarithmic, RaySpread::Beyond];

impl RaySpread {
    fn at(self, random: &mut Random) -> f64 {
        let part = random.next();
        match self {
            Self::Even => part,
            Self::Thinning => part * part,
            Self::Logarithmic => 0.002f64.powf(part),
            Self::Beyond => 0.1 + 0.9 * part,
        }
    }
}

/// The box of a scene's own points, and the box that is found with strays on rays of these directions from a place in
/// it.
fn found(
    scene: SceneMaker,
    num: usize,
    share: f64,
    rays: &[DVec3],
    spread: RaySpread,
    length: f64,
) -> (Bounds, Bounds) {
    let random = &mut Random(num as u64 + rays.len() as u64);
    let num_strays = (share * num as f64) as usize;
    let mut positions: Vec<DVec3> = (num_strays..num).map(|_| scene.1(random)).collect();
    let bounds = Bounds::around(&positions);
    let eye = DVec3::new(0.0, 0.0, 0.0125);
    positions.extend((0..num_strays).map(|i| {
        let ray = rays[i % rays.len()];
        // Strays lie within a milliradian of the ray.
        let off = DVec3::new(random.next(), random.next(), random.next()) - 0.5;
        eye + (ray.normalize() + off * 1e-3) * length * spread.at(random)
    }));
    (bounds, find(positions).expect("a scene"))
}

fn directions(num: usize) -> Vec<DVec3> {
    let random = &mut Random(40 + num as u64);
    (0..num)
        .map(|_| DVec3::new(random.next() - 0.5, random.next() - 0.5, 0.4 * (random.next() - 0.2)))
        .collect()
}

#[test]
fn strays_on_few_rays_do_not_count() {
    let mut num_cases = 0;
    for scene in SCENES {
        for num in [150, 3_000, 40_000] {
            for share in [0.049, 0.1, 0.15, 0.2] {
                for num_rays in [1, 2, 5] {
                    for (spread, length) in SPREADS.into_iter().flat_map(|s| [(s, 100.0), (s, 15.0)]) {
                        // Nobody sees rays of so few points.
                        if share * (num as f64) < 20.0 * num_rays as f64 {
                            continue;
                        }
                        let rays = directions(num_rays);
                        let (bounds, found) = found(scene, num, share, &rays, spread, length);
                        let what = format!(
                            "{} {num} {share} {num_rays} {spread:?} {length}: {found:.2?} of {bounds:.2?}",
                            scene.0
                        );
                        let most = bounds.grown(1.5 * bounds.edge());
                        assert!(most.contains(found.min) && most.contains(found.max), "{what}");
                        // The scene's thin parts may get lost among strays.
                        assert!(found.edge() > 0.6 * bounds.edge() || scene.0 == "terrestrial", "{what}");
                        num_cases += 1;
                    }
                }
            }
        }
    }
    assert!(num_cases > 500);
}

/// A tunnel 100 times as long as wide, seen from one place with as many points at each degree.
fn tunnel(random: &mut Random) -> DVec3 {
    let (turn, along) = (TAU * random.next(), std::f64::consts::PI * (random.next() - 0.5));
    let at = (0.005 * along.tan()).clamp(-0.5, 0.5) * (0.9 + 0.1 * random.next());
    DVec3::new(at, 0.005 * turn.cos(), 0.005 * turn.sin())
}

/// A street between walls, seen from one place; wires above it.
fn street(random: &mut Random) -> DVec3 {
    let along = std::f64::consts::PI * (random.next() - 0.5);
    let at = (0.02 * along.tan()).clamp(-0.5, 0.5) * (0.9 + 0.1 * random.next());
    let height = 0.03 * random.next();
    match (10.0 * random.next()) as u32 {
        0..4 => DVec3::new(at, 0.02 * (2.0 * random.next() - 1.0), 0.0),
        4..6 => DVec3::new(at, 0.02, height),
        6..9 => DVec3::new(at, -0.02, height),
        _ => DVec3::new(at, 0.004, 0.02),
    }
}

/// A road with lamp posts, from a car.
fn road(random: &mut Random) -> DVec3 {
    let at = random.next() - 0.5;
    match (10.0 * random.next()) as u32 {
        0..9 => DVec3::new(at, 0.005 * (random.next() - 0.5), 0.0),
        _ => DVec3::new((20.0 * at).round() / 20.0, 0.0025, 0.01 * random.next()),
    }
}

/// Wires from tower to tower.
fn power_line(random: &mut Random) -> DVec3 {
    let at = random.next() - 0.5;
    let tower = (10.0 * at).round() / 10.0;
    let sag = 0.02 * (10.0 * (at - tower)).powi(2);
    match (10.0 * random.next()) as u32 {
        0..4 => DVec3::new(at, 0.008, 0.03 - sag),
        4..7 => DVec3::new(at, -0.008, 0.03 - sag),
        _ => DVec3::new(tower + 0.002 * random.next(), 0.016 * (random.next() - 0.5), 0.03 * random.next()),
    }
}

/// A machine house, and a pipe from it that half of the points are on.
fn pipe(random: &mut Random) -> DVec3 {
    if random.next() < 0.5 { 0.02 * room(random) } else { DVec3::new(0.01 + random.next(), 0.0, 0.002) }
}

/// A mast beside its hut.
fn mast(random: &mut Random) -> DVec3 {
    if random.next() < 0.95 { 0.1 * room(random) } else { DVec3::new(0.0, 0.0, random.next()) }
}

#[test]
fn what_reaches_far_in_one_direction_stays_whole() {
    for (name, scene) in [
        ("tunnel", tunnel as fn(&mut Random) -> DVec3),
        ("street", street),
        ("road", road),
        ("power line", power_line),
        ("pipe", pipe),
        ("mast", mast),
    ] {
        for num in [1_000, 6_000, 60_000] {
            for seed in 0..5 {
                let random = &mut Random(1000 * seed + num as u64);
                let positions: Vec<DVec3> = (0..num).map(|_| scene(random)).collect();
                let all = Bounds::around(&positions);
                assert_eq!(find(positions), Some(all), "{name} {num}");
            }
        }
    }
}

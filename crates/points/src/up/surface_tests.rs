//! Places of many kinds, with z up, y up and −y up: those that leave no doubt are turned, and none is turned wrongly.

use super::*;
use proptest::prelude::*;

/// Patches of a surface with this corner and these two edges; it faces along the cross product of the edges.
fn sheet(corner: [f64; 3], u: [f64; 3], v: [f64; 3], seed: u32) -> Vec<Patch> {
    let [corner, u, v] = [corner, u, v].map(DVec3::from_array);
    let cross = u.cross(v);
    let at = |i: u32| {
        let part = |salt: u32| {
            let hash = (i * 2 + salt + 7919 * seed).wrapping_mul(0x9e37_79b9);
            f64::from((hash ^ hash >> 15).wrapping_mul(0x85eb_ca6b) >> 8) / f64::from(1 << 24)
        };
        Patch {
            at: corner + u * part(0) + v * part(1),
            normal: cross.normalize(),
            area: cross.length() / 300.0,
        }
    };
    (0..300).map(at).collect()
}

/// A box from `low` to `high`, seen from inside or outside, without its bottom if it stands on something.
fn block(low: [f64; 3], high: [f64; 3], inside: bool, bottom: bool) -> Vec<Patch> {
    let [dx, dy, dz] = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    let (x, y, z) = ([dx, 0.0, 0.0], [0.0, dy, 0.0], [0.0, 0.0, dz]);
    // The sheets face out.
    let mut sheets = vec![
        sheet(low, x, z, 1),
        sheet(high, z.map(|c| -c), x.map(|c| -c), 2),
        sheet(low, z, y, 3),
        sheet(high, y.map(|c| -c), z.map(|c| -c), 4),
        sheet(high, x.map(|c| -c), y.map(|c| -c), 5),
    ];
    if bottom {
        sheets.push(sheet(low, y, x, 6));
    }
    let mut patches = sheets.concat();
    if inside {
        patches.iter_mut().for_each(|patch| patch.normal = -patch.normal);
    }
    patches
}

/// A rounded thing, as a statue is: an ellipsoid `size` wide, deep and high.
fn blob(size: [f64; 3], center: [f64; 3]) -> Vec<Patch> {
    let size = DVec3::from_array(size);
    let patch = |i: u32| {
        let z = 1.0 - (f64::from(i) + 0.5) / 500.0;
        let (turn, radius) = (2.399_963 * f64::from(i), (1.0 - z * z).sqrt());
        let p = DVec3::new(radius * turn.cos(), radius * turn.sin(), z);
        let area = 0.01 * size.length_squared();
        Patch { at: DVec3::from_array(center) + 0.5 * size * p, normal: (p / size).normalize(), area }
    };
    (0..1000).map(patch).collect()
}

/// A tube along z: a trunk, a silo, a shaft.
fn tube(radius: f64, height: f64, inside: bool) -> Vec<Patch> {
    let patch = |i: u32| {
        let turn = 2.399_963 * f64::from(i);
        let normal = DVec3::new(turn.cos(), turn.sin(), 0.0);
        let at = normal * radius + DVec3::Z * height * f64::from(i) / 1000.0;
        let area = 0.001 * std::f64::consts::TAU * radius * height;
        Patch { at, normal: if inside { -normal } else { normal }, area }
    };
    (0..1000).map(patch).collect()
}

/// Hills: a square `edge` long, `height` high.
fn hills(edge: f64, height: f64) -> Vec<Patch> {
    let k = 9.0 / edge;
    let mut patches = sheet([0.0; 3], [edge, 0.0, 0.0], [0.0, edge, 0.0], 8);
    for patch in &mut patches {
        let (x, y) = (patch.at.x, patch.at.y);
        let a = 0.5 * height;
        patch.at.z = a * ((k * x).sin() + (k * y).cos());
        patch.normal = DVec3::new(-a * k * (k * x).cos(), a * k * (k * y).sin(), 1.0).normalize();
    }
    patches
}

/// A room, the first of the kinds whose surfaces say which axis is up when they stand askew. All kinds are made with z
/// up.
fn room(seed: f64) -> Vec<Patch> {
    let (width, depth) = (4.0 + 3.0 * seed, 5.0);
    let mut patches = block([0.0; 3], [width, depth, 2.5], true, true);
    patches.extend(block([0.5, 0.5, 0.0], [2.0, 1.3, 0.7], false, false));
    patches.extend(blob([0.5, 0.5, 0.5], [3.0, 3.0, 0.3]));
    patches
}

/// A house in its garden.
fn house(seed: f64) -> Vec<Patch> {
    let edge = 16.0 + 4.0 * seed;
    let mut patches = sheet([0.0; 3], [edge, 0.0, 0.0], [0.0, edge, 0.0], 9);
    patches.extend(block([4.0, 5.0, 0.0], [12.0, 11.0, 7.0], false, false));
    patches.extend(blob([2.0, 2.0, 3.0], [2.0, 2.0, 2.0]));
    patches
}

/// A statue on the ground around it.
fn monument(seed: f64) -> Vec<Patch> {
    let mut patches = sheet([-2.0, -2.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], 10);
    patches.extend(block([-0.5, -0.5, 0.0], [0.5, 0.5, 0.6], false, false));
    patches.extend(blob([0.8, 0.8, 1.5 + seed], [0.0, 0.0, 1.3]));
    patches
}

fn hall(seed: f64) -> Vec<Patch> {
    block([0.0; 3], [10.0 + 5.0 * seed, 12.0, 3.0], true, true)
}

/// A facade, the first of the kinds that say nothing, or that only z explains.
fn facade(seed: f64) -> Vec<Patch> {
    let mut patches = sheet([0.0; 3], [20.0, 0.0, 0.0], [0.0, 0.0, 12.0], 11);
    for i in 0..6 {
        let x = 1.0 + 3.0 * f64::from(i);
        patches.extend(block([x, -1.2 - seed, 4.0], [x + 1.5, 0.0, 5.0], false, true));
    }
    patches
}

fn street(seed: f64) -> Vec<Patch> {
    let mut patches = sheet([0.0; 3], [40.0, 0.0, 0.0], [0.0, 3.0 + 5.0 * seed, 0.0], 12);
    patches.extend(
        sheet([0.0; 3], [40.0, 0.0, 0.0], [0.0, 0.0, 15.0], 13)
            .iter()
            .map(|patch| Patch { normal: -patch.normal, ..*patch }),
    );
    patches.extend(sheet([0.0, 3.0 + 5.0 * seed, 0.0], [40.0, 0.0, 0.0], [0.0, 0.0, 15.0], 14));
    patches
}

fn corridor(seed: f64) -> Vec<Patch> {
    block([0.0; 3], [20.0, 1.0 + 2.0 * seed, 2.6], true, true)
}

fn gabled(_: f64) -> Vec<Patch> {
    let mut patches = block([0.0; 3], [8.0, 10.0, 5.0], false, false);
    patches.retain(|patch| patch.normal.z < 0.5);
    patches.extend(sheet([0.0, 0.0, 5.0], [4.0, 0.0, 3.0], [0.0, 10.0, 0.0], 15));
    patches.extend(sheet([4.0, 0.0, 8.0], [4.0, 0.0, -3.0], [0.0, 10.0, 0.0], 16));
    patches
}

/// A tank that lies along y, with its ends.
fn tank(seed: f64) -> Vec<Patch> {
    let mut patches = tube(1.0, 2.0 + seed, false);
    patches.iter_mut().for_each(|patch| {
        patch.at = DVec3::new(patch.at.x, patch.at.z, patch.at.y);
        patch.normal = DVec3::new(patch.normal.x, patch.normal.z, patch.normal.y);
    });
    for (y, normal) in [(0.0, DVec3::NEG_Y), (2.0 + seed, DVec3::Y)] {
        let end = blob([2.0, 0.0, 2.0], [0.0, y, 0.0]).into_iter();
        patches.extend(end.map(|patch| Patch { normal, area: 0.003, ..patch }));
    }
    patches
}

type PatchMaker = (&'static str, fn(f64) -> Vec<Patch>);

const TELLING: [PatchMaker; 4] = [("room", room), ("house", house), ("monument", monument), ("hall", hall)];
const SILENT: [PatchMaker; 9] = [
    ("statue", |seed| blob([0.6, 0.4 + seed, 1.8], [0.0; 3])),
    ("hills", |seed| hills(200.0, 10.0 + 30.0 * seed)),
    ("trunk", |seed| tube(0.3, 4.0 + 20.0 * seed, false)),
    ("shaft", |seed| tube(2.0, 4.0 + 20.0 * seed, true)),
    ("facade", facade),
    ("street", street),
    ("corridor", corridor),
    ("gabled house", gabled),
    ("lying tank", tank),
];

/// Turns patches about z, moves them, and adds noise to the normals.
fn placed(patches: Vec<Patch>, yaw: f64, noise: f64) -> Vec<Patch> {
    let turn = glam::DQuat::from_rotation_z(yaw);
    let place = |(i, patch): (usize, Patch)| {
        let wobble = [0, 1, 2].map(|axis| noise * ((i * (7 + axis)) as f64 * 0.618).sin());
        let normal = (turn * patch.normal + DVec3::from_array(wobble)).normalize();
        Patch { at: turn * patch.at + DVec3::new(30.0, -7.0, 2.0), normal, ..patch }
    };
    patches.into_iter().enumerate().map(place).collect()
}

/// Patches as a file has them in which another axis is up.
fn stored(patches: &[Patch], up: UpAxis) -> Vec<Patch> {
    let in_file = |v: DVec3| match up {
        UpAxis::Z => v,
        UpAxis::Y => DVec3::new(v.x, v.z, -v.y),
        UpAxis::MinusY => DVec3::new(v.x, -v.z, v.y),
    };
    let patch = |patch: &Patch| Patch { at: in_file(patch.at), normal: in_file(patch.normal), ..*patch };
    patches.iter().map(patch).collect()
}

fn found(patches: &[Patch], up: UpAxis) -> Option<UpAxis> {
    match of_patches(stored(patches, up)) {
        Vote::For(evidence) => Some(evidence.up),
        _ => None,
    }
}

/// Angles by which kinds with walls are turned: askew to the axes or along them.
fn yaw() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), Just(std::f64::consts::FRAC_PI_2), 0.0..std::f64::consts::TAU]
}

proptest! {
    #[test]
    fn nothing_is_turned_wrongly(kind in 0..13usize, seed in 0.0..1.0f64, yaw in yaw(), noise in 0.0..0.12f64) {
        let (name, make) = TELLING.iter().chain(&SILENT).nth(kind).unwrap();
        let patches = placed(make(seed), yaw, noise);
        prop_assert_eq!(found(&patches, UpAxis::Z), None, "{} with z up", name);
        for up in [UpAxis::Y, UpAxis::MinusY] {
            let found = found(&patches, up);
            // A closed room does not say which of floor and ceiling is which: y is far more usual.
            let is_room = ["room", "hall", "corridor"].contains(name);
            prop_assert!(found.is_none() || found == Some(up) || is_room && found == Some(UpAxis::Y), "{name}: {found:?} for {up:?}");
        }
    }

    #[test]
    fn what_leaves_no_doubt_is_turned(kind in 0..4usize, seed in 0.0..1.0f64, yaw in 0.25..1.3f64, noise in 0.0..0.08f64) {
        let (name, make) = TELLING[kind];
        let patches = placed(make(seed), yaw, noise);
        prop_assert_eq!(found(&patches, UpAxis::Y), Some(UpAxis::Y), "{}", name);
        if kind == 1 || kind == 2 {
            prop_assert_eq!(found(&patches, UpAxis::MinusY), Some(UpAxis::MinusY), "{}", name);
        }
    }
}

#[test]
fn places_along_the_axes_are_turned_where_there_is_ground_or_width() {
    for (kind, up) in
        [(1, UpAxis::Y), (1, UpAxis::MinusY), (2, UpAxis::Y), (2, UpAxis::MinusY), (3, UpAxis::Y)]
    {
        let (name, make) = TELLING[kind];
        assert_eq!(found(&make(0.5), up), Some(up), "{name}");
    }
    // A room of a common size is a box: nobody can tell.
    assert_eq!(found(&room(0.0), UpAxis::Y), None);
}

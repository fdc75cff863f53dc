//! The garden under the open sky: fountain, lawns, the tree, hedges and pots.

use super::{ARCADE_FLOOR, COLUMNS_X, CourtyardParts, HALF_X, HALF_Y, TERRACE};
use crate::synth::material::{Material, rgb};
use crate::synth::shape::Shape;
use base::random::Rng;
use glam::DVec3;

/// Foot of the tree.
const TREE: DVec3 = DVec3::new(6.4, 3.6, 0.05);

/// Adds the garden, the same every time.
pub fn add(parts: &mut CourtyardParts) {
    fountain(parts);
    for (x, y) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        lawn(x, y, parts);
    }
    let mut rng = Rng::new(0x7265_6574, 0);
    tree(&mut rng, parts);
    pots(&mut rng, parts);
    climbers(&mut rng, parts);
}

fn fountain(parts: &mut CourtyardParts) {
    let ring = |z: f64, height: f64, inner: f64, outer: f64| Shape::Ring {
        base: DVec3::new(0.0, 0.0, z),
        height,
        inner,
        outer,
    };
    parts.turned(DVec3::ZERO, 0.12, 2.25, 2.25, Material::Stone);
    parts.add(ring(0.12, 0.46, 1.52, 1.75), Material::Stone);
    parts.add(ring(0.58, 0.09, 1.46, 1.82), Material::Stone);
    let water = |z: f64, radius| Shape::Disc { center: DVec3::new(0.0, 0.0, z), normal: DVec3::Z, radius };
    parts.add(water(0.48, 1.52), Material::Water);
    let foot = [(0.35, 0.42, 0.30), (0.25, 0.22, 0.17), (0.60, 0.17, 0.14), (0.10, 0.20, 0.22)];
    parts.stack(DVec3::new(0.0, 0.0, 0.12), &foot, Material::Stone);
    parts.stack(DVec3::new(0.0, 0.0, 1.42), &[(0.12, 0.20, 0.55), (0.10, 0.55, 0.80)], Material::Stone);
    parts.add(ring(1.64, 0.07, 0.74, 0.86), Material::Stone);
    parts.add(water(1.67, 0.74), Material::Water);
    let finial = [(0.22, 0.13, 0.08), (0.20, 0.08, 0.07), (0.10, 0.16, 0.10)];
    parts.stack(DVec3::new(0.0, 0.0, 1.64), &finial, Material::Stone);
    parts.add(Shape::Ball { center: DVec3::new(0.0, 0.0, 2.28), radius: 0.15 }, Material::Stone);
}

/// A lawn with a stone rim and a low hedge in one quarter of the court.
fn lawn(x: f64, y: f64, parts: &mut CourtyardParts) {
    let (near, far) = ([2.9, 2.5], [9.6, if y > 0.0 { 5.8 } else { 7.0 }]);
    let corner = |c: [f64; 2], z: f64| [x * c[0], y * c[1], z];
    parts.cuboid(corner(near, 0.0), corner(far, 0.10), Material::Stone);
    let inset = |by: f64| ([near[0] + by, near[1] + by], [far[0] - by, far[1] - by]);
    let (a, b) = inset(0.16);
    parts.cuboid(corner(a, 0.0), corner(b, 0.115), Material::Grass);
    // Box hedges: four low walls of leaves.
    let (a, b) = inset(0.35);
    let hedge = Material::Leaf { tint: rgb(66, 96, 44) };
    let mut rng = Rng::new(0x6564_6765, ((x > 0.0) as u64) * 2 + (y > 0.0) as u64);
    for _ in 0..2600 {
        let along = rng.between(0.0, 2.0 * (b[0] - a[0] + b[1] - a[1]));
        let (w, h) = (b[0] - a[0], b[1] - a[1]);
        let (px, py) = match along {
            t if t < w => (a[0] + t, a[1]),
            t if t < 2.0 * w => (a[0] + t - w, b[1]),
            t if t < 2.0 * w + h => (a[0], a[1] + t - 2.0 * w),
            t => (b[0], a[1] + t - 2.0 * w - h),
        };
        let round = 0.17 * rng.direction();
        let center = DVec3::new(x * px + round.x, y * py + round.y, 0.30 + 1.1 * round.z);
        parts.add(Shape::Disc { center, normal: rng.direction(), radius: rng.between(0.03, 0.06) }, hedge);
    }
}

/// A broad tree: branches that fork, leaves round their ends.
fn tree(rng: &mut Rng, parts: &mut CourtyardParts) {
    let fork = TREE + DVec3::new(0.12, -0.08, 2.1);
    parts.stack(TREE, &[(0.16, 0.42, 0.29), (0.45, 0.29, 0.23)], Material::Bark);
    parts.bar(TREE + 0.5 * DVec3::Z, fork, 0.21, Material::Bark);
    let mut open: Vec<(DVec3, DVec3, f64, f64, u32)> = Vec::new();
    for i in 0..5 {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * (f64::from(i) + 0.5 * rng.unit()) / 5.0);
        let direction = DVec3::new(0.72 * cos, 0.72 * sin, 0.85).normalize();
        open.push((fork, direction, 1.35, 0.12, 0));
    }
    open.push((fork, DVec3::new(0.1, 0.1, 1.0).normalize(), 1.5, 0.13, 0));
    while let Some((start, direction, length, radius, depth)) = open.pop() {
        let end = start + length * direction;
        parts.bar(start, end, radius, Material::Bark);
        if depth >= 2 {
            leaves(end, 0.62, 150, rng, parts);
        }
        if depth == 3 {
            continue;
        }
        for _ in 0..3 {
            let turn = (direction + 0.75 * rng.direction() + 0.12 * DVec3::Z).normalize();
            let shorter = length * rng.between(0.62, 0.8);
            open.push((end, turn, shorter, 0.62 * radius, depth + 1));
        }
    }
}

/// A cloud of leaves, thinner outwards.
fn leaves(center: DVec3, radius: f64, count: u32, rng: &mut Rng, parts: &mut CourtyardParts) {
    let green = Material::Leaf { tint: rgb(104, 136, 58) };
    for _ in 0..count / 2 {
        let place = center + radius * rng.unit().sqrt() * rng.direction() * DVec3::new(1.0, 1.0, 0.8);
        // Leaves lie rather flat.
        let normal = (rng.direction() + 0.7 * DVec3::Z).normalize_or(DVec3::Z);
        let shape = Shape::Disc { center: place, normal, radius: rng.between(0.035, 0.065) };
        parts.add(shape, green);
    }
}

/// Clay pots with plants: beside the doors, on the terrace, round the fountain.
fn pots(rng: &mut Rng, parts: &mut CourtyardParts) {
    let court = [(-2.6, -2.2), (2.6, -2.2), (2.6, 2.2), (-2.6, 2.2)].map(|(x, y)| DVec3::new(x, y, 0.0));
    let arcade = [
        DVec3::new(HALF_X - 0.4, -1.75, ARCADE_FLOOR),
        DVec3::new(HALF_X - 0.4, 1.75, ARCADE_FLOOR),
        DVec3::new(-HALF_X + 0.4, -1.3, ARCADE_FLOOR),
        DVec3::new(-HALF_X + 0.4, 1.3, ARCADE_FLOOR),
        DVec3::new(-5.5, -HALF_Y + 0.4, ARCADE_FLOOR),
        DVec3::new(COLUMNS_X, COLUMNS_Y_OUTSIDE, 0.0),
    ];
    let terrace = [-6.0, -2.0, 2.0, 6.0, 9.5].map(|x| DVec3::new(x, HALF_Y - 0.35, TERRACE));
    let flowers = [rgb(196, 64, 58), rgb(214, 130, 66), rgb(206, 96, 140), rgb(226, 204, 96)];
    for (i, foot) in court.into_iter().chain(arcade).chain(terrace).enumerate() {
        parts.stack(foot, &[(0.34, 0.16, 0.25), (0.07, 0.28, 0.28)], Material::Clay);
        let green = Material::Leaf { tint: rgb(88, 124, 56) };
        let flower = Material::Leaf { tint: flowers[i % flowers.len()] };
        for k in 0..240 {
            let center = foot + 0.62 * DVec3::Z + 0.30 * rng.unit().sqrt() * rng.direction();
            let material = if k % 5 == 0 && center.z > foot.z + 0.6 { flower } else { green };
            parts.add(
                Shape::Disc { center, normal: rng.direction(), radius: rng.between(0.02, 0.045) },
                material,
            );
        }
    }
}

/// South–north place of a pot: south of the north-east corner pier.
const COLUMNS_Y_OUTSIDE: f64 = 7.9;

/// Creepers on the west wall, above the roof, and hanging from the terrace.
fn climbers(rng: &mut Rng, parts: &mut CourtyardParts) {
    let green = Material::Leaf { tint: rgb(78, 112, 48) };
    let violet = Material::Leaf { tint: rgb(150, 108, 170) };
    for _ in 0..2200 {
        let x = rng.between(4.2, 10.8);
        let drop = 1.7 * rng.unit() * rng.unit() * (0.35 + 0.65 * (1.0 - ((x - 7.5) / 3.3).abs()));
        let center = DVec3::new(x, 8.46 - 0.16 * rng.unit(), TERRACE + 0.25 - drop);
        let material = if rng.unit() < 0.3 { violet } else { green };
        parts.add(Shape::Disc { center, normal: rng.direction(), radius: rng.between(0.03, 0.06) }, material);
    }
}

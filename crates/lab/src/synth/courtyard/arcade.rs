//! Columns and arches on all four sides, their roofs, the terrace in the north and the stair up to it.

use super::{ARCADE_FLOOR, COLUMNS_X, COLUMNS_Y, CourtyardParts, HALF_X, HALF_Y, TERRACE};
use crate::synth::material::{Material, rgb};
use crate::synth::shape::Shape;
use glam::DVec3;

/// Height at which the arches rest on the columns.
const CAPITAL: f64 = 2.6;
/// Height at which the arches begin to curve.
const SPRING: f64 = 2.72;
/// Upper edge of the wall above the arches.
const PARAPET: f64 = 4.45;
/// Half the thickness of that wall.
const HALF_THICK: f64 = 0.25;
/// Bays on the long sides.
const BAYS_X: u32 = 7;
/// Bays on the short sides.
const BAYS_Y: u32 = 5;

const BEAM: Material = Material::Wood { grain: 0, tint: rgb(122, 90, 62) };

/// Adds the arcade, its roofs, the terrace and the stair.
pub fn add(parts: &mut CourtyardParts) {
    floor(parts);
    for side in [-1.0, 1.0] {
        row(0, side * COLUMNS_Y, COLUMNS_X, BAYS_X, parts);
        row(1, side * COLUMNS_X, COLUMNS_Y, BAYS_Y, parts);
        for corner in [-1.0, 1.0] {
            let (x, y) = (side * COLUMNS_X, corner * COLUMNS_Y);
            parts.cuboid([x - 0.36, y - 0.36, 0.0], [x + 0.36, y + 0.36, PARAPET], Material::Stone);
        }
    }
    ceiling(parts);
    roofs(parts);
    terrace(parts);
    stair(parts);
}

/// A paved floor on all sides, one step high.
fn floor(parts: &mut CourtyardParts) {
    let (x, y) = (COLUMNS_X - 0.5, COLUMNS_Y - 0.5);
    for s in [-1.0, 1.0] {
        parts.cuboid([s * x, -HALF_Y, 0.0], [s * (HALF_X + 0.5), HALF_Y, ARCADE_FLOOR], Material::Paving);
        parts.cuboid([-x, s * y, 0.0], [x, s * (HALF_Y + 0.5), ARCADE_FLOOR], Material::Paving);
    }
}

/// A row of columns along `axis` with arches between them.
fn row(axis: usize, across: f64, half: f64, bays: u32, parts: &mut CourtyardParts) {
    let place = |along: f64, z: f64| match axis {
        0 => DVec3::new(along, across, z),
        _ => DVec3::new(across, along, z),
    };
    let bay = 2.0 * half / f64::from(bays);
    let thick = HALF_THICK * if axis == 0 { DVec3::Y } else { DVec3::X };
    for i in 0..bays {
        let (from, to) = (-half + f64::from(i) * bay, -half + f64::from(i + 1) * bay);
        let (min, max) = (place(from, CAPITAL) - thick, place(to, PARAPET) + thick);
        let (middle, radius) = (0.5 * (from + to), 0.5 * bay - 0.24);
        let tint = rgb(224, 198, 152);
        let plaster = Material::Plaster { tint, foot: -10.0, top: PARAPET + 0.8 };
        parts.add(Shape::Arch { min, max, through: 1 - axis, middle, radius, spring: SPRING }, plaster);
        // A proud ring of stone round the arch.
        let (min, max) =
            (place(from, CAPITAL) - 1.12 * thick, place(to, SPRING + radius + 0.16) + 1.12 * thick);
        let clip = radius + 0.16;
        let (a, b) =
            (place(middle - clip, CAPITAL) - 1.12 * thick, place(middle + clip, max.z) + 1.12 * thick);
        let ring = Shape::Arch {
            min: a.max(min),
            max: b.min(max),
            through: 1 - axis,
            middle,
            radius,
            spring: SPRING,
        };
        parts.add(ring, Material::Stone);
        if i > 0 {
            column(place(from, ARCADE_FLOOR), parts);
        }
    }
}

/// A round column: plinth, base, shaft with entasis, capital, abacus.
fn column(foot: DVec3, parts: &mut CourtyardParts) {
    let square = |half: f64, low: f64, high: f64, parts: &mut CourtyardParts| {
        let r = DVec3::new(half, half, 0.0);
        let (min, max) = (foot - r + low * DVec3::Z, foot + r + high * DVec3::Z);
        parts.add(Shape::Cuboid { min, max }, Material::Stone);
    };
    let height = CAPITAL - ARCADE_FLOOR;
    square(0.31, 0.0, 0.14, parts);
    square(0.31, height - 0.11, height, parts);
    let base = [(0.05, 0.27, 0.29), (0.05, 0.29, 0.27), (0.04, 0.23, 0.23), (0.04, 0.25, 0.22)];
    parts.stack(foot + 0.14 * DVec3::Z, &base, Material::Stone);
    let shaft = height - 0.11 - 0.32 - 0.30;
    let pieces = [
        (0.35 * shaft, 0.205, 0.202),
        (0.65 * shaft, 0.202, 0.170),
        (0.04, 0.20, 0.20),
        (0.06, 0.172, 0.175),
        (0.14, 0.18, 0.27),
        (0.08, 0.29, 0.29),
    ];
    parts.stack(foot + 0.30 * DVec3::Z, &pieces, Material::Stone);
}

/// Boards and beams over the arcade.
fn ceiling(parts: &mut CourtyardParts) {
    let (low, high) = (PARAPET - 0.12, PARAPET - 0.04);
    let boards = Material::Wood { grain: 0, tint: rgb(148, 112, 78) };
    for s in [-1.0, 1.0] {
        parts.cuboid([s * COLUMNS_X, -HALF_Y, low], [s * HALF_X, HALF_Y, high], boards);
        parts.cuboid([-HALF_X, s * COLUMNS_Y, low], [HALF_X, s * HALF_Y, high], boards);
        let mut at = -HALF_X + 0.5;
        while at < HALF_X {
            let (a, b) = (s * (COLUMNS_Y + 0.2), s * HALF_Y);
            parts.cuboid(
                [at, a, low - 0.2],
                [at + 0.14, b, low],
                Material::Wood { grain: 1, tint: rgb(122, 90, 62) },
            );
            at += 0.98;
        }
        let mut at = -HALF_Y + 0.5;
        while at < HALF_Y {
            let (a, b) = (s * (COLUMNS_X + 0.2), s * HALF_X);
            parts.cuboid([a, at, low - 0.2], [b, at + 0.14, low], BEAM);
            at += 0.98;
        }
    }
}

/// Lean-to roofs in the east, south and west; where two meet, the higher one shows.
fn roofs(parts: &mut CourtyardParts) {
    let (eave, ridge, overhang) = (PARAPET + 0.05, PARAPET + 1.35, 0.45);
    let roof = |corner: DVec3, u: DVec3, out: DVec3, deep: f64, parts: &mut CourtyardParts| {
        let v = deep * out + (ridge - eave) * DVec3::Z;
        parts.add(Shape::Sheet { corner, u, v, triangle: false }, Material::Roof { down: -out });
        let gutter = corner - 0.04 * out - 0.04 * DVec3::Z;
        parts.bar(gutter, gutter + u, 0.055, Material::Iron);
    };
    let length = HALF_Y + COLUMNS_Y;
    for s in [-1.0, 1.0] {
        let corner = DVec3::new(s * (COLUMNS_X - overhang), -HALF_Y, eave);
        roof(corner, length * DVec3::Y, s * DVec3::X, HALF_X - COLUMNS_X + overhang, parts);
        // The gable toward the terrace.
        let corner = DVec3::new(s * HALF_X, COLUMNS_Y, eave);
        let (u, v) = (-s * (HALF_X - COLUMNS_X + overhang) * DVec3::X, (ridge - eave) * DVec3::Z);
        let plaster = Material::Plaster { tint: rgb(222, 190, 138), foot: -10.0, top: ridge };
        parts.add(Shape::Sheet { corner, u, v, triangle: true }, plaster);
    }
    let corner = DVec3::new(-HALF_X, -(COLUMNS_Y - overhang), eave);
    let deep = HALF_Y - COLUMNS_Y + overhang;
    roof(corner, 2.0 * HALF_X * DVec3::X, DVec3::NEG_Y, deep, parts);
}

/// Floor and balustrade of the terrace; the balustrade is open where the stair arrives.
fn terrace(parts: &mut CourtyardParts) {
    let front = COLUMNS_Y - 0.35;
    parts.cuboid([-HALF_X, front, PARAPET], [HALF_X, HALF_Y, TERRACE], Material::Stone);
    let floor = Shape::Sheet {
        corner: DVec3::new(-HALF_X, front, TERRACE + 0.002),
        u: DVec3::new(2.0 * HALF_X, 0.0, 0.0),
        v: DVec3::new(0.0, HALF_Y - front, 0.0),
        triangle: false,
    };
    parts.add(floor, Material::Checker);
    let y = COLUMNS_Y - 0.15;
    for (from, to) in [(-COLUMNS_X - 0.2, STAIR_TOP - 1.45), (STAIR_TOP, COLUMNS_X + 0.2)] {
        parts.cuboid([from, y - 0.12, TERRACE], [to, y + 0.12, TERRACE + 0.1], Material::Stone);
        parts.cuboid([from, y - 0.13, TERRACE + 0.82], [to, y + 0.13, TERRACE + 0.94], Material::Stone);
        let count = ((to - from) / 0.27).round().max(1.0);
        for i in 0..count as u32 {
            let x = from + (f64::from(i) + 0.5) * (to - from) / count;
            let foot = DVec3::new(x, y, TERRACE + 0.1);
            let pieces = [(0.08, 0.06, 0.05), (0.22, 0.05, 0.085), (0.34, 0.085, 0.04), (0.08, 0.045, 0.06)];
            parts.stack(foot, &pieces, Material::Stone);
        }
        for x in [from, to] {
            parts.cuboid(
                [x - 0.15, y - 0.15, TERRACE],
                [x + 0.15, y + 0.15, TERRACE + 1.05],
                Material::Stone,
            );
        }
    }
}

/// East end of the stair's landing.
const STAIR_TOP: f64 = -8.75;
/// Steps of the stair.
const STEPS: u32 = 27;

/// A straight stair along the north arcade, rising to the west, with a landing on an arch.
fn stair(parts: &mut CourtyardParts) {
    let (south, north) = (COLUMNS_Y - 1.95, COLUMNS_Y - 0.3);
    let (rise, run) = (TERRACE / f64::from(STEPS), 0.30);
    let start = STAIR_TOP + run * f64::from(STEPS - 1);
    for i in 0..STEPS - 1 {
        let (x, z) = (start - run * f64::from(i), rise * f64::from(i + 1));
        // A nosing over the riser.
        parts.cuboid([x + 0.03, south, z - 0.045], [x - run, north, z], Material::Stone);
        parts.cuboid(
            [x, south + 0.02, 0.0],
            [x - run, north, z - 0.045],
            Material::Plaster { tint: rgb(220, 192, 148), foot: 0.0, top: 20.0 },
        );
    }
    let (min, max) = (DVec3::new(STAIR_TOP - 1.45, south, 0.0), DVec3::new(STAIR_TOP, north, TERRACE));
    let middle = 0.5 * (min.x + max.x);
    let landing = Shape::Arch { min, max, through: 1, middle, radius: 0.5, spring: 2.0 };
    parts.add(landing, Material::Stone);
    let rail = |x: f64, z: f64| DVec3::new(x, south + 0.08, z);
    parts.bar(rail(start, rise + 0.9), rail(STAIR_TOP, TERRACE + 0.9), 0.028, Material::Iron);
    parts.bar(rail(STAIR_TOP, TERRACE + 0.9), rail(STAIR_TOP - 1.4, TERRACE + 0.9), 0.028, Material::Iron);
    for i in 0..STEPS + 4 {
        let x = start - run * (f64::from(i) + 0.5);
        let z = rise * f64::from((i + 1).min(STEPS));
        parts.bar(rail(x, z), rail(x, z + 0.9), 0.012, Material::Iron);
    }
}

//! The four walls with doors and windows, the roofs' edges and the tower behind.

use super::{ARCADE_FLOOR, CourtyardParts, HALF_X, HALF_Y, TERRACE, WALL};
use crate::synth::material::{Material, rgb};
use crate::synth::shape::Shape;
use glam::DVec3;

/// Lower edge of the upper story.
const STORY: f64 = 4.4;
/// Upper edge of the walls.
const TOP: f64 = 8.4;
/// Color of a window's wooden parts.
const SHUTTER: DVec3 = rgb(86, 116, 104);

/// A wall along a horizontal axis, a story high.
pub struct Wall {
    /// Axis along which the wall runs: 0 for x, 1 for y.
    pub along: usize,
    /// The wall's two faces on the other axis.
    pub faces: [f64; 2],
    /// The wall's two ends.
    pub ends: [f64; 2],
    /// The wall's lower and upper edge.
    pub heights: [f64; 2],
    /// Material of the wall.
    pub material: Material,
}

/// An opening in a wall.
#[derive(Clone, Copy)]
pub struct Opening {
    /// Middle, along the wall.
    pub middle: f64,
    /// Width.
    pub width: f64,
    /// Heights of sill and lintel; an arch's crown stands for the lintel.
    pub heights: [f64; 2],
    /// True if it is round at the top.
    pub arched: bool,
}

impl Wall {
    /// Adds the wall with openings, in order along the wall.
    pub fn add(&self, openings: &[Opening], parts: &mut CourtyardParts) {
        let [foot, top] = self.heights;
        let mut start = self.ends[0];
        for opening in openings {
            let (from, to) = (opening.middle - 0.5 * opening.width, opening.middle + 0.5 * opening.width);
            let [sill, lintel] = opening.heights;
            self.piece(start, from, foot, top, parts);
            self.piece(from, to, foot, sill, parts);
            if opening.arched {
                let radius = 0.5 * opening.width;
                let (min, max) = self.corners(from, to, lintel - radius, top);
                let spring = lintel - radius;
                let through = 1 - self.along;
                let shape = Shape::Arch { min, max, through, middle: opening.middle, radius, spring };
                parts.add(shape, self.material);
            } else {
                self.piece(from, to, lintel, top, parts);
            }
            start = to;
        }
        self.piece(start, self.ends[1], foot, top, parts);
    }

    fn piece(&self, from: f64, to: f64, low: f64, high: f64, parts: &mut CourtyardParts) {
        if from < to && low < high {
            let (min, max) = self.corners(from, to, low, high);
            parts.add(Shape::Cuboid { min, max }, self.material);
        }
    }

    /// Corners of the part between two places along the wall and two heights.
    pub fn corners(&self, from: f64, to: f64, low: f64, high: f64) -> (DVec3, DVec3) {
        let place = |along: f64, face: f64, z: f64| match self.along {
            0 => DVec3::new(along, face, z),
            _ => DVec3::new(face, along, z),
        };
        let [a, b] = self.faces;
        (place(from, a.min(b), low), place(to, a.max(b), high))
    }
}

/// Walls of the court, with all that hangs on them.
pub fn add(parts: &mut CourtyardParts) {
    let yellow = rgb(222, 190, 138);
    let rose = rgb(212, 164, 132);
    for side in [Side::East, Side::West, Side::South, Side::North] {
        let tint = if matches!(side, Side::East | Side::South) { yellow } else { rose };
        let (ground, upper) = side.walls(tint);
        ground.add(&side.doors(), parts);
        upper.add(&side.windows(), parts);
        for window in side.windows() {
            glaze(&upper, side.outward(), &window, parts);
        }
        if side == Side::West || side == Side::North {
            for door in side.doors() {
                shut(&ground, side.outward(), &door, parts);
            }
        }
        eaves(&side, parts);
    }
    tower(parts);
    let ground = Shape::Sheet {
        corner: DVec3::new(-80.0, -80.0, 0.0),
        u: DVec3::new(160.0, 0.0, 0.0),
        v: DVec3::new(0.0, 160.0, 0.0),
        triangle: false,
    };
    parts.add(ground, Material::Paving);
}

#[derive(Clone, Copy, PartialEq)]
enum Side {
    East,
    West,
    South,
    North,
}

impl Side {
    /// Unit vector out of the court.
    fn outward(self) -> DVec3 {
        match self {
            Self::East => DVec3::X,
            Self::West => DVec3::NEG_X,
            Self::South => DVec3::NEG_Y,
            Self::North => DVec3::Y,
        }
    }

    /// Ground floor and upper story.
    fn walls(self, tint: DVec3) -> (Wall, Wall) {
        let out = self.outward();
        let (along, half, length) =
            if out.x != 0.0 { (1, HALF_X, HALF_Y) } else { (0, HALF_Y, HALF_X + WALL) };
        let sign = out.x + out.y;
        let faces = [sign * half, sign * (half + WALL)];
        let ends = [-length, length];
        let plaster = Material::Plaster { tint, foot: ARCADE_FLOOR, top: TOP };
        let upper = Material::Plaster { tint, foot: -10.0, top: TOP };
        (
            Wall { along, faces, ends, heights: [0.0, STORY], material: plaster },
            Wall { along, faces, ends, heights: [STORY, TOP], material: upper },
        )
    }

    fn doors(self) -> Vec<Opening> {
        let opening = |middle, width, low, high, arched| Opening {
            middle,
            width,
            heights: [ARCADE_FLOOR + low, ARCADE_FLOOR + high],
            arched,
        };
        match self {
            Self::East => vec![
                opening(-3.4, 1.1, 0.9, 2.5, false),
                opening(0.0, 2.4, 0.0, 3.3, true),
                opening(3.4, 1.1, 0.9, 2.5, false),
            ],
            Self::South => vec![
                opening(-8.7, 0.9, 0.9, 2.3, false),
                opening(-6.74, 1.5, 0.0, 2.6, true),
                opening(-4.8, 0.9, 0.9, 2.3, false),
            ],
            Self::West => {
                vec![
                    opening(-5.2, 1.3, 0.0, 2.5, true),
                    opening(0.0, 1.8, 0.0, 3.0, true),
                    opening(5.2, 1.3, 0.0, 2.5, true),
                ]
            }
            Self::North => vec![opening(-6.74, 1.4, 0.0, 2.5, true), opening(3.37, 1.4, 0.0, 2.5, true)],
        }
    }

    fn windows(self) -> Vec<Opening> {
        let window = |middle| Opening { middle, width: 1.0, heights: [6.1, 7.7], arched: false };
        match self {
            Self::East | Self::West => [-7.2, -3.6, 0.0, 3.6, 7.2].map(window).to_vec(),
            Self::South => [-11.0, -6.74, -2.25, 2.25, 6.74, 11.0].map(window).to_vec(),
            Self::North => {
                let door = Opening { middle: 0.0, width: 1.5, heights: [TERRACE, 7.3], arched: true };
                let low = |middle| Opening { middle, width: 1.0, heights: [5.6, 7.2], arched: false };
                let mut all = [-11.0, -7.4, -3.7].map(low).to_vec();
                all.push(door);
                all.extend([3.7, 7.4, 11.0].map(low));
                all
            }
        }
    }
}

/// A pane set back in the wall, bars before it, open shutters, a sill.
fn glaze(wall: &Wall, outward: DVec3, window: &Opening, parts: &mut CourtyardParts) {
    let [low, high] = window.heights;
    let (from, to) = (window.middle - 0.5 * window.width, window.middle + 0.5 * window.width);
    let mut panel = |from: f64, to: f64, low: f64, high: f64, depth: [f64; 2], material| {
        let face = wall.faces[0];
        let sign = outward.x + outward.y;
        let part = Wall { faces: [face + sign * depth[0], face + sign * depth[1]], ..*wall };
        let (min, max) = part.corners(from, to, low, high);
        parts.add(Shape::Cuboid { min, max }, material);
    };
    let paint = Material::Paint { tint: SHUTTER };
    panel(from, to, low, high, [0.26, 0.30], Material::Glass);
    panel(window.middle - 0.03, window.middle + 0.03, low, high, [0.20, 0.26], paint);
    for part in [0.0, 0.34, 0.67, 1.0] {
        let z = low + part * (high - low - 0.06);
        panel(from, to, z, z + 0.06, [0.20, 0.26], paint);
    }
    panel(from - 0.12, to + 0.12, low - 0.1, low, [-0.08, 0.2], Material::Stone);
    if window.arched {
        return;
    }
    for (a, b) in [(from - 0.52, from - 0.03), (to + 0.03, to + 0.52)] {
        panel(a, b, low, high, [-0.05, -0.01], paint);
        let mut z = low + 0.08;
        while z < high - 0.1 {
            panel(a + 0.06, b - 0.06, z, z + 0.045, [-0.065, -0.05], paint);
            z += 0.09;
        }
    }
}

/// A closed wooden door set back in its opening, on a stone threshold.
fn shut(wall: &Wall, outward: DVec3, door: &Opening, parts: &mut CourtyardParts) {
    let sign = outward.x + outward.y;
    let (from, to) = (door.middle - 0.5 * door.width, door.middle + 0.5 * door.width);
    let boards = Wall { faces: [wall.faces[0] + sign * 0.22, wall.faces[0] + sign * 0.28], ..*wall };
    let (min, max) = boards.corners(from, to, ARCADE_FLOOR, door.heights[1]);
    parts.add(Shape::Cuboid { min, max }, Material::Wood { grain: 2, tint: rgb(120, 80, 50) });
    for height in [0.4, 1.2, 2.0] {
        let band = Wall { faces: [wall.faces[0] + sign * 0.20, wall.faces[0] + sign * 0.22], ..*wall };
        let z = ARCADE_FLOOR + height;
        let (min, max) = band.corners(from + 0.08, to - 0.08, z, z + 0.06);
        parts.add(Shape::Cuboid { min, max }, Material::Iron);
    }
}

/// Cornice, rafters and the roof above a wall.
fn eaves(side: &Side, parts: &mut CourtyardParts) {
    let out = side.outward();
    let along = DVec3::new(out.y.abs(), out.x.abs(), 0.0);
    let half = if out.x != 0.0 { HALF_X } else { HALF_Y };
    let length = if out.x != 0.0 { HALF_Y } else { HALF_X };
    let wall = half * out;
    let (a, b) = (wall - 0.14 * out - length * along, wall + 0.3 * out + length * along);
    let (min, max) = (a.min(b) + TOP * DVec3::Z, a.max(b) + (TOP + 0.14) * DVec3::Z);
    parts.add(Shape::Cuboid { min, max }, Material::Stone);
    let mut place = -length + 0.3;
    while place < length {
        let (a, b) = (wall - 0.55 * out + place * along, wall + 0.3 * out + (place + 0.1) * along);
        let (min, max) = (a.min(b) + (TOP + 0.14) * DVec3::Z, a.max(b) + (TOP + 0.26) * DVec3::Z);
        parts.add(Shape::Cuboid { min, max }, Material::Wood { grain: 0, tint: rgb(112, 82, 58) });
        place += 0.6;
    }
    let corner = wall - 0.65 * out - (length + 0.6) * along + (TOP + 0.26) * DVec3::Z;
    let (u, v) = (2.0 * (length + 0.6) * along, 4.0 * out + 1.6 * DVec3::Z);
    parts.add(Shape::Sheet { corner, u, v, triangle: false }, Material::Roof { down: -out });
    let gutter = corner - 0.05 * out;
    parts.bar(gutter, gutter + u, 0.06, Material::Iron);
}

/// A bell tower behind the north wall.
fn tower(parts: &mut CourtyardParts) {
    let (west, east, south, north) = (-13.4, -8.6, 13.6, 18.4);
    let (shaft, belfry) = (13.2, 17.0);
    parts.cuboid([west, south, 0.0], [east, north, shaft], Material::Brick);
    parts.cuboid([west - 0.2, south - 0.2, shaft], [east + 0.2, north + 0.2, shaft + 0.3], Material::Stone);
    let (middle_x, middle_y) = (0.5 * (west + east), 0.5 * (south + north));
    let walls = [
        (0, [south, south + 0.6], [west, east], middle_x),
        (0, [north - 0.6, north], [west, east], middle_x),
        (1, [west, west + 0.6], [south, north], middle_y),
        (1, [east - 0.6, east], [south, north], middle_y),
    ];
    for (along, faces, ends, middle) in walls {
        let wall = Wall { along, faces, ends, heights: [shaft + 0.3, belfry], material: Material::Brick };
        let heights = [shaft + 1.0, belfry - 0.5];
        let opening = |at| Opening { middle: middle + at, width: 1.2, heights, arched: true };
        wall.add(&[opening(-0.9), opening(0.9)], parts);
    }
    parts.cuboid([west - 0.3, south - 0.3, belfry], [east + 0.3, north + 0.3, belfry + 0.3], Material::Stone);
    let bell = DVec3::new(middle_x, middle_y, shaft + 1.2);
    parts.stack(bell, &[(0.25, 0.62, 0.5), (0.7, 0.5, 0.34), (0.25, 0.34, 0.1)], Material::Iron);
    parts.bar(bell + 1.2 * DVec3::Z, bell.with_z(belfry), 0.05, Material::Iron);
    // A pyramid of four triangles.
    let tip = DVec3::new(middle_x, middle_y, belfry + 3.4);
    let half = 0.5 * (east - west) + 0.5;
    for down in [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y] {
        let side = down.cross(DVec3::Z);
        let corner = |s: f64| tip.with_z(belfry + 0.3) + half * (down + s * side);
        let (u, v) = (corner(1.0) - corner(-1.0), tip - corner(-1.0));
        let roof = Shape::Sheet { corner: corner(-1.0), u, v, triangle: true };
        parts.add(roof, Material::Roof { down });
    }
    parts.bar(tip, tip + 1.1 * DVec3::Z, 0.04, Material::Iron);
}

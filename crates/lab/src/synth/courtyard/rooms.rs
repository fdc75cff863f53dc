//! A hall in the east and a chamber in the south, with their furniture.

use super::walls::Wall;
use super::{ARCADE_FLOOR, CourtyardParts, HALF_X, HALF_Y, WALL};
use crate::synth::material::{Material, rgb};
use crate::synth::shape::Shape;
use glam::DVec3;

const OAK: DVec3 = rgb(152, 108, 70);
const WALNUT: DVec3 = rgb(108, 74, 50);

/// Adds both rooms, and the benches.
pub fn add(parts: &mut CourtyardParts) {
    let hall = Room { min: [HALF_X + WALL, -5.2], max: [22.0, 5.2], ceiling: 4.1, tint: rgb(228, 216, 190) };
    hall.add(parts);
    hall_furniture(parts);
    let chamber =
        Room { min: [-10.2, -17.6], max: [-3.4, -HALF_Y - WALL], ceiling: 3.6, tint: rgb(198, 208, 200) };
    chamber.add(parts);
    chamber_furniture(parts);
    benches(parts);
}

/// A room's floor, walls and ceiling; the wall toward the court is the court's own.
struct Room {
    min: [f64; 2],
    max: [f64; 2],
    ceiling: f64,
    tint: DVec3,
}

impl Room {
    fn add(&self, parts: &mut CourtyardParts) {
        let ([x0, y0], [x1, y1], top) = (self.min, self.max, self.ceiling);
        parts.cuboid([x0, y0, -0.1], [x1, y1, ARCADE_FLOOR], Material::Checker);
        let plaster = Material::Plaster { tint: self.tint, foot: -10.0, top: 40.0 };
        let walls = [
            (1, [x1, x1 + 0.3], [y0 - 0.3, y1 + 0.3]),
            (0, [y0 - 0.3, y0], [x0, x1]),
            (0, [y1, y1 + 0.3], [x0, x1]),
            (1, [x0 - 0.3, x0], [y0 - 0.3, y1 + 0.3]),
        ];
        for (along, faces, ends) in walls {
            // The room has no wall of its own where the court's wall stands.
            let court = faces[0] < HALF_X + WALL && faces[1] > HALF_X
                || along == 0 && faces[0] < -HALF_Y && faces[1] > -HALF_Y - WALL;
            if !court {
                Wall { along, faces, ends, heights: [0.0, top], material: plaster }.add(&[], parts);
            }
        }
        parts.cuboid(
            [x0, y0, top],
            [x1, y1, top + 0.2],
            Material::Wood { grain: 0, tint: rgb(166, 130, 92) },
        );
        let mut x = x0 + 0.4;
        while x < x1 {
            parts.cuboid([x, y0, top - 0.22], [x + 0.18, y1, top], Material::Wood { grain: 1, tint: WALNUT });
            x += 1.05;
        }
        // A painted base along the walls.
        let base = Material::Paint { tint: rgb(150, 84, 62) };
        parts.cuboid([x0, y0, ARCADE_FLOOR], [x1, y0 + 0.02, 1.1], base);
        parts.cuboid([x0, y1 - 0.02, ARCADE_FLOOR], [x1, y1, 1.1], base);
        parts.cuboid([x1 - 0.02, y0, ARCADE_FLOOR], [x1, y1, 1.1], base);
    }
}

/// A board on four legs.
fn table(min: [f64; 2], max: [f64; 2], height: f64, tint: DVec3, parts: &mut CourtyardParts) {
    let top = ARCADE_FLOOR + height;
    let material = Material::Wood { grain: 1, tint };
    parts.cuboid([min[0], min[1], top - 0.05], [max[0], max[1], top], material);
    for x in [min[0] + 0.06, max[0] - 0.06] {
        for y in [min[1] + 0.06, max[1] - 0.06] {
            let legs = Material::Wood { grain: 2, tint };
            parts.cuboid([x - 0.035, y - 0.035, ARCADE_FLOOR], [x + 0.035, y + 0.035, top - 0.05], legs);
        }
    }
}

/// A chair whose back stands on the side of `back` (a step in x and y).
fn chair(x: f64, y: f64, back: [f64; 2], parts: &mut CourtyardParts) {
    table([x - 0.22, y - 0.22], [x + 0.22, y + 0.22], 0.46, OAK, parts);
    let (bx, by) = (x + 0.20 * back[0], y + 0.20 * back[1]);
    let (wx, wy) = (0.02 + 0.2 * back[1].abs(), 0.02 + 0.2 * back[0].abs());
    let seat = ARCADE_FLOOR + 0.46;
    for rail in [0.18, 0.34, 0.50] {
        let material = Material::Wood { grain: 2, tint: OAK };
        parts.cuboid([bx - wx, by - wy, seat + rail], [bx + wx, by + wy, seat + rail + 0.07], material);
    }
    for s in [-1.0, 1.0] {
        let (px, py) = (bx + s * 0.19 * back[1].abs(), by + s * 0.19 * back[0].abs());
        let post = DVec3::new(px, py, seat);
        parts.bar(post, post + 0.58 * DVec3::Z, 0.022, Material::Wood { grain: 2, tint: OAK });
    }
}

/// A jug or bowl turned on a wheel.
fn jug(foot: DVec3, size: f64, material: Material, parts: &mut CourtyardParts) {
    let pieces = [(0.10, 0.07, 0.12), (0.12, 0.12, 0.11), (0.08, 0.11, 0.05), (0.06, 0.05, 0.07)];
    parts.stack(foot, &pieces.map(|(h, a, b)| (size * h, size * a, size * b)), material);
}

/// Shelves with books, their backs to a wall at x = `wall`.
fn bookcase(wall: f64, from: f64, to: f64, parts: &mut CourtyardParts) {
    let (front, foot, top) = (wall - 0.36, ARCADE_FLOOR, ARCADE_FLOOR + 2.3);
    let wood = Material::Wood { grain: 1, tint: WALNUT };
    for y in [from, to - 0.04] {
        parts.cuboid([front, y, foot], [wall, y + 0.04, top], Material::Wood { grain: 2, tint: WALNUT });
    }
    parts.cuboid([wall - 0.02, from, foot], [wall, to, top], wood);
    let covers = [
        rgb(142, 52, 44),
        rgb(58, 84, 112),
        rgb(186, 150, 92),
        rgb(74, 98, 68),
        rgb(96, 70, 56),
        rgb(204, 192, 168),
    ];
    for shelf in 0..6_u32 {
        let z = foot + 0.08 + 0.44 * f64::from(shelf);
        parts.cuboid([front, from, z - 0.03], [wall, to, z], wood);
        let mut y = from + 0.06;
        let mut book = u64::from(shelf) * 31;
        while shelf < 5 && y < to - 0.16 {
            book += 1;
            let value = |salt| base::random::cell_value([book as i64, i64::from(shelf), 0], salt);
            let (thick, tall) = (0.025 + 0.045 * value(11), 0.22 + 0.13 * value(12));
            if value(13) < 0.86 {
                let tint = covers[(value(14) * covers.len() as f64) as usize];
                parts.cuboid(
                    [front + 0.04, y, z],
                    [wall - 0.05, y + thick, z + tall],
                    Material::Paint { tint },
                );
            }
            y += thick + 0.004;
        }
    }
}

fn hall_furniture(parts: &mut CourtyardParts) {
    let floor = ARCADE_FLOOR;
    table([18.2, -1.9], [19.3, 1.5], 0.76, OAK, parts);
    for y in [-1.3, -0.2, 0.9] {
        chair(17.85, y, [-1.0, 0.0], parts);
        chair(19.65, y, [1.0, 0.0], parts);
    }
    let top = DVec3::new(0.0, 0.0, floor + 0.76);
    jug(top + DVec3::new(18.7, -0.6, 0.0), 1.0, Material::Clay, parts);
    jug(top + DVec3::new(18.9, 0.5, 0.0), 0.7, Material::Paint { tint: rgb(84, 112, 140) }, parts);
    for y in [-1.2, 0.1, 1.0] {
        parts.turned(
            top + DVec3::new(18.55, y, 0.0),
            0.03,
            0.10,
            0.13,
            Material::Paint { tint: rgb(226, 220, 206) },
        );
    }
    parts.cuboid([17.0, -2.9, floor], [20.6, 2.6, floor + 0.015], Material::Cloth { tint: rgb(150, 52, 46) });
    bookcase(22.0, -3.4, -0.8, parts);
    bookcase(22.0, 1.0, 3.6, parts);
    // A fireplace between the bookcases.
    parts.cuboid([21.5, -0.7, floor], [22.0, -0.45, 1.5], Material::Stone);
    parts.cuboid([21.5, 0.65, floor], [22.0, 0.9, 1.5], Material::Stone);
    parts.cuboid([21.4, -0.8, 1.5], [22.0, 1.0, 1.72], Material::Stone);
    parts.cuboid([21.96, -0.45, floor], [22.0, 0.65, 1.5], Material::Iron);
    parts.cuboid([21.96, -0.5, 2.0], [22.0, 0.7, 3.0], Material::Wood { grain: 1, tint: rgb(170, 132, 60) });
    parts.cuboid([21.95, -0.42, 2.08], [21.96, 0.62, 2.92], Material::Paint { tint: rgb(88, 116, 116) });
    // Chests, a bench and large jars along the side walls.
    parts.cuboid([16.3, -5.1, floor], [17.8, -4.5, floor + 0.62], Material::Wood { grain: 0, tint: WALNUT });
    parts.cuboid(
        [16.26, -5.1, floor + 0.62],
        [17.84, -4.46, floor + 0.69],
        Material::Wood { grain: 0, tint: OAK },
    );
    for (x, size) in [(18.6, 2.2), (19.4, 1.7), (20.0, 2.0)] {
        jug(DVec3::new(x, -4.75, floor), size, Material::Clay, parts);
    }
    parts.cuboid([16.6, 4.7, floor + 0.4], [20.4, 5.1, floor + 0.47], Material::Wood { grain: 0, tint: OAK });
    for x in [16.8, 18.5, 20.2] {
        parts.cuboid(
            [x - 0.05, 4.72, floor],
            [x + 0.05, 5.08, floor + 0.4],
            Material::Wood { grain: 2, tint: OAK },
        );
    }
    parts.cuboid([17.0, 5.16, 1.6], [18.2, 5.2, 2.7], Material::Paint { tint: rgb(176, 140, 84) });
    parts.cuboid([18.8, 5.16, 1.6], [20.0, 5.2, 2.7], Material::Paint { tint: rgb(92, 110, 132) });
    // An iron lamp over the table.
    let lamp = DVec3::new(18.75, -0.2, 2.4);
    parts.bar(lamp, lamp.with_z(4.1), 0.015, Material::Iron);
    parts.add(Shape::Ring { base: lamp, height: 0.05, inner: 0.42, outer: 0.46 }, Material::Iron);
    for i in 0..8 {
        let (sin, cos) = libm::sincos(f64::from(i) * std::f64::consts::TAU / 8.0);
        let foot = lamp + 0.44 * DVec3::new(cos, sin, 0.0);
        parts.bar(foot, lamp + 0.5 * DVec3::Z, 0.008, Material::Iron);
        parts.turned(
            foot + 0.05 * DVec3::Z,
            0.14,
            0.016,
            0.014,
            Material::Paint { tint: rgb(238, 230, 206) },
        );
    }
}

fn chamber_furniture(parts: &mut CourtyardParts) {
    let floor = ARCADE_FLOOR;
    let (oak, linen) = (Material::Wood { grain: 0, tint: OAK }, Material::Cloth { tint: rgb(214, 206, 188) });
    // A bed with its head to the back wall.
    parts.cuboid([-9.6, -17.5, floor], [-8.0, -17.4, floor + 1.1], oak);
    parts.cuboid([-9.6, -17.4, floor + 0.2], [-8.0, -15.4, floor + 0.38], oak);
    parts.cuboid([-9.55, -17.35, floor + 0.38], [-8.05, -15.45, floor + 0.56], linen);
    parts.cuboid(
        [-9.58, -16.6, floor + 0.36],
        [-8.02, -15.42, floor + 0.6],
        Material::Cloth { tint: rgb(66, 98, 128) },
    );
    parts.cuboid([-9.4, -17.3, floor + 0.56], [-8.2, -16.9, floor + 0.70], linen);
    for x in [-9.55, -8.05] {
        for y in [-17.45, -15.4] {
            parts.turned(DVec3::new(x, y, floor), 0.65, 0.05, 0.04, oak);
        }
    }
    table([-6.9, -17.3], [-5.3, -16.6], 0.76, WALNUT, parts);
    chair(-6.1, -16.3, [0.0, 1.0], parts);
    jug(DVec3::new(-5.7, -17.0, floor + 0.76), 0.9, Material::Paint { tint: rgb(206, 186, 120) }, parts);
    parts.cuboid(
        [-3.95, -16.4, floor],
        [-3.4, -14.6, floor + 1.9],
        Material::Wood { grain: 2, tint: WALNUT },
    );
    parts.cuboid(
        [-7.6, -15.2, floor],
        [-5.4, -13.4, floor + 0.015],
        Material::Cloth { tint: rgb(120, 134, 92) },
    );
    parts.cuboid([-6.7, -17.6, 1.7], [-5.5, -17.56, 2.5], Material::Paint { tint: rgb(120, 84, 60) });
}

/// Stone benches and potted plants' stands under the arcade.
fn benches(parts: &mut CourtyardParts) {
    let seat = ARCADE_FLOOR + 0.45;
    for y in [-7.4, -2.6, 2.6, 7.4] {
        parts.cuboid([-HALF_X, y - 0.9, seat - 0.1], [-HALF_X + 0.42, y + 0.9, seat], Material::Stone);
        for end in [y - 0.75, y + 0.6] {
            parts.cuboid(
                [-HALF_X, end, ARCADE_FLOOR],
                [-HALF_X + 0.38, end + 0.15, seat - 0.1],
                Material::Stone,
            );
        }
    }
    for x in [2.0, 6.5, 10.5] {
        parts.cuboid(
            [x - 0.9, -HALF_Y, seat - 0.08],
            [x + 0.9, -HALF_Y + 0.4, seat],
            Material::Wood { grain: 0, tint: OAK },
        );
        for end in [x - 0.8, x + 0.7] {
            parts.cuboid(
                [end, -HALF_Y, ARCADE_FLOOR],
                [end + 0.1, -HALF_Y + 0.36, seat - 0.08],
                Material::Wood { grain: 2, tint: OAK },
            );
        }
    }
}

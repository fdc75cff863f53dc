//! The land that the aircraft flies over: hills, a river, a road with a bridge, a village, trees.
//!
//! Coordinates are its own: meters, x east and y north from 0 to [`SIZE_M`], z up from the river's valley.

use super::material::{rgb, smooth};
use super::span::{Ray, ball};
use base::random::{Rng, cell_value, fractal};
use glam::{DVec2, DVec3};

/// Edge of the square.
pub const SIZE_M: f64 = 1000.0;
/// Height of the river's surface.
const WATER_Z: f64 = -1.0;
/// Edge of the cells that hold at most one tree each.
const CELL_M: f64 = 7.0;
const NUM_CELLS: i64 = (SIZE_M / CELL_M) as i64 + 1;

/// What covers the ground; the numbers are ASPRS classes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cover {
    /// Field, meadow or forest floor.
    Ground = 2,
    /// Roof.
    Building = 6,
    /// River.
    Water = 9,
    /// Asphalt.
    Road = 11,
    /// The road where it crosses the river.
    Bridge = 17,
}

/// A house with a gabled roof.
#[derive(Clone, Copy, Debug)]
struct House {
    middle: DVec2,
    /// Unit vector along the ridge.
    along: DVec2,
    /// Half length and half width.
    half: DVec2,
    /// Heights of ground, eaves and ridge.
    heights: [f64; 3],
    tone: f64,
}

/// A tree whose crown is an ellipsoid.
#[derive(Clone, Copy, Debug)]
pub struct Plant {
    /// Middle of the crown.
    crown: DVec3,
    radius: f64,
    half_height: f64,
    tone: f64,
}

/// Land with all that stands on it.
pub struct Landscape {
    houses: Vec<House>,
    /// The house and the tree of every cell.
    cells: Vec<(Option<u16>, Option<Plant>)>,
}

/// North coordinate of the river's middle.
fn river(x: f64) -> f64 {
    470.0 + 90.0 * libm::sin(x / 190.0 + 0.7) + 30.0 * libm::sin(x / 71.0)
}

/// East coordinate of the road's middle.
fn road(y: f64) -> f64 {
    520.0 + 70.0 * libm::sin(y / 210.0) + 16.0 * libm::sin(y / 60.0)
}

/// Height of the bare land.
fn land(p: DVec2) -> f64 {
    let far = (p.y - river(p.x)).abs();
    let hills = 20.0 + 26.0 * fractal((p / 330.0).extend(4.0), 3);
    let rough = 0.9 * fractal((p / 34.0).extend(8.0), 2);
    -2.2 + 5.5 * smooth(11.0, 34.0, far) + (hills + rough) * smooth(30.0, 360.0, far)
}

impl House {
    fn local(&self, p: DVec2) -> DVec2 {
        let d = p - self.middle;
        DVec2::new(d.dot(self.along), d.perp_dot(self.along))
    }

    /// Height of the roof, with eaves over the walls; None beside the house.
    fn roof(&self, p: DVec2) -> Option<f64> {
        let q = self.local(p).abs();
        let [_, eaves, ridge] = self.heights;
        let inside = q.x < self.half.x && q.y < self.half.y;
        inside.then(|| ridge - (ridge - eaves) * q.y / self.half.y)
    }
}

impl Landscape {
    /// Makes the landscape, the same every time.
    pub fn new() -> Self {
        let mut rng = Rng::new(0x6C61_6E64, 0);
        let mut houses = village(&mut rng);
        houses.push(church());
        houses.push(House { half: DVec2::new(3.2, 3.2), ..tower() });
        let num = (NUM_CELLS * NUM_CELLS) as usize;
        let mut landscape = Self { houses, cells: vec![(None, None); num] };
        for i in 0..num {
            let (cx, cy) = (i as i64 % NUM_CELLS, i as i64 / NUM_CELLS);
            let middle = CELL_M * DVec2::new(cx as f64 + 0.5, cy as f64 + 0.5);
            let house = landscape.houses.iter().position(|h| {
                let q = h.local(middle).abs();
                q.x < h.half.x + CELL_M && q.y < h.half.y + CELL_M
            });
            landscape.cells[i] = (house.map(|h| h as u16), landscape.plant(cx, cy, house.is_some()));
        }
        landscape
    }

    /// The tree of a cell: dense in woods, single ones elsewhere, none in river, road and houses.
    fn plant(&self, cx: i64, cy: i64, near_house: bool) -> Option<Plant> {
        let value = |salt| cell_value([cx, cy, 0], salt);
        let p = CELL_M * DVec2::new(cx as f64 + 0.2 + 0.6 * value(31), cy as f64 + 0.2 + 0.6 * value(32));
        let bank = smooth(34.0, 22.0, (p.y - river(p.x)).abs());
        let wood = smooth(0.02, 0.2, fractal((p / 150.0).extend(2.0), 3));
        let village = smooth(150.0, 60.0, (p.x - road(p.y)).abs()) * smooth(330.0, 400.0, p.y);
        let dense = (0.9 * wood).max(0.35 * bank) * (1.0 - 0.8 * village) + 0.025 + 0.07 * village;
        let free = (p.y - river(p.x)).abs() > 17.0 && (p.x - road(p.y)).abs() > 7.0;
        if value(33) > dense || !free || near_house {
            return None;
        }
        let height = 7.0 + 13.0 * value(34) * (0.5 + 0.5 * wood);
        let slim = value(35) < 0.35;
        let radius = height * if slim { 0.17 } else { 0.27 };
        let half_height = height * if slim { 0.44 } else { 0.36 };
        let crown = p.extend(land(p) + height - half_height);
        Some(Plant {
            crown,
            radius,
            half_height,
            tone: if slim { 0.3 * value(36) } else { 0.4 + 0.6 * value(36) },
        })
    }

    fn cell(&self, p: DVec2, dx: i64, dy: i64) -> Option<&(Option<u16>, Option<Plant>)> {
        let (cx, cy) = ((p.x / CELL_M).floor() as i64 + dx, (p.y / CELL_M).floor() as i64 + dy);
        let inside = (0..NUM_CELLS).contains(&cx) && (0..NUM_CELLS).contains(&cy);
        inside.then(|| &self.cells[(cy * NUM_CELLS + cx) as usize])
    }

    fn house(&self, p: DVec2) -> Option<(&House, f64)> {
        let house = &self.houses[usize::from(self.cell(p, 0, 0)?.0?)];
        Some((house, house.roof(p)?))
    }

    /// Height of the highest thing at a place that is not a tree, and what it is.
    pub fn top(&self, p: DVec2) -> (f64, Cover) {
        if let Some((_, roof)) = self.house(p) {
            return (roof, Cover::Building);
        }
        let (to_road, to_river) = ((p.x - road(p.y)).abs(), (p.y - river(p.x)).abs());
        if to_road < 4.0 && to_river < 30.0 {
            return (3.6, Cover::Bridge);
        }
        let z = land(p);
        match () {
            () if z < WATER_Z => (WATER_Z, Cover::Water),
            () if to_road < 3.2 => (z + 0.08, Cover::Road),
            () => (z, Cover::Ground),
        }
    }

    /// The first crown that a ray to the ground at `ground` crosses: where it enters and leaves.
    pub fn crown(&self, ray: &Ray, ground: DVec2) -> Option<(f64, f64, Plant)> {
        let mut best: Option<(f64, f64, Plant)> = None;
        for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
            let Some(tree) = self.cell(ground, dx, dy).and_then(|c| c.1) else { continue };
            // An ellipsoid is a ball in stretched space; distances along the ray stay what they are.
            let stretch = DVec3::new(1.0, 1.0, tree.radius / tree.half_height);
            let direction = ray.direction * stretch;
            let length = direction.length();
            let stretched = Ray { origin: ray.origin * stretch, direction: direction / length };
            if let Some(span) = ball(&stretched, tree.crown * stretch, tree.radius)
                && best.is_none_or(|b| span.enter.t / length < b.0)
                && span.exit.t > 0.0
            {
                best = Some((span.enter.t / length, span.exit.t / length, tree));
            }
        }
        best
    }

    /// Display color of what [`Landscape::top`] found, in the sun.
    pub fn color(&self, p: DVec2, z: f64, cover: Cover, to_sun: DVec3) -> DVec3 {
        let step = 0.6;
        let slope = |d: DVec2| (self.smooth_top(p + d, cover) - self.smooth_top(p - d, cover)) / (2.0 * step);
        let normal = match cover {
            Cover::Water => DVec3::Z,
            _ => DVec3::new(-slope(step * DVec2::X), -slope(step * DVec2::Y), 1.0).normalize(),
        };
        let stain = fractal((p / 3.0).extend(1.0), 3);
        let tint = match cover {
            Cover::Building => {
                let tone = self.house(p).map_or(0.5, |(house, _)| house.tone);
                rgb(150, 78, 56) + (rgb(196, 120, 84) - rgb(150, 78, 56)) * tone
            }
            Cover::Water => rgb(62, 92, 96),
            Cover::Road => rgb(128, 126, 124),
            Cover::Bridge => rgb(168, 160, 148),
            Cover::Ground => field(p),
        } * (1.0 + 0.08 * stain);
        let start = p.extend(z + 0.3);
        let ray = Ray { origin: start, direction: to_sun };
        let in_shade = cover != Cover::Building
            && (self.crown(&ray, p + 7.0 * to_sun.truncate()).is_some()
                || (1..6).any(|i| {
                    let q = start + 2.2 * f64::from(i) * to_sun;
                    self.house(q.truncate()).is_some_and(|(_, roof)| roof > q.z)
                }));
        let sun = if in_shade { 0.0 } else { normal.dot(to_sun).max(0.0) };
        let light = sun * DVec3::new(1.1, 1.0, 0.84) + 0.26 * DVec3::new(0.8, 0.9, 1.1);
        tint * light.map(f64::sqrt)
    }

    /// Height that slopes are taken from; a house's walls make no slope.
    fn smooth_top(&self, p: DVec2, cover: Cover) -> f64 {
        match self.house(p) {
            Some((_, roof)) if cover == Cover::Building => roof,
            _ => land(p),
        }
    }
}

impl Plant {
    /// Display color at a place of the crown.
    pub fn color(&self, p: DVec3, to_sun: DVec3) -> DVec3 {
        let out = (p - self.crown) / DVec3::new(self.radius, self.radius, self.half_height);
        let sun = (0.35 + 0.65 * out.normalize_or(DVec3::Z).dot(to_sun)).max(0.0) * out.length().min(1.0);
        let tint = rgb(52, 82, 44) + (rgb(122, 142, 62) - rgb(52, 82, 44)) * self.tone;
        tint * (0.3 + sun).sqrt() * (1.0 + 0.15 * fractal(p, 2))
    }
}

/// Fields in strips of different crops, meadows between them.
fn field(p: DVec2) -> DVec3 {
    let bend = 18.0 * fractal((p / 160.0).extend(6.0), 2);
    let q = DVec2::new(0.83 * p.x + 0.56 * p.y + bend, 0.83 * p.y - 0.56 * p.x + bend);
    let cell = [(q.x / 130.0).floor() as i64, (q.y / 62.0).floor() as i64, 0];
    let crops =
        [rgb(126, 144, 74), rgb(176, 160, 98), rgb(148, 152, 84), rgb(154, 126, 92), rgb(104, 130, 66)];
    let tint = crops[(cell_value(cell, 41) * crops.len() as f64) as usize];
    let furrow = 1.0 + 0.05 * libm::sin(q.y * 2.4);
    tint * furrow * (1.0 + 0.16 * fractal((p / 28.0).extend(3.0), 3))
}

/// Houses on both sides of the road, north of the river.
fn village(rng: &mut Rng) -> Vec<House> {
    let mut houses: Vec<House> = Vec::new();
    for row in [18.0, 52.0, 88.0] {
        for side in [-1.0, 1.0] {
            let mut y = 430.0 + 60.0 * rng.unit();
            while y < 930.0 - 2.0 * row {
                let middle = DVec2::new(road(y) + side * (row + 7.0 * rng.unit()), y);
                let toward = DVec2::new(road(y + 5.0) - road(y - 5.0), 10.0).normalize();
                let along = if rng.unit() < 0.6 { toward } else { toward.perp() };
                let half = DVec2::new(rng.between(5.0, 8.5), rng.between(3.6, 5.0));
                let ground = land(middle);
                let eaves = ground + rng.between(3.0, 6.2);
                let heights = [ground, eaves, eaves + half.y * rng.between(0.75, 1.05)];
                let dry = (middle.y - river(middle.x)).abs() > 48.0;
                if dry && houses.iter().all(|h| h.middle.distance(middle) > 21.0) && rng.unit() < 0.88 {
                    houses.push(House { middle, along, half, heights, tone: rng.unit() });
                }
                y += rng.between(19.0, 27.0);
            }
        }
    }
    houses.retain(|h| h.middle.distance(CHURCH) > 30.0);
    houses
}

/// Where the church stands.
const CHURCH: DVec2 = DVec2::new(620.0, 640.0);

fn church() -> House {
    let ground = land(CHURCH);
    let half = DVec2::new(14.0, 6.5);
    House {
        middle: CHURCH,
        along: DVec2::X,
        half,
        heights: [ground, ground + 10.0, ground + 17.0],
        tone: 0.1,
    }
}

fn tower() -> House {
    let ground = land(CHURCH);
    let middle = CHURCH - DVec2::new(17.5, 0.0);
    House {
        middle,
        along: DVec2::X,
        half: DVec2::ONE,
        heights: [ground, ground + 24.0, ground + 31.0],
        tone: 0.0,
    }
}

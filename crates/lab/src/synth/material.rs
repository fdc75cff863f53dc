//! Colors of surfaces: patterns, stains and wear as functions of the place.
//!
//! Colors here are display values (0 to 1, as on a screen); the light's square root scales them.

use base::random::{cell_value, fractal, noise};
use glam::DVec3;

/// What a surface is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Material {
    /// Dressed limestone: columns, arches, steps, rims.
    Stone,
    /// Painted plaster of the given tint, dirty near the ground and under the eaves (`foot`, `top`: heights).
    Plaster {
        /// Base color.
        tint: DVec3,
        /// Height at which the wall meets the ground.
        foot: f64,
        /// Height of its upper edge.
        top: f64,
    },
    /// Bricks with mortar.
    Brick,
    /// Large floor slabs in a running bond.
    Paving,
    /// Small square tiles in two colors, their diagonal along the walls.
    Checker,
    /// Clay roof tiles in rows; `down` is the horizontal direction in which the roof falls.
    Roof {
        /// Horizontal unit vector down the roof.
        down: DVec3,
    },
    /// Boards or beams, grain along an axis (0, 1, 2).
    Wood {
        /// Axis of the grain.
        grain: usize,
        /// Base color.
        tint: DVec3,
    },
    /// Grass.
    Grass,
    /// Leaves, whose brightness varies with the place from leaf to leaf.
    Leaf {
        /// Base color.
        tint: DVec3,
    },
    /// Bark.
    Bark,
    /// Still water.
    Water,
    /// Window panes.
    Glass,
    /// Iron.
    Iron,
    /// Fired clay pots.
    Clay,
    /// Cloth of the given color, woven in stripes.
    Cloth {
        /// Base color.
        tint: DVec3,
    },
    /// Anything painted evenly.
    Paint {
        /// Color.
        tint: DVec3,
    },
}

/// A color from display values of 0–255.
pub const fn rgb(r: u8, g: u8, b: u8) -> DVec3 {
    DVec3::new(r as f64 / 255.0, g as f64 / 255.0, b as f64 / 255.0)
}

fn lerp(a: DVec3, b: DVec3, t: f64) -> DVec3 {
    a + (b - a) * t.clamp(0.0, 1.0)
}

/// 0 below `low`, 1 above `high`, smooth between.
pub fn smooth(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Coordinates on a surface: along the horizontal (or x) and upwards (or y).
fn on_surface(p: DVec3, normal: DVec3) -> (f64, f64) {
    let n = normal.abs();
    if n.z > 0.7 {
        (p.x, p.y)
    } else if n.x > n.y {
        (p.y, p.z)
    } else {
        (p.x, p.z)
    }
}

/// The stone of a running bond at a place, and the distance to its joint in meters.
fn bond(u: f64, v: f64, width: f64, height: f64) -> ([i64; 3], f64) {
    let row = (v / height).floor();
    let shifted = u / width + 0.5 * (row - 2.0 * (0.5 * row).floor());
    let column = shifted.floor();
    let (du, dv) = ((shifted - column) * width, v - row * height);
    let joint = du.min(width - du).min(dv).min(height - dv);
    ([column as i64, row as i64, 0], joint)
}

impl Material {
    /// Color at a place of the surface, display values.
    pub fn color(&self, p: DVec3, normal: DVec3) -> DVec3 {
        let (u, v) = on_surface(p, normal);
        let grain = noise(60.0 * p);
        let stain = fractal(1.3 * p, 4);
        match *self {
            Self::Stone => {
                let (stone, joint) = bond(u, v, 0.62, 0.31);
                let warm = lerp(rgb(196, 180, 150), rgb(214, 203, 180), cell_value(stone, 1));
                let color = lerp(warm, rgb(140, 126, 104), smooth(0.05, 0.7, stain));
                color * (1.0 + 0.03 * grain) * if joint < 0.006 { 0.82 } else { 1.0 }
            }
            Self::Plaster { tint, foot, top } => plaster(p, u, tint, p.z - foot, top - p.z),
            Self::Brick => {
                let (brick, joint) = bond(u, v, 0.25, 0.08);
                let tone = lerp(rgb(150, 82, 58), rgb(186, 112, 78), cell_value(brick, 2));
                let color = if joint < 0.006 { rgb(178, 168, 150) } else { tone };
                color * (1.0 + 0.05 * grain + 0.10 * stain)
            }
            Self::Paving => {
                let (slab, joint) = bond(u, v, 0.8, 0.6);
                let tone = lerp(rgb(158, 146, 128), rgb(190, 178, 158), cell_value(slab, 3));
                let moss = smooth(0.15, 0.6, fractal(0.5 * p + DVec3::splat(40.0), 3));
                let seam = lerp(rgb(96, 88, 74), rgb(84, 98, 52), moss);
                let worn = tone * (1.0 + 0.04 * grain + 0.09 * stain);
                if joint < 0.012 { seam } else { worn }
            }
            Self::Checker => {
                let (a, b) = ((u + v) / 0.424, (u - v) / 0.424);
                let dark = (a.floor() as i64 + b.floor() as i64) & 1 == 0;
                let edge = (a - a.floor()).min(b - b.floor());
                let tone = if dark { rgb(140, 70, 50) } else { rgb(214, 192, 156) };
                let tile = cell_value([a.floor() as i64, b.floor() as i64, 0], 4);
                let color = tone * (0.92 + 0.12 * tile + 0.05 * stain);
                if edge < 0.02 { rgb(120, 108, 92) } else { color }
            }
            Self::Roof { down } => roof(p, down, stain),
            Self::Wood { grain: axis, tint } => {
                let mut stretched = p * 22.0;
                stretched[axis] *= 0.06;
                let board = cell_value(DVec3::floor(p / 0.18).with_axis(axis, 0.0), 6);
                tint * (0.88 + 0.16 * board + 0.14 * fractal(stretched, 3))
            }
            Self::Grass => {
                let tone = lerp(rgb(86, 112, 46), rgb(142, 148, 76), 0.5 + 0.9 * stain);
                tone * (0.9 + 0.22 * grain)
            }
            Self::Leaf { tint } => {
                let tone = cell_value((p / 0.06).floor().to_array().map(|c| c as i64), 7);
                lerp(tint * 0.72, tint * 1.22 + DVec3::new(0.05, 0.03, 0.0), tone)
            }
            Self::Bark => {
                let rough = fractal(p * DVec3::new(24.0, 24.0, 5.0), 3);
                lerp(rgb(84, 68, 54), rgb(138, 120, 100), 0.5 + 0.8 * rough)
            }
            Self::Water => rgb(74, 104, 104) * (1.0 + 0.10 * fractal(4.0 * p, 3)),
            Self::Glass => rgb(66, 80, 92) * (1.0 + 0.2 * noise(0.8 * p)),
            Self::Iron => rgb(58, 54, 52) * (1.0 + 0.15 * stain),
            Self::Clay => rgb(176, 96, 62) * (1.0 + 0.10 * stain + 0.04 * grain),
            Self::Cloth { tint } => {
                let stripe = if ((p.x + p.y) / 0.12).floor() as i64 & 3 == 0 { 0.78 } else { 1.0 };
                tint * stripe * (1.0 + 0.05 * grain)
            }
            Self::Paint { tint } => tint * (1.0 + 0.06 * stain + 0.02 * grain),
        }
    }

    /// Share of the laser's light (near infrared) that comes back from a surface seen straight on.
    pub fn reflectance(&self) -> f64 {
        match self {
            Self::Stone | Self::Plaster { .. } => 0.62,
            Self::Paving | Self::Checker | Self::Clay | Self::Paint { .. } => 0.45,
            Self::Brick | Self::Roof { .. } | Self::Cloth { .. } => 0.40,
            Self::Wood { .. } | Self::Bark => 0.35,
            Self::Grass | Self::Leaf { .. } => 0.55,
            Self::Water | Self::Glass => 0.06,
            Self::Iron => 0.18,
        }
    }

    /// True where light shines through from behind.
    pub fn is_thin(&self) -> bool {
        matches!(self, Self::Leaf { .. })
    }
}

/// Plaster `above` the ground and `below` the eaves: bare patches with bricks, splashes, streaks of rain.
fn plaster(p: DVec3, u: f64, tint: DVec3, above: f64, below: f64) -> DVec3 {
    let broad = fractal(0.45 * p + DVec3::splat(9.0), 4);
    let fine = fractal(5.0 * p, 3);
    let mut color = tint * (1.0 + 0.09 * broad + 0.035 * fine);
    let bare = smooth(0.50, 0.56, fractal(0.6 * p + DVec3::splat(71.0), 5) + 0.24 * smooth(1.2, 0.0, above));
    if bare > 0.0 {
        let (brick, joint) = bond(u, p.z, 0.25, 0.08);
        let tone = lerp(rgb(158, 92, 66), rgb(186, 116, 84), cell_value(brick, 2));
        color = lerp(color, if joint < 0.007 { rgb(180, 168, 148) } else { tone }, 0.85 * bare);
    }
    let splash = smooth(0.75, 0.0, above + 0.3 * fine) * 0.45;
    color = lerp(color, rgb(112, 100, 80), splash);
    let streak = smooth(0.1, 0.8, noise(DVec3::new(5.0 * u, 0.25 * p.z, 3.0))) * smooth(2.6, 0.0, below);
    lerp(color, rgb(120, 110, 94), 0.5 * streak)
}

/// Half-round tiles: rows across the fall, each tile with its own tone, moss here and there.
fn roof(p: DVec3, down: DVec3, stain: f64) -> DVec3 {
    let (across, along) = (p.dot(down.cross(DVec3::Z)), p.dot(down));
    let (column, row) = ((across / 0.20).floor(), (along / 0.33).floor());
    let in_column = across / 0.20 - column;
    let in_row = along / 0.33 - row;
    let round = 0.70 + 0.34 * smooth(0.0, 0.5, 0.5 - (in_column - 0.5).abs());
    let lip = if in_row > 0.9 { 0.72 } else { 1.0 };
    let tone = cell_value([column as i64, row as i64, 0], 5);
    let clay = lerp(rgb(168, 92, 60), rgb(206, 138, 96), tone);
    let color = lerp(clay, rgb(132, 128, 92), smooth(0.1, 0.7, stain));
    color * round * lip
}

/// Cells with one coordinate replaced.
trait WithAxis {
    fn with_axis(self, axis: usize, value: f64) -> [i64; 3];
}

impl WithAxis for DVec3 {
    fn with_axis(mut self, axis: usize, value: f64) -> [i64; 3] {
        self[axis] = value;
        self.to_array().map(|c| c as i64)
    }
}

//! Where one can stand: an index of a scan's points by columns and layers, made once, that tells the floors along a vertical
//! and what is in the way, without taking memory.
//!
//! A column is a square of the floor plan, a layer a quarter of its edge thick, and a cell knows the mean place of its
//! points. A floor is a plane through the cells round a place, one of as many as there are stories; see `surface`. Single
//! points in the air are neither floors nor walls: there are next to none beside the densest layers of their columns.

mod build;
mod cells;
#[cfg(test)]
pub(crate) mod made_up;
mod surface;
#[cfg(test)]
mod tests;

use glam::{DVec2, DVec3};
use std::sync::{Arc, OnceLock};
use surface::{ColumnWindow, NEAR, Surface, WIDE};

/// Layers as thick as a column's edge is long.
const LAYERS_PER_EDGE: f64 = 4.0;
/// Steepest floor that one can stand on, as its rise over its run: 40 degrees.
pub const STEEPEST: f64 = 0.839;
/// Highest step that one takes, meters.
pub const STEP_M: f64 = 0.35;
/// Least room between a floor and what hangs above it, meters.
pub const HEADROOM_M: f64 = 1.2;
/// Share of a floor's points that may be in the room above it, as single points are.
const CLUTTER_SHARE: f64 = 0.1;
/// Number of points that may be in the room above a floor, however few the floor has.
const CLUTTER_POINTS: f64 = 2.0;
/// Part of a floor's points in the middle column, above which what lies on it, lower than a step, is the floor instead.
const COVER_SHARE: f64 = 0.5;
/// Least share of the points in the densest layers around that something solid has.
const SOLID_SHARE: f64 = 0.004;
/// Least number of points of something solid.
const SOLID_POINTS: f64 = 5.0;
/// Half the height, in edges, of what is looked at for something solid.
const SOLID_REACH: f64 = 1.0;
/// Depth, meters, within which a floor that is seen through a hole shows that the hole is one in the floor, and not in
/// what was scanned of it.
const SEEN_THROUGH_M: f64 = 4.0;

/// Floors that come when they have been made, for those who walk meanwhile.
pub type FloorsCell = Arc<OnceLock<Floors>>;

/// Points of a scan by columns and layers.
#[derive(Clone, Debug)]
pub struct Floors {
    /// Corner of the first column's first layer, world space.
    origin: DVec3,
    /// Edge of a column, world units.
    edge: f64,
    units_per_m: f64,
    /// Number of the highest layer that has points.
    top_layer: i64,
    /// Number of the first column of each row along x; and of all columns, at the end.
    rows: Vec<u32>,
    /// Columns that have points, by y, then x.
    columns: Vec<FloorColumn>,
    /// Cells that have points, by columns, then upwards.
    cells: Vec<Cell>,
}

/// A column.
#[derive(Clone, Copy, Debug)]
struct FloorColumn {
    /// Number along x.
    x: u32,
    /// Number of its first cell.
    first: u32,
    /// Points in its densest two layers.
    peak: f32,
}

/// A cell: the number of its points, at most 65535, and their mean place from its corner.
#[derive(Clone, Copy, Debug)]
struct Cell {
    layer: u16,
    /// In 65536ths of a layer.
    z: u16,
    /// In 256ths of the edge.
    x: u8,
    /// In 256ths of the edge.
    y: u8,
    num: u16,
}

/// A floor at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floor {
    /// Height of the place, world space.
    pub height: f64,
    /// Rise of the floor along x and y.
    pub grade: DVec2,
}

impl Floors {
    /// No floors anywhere.
    #[must_use]
    pub fn none(units_per_m: f64) -> Self {
        let (rows, columns, cells) = (Vec::new(), Vec::new(), Vec::new());
        Self { origin: DVec3::ZERO, edge: units_per_m, units_per_m, top_layer: 0, rows, columns, cells }
    }

    /// True if there are no floors anywhere.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// Edge of a column, world units: what is nearer to each other than this is hardly told apart.
    #[must_use]
    pub fn edge(&self) -> f64 {
        self.edge
    }

    /// World units a meter of the user's where the scan is shown as large as life.
    #[must_use]
    pub fn units_per_m(&self) -> f64 {
        self.units_per_m
    }

    /// Memory that the index takes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&self.rows[..]) + size_of_val(&self.columns[..]) + size_of_val(&self.cells[..])
    }

    /// Heights of the surfaces on the vertical through a place between two heights, from above downwards, be they floors,
    /// ceilings or tables.
    pub fn heights(&self, at_in_world: DVec2, low: f64, high: f64) -> impl Iterator<Item = f64> {
        let at = at_in_world - self.origin.truncate();
        let [low, high] = [low, high].map(|height| height - self.origin.z);
        let mut below = high;
        std::iter::from_fn(move || {
            let found = self.surface(at, &NEAR, low, below)?;
            below = found.below;
            Some(found.floor.height + self.origin.z)
        })
    }

    /// The highest floor below a place that one can stand on, at most `depth` world units lower.
    #[must_use]
    pub fn below(&self, p_in_world: DVec3, depth: f64) -> Option<Floor> {
        let p = p_in_world - self.origin;
        let floor = self.highest(p.truncate(), p.z - depth, p.z).or_else(|| {
            let floor = self.standing(p.truncate(), &WIDE, p.z - depth, p.z).next()?;
            self.is_bridged(p.truncate(), &floor).then_some(floor)
        });
        floor.map(|floor| self.in_world(floor))
    }

    /// As [`Self::below`], without a look beyond the hole that a place may be in.
    #[must_use]
    pub fn right_below(&self, p_in_world: DVec3, depth: f64) -> Option<Floor> {
        let p = p_in_world - self.origin;
        self.highest(p.truncate(), p.z - depth, p.z).map(|floor| self.in_world(floor))
    }

    /// The floor that one can stand on whose height is nearest to that of a place, at most `up` world units higher and
    /// `down` lower.
    #[must_use]
    pub fn nearest(&self, p_in_world: DVec3, up: f64, down: f64) -> Option<Floor> {
        let p = p_in_world - self.origin;
        let (at, [low, high]) = (p.truncate(), [p.z - down, p.z + up]);
        let away = |floor: &Floor| (floor.height - p.z).abs();
        let nearest = |window: &'static ColumnWindow| {
            self.standing(at, window, low, high).min_by(|a, b| away(a).total_cmp(&away(b)))
        };
        let floor = nearest(&NEAR).or_else(|| nearest(&WIDE).filter(|floor| self.is_bridged(at, floor)));
        floor.map(|floor| self.in_world(floor))
    }

    /// True if something solid is within about an edge of a place: a wall, a ceiling, a floor.
    #[must_use]
    pub fn is_solid(&self, p_in_world: DVec3) -> bool {
        let p = p_in_world - self.origin;
        let (half, window) = (SOLID_REACH * self.edge, ColumnWindow { reach: 1, stride: 1 });
        let (mut num, mut filled) = (0.0, 0u128);
        self.visit(p.truncate(), &window, p.z - half, p.z + half, |seen| {
            num += seen.num;
            filled |= 1 << seen.slot;
        });
        let is_some = num >= SOLID_POINTS && filled.count_ones() >= 2;
        is_some && num >= SOLID_SHARE * self.peaks(p.truncate(), &window)
    }

    fn in_world(&self, floor: Floor) -> Floor {
        Floor { height: floor.height + self.origin.z, ..floor }
    }

    /// The highest floor between two heights, from the points right there.
    fn highest(&self, at: DVec2, low: f64, high: f64) -> Option<Floor> {
        self.standing(at, &NEAR, low, high).next()
    }

    /// Floors that one can stand on between two heights, from above downwards.
    fn standing(
        &self,
        at: DVec2,
        window: &'static ColumnWindow,
        low: f64,
        high: f64,
    ) -> impl Iterator<Item = Floor> {
        let mut below = high;
        std::iter::from_fn(move || {
            loop {
                let found = self.surface(at, window, low, below)?;
                below = found.below;
                let Surface { floor, num, .. } = found;
                let is_floor = floor.grade.length() <= STEEPEST && !self.is_covered(at, &floor);
                if is_floor && self.has_headroom(at, &floor, num) {
                    return Some(floor);
                }
            }
        })
    }

    /// True if nothing hangs low above a floor that has `num` points round the place.
    fn has_headroom(&self, at: DVec2, floor: &Floor, num: f64) -> bool {
        let [low, high] = [STEP_M, HEADROOM_M].map(|height| height * self.units_per_m);
        // A slope rises beside the place, and is not in the way of itself.
        let rise = floor.grade.length() * 3.0 * self.edge;
        let range = [floor.height + low - rise, floor.height + high + rise];
        let mut in_the_way = 0.0;
        self.visit(at, &ColumnWindow { reach: 1, stride: 1 }, range[0], range[1], |seen| {
            let above = seen.z - floor.height - floor.grade.dot(seen.d);
            in_the_way += if (low..high).contains(&above) { seen.num } else { 0.0 };
        });
        in_the_way <= (CLUTTER_SHARE * num).max(CLUTTER_POINTS)
    }

    /// True if something lies on a floor, lower than a step: that is the floor then, or this is the lower side of one.
    fn is_covered(&self, at: DVec2, floor: &Floor) -> bool {
        let layer = self.edge / LAYERS_PER_EDGE;
        let (mut floor_points, mut on_it) = (0.0, 0.0);
        let [low, high] = [floor.height - 2.5 * layer, floor.height + STEP_M * self.units_per_m];
        self.visit(at, &ColumnWindow { reach: 0, stride: 1 }, low, high, |seen| {
            let above = seen.z - floor.height - floor.grade.dot(seen.d);
            *(if above > 2.5 * layer { &mut on_it } else { &mut floor_points }) += seen.num;
        });
        on_it > COVER_SHARE * floor_points
    }

    /// True if a floor that is known only around a place goes on there, as far as can be seen.
    fn is_bridged(&self, at: DVec2, floor: &Floor) -> bool {
        let [high, depth] = [STEP_M, SEEN_THROUGH_M].map(|depth| floor.height - depth * self.units_per_m);
        self.highest(at, depth, high).is_none()
    }
}

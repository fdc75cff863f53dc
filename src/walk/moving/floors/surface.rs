//! A surface at a place: layers in which many points of the columns around it lie, and the plane through them that most of
//! these points agree on, whatever else stands there.

use super::{Floor, FloorColumn, Floors, LAYERS_PER_EDGE, STEP_M};
use glam::{DMat3, DVec2, DVec3};

/// Columns around a place that are looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColumnWindow {
    /// Columns to each side.
    pub reach: i64,
    /// Each so many columns.
    pub stride: i64,
}

/// Columns that tell a floor's height.
pub(super) const NEAR: ColumnWindow = ColumnWindow { reach: 2, stride: 1 };
/// Columns that tell whether a floor has a hole.
pub(super) const WIDE: ColumnWindow = ColumnWindow { reach: 8, stride: 2 };
/// Columns in which layers are sought.
const CORE: ColumnWindow = ColumnWindow { reach: 1, stride: 1 };
/// Least number of the 25 columns of [`NEAR`] that a floor has points in: a step of a staircase is as deep.
const MOST_MISSING: u32 = 14;
/// Least number of the 81 columns of [`WIDE`] that a floor with a hole has points in.
const AROUND: u32 = 8;
/// Least number of the 9 columns of [`CORE`] that a floor has points in where the middle one has none at all.
const CORE_COLUMNS: u32 = 3;
/// Least share of the points in the densest layers around that a surface has.
const SURFACE_SHARE: f64 = 0.05;
/// Layers that are looked at together.
const CHUNK: usize = 64;
/// Most cells that a plane is laid through.
const MOST_SPOTS: usize = 400;
/// Rises over run that are tried, in eight directions, besides a level plane.
const GRADES: [f64; 2] = [0.35, 0.7];
/// Distances from the plane, in layers, within which cells count, one after the other.
const TOLERANCES: [f64; 5] = [2.0, 1.5, 1.0, 0.75, 0.6];
/// Share of the slope before that the next one keeps; it matters where cells lie in a line.
const KEPT_SLOPE: f64 = 0.02;

/// A cell as seen from a place.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SeenCell {
    /// Mean of its points across, from the place.
    pub d: DVec2,
    /// Mean height of its points.
    pub z: f64,
    /// Number of its points.
    pub num: f64,
    /// Number of its column in the window.
    pub slot: usize,
}

/// A surface that was found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    /// As a floor; its height is from the origin of the index.
    pub floor: Floor,
    /// Number of its points round the place.
    pub num: f64,
    /// Height below which other surfaces may be.
    pub below: f64,
}

impl ColumnWindow {
    fn width(&self) -> i64 {
        2 * self.reach / self.stride + 1
    }

    /// Number of the middle column.
    fn middle(&self) -> usize {
        let half = self.reach / self.stride;
        (half * self.width() + half) as usize
    }
}

impl Floors {
    /// Thickness of a layer.
    fn layer(&self) -> f64 {
        self.edge / LAYERS_PER_EDGE
    }

    /// Calls `see` with each column of the window that has points, and its number in the window.
    fn each_column(&self, at: DVec2, window: &ColumnWindow, mut see: impl FnMut(usize, usize)) {
        let [x, y] = (at / self.edge).floor().to_array();
        // Places far outside have no columns.
        if !(x.abs() < 1e9 && y.abs() < 1e9) {
            return;
        }
        let (x, y) = (x as i64, y as i64);
        for row in 0..window.width() {
            let y = y - window.reach + row * window.stride;
            let Some(&[first, end]) =
                usize::try_from(y).ok().and_then(|y| self.rows.get(y..y + 2)?.first_chunk())
            else {
                continue;
            };
            let left = x - window.reach;
            let columns = &self.columns[first as usize..end as usize];
            let begin = columns.partition_point(|column| i64::from(column.x) < left);
            for (number, column) in columns.iter().enumerate().skip(begin) {
                let across = i64::from(column.x) - left;
                if across > 2 * window.reach {
                    break;
                }
                if across % window.stride == 0 {
                    let slot = row * window.width() + across / window.stride;
                    see(slot as usize, first as usize + number);
                }
            }
        }
    }

    /// Calls `see` with each cell of the window whose mean height is between two heights.
    pub(super) fn visit(
        &self,
        at: DVec2,
        window: &ColumnWindow,
        low: f64,
        high: f64,
        mut see: impl FnMut(SeenCell),
    ) {
        let layer = self.layer();
        let lowest = (low / layer).floor();
        let y0 = (at.y / self.edge).floor() - window.reach as f64;
        self.each_column(at, window, |slot, number| {
            let FloorColumn { x, first, .. } = self.columns[number];
            let end = self.columns.get(number + 1).map_or(self.cells.len(), |next| next.first as usize);
            let cells = &self.cells[first as usize..end];
            let begin = cells.partition_point(|cell| f64::from(cell.layer) < lowest);
            let y = y0 + (slot as i64 / window.width() * window.stride) as f64;
            for cell in &cells[begin..] {
                let z = (f64::from(cell.layer) + (f64::from(cell.z) + 0.5) / 65_536.0) * layer;
                if z > high {
                    break;
                }
                if z >= low {
                    let inside = DVec2::new(f64::from(cell.x), f64::from(cell.y));
                    let d = (DVec2::new(f64::from(x), y) + (inside + 0.5) / 256.0) * self.edge - at;
                    see(SeenCell { d, z, num: f64::from(cell.num), slot });
                }
            }
        });
    }

    /// Points in the densest two layers of each column of the window, together.
    pub(super) fn peaks(&self, at: DVec2, window: &ColumnWindow) -> f64 {
        let mut sum = 0.0;
        self.each_column(at, window, |_, number| sum += f64::from(self.columns[number].peak));
        sum
    }

    /// The highest surface at a place between two heights.
    pub(super) fn surface(
        &self,
        at: DVec2,
        window: &'static ColumnWindow,
        low: f64,
        high: f64,
    ) -> Option<Surface> {
        let is_near = window.stride == 1;
        let core = if is_near { &CORE } else { window };
        let least = SURFACE_SHARE * self.peaks(at, core);
        let layer = self.layer();
        // The layer above may hold a part of a surface that is not above `high`.
        let mut top = ((high / layer).floor() as i64).min(self.top_layer) + 1;
        let lowest = (low / layer).floor().max(0.0) as i64;
        while top >= lowest {
            // One more layer on each side tells whether a layer is denser than those beside it.
            let bottom = (top - CHUNK as i64).max(lowest - 2);
            let (mut num, mut sum) = ([0.0; CHUNK + 3], [0.0; CHUNK + 3]);
            let range = [(bottom - 1) as f64 * layer, (top + 2) as f64 * layer];
            self.visit(at, core, range[0], range[1], |seen| {
                let slot = ((seen.z / layer) as i64 - bottom + 1).clamp(0, CHUNK as i64 + 2) as usize;
                num[slot] += seen.num;
                sum[slot] += seen.num * seen.z;
            });
            let slab = |slot: usize| num[slot] + num[slot - 1];
            for slot in (2..=CHUNK + 1).rev() {
                let dense = slab(slot);
                if dense < least.max(1.0) || dense < slab(slot + 1) || dense <= slab(slot - 1) {
                    continue;
                }
                let z = (sum[slot] + sum[slot - 1]) / dense;
                if let Some(surface) = self.plane(at, window, z)
                    && (low..=high).contains(&surface.floor.height)
                {
                    return Some(surface);
                }
            }
            top = bottom;
        }
        None
    }

    /// The surface through most of the cells near a height, if it is one at this place.
    fn plane(&self, at: DVec2, window: &ColumnWindow, z: f64) -> Option<Surface> {
        let (layer, is_near) = (self.layer(), window.stride == 1);
        let cone = if is_near { 0.9 } else { 0.3 };
        let slack = 2.5 * layer;
        let most = slack + cone * (window.reach as f64 + 1.5) * self.edge;
        let (mut spots, mut num_spots) = ([SeenCell::default(); MOST_SPOTS], 0);
        self.visit(at, window, z - most, z + most, |seen| {
            if (seen.z - z).abs() <= slack + cone * seen.d.length() && num_spots < MOST_SPOTS {
                spots[num_spots] = seen;
                num_spots += 1;
            }
        });
        let spots = &spots[..num_spots];
        let spread = if is_near { 1.5 } else { 8.0 } * self.edge;
        let kernel = |d: DVec2| (-0.5 * d.length_squared() / (spread * spread)).exp();
        let mut plane = hypotheses(is_near)
            .map(|grade| anchored(spots, grade, z, slack, layer, &kernel))
            .max_by(|a, b| a.0.total_cmp(&b.0))?
            .1;
        for tolerance in TOLERANCES {
            plane = refined(spots, plane, tolerance * layer, spread, &kernel)?;
        }
        let height = plane.x;
        // What belongs to the surface.
        let (mut num, mut filled) = (0.0, 0u128);
        for seen in spots {
            if residual(seen, plane).abs() <= 1.2 * layer + 0.05 * seen.d.length() {
                filled |= 1 << seen.slot;
                num += if seen.d.abs().max_element() <= 1.5 * self.edge { seen.num } else { 0.0 };
            }
        }
        let is_one = if is_near {
            let has_core = filled & (1 << window.middle()) != 0
                || filled_core(filled) >= CORE_COLUMNS && !self.has_other(at, height);
            has_core && 25 - filled.count_ones() <= MOST_MISSING
        } else {
            filled.count_ones() >= AROUND && surrounds(filled, window)
        };
        let floor = Floor { height, grade: DVec2::new(plane.y, plane.z) };
        is_one.then_some(Surface { floor, num, below: height.min(z) - 1.5 * layer })
    }

    /// True if the middle column has something at about a height, up to a step away.
    fn has_other(&self, at: DVec2, height: f64) -> bool {
        let (step, mut has) = (STEP_M * self.units_per_m, false);
        self.visit(at, &ColumnWindow { reach: 0, stride: 1 }, height - step, height + step, |_| has = true);
        has
    }
}

/// Slopes to begin with: level, and eight directions.
fn hypotheses(with_slopes: bool) -> impl Iterator<Item = DVec2> {
    let directions = (0..8).map(|eighth| DVec2::from_angle(f64::from(eighth) * std::f64::consts::FRAC_PI_4));
    let slopes = directions.flat_map(|direction| GRADES.map(|grade| direction * grade));
    std::iter::once(DVec2::ZERO).chain(slopes.filter(move |_| with_slopes))
}

/// Height of a cell above a plane: its height at the place, and its rises.
fn residual(seen: &SeenCell, plane: DVec3) -> f64 {
    seen.z - plane.dot(DVec3::new(1.0, seen.d.x, seen.d.y))
}

/// The plane of a slope at the height that its cells have on average, and how many of them agree with it.
fn anchored(
    spots: &[SeenCell],
    grade: DVec2,
    z: f64,
    slack: f64,
    layer: f64,
    kernel: &impl Fn(DVec2) -> f64,
) -> (f64, DVec3) {
    let (mut weight, mut sum) = (0.0, 0.0);
    for seen in spots {
        let above = seen.z - z - grade.dot(seen.d);
        if above.abs() <= slack {
            let w = seen.num * kernel(seen.d);
            (weight, sum) = (weight + w, sum + w * above);
        }
    }
    let plane = DVec3::new(z + if weight > 0.0 { sum / weight } else { 0.0 }, grade.x, grade.y);
    let agreeing = |seen: &SeenCell| {
        let away = residual(seen, plane) / (layer + 0.12 * seen.d.length());
        seen.num.min(64.0) * kernel(seen.d) * (1.0 - away * away).max(0.0)
    };
    (spots.iter().map(agreeing).sum(), plane)
}

/// The plane of least squares through the cells within a distance of a plane; the further away, the less they count.
fn refined(
    spots: &[SeenCell],
    plane: DVec3,
    tolerance: f64,
    spread: f64,
    kernel: &impl Fn(DVec2) -> f64,
) -> Option<DVec3> {
    let (mut normal, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for seen in spots {
        let above = residual(seen, plane);
        let away = above / (tolerance + 0.05 * seen.d.length());
        if away.abs() < 1.0 {
            let biweight = (1.0 - away * away).powi(2);
            let row = DVec3::new(1.0, seen.d.x, seen.d.y);
            let weighted = row * (seen.num * kernel(seen.d) * biweight);
            normal += DMat3::from_cols(weighted * row.x, weighted * row.y, weighted * row.z);
            right += weighted * above;
        }
    }
    let weight = normal.x_axis.x;
    if weight <= 0.0 {
        return None;
    }
    let kept = KEPT_SLOPE * weight * spread * spread;
    (normal.y_axis.y, normal.z_axis.z) = (normal.y_axis.y + kept, normal.z_axis.z + kept);
    let better = plane + normal.inverse() * right;
    better.is_finite().then_some(better)
}

/// Number of the nine columns in the middle of [`NEAR`] that are filled.
fn filled_core(filled: u128) -> u32 {
    let core = (1..4).flat_map(|row| (1..4).map(move |column| 1u128 << (5 * row + column)));
    (filled & core.sum::<u128>()).count_ones()
}

/// True if filled columns are on all sides of the middle one.
fn surrounds(filled: u128, window: &ColumnWindow) -> bool {
    let (width, half) = (window.width(), window.reach / window.stride);
    let quadrant = |right: bool, ahead: bool| {
        let is_in = |at: i64, far: bool| if far { at > half } else { at < half };
        (0..width * width).any(|slot| {
            let (x, y) = (slot % width, slot / width);
            is_in(x, right) && is_in(y, ahead) && filled & (1 << slot) != 0
        })
    };
    [(false, false), (false, true), (true, false), (true, true)].into_iter().all(|(x, y)| quadrant(x, y))
}

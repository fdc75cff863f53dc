//! Whether one can stand in a scene, and where. A room has a floor below, and walls all around that are further away
//! than arm's length; an open place has its ground on all sides. A scene that has neither is an object, to be seen
//! from outside. Size tells little: a statue may be larger than a room.

use base::space::Bounds;
use glam::{DVec2, DVec3};
use points::Scene;

/// Most cells along the longer side of the floor plan.
const MAX_CELLS: f64 = 64.0;
/// Least edge of a cell, meters.
const MIN_CELL_M: f64 = 0.25;
/// Least number of points that a cell has on average.
const MEAN_CELL_POINTS: f64 = 16.0;
/// Factors on the cells' edge, one after the other: if there is no place, the ground may be scanned more thinly than
/// what stands on it.
const COARSER: [f64; 2] = [1.0, 3.0];
/// Least number of points in a cell that has a floor.
const MIN_CELL_POINTS: usize = 3;
/// Share of a cell's points that may lie below its floor, as single points do.
const FLOOR_SHARE: f64 = 0.05;
/// Share of the points that reflections and dust leave in the air of any scan. This share of a mean cell's points is
/// in nobody's way, and this share of the points in a direction is no wall.
const AIR_SHARE: f64 = 0.05;
/// Heights above the floor, meters, between which a body would bump into things.
const BODY_M: [f64; 2] = [0.4, 1.9];
/// Room that a body needs to each side, meters.
const BODY_RADIUS_M: f64 = 0.5;
/// Heights above the floor, meters, at which walls are looked for: above tables, below ceilings.
const WALL_M: [f64; 2] = [1.0, 2.2];
/// Number of directions in which walls are looked for.
const NUM_DIRECTIONS: usize = 32;
/// Least share of the directions that have a wall in a room.
const ENCLOSED: f64 = 0.7;
/// Least distance of the walls of a room, meters.
const ARMS_LENGTH_M: f64 = 0.9;
/// Least share of the floor up to the walls that is level. A hollow scene that is no room is round below.
const FLOOR_LEVEL_SHARE: f64 = 0.5;
/// Largest difference in height of a level floor, meters.
const FLOOR_LEVEL_M: f64 = 0.3;
/// Nobody stands on tables: a place is on one if the floor within the first distance is lower by the second, meters.
const TABLE_M: [f64; 2] = [1.0, 0.3];
/// Walls nearer than this, meters, are those of a tower or a shed, to be seen from outside if there is an open place.
const SMALL_ROOM_M: f64 = 2.5;
/// Distance, meters, in which a place outside has nothing in a body's way, if there is such a place.
const CLEARANCE_M: f64 = 3.0;
/// Walls nearer than this, meters, are those of a room, whether or not its ceiling was scanned.
const ROOM_M: f64 = 6.0;
/// Least height of a ceiling above the floor, meters.
const CEILING_M: f64 = 1.9;
/// Distance within which a ceiling is looked for, meters.
const CEILING_REACH_M: f64 = 5.0;
/// A ceiling covers the first share of the floor, whatever its form, or the second share within [`FLOOR_LEVEL_M`] of one
/// height. Trees do neither.
const CEILING_SHARES: [f64; 2] = [0.9, 0.6];
/// Least length of a scene that has an open place, meters.
const OPEN_M: f64 = 12.0;
/// Distance within which the ground of an open place is looked at, meters.
const GROUND_M: f64 = 5.0;
/// Largest difference in height of the level ground of an open place, meters.
const LEVEL_M: f64 = 0.5;
/// Least share of the ground of an open place that is level.
const GROUND_SHARE: f64 = 0.7;
/// Share of the scene's height, from below, in which the ground of an open place lies.
const LOW_SHARE: f64 = 0.25;
/// Share of the points at either end of the height that may be strays.
const STRAY_SHARE: f64 = 0.02;

/// Heights of a scanner on its tripod above the floor, meters.
const TRIPOD_M: [f64; 2] = [0.5, 2.5];
/// Distance in meters within which the floor below a scanner is looked for: a scanner does not see its own feet.
const BLIND_M: f64 = 1.5;
/// Most distance that counts of a view, meters: whatever is further away is far.
const VIEW_M: f64 = 20.0;
/// One faces north where the view is this part as far as the farthest.
const FAR_ENOUGH: f64 = 0.8;

/// Where one can stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Standing {
    /// Place on the floor, world space.
    pub floor_in_world: DVec3,
    /// True if walls are all around.
    pub enclosed: bool,
    /// True if it is a room: it has a ceiling, or its walls are near.
    pub in_room: bool,
    /// Direction of the farthest view between walls that are all around, radians; 0, which is north, if that is far
    /// enough.
    pub yaw: f64,
}

impl Standing {
    /// The place at a scanner's station, in surroundings such as there are at this place. Whoever set up a scanner had
    /// room there.
    pub fn at_station(self, scene: &Scene, units_per_m: f64, p_in_world: DVec3) -> Self {
        let Some(plan) = FloorPlan::new(scene, units_per_m, 1.0) else { return self };
        let scanner = (p_in_world - plan.origin) / units_per_m;
        let at = scanner.truncate();
        let floor = plan.floor_below(scanner);
        let yaw = if self.enclosed { plan.farthest_view(at, floor) } else { 0.0 };
        Self { floor_in_world: plan.origin + at.extend(floor) * units_per_m, yaw, ..self }
    }
}

/// The place nearest to the scene's middle where one can stand; `None` if the scene is an object. `enclosed` asks for a
/// place with walls all around, or for one without, where the user says what the scene is.
pub(super) fn standing(scene: &Scene, units_per_m: f64, enclosed: Option<bool>) -> Option<Standing> {
    COARSER
        .into_iter()
        .find_map(|coarser| standing_in(&FloorPlan::new(scene, units_per_m, coarser)?, units_per_m, enclosed))
}

fn standing_in(plan: &FloorPlan, units_per_m: f64, enclosed: Option<bool>) -> Option<Standing> {
    let free: Vec<(DVec2, f64)> = plan.free_places();
    let room = free.iter().find_map(|&(at, floor)| Some((at, floor, plan.walls(at, floor)?)));
    let outside = |reach| (reach < SMALL_ROOM_M).then(|| plan.open_place(&free, true)).flatten();
    let (at, floor, reach) = match (room, enclosed) {
        (Some((at, floor, reach)), Some(true)) => (at, floor, Some(reach)),
        (Some((at, floor, reach)), None) => {
            outside(reach).map_or((at, floor, Some(reach)), |(at, floor)| (at, floor, None))
        }
        (None, Some(true)) => return None,
        _ => plan.open_place(&free, false).map(|(at, floor)| (at, floor, None))?,
    };
    let floor_in_world = plan.origin + at.extend(floor) * units_per_m;
    let in_room = reach.is_some_and(|reach| reach < ROOM_M || plan.has_ceiling(at, floor, reach));
    let yaw = if reach.is_some() { plan.farthest_view(at, floor) } else { 0.0 };
    Some(Standing { floor_in_world, enclosed: reach.is_some(), in_room, yaw })
}

/// A scene from above: its points by the cells of a floor plan of where most of it is. Lengths are in meters from the
/// plan's origin.
struct FloorPlan {
    /// Origin in world space.
    origin: DVec3,
    size: DVec3,
    /// Longer side of the whole scene.
    extent: f64,
    /// Greatest height that the ground of an open place has.
    highest_ground: f64,
    /// Where the middle of the points is.
    middle: DVec2,
    cell_m: f64,
    num_cells: [usize; 2],
    points: Vec<DVec3>,
    /// Heights of the points of each cell, ascending.
    heights: Vec<Vec<f64>>,
    /// Most points of a cell that may hang in the air.
    max_in_air: usize,
}

impl FloorPlan {
    /// The floor plan of a scene; `None` if nobody fits into it.
    fn new(scene: &Scene, units_per_m: f64, coarser: f64) -> Option<Self> {
        let (x, y) = (scene.quarters(0)?, scene.quarters(1)?);
        let width = (x[2] - x[0]).max(y[2] - y[0]);
        let Bounds { min, max } = scene.bounds;
        let origin = min.max(DVec3::new(x[0] - width, y[0] - width, min.z));
        let size = (max.min(DVec3::new(x[2] + width, y[2] + width, max.z)) - origin) / units_per_m;
        let middle = (DVec2::new(x[1], y[1]) - origin.truncate()) / units_per_m;
        if size.truncate().min_element() < 2.0 * BODY_RADIUS_M || size.z < WALL_M[0] {
            return None;
        }
        let thin = (size.x * size.y * MEAN_CELL_POINTS / scene.samples.len() as f64).sqrt();
        let cell_m = (size.x.max(size.y) / MAX_CELLS).max(MIN_CELL_M).max(thin) * coarser;
        let num_cells = [size.x, size.y].map(|edge| (edge / cell_m) as usize + 1);
        let points: Vec<DVec3> = scene.samples.iter().map(|&p| (p - origin) / units_per_m).collect();
        let [low, high] = heights(points.iter().map(|p| p.z).collect());
        let mut plan = Self {
            origin,
            size,
            extent: (max - min).truncate().max_element() / units_per_m,
            highest_ground: low + LOW_SHARE * (high - low) + LEVEL_M,
            middle,
            cell_m,
            num_cells,
            points,
            heights: vec![Vec::new(); num_cells[0] * num_cells[1]],
            max_in_air: 0,
        };
        for p in plan.points.iter().filter(|p| p.cmpge(DVec3::ZERO).all() && p.cmple(size).all()) {
            let [x, y] = plan.cell(p.truncate());
            plan.heights[x + y * num_cells[0]].push(p.z);
        }
        plan.heights.iter_mut().for_each(|heights| heights.sort_unstable_by(f64::total_cmp));
        let num_filled = plan.heights.iter().filter(|heights| !heights.is_empty()).count();
        plan.max_in_air = (AIR_SHARE * plan.points.len() as f64 / num_filled.max(1) as f64) as usize;
        Some(plan)
    }

    fn cell(&self, at: DVec2) -> [usize; 2] {
        // `as` saturates, so places outside belong to cells at the border.
        [0, 1].map(|axis| ((at[axis] / self.cell_m) as usize).min(self.num_cells[axis] - 1))
    }

    /// Height of a cell's floor, if it has one.
    fn floor(&self, [x, y]: [usize; 2]) -> Option<f64> {
        let heights = &self.heights[x + y * self.num_cells[0]];
        let at = (FLOOR_SHARE * heights.len() as f64) as usize;
        heights.get(at).copied().filter(|_| heights.len() >= MIN_CELL_POINTS)
    }

    /// The cells within a distance of a place, along both axes.
    fn within(&self, at: DVec2, radius: f64) -> impl Iterator<Item = [usize; 2]> {
        self.cells(at - radius, at + radius)
    }

    /// The cells that a rectangle touches.
    fn cells(&self, low: DVec2, high: DVec2) -> impl Iterator<Item = [usize; 2]> {
        let ([x0, y0], [x1, y1]) = (self.cell(low), self.cell(high));
        (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| [x, y]))
    }

    /// Places with room for a body, and their floors; nearest to the middle first.
    fn free_places(&self) -> Vec<(DVec2, f64)> {
        let center = |[x, y]: [usize; 2]| (DVec2::new(x as f64, y as f64) + 0.5) * self.cell_m;
        let mut places: Vec<(DVec2, f64)> = self
            .cells(DVec2::ZERO, self.size.truncate())
            .filter_map(|cell| Some((center(cell), self.floor(cell)?)))
            .filter(|&(at, floor)| self.is_free(at, floor))
            .collect();
        let away = |at: &DVec2| at.distance_squared(self.middle);
        places.sort_by(|a, b| away(&a.0).total_cmp(&away(&b.0)));
        places
    }

    fn is_free(&self, at: DVec2, floor: f64) -> bool {
        self.has_room(at, floor, BODY_RADIUS_M) && self.is_no_table(at, floor)
    }

    fn is_no_table(&self, at: DVec2, floor: f64) -> bool {
        let [near, lower] = TABLE_M;
        !self.within(at, near).filter_map(|cell| self.floor(cell)).any(|below| below < floor - lower)
    }

    /// True if nothing within `radius` is in a body's way.
    fn has_room(&self, at: DVec2, floor: f64, radius: f64) -> bool {
        let in_the_way = |height: f64| (floor + BODY_M[0]..floor + BODY_M[1]).contains(&height);
        let num_in_the_way = |[x, y]: [usize; 2]| {
            let heights = &self.heights[x + y * self.num_cells[0]];
            heights.iter().filter(|&&height| in_the_way(height)).count()
        };
        self.within(at, radius).all(|cell| num_in_the_way(cell) <= self.max_in_air)
    }

    /// Distance of the walls that stand all around, further away than arm's length; `None` if there are none.
    fn walls(&self, at: DVec2, floor: f64) -> Option<f64> {
        let mut nearest = self.walls_around(at, floor);
        let walls = nearest.iter().filter(|&&distance| distance.is_finite() && distance > ARMS_LENGTH_M);
        if (walls.count() as f64) < ENCLOSED * NUM_DIRECTIONS as f64 {
            return None;
        }
        let reach = *nearest.select_nth_unstable_by(NUM_DIRECTIONS / 2, f64::total_cmp).1;
        (self.level_share(at, floor, reach, FLOOR_LEVEL_M) >= FLOOR_LEVEL_SHARE).then_some(reach)
    }

    /// Distances of the nearest walls in all directions, counterclockwise from west; infinite where there is none.
    fn walls_around(&self, at: DVec2, floor: f64) -> Vec<f64> {
        let mut distances = vec![Vec::new(); NUM_DIRECTIONS];
        for p in self.points.iter().filter(|p| (floor + WALL_M[0]..floor + WALL_M[1]).contains(&p.z)) {
            let to = p.truncate() - at;
            let turn = to.y.atan2(to.x) / std::f64::consts::TAU + 0.5;
            let direction = ((turn * NUM_DIRECTIONS as f64) as usize).min(NUM_DIRECTIONS - 1);
            distances[direction].push(to.length());
        }
        distances.into_iter().map(nearest_wall).collect()
    }

    /// The yaw of somebody who looks where the view is farthest; 0, which is north, if that is far enough. A view is as
    /// wide as some of the directions, so that nobody looks at a wall beside a door.
    fn farthest_view(&self, at: DVec2, floor: f64) -> f64 {
        let walls = self.walls_around(at, floor);
        let view = |direction: usize| {
            let of =
                |turn: usize| walls[(direction + turn + NUM_DIRECTIONS - 1) % NUM_DIRECTIONS].min(VIEW_M);
            [0, 1, 2].map(of).into_iter().fold(VIEW_M, f64::min)
        };
        let north = 3 * NUM_DIRECTIONS / 4;
        let farthest = (0..NUM_DIRECTIONS).max_by(|&a, &b| view(a).total_cmp(&view(b))).unwrap_or(north);
        if view(north).min(view(north - 1)) >= FAR_ENOUGH * view(farthest) {
            return 0.0;
        }
        // Directions count from west, and yaw from north.
        let turns = (farthest as f64 + 0.5) / NUM_DIRECTIONS as f64 - 0.75;
        (turns - turns.round()) * std::f64::consts::TAU
    }

    /// Height of the floor below a scanner.
    fn floor_below(&self, scanner: DVec3) -> f64 {
        let [least, most] = TRIPOD_M;
        let mut below: Vec<f64> = self
            .within(scanner.truncate(), BLIND_M)
            .flat_map(|[x, y]| &self.heights[x + y * self.num_cells[0]])
            .copied()
            .filter(|height| (scanner.z - most..scanner.z - least).contains(height))
            .collect();
        let at = (FLOOR_SHARE * below.len() as f64) as usize;
        if below.len() < MIN_CELL_POINTS {
            return scanner.z - super::start::EYE_HEIGHT_M;
        }
        *below.select_nth_unstable_by(at, f64::total_cmp).1
    }

    /// Share of the floor within a distance that is as high as at a place.
    fn level_share(&self, at: DVec2, floor: f64, reach: f64, level: f64) -> f64 {
        let floors: Vec<f64> = self.within(at, reach).filter_map(|cell| self.floor(cell)).collect();
        let as_high = floors.iter().filter(|height| (**height - floor).abs() < level);
        as_high.count() as f64 / floors.len().max(1) as f64
    }

    /// True if there is a ceiling above the floor around a place.
    fn has_ceiling(&self, at: DVec2, floor: f64, reach: f64) -> bool {
        let (mut num_cells, mut lowest) = (0, Vec::new());
        for [x, y] in self.within(at, reach.min(CEILING_REACH_M)) {
            let heights = &self.heights[x + y * self.num_cells[0]];
            num_cells += 1;
            lowest.extend(heights.iter().copied().find(|&height| height > floor + CEILING_M));
        }
        if lowest.is_empty() {
            return false;
        }
        let middle = lowest.len() / 2;
        let height = *lowest.select_nth_unstable_by(middle, f64::total_cmp).1;
        let num_level = lowest.iter().filter(|lowest| (**lowest - height).abs() < FLOOR_LEVEL_M).count();
        let [of_any_form, of_one_height] = CEILING_SHARES.map(|share| share * f64::from(num_cells));
        lowest.len() as f64 >= of_any_form || num_level as f64 >= of_one_height
    }

    /// The open place nearest to the middle, with a view if there is one; `outside` excludes places with walls all
    /// around.
    fn open_place(&self, free: &[(DVec2, f64)], outside: bool) -> Option<(DVec2, f64)> {
        let is_open = |&&(at, floor): &&(DVec2, f64)| {
            self.is_open(at, floor) && !(outside && self.walls(at, floor).is_some())
        };
        let with_view =
            free.iter().filter(|&&(at, floor)| self.has_room(at, floor, CLEARANCE_M)).find(is_open);
        with_view.or_else(|| free.iter().find(is_open)).copied()
    }

    /// True if the ground goes on all around, at the scene's bottom.
    fn is_open(&self, at: DVec2, floor: f64) -> bool {
        if self.extent < OPEN_M || floor > self.highest_ground {
            return false;
        }
        let (num, known) = self
            .within(at, GROUND_M)
            .fold((0, 0), |(num, known), cell| (num + 1, known + usize::from(self.floor(cell).is_some())));
        2 * known >= num && self.level_share(at, floor, GROUND_M, LEVEL_M) >= GROUND_SHARE
    }
}

/// Distance of the wall that points at these distances belong to, except for some in the air before it; infinite if
/// there are no points.
fn nearest_wall(mut distances: Vec<f64>) -> f64 {
    let in_air = (AIR_SHARE * distances.len() as f64) as usize;
    if distances.is_empty() {
        return f64::INFINITY;
    }
    *distances.select_nth_unstable_by(in_air, f64::total_cmp).1
}

/// The heights between which all points lie except for strays.
fn heights(mut heights: Vec<f64>) -> [f64; 2] {
    let Some(last) = heights.len().checked_sub(1) else { return [0.0; 2] };
    let tail = (STRAY_SHARE * heights.len() as f64) as usize;
    [tail, last - tail].map(|at| *heights.select_nth_unstable_by(at, f64::total_cmp).1)
}

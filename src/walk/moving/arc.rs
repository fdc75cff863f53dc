//! Where a hand points: the arc of a teleport, which flies like a thrown ball, and a straight ray. Both end at what is solid,
//! and where they come down on a floor is a landing.

use super::floors::{Floor, Floors};
use glam::DVec3;

/// Places of an arc that are drawn, at most.
pub const MOST_POINTS: usize = 64;
/// Meters a second squared.
const GRAVITY: f64 = 9.81;
/// Rise over run of a hand that points comfortably far.
const COMFORTABLE: f64 = 0.577;
/// Height of a hand above the floor, meters.
const HAND_M: f64 = 1.2;
/// Longest flight, seconds.
const LONGEST_S: f64 = 3.0;
/// Length at the arc's beginning that passes through everything, meters: a hand may reach into a wall.
const FREE_M: f64 = 0.3;
/// Most steps of an arc; one over a model may end in the air after that.
const MOST_STEPS: usize = 3000;
/// Most steps of a ray.
const MOST_RAY_STEPS: usize = 4000;
/// Distance between two looks for a floor with a hole, meters.
const HOLE_EVERY_M: f64 = 0.2;
/// Depth below a wall that a ray has hit within which a floor is sought, meters.
const FOOT_OF_WALL_M: f64 = 3.0;

/// Where a teleport would end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// Place on the floor, world space.
    pub floor_in_world: DVec3,
    /// Direction in which the head would face, about the world's vertical, radians; 0 is +y (north), positive to the left.
    pub yaw: f64,
}

/// The arc of a teleport.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TeleportArc {
    /// Places on the arc from the hand to its end, world space; those from `num` on mean nothing.
    pub points: [DVec3; MOST_POINTS],
    /// Number of places.
    pub num: usize,
    /// Where the user would stand; `None` if the arc ends at a wall, or nowhere.
    pub landing: Option<Landing>,
}

impl TeleportArc {
    /// The places on the arc, world space.
    #[must_use]
    pub fn points(&self) -> &[DVec3] {
        &self.points[..self.num]
    }
}

/// What is in the way of arcs and rays.
#[derive(Clone, Copy, Debug)]
pub enum Ground<'a> {
    /// A scan's floors.
    Floors(&'a Floors),
    /// A level floor everywhere, at this height, while no other is known.
    Level(f64),
}

impl Ground<'_> {
    /// The floor right below a place, and with `bridged` also one that has a hole there.
    fn below(&self, p: DVec3, depth: f64, bridged: bool) -> Option<Floor> {
        match self {
            Self::Level(height) => {
                let is_near = (p.z - depth..=p.z).contains(height);
                is_near.then_some(Floor { height: *height, grade: glam::DVec2::ZERO })
            }
            Self::Floors(floors) if bridged => floors.below(p, depth),
            Self::Floors(floors) => floors.right_below(p, depth),
        }
    }

    fn is_solid(&self, p: DVec3) -> bool {
        matches!(self, Self::Floors(floors) if floors.is_solid(p))
    }

    /// Half the edge of a column: a wall is thicker than that. `units_per_m` stands in where there is none.
    fn step(&self, units_per_m: f64) -> f64 {
        match self {
            Self::Floors(floors) => 0.5 * floors.edge(),
            Self::Level(_) => 0.1 * units_per_m,
        }
    }
}

/// Speed, meters a second, at which an arc that a hand throws a little upwards reaches `reach_m` meters far.
#[must_use]
pub fn speed_for(reach_m: f64) -> f64 {
    let cos_squared = 1.0 / (1.0 + COMFORTABLE * COMFORTABLE);
    let squared = GRAVITY * reach_m * reach_m / (2.0 * cos_squared * (HAND_M + reach_m * COMFORTABLE));
    squared.sqrt()
}

/// The arc from a hand along its ray, a unit vector, both in world space. Lengths of the user are `units_per_m` world units
/// long. `yaw` is that of the landing.
#[must_use]
pub fn arc(
    ground: Ground,
    hand: DVec3,
    along: DVec3,
    yaw: f64,
    speed_m_per_s: f64,
    units_per_m: f64,
) -> TeleportArc {
    let (speed, gravity) = (speed_m_per_s * units_per_m, GRAVITY * units_per_m);
    let at = |t: f64| hand + along * (speed * t) - DVec3::Z * (0.5 * gravity * t * t);
    let velocity = |t: f64| (along * speed - DVec3::Z * (gravity * t)).length();
    let step = ground.step(units_per_m);
    let (mut t, mut tracer) = (0.0, Tracer::new(ground, hand, step, units_per_m));
    let mut end = ArcEnd::Nowhere(hand);
    for _ in 0..MOST_STEPS {
        t = (t + step / velocity(t).max(0.1 * speed)).min(LONGEST_S);
        end = tracer.step(at(t));
        if !matches!(end, ArcEnd::Nowhere(_)) || t >= LONGEST_S {
            break;
        }
    }
    let mut points = [hand; MOST_POINTS];
    for (number, point) in points.iter_mut().enumerate() {
        *point = at(t * number as f64 / (MOST_POINTS - 1) as f64);
    }
    points[MOST_POINTS - 1] = end.place();
    let landing = end.floor().map(|floor_in_world| Landing { floor_in_world, yaw });
    TeleportArc { points, num: MOST_POINTS, landing }
}

/// The floor that a straight ray points at, at most `reach` world units away; or the foot of the wall that it hits.
#[must_use]
pub fn pointed_at(floors: &Floors, from: DVec3, along: DVec3, reach: f64, units_per_m: f64) -> Option<DVec3> {
    let step = (0.5 * floors.edge()).max(reach / MOST_RAY_STEPS as f64);
    let mut tracer = Tracer::new(Ground::Floors(floors), from, step, units_per_m);
    for number in 1..=(reach / step) as usize {
        match tracer.step(from + along * (step * number as f64)) {
            ArcEnd::Nowhere(_) => {}
            ArcEnd::Floor(floor) => return Some(floor),
            ArcEnd::Wall(p) => {
                // The wall itself has no floor: one stands a little before it.
                let before = p - along.with_z(0.0).normalize_or_zero() * (3.0 * floors.edge());
                let depth = FOOT_OF_WALL_M * floors.units_per_m();
                return floors.below(before, depth).map(|floor| before.with_z(floor.height));
            }
        }
    }
    None
}

/// Where a way has come to.
#[derive(Clone, Copy, Debug)]
enum ArcEnd {
    /// Nothing is in the way so far.
    Nowhere(DVec3),
    Wall(DVec3),
    Floor(DVec3),
}

impl ArcEnd {
    fn place(&self) -> DVec3 {
        match *self {
            Self::Nowhere(p) | Self::Wall(p) | Self::Floor(p) => p,
        }
    }

    fn floor(&self) -> Option<DVec3> {
        if let Self::Floor(p) = self { Some(*p) } else { None }
    }
}

/// Follows a way step by step.
struct Tracer<'a> {
    ground: Ground<'a>,
    from: DVec3,
    /// The place before.
    last: DVec3,
    step: f64,
    free: f64,
    hole_every: f64,
    /// Length since floors with holes were looked for, and the place then.
    since_hole: f64,
    last_hole: DVec3,
}

impl<'a> Tracer<'a> {
    fn new(ground: Ground<'a>, from: DVec3, step: f64, units_per_m: f64) -> Self {
        let life = if let Ground::Floors(floors) = ground { floors.units_per_m() } else { units_per_m };
        let [free, hole_every] = [FREE_M * life.min(units_per_m), HOLE_EVERY_M * life];
        Self { ground, from, last: from, step, free, hole_every, since_hole: 0.0, last_hole: from }
    }

    /// Goes on to a place near the one before.
    fn step(&mut self, to: DVec3) -> ArcEnd {
        let from = std::mem::replace(&mut self.last, to);
        self.since_hole += from.distance(to);
        // A floor may rise toward the way.
        let margin = 2.0 * self.step;
        if let Some(end) = self.crossed(from, to, margin, false) {
            return end;
        }
        if self.since_hole >= self.hole_every {
            let before = std::mem::replace(&mut self.last_hole, to);
            self.since_hole = 0.0;
            if to.z < before.z
                && let Some(end) = self.crossed(before, to, margin, true)
            {
                return end;
            }
        }
        let is_free = to.distance(self.from) < self.free;
        if !is_free && self.ground.is_solid(to) && !self.comes_down(to, margin) {
            return ArcEnd::Wall(to);
        }
        ArcEnd::Nowhere(to)
    }

    /// The floor between two places, the first of which is above it.
    fn crossed(&self, from: DVec3, to: DVec3, margin: f64, bridged: bool) -> Option<ArcEnd> {
        let high = from.z.max(to.z) + margin;
        let floor = self.ground.below(to.with_z(high), high - to.z, bridged)?;
        // Heights above the plane of the floor, where it is known.
        let above = |p: DVec3| p.z - floor.height - floor.grade.dot((p - to).truncate());
        let (before, now) = (above(from), above(to));
        if now > 0.0 || before < -0.25 * margin {
            return None;
        }
        let part = (before.max(0.0) / (before.max(0.0) - now).max(1e-12)).clamp(0.0, 1.0);
        let landing = from.lerp(to, part);
        // The floor is known best right there.
        let again = self.ground.below(landing.with_z(high), high - landing.z + margin, bridged);
        let floor = again.unwrap_or(floor);
        let height = if again.is_some() {
            floor.height
        } else {
            floor.height + floor.grade.dot((landing - to).truncate())
        };
        Some(ArcEnd::Floor(landing.with_z(height)))
    }

    /// True if a floor that one can stand on is right below: it is no wall that the way has come to.
    fn comes_down(&self, p: DVec3, margin: f64) -> bool {
        let depth = self.step * 4.0 + margin;
        self.ground.below(p, depth, false).is_some()
    }
}

#[cfg(test)]
#[path = "arc_tests.rs"]
mod tests;

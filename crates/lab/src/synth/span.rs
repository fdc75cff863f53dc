//! Rays, and the span of a line in a convex solid, of which every shape's intersection is made.

use glam::DVec3;

/// Distance below which no surface is seen, since the ray starts there.
pub const NEAREST: f64 = 1e-6;

/// A half line.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Place where the ray starts.
    pub origin: DVec3,
    /// Direction of the ray, of unit length.
    pub direction: DVec3,
}

impl Ray {
    /// The place at distance `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance from the ray's origin.
    pub t: f64,
    /// Unit normal of the surface, away from the solid.
    pub normal: DVec3,
}

/// Where a line enters and leaves a convex solid; distances may be negative.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// Where the line goes into the solid.
    pub enter: Hit,
    /// Where the line comes out of the solid.
    pub exit: Hit,
}

impl Span {
    /// Makes a span; `None` if it is empty.
    pub fn new(enter: Hit, exit: Hit) -> Option<Self> {
        (enter.t < exit.t).then_some(Self { enter, exit })
    }

    /// The part in both solids.
    pub fn and(self, other: Self) -> Option<Self> {
        let enter = if self.enter.t > other.enter.t { self.enter } else { other.enter };
        let exit = if self.exit.t < other.exit.t { self.exit } else { other.exit };
        Self::new(enter, exit)
    }

    /// The part in either solid, where their union is convex too.
    pub fn or(self, other: Option<Self>) -> Self {
        let Some(other) = other else { return self };
        Self {
            enter: if self.enter.t < other.enter.t { self.enter } else { other.enter },
            exit: if self.exit.t > other.exit.t { self.exit } else { other.exit },
        }
    }

    /// The first surface in front of the ray.
    pub fn first(self) -> Option<Hit> {
        [self.enter, self.exit].into_iter().find(|hit| hit.t > NEAREST)
    }

    /// The first surface of this solid with `hole` cut out of it.
    pub fn first_without(self, hole: Option<Self>) -> Option<Hit> {
        let Some(hole) = hole else { return self.first() };
        let in_hole = |t: f64| hole.enter.t < t && t < hole.exit.t;
        let in_solid = |t: f64| self.enter.t < t && t < self.exit.t;
        // The hole's wall looks into the hole.
        let wall = |hit: Hit| Hit { t: hit.t, normal: -hit.normal };
        let surfaces = [
            (!in_hole(self.enter.t), self.enter),
            (in_solid(hole.enter.t), wall(hole.enter)),
            (in_solid(hole.exit.t), wall(hole.exit)),
            (!in_hole(self.exit.t), self.exit),
        ];
        let seen = surfaces.into_iter().filter(|(exists, hit)| *exists && hit.t > NEAREST);
        seen.map(|(_, hit)| hit).min_by(|a, b| a.t.total_cmp(&b.t))
    }
}

/// Part of the line between two planes across `axis` (0, 1, 2).
pub fn slab(ray: &Ray, axis: usize, low: f64, high: f64) -> Option<Span> {
    let (o, d) = (ray.origin[axis], ray.direction[axis]);
    let unit = DVec3::AXES[axis];
    if d == 0.0 {
        let everywhere = |t, normal| Hit { t, normal };
        return (low < o && o < high).then_some(Span {
            enter: everywhere(f64::NEG_INFINITY, unit),
            exit: everywhere(f64::INFINITY, unit),
        });
    }
    let (a, b) = (Hit { t: (low - o) / d, normal: -unit }, Hit { t: (high - o) / d, normal: unit });
    if a.t < b.t { Span::new(a, b) } else { Span::new(b, a) }
}

/// Part of the line in an axis-aligned box.
pub fn cuboid(ray: &Ray, min: DVec3, max: DVec3) -> Option<Span> {
    let x = slab(ray, 0, min.x, max.x)?;
    let y = slab(ray, 1, min.y, max.y)?;
    x.and(y)?.and(slab(ray, 2, min.z, max.z)?)
}

/// Part of the line in a ball.
pub fn ball(ray: &Ray, center: DVec3, radius: f64) -> Option<Span> {
    let to_origin = ray.origin - center;
    let b = to_origin.dot(ray.direction);
    let root = b * b - to_origin.length_squared() + radius * radius;
    if root <= 0.0 {
        return None;
    }
    let hit = |t| Hit { t, normal: (ray.at(t) - center) / radius };
    Span::new(hit(-b - root.sqrt()), hit(-b + root.sqrt()))
}

/// Part of the line in an endless round bar along the unit vector `axis` through `center`.
pub fn bar(ray: &Ray, center: DVec3, axis: DVec3, radius: f64) -> Option<Span> {
    let across = |v: DVec3| v - axis * v.dot(axis);
    let (o, d) = (across(ray.origin - center), across(ray.direction));
    let a = d.length_squared();
    let c = o.length_squared() - radius * radius;
    if a < 1e-18 {
        let end = |t| Hit { t, normal: axis };
        return (c < 0.0).then_some(Span { enter: end(f64::NEG_INFINITY), exit: end(f64::INFINITY) });
    }
    let b = o.dot(d);
    let root = b * b - a * c;
    if root <= 0.0 {
        return None;
    }
    let hit = |t: f64| Hit { t, normal: (o + t * d) / radius };
    Span::new(hit((-b - root.sqrt()) / a), hit((-b + root.sqrt()) / a))
}

//! The shapes that scenes are made of: the first surface that a ray meets, and whether a place is inside.

use super::span::{Hit, NEAREST, Ray, Span, ball, bar, cuboid, slab};
use base::space::Bounds;
use glam::DVec3;

/// A shape in world axes; lengths in meters. All are solid except the last two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// An axis-aligned box.
    Cuboid {
        /// Smallest corner.
        min: DVec3,
        /// Largest corner.
        max: DVec3,
    },
    /// A box with an arched passage cut through it, open at the bottom: width `2·radius`, straight up to
    /// `spring`, a half circle above.
    Arch {
        /// Smallest corner.
        min: DVec3,
        /// Largest corner.
        max: DVec3,
        /// Direction of the passage: 0 for x, 1 for y.
        through: usize,
        /// Middle of the passage on the other horizontal axis.
        middle: f64,
        /// Half the width of the passage.
        radius: f64,
        /// Height at which the half circle begins.
        spring: f64,
    },
    /// A vertical cone without its tip, or a cylinder.
    Frustum {
        /// Center of the lower disc.
        base: DVec3,
        /// Height.
        height: f64,
        /// Radius at the bottom.
        bottom: f64,
        /// Radius at the top; 0 for a full cone.
        top: f64,
    },
    /// A vertical tube.
    Ring {
        /// Center of the lower face.
        base: DVec3,
        /// Height.
        height: f64,
        /// Radius of the hole.
        inner: f64,
        /// Radius outside.
        outer: f64,
    },
    /// A round bar with round ends.
    Capsule {
        /// One end.
        a: DVec3,
        /// The other end.
        b: DVec3,
        /// Radius of the bar.
        radius: f64,
    },
    /// A ball.
    Ball {
        /// Center.
        center: DVec3,
        /// Radius.
        radius: f64,
    },
    /// A flat parallelogram `corner + a·u + b·v`, 0 ≤ a, b ≤ 1; or its half with a + b ≤ 1.
    Sheet {
        /// A corner.
        corner: DVec3,
        /// One edge.
        u: DVec3,
        /// The other edge.
        v: DVec3,
        /// True for the half at the corner alone.
        triangle: bool,
    },
    /// A flat disc.
    Disc {
        /// Center.
        center: DVec3,
        /// Unit normal.
        normal: DVec3,
        /// Radius.
        radius: f64,
    },
}

impl Shape {
    /// The first surface that the ray meets; its normal looks toward the ray's origin.
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let hit = match *self {
            Self::Cuboid { min, max } => cuboid(ray, min, max)?.first()?,
            Self::Arch { min, max, through, middle, radius, spring } => {
                let solid = cuboid(ray, min, max)?;
                solid.first_without(passage(ray, through, middle, radius, spring))?
            }
            Self::Frustum { base, height, bottom, top } => {
                frustum(ray, base, height, bottom, top)?.first()?
            }
            Self::Ring { base, height, inner, outer } => {
                let solid = slab(ray, 2, base.z, base.z + height)?.and(bar(ray, base, DVec3::Z, outer)?)?;
                solid.first_without(bar(ray, base, DVec3::Z, inner))?
            }
            Self::Capsule { a, b, radius } => capsule(ray, a, b, radius)?.first()?,
            Self::Ball { center, radius } => ball(ray, center, radius)?.first()?,
            Self::Sheet { corner, u, v, triangle } => sheet(ray, corner, u, v, triangle)?,
            Self::Disc { center, normal, radius } => disc(ray, center, normal, radius)?,
        };
        let flip = hit.normal.dot(ray.direction) > 0.0;
        Some(Hit { t: hit.t, normal: if flip { -hit.normal } else { hit.normal } })
    }

    /// True if `p` is in the material; never for sheets and discs.
    pub fn contains(&self, p: DVec3) -> bool {
        let in_box = |min: DVec3, max: DVec3| p.cmpgt(min).all() && p.cmplt(max).all();
        let in_tube = |base: DVec3, height: f64| p.z > base.z && p.z < base.z + height;
        match *self {
            Self::Cuboid { min, max } => in_box(min, max),
            Self::Arch { min, max, through, middle, radius, spring } => {
                let side = p[1 - through] - middle;
                let up = (p.z - spring).max(0.0);
                in_box(min, max) && side * side + up * up > radius * radius
            }
            Self::Frustum { base, height, bottom, top } => {
                let radius = bottom + (top - bottom) * (p.z - base.z) / height;
                in_tube(base, height) && (p - base).truncate().length() < radius
            }
            Self::Ring { base, height, inner, outer } => {
                let radius = (p - base).truncate().length();
                in_tube(base, height) && inner < radius && radius < outer
            }
            Self::Capsule { a, b, radius } => {
                let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
                p.distance(a + along * (b - a)) < radius
            }
            Self::Ball { center, radius } => p.distance(center) < radius,
            Self::Sheet { .. } | Self::Disc { .. } => false,
        }
    }

    /// The box around the shape.
    pub fn bounds(&self) -> Bounds {
        let (min, max) = match *self {
            Self::Cuboid { min, max } | Self::Arch { min, max, .. } => (min, max),
            Self::Frustum { base, height, bottom, top } => {
                let r = DVec3::new(bottom.max(top), bottom.max(top), 0.0);
                (base - r, base + r + height * DVec3::Z)
            }
            Self::Ring { base, height, outer, .. } => {
                let r = DVec3::new(outer, outer, 0.0);
                (base - r, base + r + height * DVec3::Z)
            }
            Self::Capsule { a, b, radius } => (a.min(b) - radius, a.max(b) + radius),
            Self::Ball { center, radius } => (center - radius, center + radius),
            Self::Sheet { corner, u, v, .. } => {
                let ends = [corner + u, corner + v, corner + u + v];
                ends.iter().fold((corner, corner), |(min, max), p| (min.min(*p), max.max(*p)))
            }
            Self::Disc { center, normal, radius } => {
                let r = radius * (DVec3::ONE - normal * normal).max(DVec3::ZERO).map(f64::sqrt);
                (center - r, center + r)
            }
        };
        Bounds { min, max }
    }
}

/// Part of the line in an endless arched passage, which is convex, since the half circle stands on its diameter.
fn passage(ray: &Ray, through: usize, middle: f64, radius: f64, spring: f64) -> Option<Span> {
    let (across, axis) = (1 - through, DVec3::AXES[through]);
    let sides = slab(ray, across, middle - radius, middle + radius);
    let below = slab(ray, 2, f64::MIN, spring);
    let straight = sides.and_then(|s| s.and(below?));
    let center = middle * DVec3::AXES[across] + spring * DVec3::Z;
    match bar(ray, center, axis, radius) {
        Some(round) => Some(round.or(straight)),
        None => straight,
    }
}

fn frustum(ray: &Ray, base: DVec3, height: f64, bottom: f64, top: f64) -> Option<Span> {
    let between = slab(ray, 2, base.z, base.z + height)?;
    // The radius along the line is r + k·d.z·t; inside is where x² + y² ≤ radius².
    let k = (top - bottom) / height;
    let (o, d) = (ray.origin - base, ray.direction);
    let r = bottom + k * o.z;
    let a = d.x * d.x + d.y * d.y - k * k * d.z * d.z;
    let a = if a.abs() < 1e-14 { 1e-14 } else { a };
    let b = o.x * d.x + o.y * d.y - r * k * d.z;
    let c = o.x * o.x + o.y * o.y - r * r;
    let hit = |t: f64| {
        let p = o + t * d;
        Hit { t, normal: DVec3::new(p.x, p.y, -k * (bottom + k * p.z)).normalize_or(DVec3::Z) }
    };
    let root = b * b - a * c;
    if root <= 0.0 {
        // The line misses the cone, or (steeper than its side) stays in it.
        return if a > 0.0 { None } else { Some(between) };
    }
    // This form of the roots loses no digits to cancellation, also where `a` nearly vanishes.
    let q = -(b + if b < 0.0 { -root.sqrt() } else { root.sqrt() });
    let (t0, t1) = (q / a, c / q);
    let (near, far) = if t0 < t1 { (t0, t1) } else { (t1, t0) };
    let end = |t| Hit { t, normal: DVec3::Z };
    let side = if a > 0.0 {
        Span::new(hit(near), hit(far))?
    } else if k * d.z > 0.0 {
        // A line steeper than the side is inside from the cone's surface on, toward where the cone widens for ever.
        Span { enter: hit(far), exit: end(f64::INFINITY) }
    } else {
        Span { enter: end(f64::NEG_INFINITY), exit: hit(near) }
    };
    between.and(side)
}

fn capsule(ray: &Ray, a: DVec3, b: DVec3, radius: f64) -> Option<Span> {
    let length = a.distance(b);
    let axis = (b - a) / length;
    // The slab between two planes across the axis is computed in a frame where the axis is x.
    let along = Ray {
        origin: DVec3::new((ray.origin - a).dot(axis), 0.0, 0.0),
        direction: DVec3::new(ray.direction.dot(axis), 0.0, 0.0),
    };
    let middle = bar(ray, a, axis, radius).and_then(|bar| bar.and(slab(&along, 0, 0.0, length)?));
    // The planes lie inside the balls and are never the first or last surface of the three.
    match (ball(ray, a, radius), ball(ray, b, radius)) {
        (Some(end), other) | (None, other @ Some(end)) => Some(end.or(other).or(middle)),
        (None, None) => middle,
    }
}

fn sheet(ray: &Ray, corner: DVec3, u: DVec3, v: DVec3, triangle: bool) -> Option<Hit> {
    let across = u.cross(v);
    let facing = ray.direction.dot(across);
    if facing == 0.0 {
        return None;
    }
    let t = (corner - ray.origin).dot(across) / facing;
    let p = ray.at(t) - corner;
    let area = across.length_squared();
    let (a, b) = (p.cross(v).dot(across) / area, u.cross(p).dot(across) / area);
    let inside = a >= 0.0 && b >= 0.0 && if triangle { a + b <= 1.0 } else { a <= 1.0 && b <= 1.0 };
    (t > NEAREST && inside).then(|| Hit { t, normal: across / area.sqrt() })
}

fn disc(ray: &Ray, center: DVec3, normal: DVec3, radius: f64) -> Option<Hit> {
    let facing = ray.direction.dot(normal);
    if facing == 0.0 {
        return None;
    }
    let t = (center - ray.origin).dot(normal) / facing;
    (t > NEAREST && ray.at(t).distance_squared(center) <= radius * radius).then_some(Hit { t, normal })
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::random::Rng;

    const STEP: f64 = 0.002;

    /// One of each solid, all about the origin and about two units large.
    fn solids() -> Vec<Shape> {
        let (min, max) = (DVec3::new(-1.0, -0.7, -0.9), DVec3::new(0.8, 0.6, 1.1));
        let base = DVec3::new(0.1, -0.1, -0.8);
        vec![
            Shape::Cuboid { min, max },
            Shape::Arch { min, max, through: 0, middle: -0.1, radius: 0.35, spring: 0.2 },
            Shape::Arch { min, max, through: 1, middle: 0.1, radius: 0.5, spring: -0.3 },
            Shape::Frustum { base, height: 1.7, bottom: 0.9, top: 0.3 },
            Shape::Frustum { base, height: 0.3, bottom: 0.2, top: 1.0 },
            Shape::Frustum { base, height: 1.5, bottom: 0.6, top: 0.6 },
            Shape::Frustum { base, height: 1.5, bottom: 0.7, top: 0.0 },
            Shape::Ring { base, height: 1.2, inner: 0.5, outer: 0.9 },
            Shape::Capsule { a: base, b: max, radius: 0.3 },
            Shape::Ball { center: base, radius: 0.8 },
        ]
    }

    fn rays(seed: u64, count: usize) -> impl Iterator<Item = Ray> {
        let mut rng = Rng::new(seed, 0);
        std::iter::repeat_with(move || {
            let origin = 2.5 * rng.direction();
            let toward = 1.2 * rng.unit() * rng.direction();
            Ray { origin, direction: (toward - origin).normalize() }
        })
        .take(count)
    }

    /// Walks along the ray until the material begins.
    fn march(shape: &Shape, ray: &Ray) -> Option<f64> {
        (1..).map(|i| f64::from(i) * STEP).take_while(|t| *t < 5.0).find(|t| shape.contains(ray.at(*t)))
    }

    /// Returns what is wrong with the hit that `shape` finds, by a march through `truth`; `None` if nothing is.
    fn fault(shape: &Shape, truth: &Shape, ray: &Ray) -> Option<String> {
        let (hit, walked) = (shape.intersect(ray), march(truth, ray));
        let Some(hit) = hit else { return walked.map(|t| format!("missed the surface at {t}")) };
        // Corners that the walk stepped over are real if there is material just behind the surface.
        let (before, behind) = (ray.at(hit.t - 1e-7), ray.at(hit.t + 1e-7));
        if truth.contains(before) || !truth.contains(behind) {
            return Some(format!("no surface at {}", hit.t));
        }
        let late = walked.is_some_and(|t| hit.t > t);
        let facing = -hit.normal.dot(ray.direction);
        let unit = (hit.normal.length() - 1.0).abs() < 1e-9;
        let p = ray.at(hit.t);
        let out = !truth.contains(p + 1e-5 * hit.normal) && truth.contains(p - 1e-5 * hit.normal);
        (late || facing < 0.0 || !unit || (facing > 0.01 && !out))
            .then(|| format!("{hit:?}, walked {walked:?}"))
    }

    #[test]
    fn solids_are_met_where_their_material_begins() {
        for shape in solids() {
            let hits = rays(11, 1500).filter(|ray| {
                assert_eq!(fault(&shape, &shape, ray), None, "{shape:?} {ray:?}");
                shape.intersect(ray).is_some()
            });
            assert!(hits.count() > 200, "{shape:?} is hardly met");
        }
    }

    #[test]
    fn the_comparison_finds_a_shape_that_is_slightly_wrong() {
        let truth = Shape::Ball { center: DVec3::ZERO, radius: 0.8 };
        let wrong = Shape::Ball { center: DVec3::ZERO, radius: 0.801 };
        assert!(rays(12, 200).any(|ray| fault(&wrong, &truth, &ray).is_some()));
        let wrong = Shape::Ball { center: DVec3::ZERO, radius: 0.799 };
        assert!(rays(12, 200).any(|ray| fault(&wrong, &truth, &ray).is_some()));
    }

    #[test]
    fn sheets_and_discs_are_met_where_the_equations_say() {
        let (corner, u, v) =
            (DVec3::new(-0.5, -0.6, 0.1), DVec3::new(1.2, 0.3, 0.2), DVec3::new(0.1, 1.0, -0.4));
        let normal = DVec3::new(0.3, 0.4, 0.866).normalize();
        let mut num_hits = [0; 3];
        for ray in rays(13, 3000) {
            // corner + a·u + b·v = origin + t·direction, as a linear system.
            let abt = glam::DMat3::from_cols(u, v, -ray.direction).inverse() * (ray.origin - corner);
            let inside = abt.x > 0.0 && abt.y > 0.0 && abt.z > 0.0;
            for (i, triangle) in [false, true].into_iter().enumerate() {
                let limit = if triangle { abt.x + abt.y < 1.0 } else { abt.x < 1.0 && abt.y < 1.0 };
                let hit = Shape::Sheet { corner, u, v, triangle }.intersect(&ray);
                assert_eq!(hit.is_some(), inside && limit);
                assert!(hit.is_none_or(|hit| (hit.t - abt.z).abs() < 1e-9));
                num_hits[i] += usize::from(hit.is_some());
            }
            let hit = Shape::Disc { center: corner, normal, radius: 0.7 }.intersect(&ray);
            let t = (corner - ray.origin).dot(normal) / ray.direction.dot(normal);
            assert_eq!(hit.is_some(), t > 0.0 && ray.at(t).distance(corner) < 0.7);
            num_hits[2] += usize::from(hit.is_some());
        }
        assert!(num_hits.iter().all(|n| *n > 100), "{num_hits:?}");
    }

    #[test]
    fn boxes_hold_their_shapes_and_touch_them() {
        for shape in solids() {
            let (around, mut seen) = (shape.bounds(), Bounds::EMPTY);
            for ray in rays(14, 20_000) {
                if let Some(hit) = shape.intersect(&ray) {
                    seen = seen.with(ray.at(hit.t));
                }
            }
            let (low, high) = (seen.min - around.min, around.max - seen.max);
            assert!(low.min(high).min_element() > -1e-9, "{shape:?} sticks out");
            assert!(low.max(high).max_element() < 0.12, "{shape:?}: box too large {low} {high}");
        }
    }
}

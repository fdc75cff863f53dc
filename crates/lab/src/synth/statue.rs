//! The statue that the photographs show: a robed reader on a plinth, as a distance function.
//!
//! Coordinates are meters, z up, the plinth's foot at the origin, the face toward −y. Distances are rough far off;
//! near the surface distance / |gradient| is good.

use super::material::{rgb, smooth};
use base::random::fractal;
use glam::{DVec2, DVec3};

/// Radius of the ground patch round the plinth.
pub const GROUND_M: f64 = 3.4;
/// Top of the plinth.
const PLINTH: f64 = 1.12;

/// Part of the scene, on which the color depends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum StatuePart {
    Ground,
    Plinth,
    Figure,
}

/// The smaller of two distances, rounded where they are equal within `k`.
fn blend(a: f64, b: f64, k: f64) -> f64 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - 0.25 * h * h * k
}

fn ellipsoid(p: DVec3, center: DVec3, radii: DVec3) -> f64 {
    let q = p - center;
    let (near, slope) = ((q / radii).length(), (q / (radii * radii)).length());
    if slope < 1e-9 { -radii.min_element() } else { near * (near - 1.0) / slope }
}

/// A limb from `a` to `b`, of radius `ra` to `rb`.
fn limb(p: DVec3, a: DVec3, b: DVec3, ra: f64, rb: f64) -> f64 {
    let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    p.distance(a + along * (b - a)) - (ra + (rb - ra) * along)
}

fn cuboid(p: DVec3, center: DVec3, half: DVec3, round: f64) -> f64 {
    let q = (p - center).abs() - half + round;
    q.max(DVec3::ZERO).length() + q.max_element().min(0.0) - round
}

/// Distance to the plinth: steps, die, moldings.
fn plinth(p: DVec3) -> f64 {
    // The distance to a box around it is enough far off.
    let far = cuboid(p, DVec3::new(0.0, 0.0, 0.5 * PLINTH), DVec3::new(0.82, 0.82, 0.5 * PLINTH + 0.1), 0.0);
    if far > 0.2 {
        return far;
    }
    let block = |z: f64, half_height: f64, half: f64| {
        cuboid(p, DVec3::new(0.0, 0.0, z), DVec3::new(half, half, half_height), 0.012)
    };
    let worn = 0.005 * fractal(7.0 * p, 3);
    let body = block(0.09, 0.11, 0.80).min(block(0.26, 0.08, 0.66)).min(block(0.62, 0.32, 0.52));
    let panel = cuboid(p, DVec3::new(0.0, -0.53, 0.64), DVec3::new(0.36, 0.035, 0.17), 0.005);
    let top = block(0.98, 0.05, 0.58).min(block(1.06, 0.06, 0.64));
    body.max(-panel).min(top) + worn
}

/// Distance to the reader.
fn figure(p: DVec3) -> f64 {
    // The distance to an ellipsoid around the reader is enough far off.
    let far = ellipsoid(p, DVec3::new(0.0, 0.0, PLINTH + 0.95), DVec3::new(0.62, 0.62, 1.15));
    if far > 0.3 {
        return far;
    }
    let q = p - DVec3::new(0.0, 0.0, PLINTH);
    let angle = libm::atan2(q.y, q.x);
    let fold = libm::sin(13.0 * angle + 2.2 * libm::sin(2.3 * q.z + angle));
    let deep = 0.028 * smooth(1.25, 0.35, q.z) + 0.006;
    let robe = limb(
        q * DVec3::new(1.0, 1.12, 1.0),
        DVec3::new(0.0, 0.0, 0.02),
        DVec3::new(0.0, 0.02, 1.1),
        0.40,
        0.22,
    ) - deep * fold;
    let robe = robe.max(-q.z);
    let mut d = blend(robe, ellipsoid(q, DVec3::new(0.0, 0.03, 1.18), DVec3::new(0.31, 0.19, 0.27)), 0.12);
    d = blend(d, limb(q, DVec3::new(0.0, 0.02, 1.38), DVec3::new(0.0, -0.03, 1.56), 0.085, 0.075), 0.06);
    for side in [-1.0, 1.0] {
        let at = |x: f64, y: f64, z: f64| DVec3::new(side * x, y, z);
        d = blend(d, limb(q, at(0.27, 0.03, 1.30), at(0.35, -0.10, 0.98), 0.105, 0.10), 0.07);
        d = blend(d, limb(q, at(0.35, -0.10, 0.98), at(0.12, -0.36, 1.08), 0.095, 0.05), 0.05);
        d = blend(d, ellipsoid(q, at(0.10, -0.39, 1.09), DVec3::new(0.05, 0.06, 0.035)), 0.02);
        // Pages of an open book, leaning together.
        let page = DVec3::new(q.x, q.y, q.z - side * 0.22 * q.x - 0.35 * (q.y + 0.42));
        d = d.min(cuboid(page, at(0.105, -0.42, 1.12), DVec3::new(0.105, 0.14, 0.014), 0.006));
    }
    d.min(head(q))
}

/// Distance to the head, slightly bowed: face and hair.
fn head(q: DVec3) -> f64 {
    let h = q - DVec3::new(0.0, -0.05, 1.70);
    let skull = ellipsoid(h, DVec3::ZERO, DVec3::new(0.105, 0.125, 0.155));
    let jaw = ellipsoid(h, DVec3::new(0.0, -0.05, -0.08), DVec3::new(0.07, 0.07, 0.075));
    let mut d = blend(skull, jaw, 0.05);
    d = blend(d, limb(h, DVec3::new(0.0, -0.122, 0.03), DVec3::new(0.0, -0.145, -0.03), 0.012, 0.019), 0.02);
    for side in [-1.0, 1.0] {
        let eye = DVec3::new(side * 0.042, -0.118, 0.022);
        d = d.max(-(h.distance(eye - DVec3::new(0.0, 0.012, 0.0)) - 0.024));
        d = blend(d, h.distance(eye + DVec3::new(0.0, 0.016, -0.002)) - 0.020, 0.006);
        d = blend(
            d,
            ellipsoid(h, DVec3::new(side * 0.104, 0.0, -0.005), DVec3::new(0.015, 0.025, 0.035)),
            0.01,
        );
    }
    let mouth = ellipsoid(h, DVec3::new(0.0, -0.116, -0.075), DVec3::new(0.028, 0.012, 0.006));
    d = d.max(-mouth);
    // A cap of curls that leaves the face free.
    let curls = 0.010 * libm::sin(70.0 * h.x) * libm::sin(70.0 * h.y + 1.0) * libm::sin(70.0 * h.z);
    let hair = ellipsoid(h, DVec3::new(0.0, 0.025, 0.03), DVec3::new(0.125, 0.135, 0.155)) - curls;
    let face = 0.06 - h.y - 0.9 * (h.z - 0.03).max(-0.02);
    blend(d, hair.max(0.7 * (face - 0.10)), 0.012)
}

fn ground(p: DVec3) -> f64 {
    // This distance is enough well above the highest bump.
    if p.z > 0.4 {
        return p.z - 0.2;
    }
    let bumps = 0.05 * fractal(0.9 * p.truncate().extend(0.0), 3);
    let stones = 0.012 * fractal(14.0 * p.truncate().extend(3.0), 2).max(0.0);
    let edge = p.truncate().length() - GROUND_M;
    (0.85 * (p.z - bumps - stones)).max(edge)
}

fn parts(p: DVec3) -> [(f64, StatuePart); 3] {
    [(ground(p), StatuePart::Ground), (plinth(p), StatuePart::Plinth), (figure(p), StatuePart::Figure)]
}

/// Distance to the nearest surface; negative inside.
pub fn distance(p: DVec3) -> f64 {
    ground(p).min(plinth(p)).min(figure(p))
}

/// Gradient of the distance at `p`, from differences along the corners of a tetrahedron.
pub fn gradient(p: DVec3) -> DVec3 {
    let step = 0.002;
    let corners = [(1.0, 1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0)];
    let slopes = corners.map(DVec3::from).map(|corner| distance(p + step * corner) * corner);
    slopes.iter().sum::<DVec3>() / (4.0 * step)
}

/// Display color of the surface at `p`, lit by a hazy sky: weathered marble, a mossy plinth, gravel, grass.
pub fn color(p: DVec3, normal: DVec3) -> DVec3 {
    let nearest = parts(p).into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    let part = nearest.map_or(StatuePart::Ground, |(_, part)| part);
    let mix = |a: DVec3, b: DVec3, t: f64| a + (b - a) * t.clamp(0.0, 1.0);
    let (broad, fine) = (fractal(2.6 * p, 4), fractal(30.0 * p, 2));
    let tint = match part {
        StatuePart::Ground => {
            let grass = smooth(
                0.05,
                0.3,
                fractal(p.truncate().extend(5.0), 3) + 0.35 * (p.truncate().length() - 2.0),
            );
            let gravel = mix(rgb(168, 156, 138), rgb(120, 112, 100), 0.5 + fine);
            mix(gravel, mix(rgb(86, 110, 48), rgb(136, 144, 72), 0.5 + 0.8 * fine), grass)
        }
        StatuePart::Plinth => {
            let moss = smooth(0.1, 0.5, broad + 0.5 * smooth(0.5, 0.0, p.z));
            mix(mix(rgb(176, 168, 152), rgb(146, 138, 124), 0.5 + fine), rgb(110, 116, 76), 0.7 * moss)
        }
        StatuePart::Figure => {
            // Rain washes surfaces that face up and leaves the rest dark.
            let washed = smooth(-0.4, 0.6, normal.z + 0.5 * broad);
            let marble = mix(rgb(150, 144, 134), rgb(226, 220, 206), washed);
            mix(marble, rgb(178, 164, 92), 0.5 * smooth(0.4, 0.6, fractal(6.0 * p + DVec3::splat(3.0), 3)))
        }
    } * (1.0 + 0.05 * fine);
    let to_sun = DVec3::new(-0.5, -0.6, 0.62).normalize();
    let open = (distance(p + 0.16 * normal) / 0.16).clamp(0.0, 1.0) * 0.5
        + (distance(p + 0.5 * (normal + 0.5 * DVec3::Z)) / 0.5).clamp(0.0, 1.0) * 0.5;
    let sky = (0.6 + 0.4 * normal.z) * (0.35 + 0.65 * open);
    let shade = [0.12, 0.25, 0.5, 0.9, 1.4].iter().all(|t| distance(p + *t * to_sun + 0.02 * normal) > 0.0);
    let sun = if shade { normal.dot(to_sun).max(0.0) } else { 0.0 };
    tint * (0.50 * sky * DVec3::new(0.9, 0.97, 1.08) + 0.72 * sun * DVec3::new(1.1, 1.0, 0.86)).map(f64::sqrt)
}

/// The most that [`coverage`] can be up to a height: less near the ground, since the photographer came to see the
/// statue.
pub fn most_coverage(height: f64) -> f64 {
    0.3 + 0.7 * smooth(0.1, 0.5, height)
}

/// Share of the photographs that show a surface: few from below, few in clefts, fewer at the patch's rim.
pub fn coverage(p: DVec3, normal: DVec3) -> f64 {
    let from_above = smooth(-0.72, -0.15, normal.z);
    let open = smooth(-0.02, 0.10, distance(p + 0.18 * normal + 0.12 * DVec3::Z));
    let patchy = 0.55 + 0.45 * fractal(1.7 * p + DVec3::splat(20.0), 3);
    let rim = smooth(GROUND_M, 0.6 * GROUND_M, DVec2::new(p.x, p.y).length()).max(smooth(0.1, 0.3, p.z));
    from_above * open * most_coverage(p.z) * (0.35 + 0.65 * patchy.clamp(0.0, 1.0)) * (0.12 + 0.88 * rim)
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::random::Rng;

    #[test]
    fn walking_by_the_distance_never_steps_far_through_the_surface() {
        let mut rng = Rng::new(4, 0);
        let mut deepest: f64 = 0.0;
        for _ in 0..3000 {
            let mut p = DVec3::new(0.0, 0.0, 0.9) + 2.5 * rng.direction() * DVec3::new(1.0, 1.0, 0.25);
            p.z += 0.6;
            let toward = (DVec3::new(0.0, 0.0, 1.4) + 0.8 * rng.direction() - p).normalize();
            if distance(p) < 0.1 {
                continue;
            }
            for _ in 0..60 {
                let d = distance(p);
                deepest = deepest.min(d);
                p += 0.8 * d.max(0.001) * toward;
                if d < 0.002 {
                    break;
                }
            }
        }
        assert!(deepest > -0.04, "{deepest} m inside");
    }
}

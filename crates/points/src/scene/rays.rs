//! Leaves out strays on few rays: a mirror, the sun or a pane gives a scanner thousands of points along one line, out
//! to a hundred times the size of what it stands in. Such strays touch the scene and leave no empty space, and they are
//! not scattered.
//!
//! A ray is told by having nothing else around it: a line through the scene, thin against its length, holds nearly all
//! positions near it. A wire does so too. A wire that holds few of the points and would make the scene several times as
//! large is left out too, but it is drawn all the same.

use base::space::Bounds;
use glam::DVec3;

/// Most rays that are sought.
const MOST_RAYS: usize = 16;
/// Largest share of the positions that may be strays: one of five.
const MOST: f64 = 0.25;
/// Rays are strays only if the scene is at least this many times smaller without them.
const SEVERAL: f64 = 3.0;
/// Rays are sought among positions further from the core's middle than this part of the scene's edge.
const AWAY: f64 = 0.25;
/// Least share of the positions away from the core that a ray has.
const RAY_SHARE: f64 = 1.0 / 16.0;
/// Least number of the positions away from the core that a ray has.
const FEWEST: usize = 5;
/// How far from a ray its points are, as a part of their distance from the core's middle.
const THIN: f64 = 1.0 / 250.0;
/// How far from a ray its points are near the core, as a part of the core's edge, if that is less than [`THIN`] of the
/// ray's length.
const THIN_NEAR: f64 = 0.1;
/// Little else lies within this many times a ray's width.
const AROUND: f64 = 8.0;
/// Least share that a ray has of the positions around it.
const ALONE: f64 = 0.5;
/// Two points tell a direction if they are this far apart, as a part of the way from the core to the farther point.
const APART: f64 = 0.3;
/// Most edges of the core that a ray passes from the core's middle.
const ASIDE: f64 = 1.5;
/// A ray with more than this rise along its length is taken for a mast.
const STEEP: f64 = 0.999;
/// A mast is less than this many times as high as the core is wide.
const MAST: f64 = 16.0;
/// Most positions that are looked at to find a ray.
const MOST_LOOKED_AT: usize = 1024;
/// Most pairs of positions that are looked at to find a ray.
const NUM_PAIRS: usize = 256;

/// A line that passes by the core's middle, and how far from the line its points are near the core.
#[derive(Clone, Copy, Debug)]
struct ScanRay {
    from: DVec3,
    direction: DVec3,
    middle: DVec3,
    radius: f64,
}

impl ScanRay {
    fn distance(&self, p: DVec3) -> f64 {
        (p - self.from).reject_from_normalized(self.direction).length()
    }

    /// True if a position is within `times` times the ray's width.
    fn has(&self, p: DVec3, times: f64) -> bool {
        self.distance(p) <= times * self.radius.max(THIN * p.distance(self.middle))
    }
}

/// The box of the scene of positions, at least one, without rays that make it several times as large. `scene` finds the
/// box with rays.
pub(super) fn without(positions: &[DVec3], scene: impl Fn(&[DVec3]) -> Bounds) -> Bounds {
    let (all, core) = (scene(positions), core(positions));
    let near = core.grown(core.edge());
    let (mut left, mut smaller, mut num_astray) = (positions.to_vec(), all, 0);
    for _ in 0..MOST_RAYS {
        if smaller.edge() < SEVERAL * core.edge() {
            break;
        }
        let away = AWAY * smaller.edge();
        let is_away = |p: &DVec3| smaller.contains(*p) && p.distance(core.center()) > away;
        let Some(ray) = find(left.iter().copied().filter(is_away).collect(), &core) else { break };
        num_astray += left.iter().filter(|p| ray.has(**p, 1.0) && !near.contains(**p)).count();
        left.retain(|&p| !ray.has(p, 1.0));
        smaller = scene(&left);
    }
    let are_few = num_astray as f64 <= MOST * positions.len() as f64;
    if are_few && all.edge() >= SEVERAL * smaller.edge() { smaller } else { all }
}

/// The box around the middle half of the positions along each axis, grown by a quarter of its edge on all sides: strays
/// widen it little.
fn core(positions: &[DVec3]) -> Bounds {
    let mut half = Bounds::EMPTY;
    for axis in 0..3 {
        let mut values: Vec<f64> = positions.iter().map(|p| p[axis]).collect();
        let last = values.len() - 1;
        half.min[axis] = *values.select_nth_unstable_by(last / 4, f64::total_cmp).1;
        half.max[axis] = *values.select_nth_unstable_by(last - last / 4, f64::total_cmp).1;
    }
    half.grown(0.25 * half.edge())
}

/// The ray that has most of the positions away from the core.
fn find(mut away: Vec<DVec3>, core: &Bounds) -> Option<ScanRay> {
    let middle = core.center();
    let step = away.len().div_ceil(MOST_LOOKED_AT).max(1);
    away = away.into_iter().step_by(step).collect();
    away.sort_by(|a, b| a.distance_squared(middle).total_cmp(&b.distance_squared(middle)));
    let needed = FEWEST.max((RAY_SHARE * away.len() as f64) as usize);
    let num_within = |ray: &ScanRay, times: f64| away.iter().filter(|&&p| ray.has(p, times)).count();
    let part = |number: usize, step: f64| ((number as f64 + 0.5) * step).fract();
    let mut best = None;
    for number in 0..NUM_PAIRS.min(away.len() * away.len()) {
        // Each pair is a position of the farther half, and one that a ray may have with it.
        let half = away.len() / 2;
        let far = away[half + (part(number, 0.754_877_666) * (away.len() - half) as f64) as usize];
        let length = far.distance(middle);
        let toward = (far - middle) / length;
        let is_in_line = |p: &DVec3| {
            (*p - middle).dot(toward) > 0.0
                && (*p - middle).reject_from_normalized(toward).length() <= ASIDE * core.edge()
                && p.distance(far) >= APART * length
        };
        let others: Vec<DVec3> = away.iter().copied().filter(is_in_line).collect();
        let at = (part(number, 0.569_840_291) * others.len() as f64) as usize;
        let Some(other) = others.get(at) else { continue };
        let direction = (far - *other).normalize();
        let radius = (THIN * length).min(THIN_NEAR * core.edge());
        let ray = ScanRay { from: far, direction, middle, radius };
        let is_mast = direction.z.abs() > STEEP && length < MAST * core.edge();
        let num = num_within(&ray, 1.0);
        if num >= needed
            && !is_mast
            && ray.distance(middle) <= ASIDE * core.edge()
            && num as f64 >= ALONE * num_within(&ray, AROUND) as f64
            && best.is_none_or(|(most, _)| num > most)
        {
            best = Some((num, ray));
        }
    }
    best.map(|(_, ray)| ray)
}

#[cfg(test)]
#[path = "rays_tests.rs"]
mod tests;

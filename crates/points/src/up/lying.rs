//! Tells whether points alone look as if y or −y pointed up: ground in the plane y = 0, and things on it. That is no
//! proof, because a wall with things before it looks the same. So nothing is turned, but the user is told.

use super::UpAxis;
use crate::{ScanFile, scene, world};
use glam::DVec3;

/// Fewer points than this tell nothing.
const LEAST: usize = 200;
/// Largest distance of ground from its level, as a part of the scan's longest edge.
const THICK: f64 = 0.005;
/// Largest distance of the ground's level from y = 0, as a part of the scan's longest edge.
const FROM_ZERO: f64 = 0.05;
/// Least height of high things on the ground, as a part of the scan's longest edge.
const HIGH: f64 = 0.05;
/// Least part of the points that is in the plane.
const IN_PLANE: f64 = 0.4;
/// Largest part of the points that is in the plane.
const MOST_IN_PLANE: f64 = 0.95;
/// Largest part of the points that is on the other side of the plane than the things.
const BELOW: f64 = 0.01;
/// Cells per axis that the plane is cut into.
const CELLS: usize = 8;
/// Least part of the cells that has ground in it.
const COVERED: f64 = 0.7;
/// Part of the plane's width and depth that is its side.
const SIDE: f64 = 0.03;
/// Largest part of the things that stands at one side: there is ground before a wall, and another wall at its end.
const AT_SIDE: f64 = 0.12;

/// The axis that may be up in a file instead of z.
pub(super) fn likely_up(file: &ScanFile) -> Option<UpAxis> {
    of_positions(world::samples(file).collect())
}

fn of_positions(mut positions: Vec<DVec3>) -> Option<UpAxis> {
    let bounds = scene::find(positions.clone())?;
    positions.retain(|&p| bounds.contains(p));
    if positions.len() < LEAST {
        return None;
    }
    [UpAxis::Y, UpAxis::MinusY].into_iter().find(|up| {
        let turned: Vec<DVec3> = positions.iter().map(|&p| up.in_world(p)).collect();
        is_ground_with_things(&turned)
    })
}

/// True if half of the points are level ground at zero, and all others are above it and not at its sides.
fn is_ground_with_things(positions: &[DVec3]) -> bool {
    let mut heights: Vec<f64> = positions.iter().map(|p| p.z).collect();
    // The height at this index is in the midst of the ground's, if ground has as many points as it must.
    let at = (0.5 * IN_PLANE * heights.len() as f64) as usize;
    let ground = *heights.select_nth_unstable_by(at, f64::total_cmp).1;
    let bounds = base::space::Bounds::around(positions);
    let (size, edge) = (bounds.size(), bounds.edge());
    let thick = THICK * edge;
    let (level, things): (Vec<DVec3>, Vec<DVec3>) =
        positions.iter().partition(|p| (p.z - ground).abs() <= thick);
    let part = |num: usize| num as f64 / positions.len() as f64;
    let num_below = things.iter().filter(|p| p.z < ground).count();
    let num_high = things.iter().filter(|p| p.z > ground + HIGH * edge).count();
    let mut has_ground = [false; CELLS * CELLS];
    for p in &level {
        let [x, y] = [0, 1].map(|axis| {
            let cell = (p[axis] - bounds.min[axis]) / size[axis] * CELLS as f64;
            (cell as usize).min(CELLS - 1)
        });
        has_ground[x + CELLS * y] = true;
    }
    let num_covered = has_ground.iter().filter(|is| **is).count();
    let are_at_side = |axis: usize, low: f64, high: f64| {
        let at = |p: &DVec3| (p[axis] - bounds.min[axis]) / size[axis];
        let num = things.iter().filter(|p| (low..=high).contains(&at(p))).count();
        num as f64 > AT_SIDE * things.len() as f64
    };
    ground.abs() <= FROM_ZERO * edge
        && (IN_PLANE..=MOST_IN_PLANE).contains(&part(level.len()))
        && part(num_below) <= BELOW
        && 4 * num_high >= things.len()
        && num_covered as f64 >= COVERED * has_ground.len() as f64
        && [0, 1].into_iter().all(|axis| !are_at_side(axis, 0.0, SIDE) && !are_at_side(axis, 1.0 - SIDE, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers from 0 to 1 that look irregular.
    fn part(at: usize, step: f64) -> f64 {
        ((at as f64 + 0.5) * step).fract()
    }

    /// Houses on their ground, 60 by 40, x and y across, half of the points on each.
    fn houses(at: usize) -> DVec3 {
        let [u, v, w] = [0.754_877_666, 0.569_840_291, 0.380_277].map(|step| part(at, step));
        if at.is_multiple_of(2) {
            return DVec3::new(60.0 * u - 30.0, 40.0 * v - 20.0, 0.0);
        }
        let foot = DVec3::new(20.0 * (at / 2 % 3) as f64 - 20.0, 18.0 * (at / 6 % 2) as f64 - 9.0, 0.0);
        foot + match at / 12 % 3 {
            0 => DVec3::new(8.0 * u - 4.0, 4.0, 6.0 * v),
            1 => DVec3::new(4.0, 8.0 * u - 4.0, 6.0 * v),
            _ => DVec3::new(8.0 * u - 4.0, 8.0 * v - 4.0, 6.0 + w),
        }
    }

    /// A wall in the plane y = 0 with balconies, and the street before it.
    fn facade(at: usize) -> DVec3 {
        let [u, v, w] = [0.754_877_666, 0.569_840_291, 0.380_277].map(|step| part(at, step));
        match at % 6 {
            0..3 => DVec3::new(40.0 * u, 0.0, 15.0 * v),
            3 => DVec3::new(8.0 * (at / 6 % 5) as f64 + 4.0 * u, 1.5 * v, 3.0 + 3.0 * (at / 30 % 4) as f64),
            4 => DVec3::new(8.0 * (at / 6 % 5) as f64 + 4.0 * u, 1.5, 3.0 * (at / 30 % 4) as f64 + w + 3.0),
            _ => DVec3::new(40.0 * u, 12.0 * v, 0.0),
        }
    }

    fn found(num: usize, in_file: impl Fn(usize) -> DVec3) -> Option<UpAxis> {
        of_positions((0..num).map(in_file).collect())
    }

    #[test]
    fn houses_on_their_ground_may_lie_on_their_side() {
        for num in [500, 5_000, 16_000] {
            let y_up = |p: DVec3| DVec3::new(p.x, p.z, -p.y);
            assert_eq!(found(num, |at| y_up(houses(at))), Some(UpAxis::Y), "{num}");
            assert_eq!(found(num, |at| y_up(houses(at)) * 1000.0), Some(UpAxis::Y), "{num}");
            let y_down = |p: DVec3| DVec3::new(p.x, -p.z, p.y);
            assert_eq!(found(num, |at| y_down(houses(at))), Some(UpAxis::MinusY), "{num}");
        }
    }

    #[test]
    fn what_stands_upright_or_could_is_left_alone() {
        for num in [500, 5_000, 16_000] {
            assert_eq!(found(num, houses), None, "{num}: as they are");
            assert_eq!(found(num, facade), None, "{num}: a facade");
            assert_eq!(
                found(num, |at| -facade(at).with_z(-facade(at).z)),
                None,
                "{num}: facing the other way"
            );
            let box_of = |at: usize| DVec3::new(facade(at).x, facade(at).y, houses(at).z);
            assert_eq!(found(num, |at| box_of(at).with_y(7.0)), None, "{num}: one plane");
            let away = DVec3::new(0.0, 50.0, 0.0);
            assert_eq!(found(num, |at| facade(at) + away), None, "{num}: away from zero");
            // The points are on two walls of a house.
            let corner = |at: usize| {
                if at.is_multiple_of(2) {
                    facade(0).with_x(part(at, 0.7549) * 40.0).with_z(15.0 * part(at, 0.5698))
                } else {
                    DVec3::new(0.0, 30.0 * part(at, 0.7549), 15.0 * part(at, 0.5698))
                }
            };
            assert_eq!(found(num, corner), None, "{num}: a corner");
            let dust = |at: usize| DVec3::new(part(at, 0.7549), part(at, 0.5698), part(at, 0.3803));
            assert_eq!(found(num, dust), None, "{num}: dust");
        }
        assert_eq!(found(0, houses), None);
    }
}

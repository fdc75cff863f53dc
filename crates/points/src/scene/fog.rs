//! Tells whether points fill a space, as noise does, or lie on surfaces, as those that a scanner sees.
//!
//! On a surface there are four times as many points within twice the distance, in a space eight times as many.

use super::nearest::distances;
use glam::DVec3;

/// Fewest positions that can tell.
const FEWEST: usize = 200;
/// Most positions that are looked at.
const MOST: usize = 4096;
/// Number of the near neighbor whose distance is compared.
const NEAR: usize = 4;
/// Number of the far neighbor whose distance is compared.
const FAR: usize = 24;
/// Power of the distance that the number of neighbors grows with in fog, at least: it is 2 on a surface and near 3 in a
/// space, less at the sides of a space.
const OF_FOG: f64 = 2.4;

/// True if most of many positions have neighbors on all sides.
pub(super) fn is_fog(positions: &[DVec3]) -> bool {
    if positions.len() < FEWEST {
        return false;
    }
    let step = positions.len().div_ceil(MOST);
    let looked_at: Vec<DVec3> = positions.iter().copied().step_by(step).collect();
    let pairs = distances(&looked_at, NEAR).into_iter().zip(distances(&looked_at, FAR));
    let more = (FAR as f64 / NEAR as f64).ln();
    let mut powers: Vec<f64> = pairs.map(|(near, far)| more / (far / near).ln()).collect();
    let middle = powers.len() / 2;
    *powers.select_nth_unstable_by(middle, f64::total_cmp).1 > OF_FOG
}

#[cfg(test)]
mod tests {
    use super::super::random::Random;
    use super::*;

    #[test]
    fn a_space_is_told_from_surfaces_and_lines() {
        let random = &mut Random(1);
        let mut is_fog_of = |num: usize, shape: fn(DVec3) -> DVec3| {
            let mut at = || DVec3::new(random.next(), random.next(), random.next()) - 0.5;
            let positions: Vec<DVec3> = (0..num).map(|_| shape(at())).collect();
            is_fog(&positions)
        };
        for num in [300, 3_000, 30_000] {
            assert!(is_fog_of(num, |p| p), "{num}");
            // The cube becomes a ball.
            assert!(is_fog_of(num, |p| p * p.abs().max_element() / p.length()), "{num}");
            for surface in [
                |p: DVec3| p.with_z(0.0),
                |p: DVec3| p.normalize(),
                |p: DVec3| p.with_z(0.1 * (9.0 * p.x).sin()),
                |p: DVec3| DVec3::X * p,
            ] {
                assert!(!is_fog_of(num, surface), "{num}");
            }
        }
        assert!(!is_fog_of(20, |p| p));
    }
}

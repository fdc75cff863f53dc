//! Leaves out strays that are scattered round a scene, as far away from it as from each other. No empty space between
//! them and the scene could tell them apart, but they are lonely.
//!
//! Points of a scanned surface have neighbors near by, many times nearer than scattered strays have, which fill a space
//! instead of a surface. So the distances to neighbors fall into two groups with next to nothing in between. A
//! scanner's own points thin out without such a jump. Where their distances do jump, from a yard to the trees beyond
//! its gate, the points beyond lie side by side, far nearer to each other than if they were strewn all around.

use super::nearest::distances;
use glam::DVec3;

/// Fewest points that can tell.
const FEWEST: usize = 30;
/// Number of the neighbor that tells how lonely a point is: strays may come in pairs.
const NEIGHBOR: usize = 4;
/// Share of the points that the neighbor's number is at most, so that few points are enough.
const NEIGHBOR_SHARE: f64 = 0.125;
/// Largest share of the positions that may be strays: one of five.
const MOST: f64 = 0.25;
/// Strays are this many times as far from their neighbors as all other positions.
const JUMP: f64 = 2.0;
/// Most positions whose distances lie in between, as a share of the strays.
const BETWEEN: f64 = 0.3;
/// Distance to the nearest of points that are strewn evenly over a disc, as a part of its radius over the root of their
/// number.
const STREWN: f64 = 0.886;
/// Part of [`STREWN`] from which on points are lonely: points strewn through space are further apart.
const LONELY: f64 = 0.5;

/// The positions that are not scattered; they must be distinct.
pub(super) fn gathered(positions: &[DVec3]) -> Vec<DVec3> {
    if positions.len() < FEWEST {
        return positions.to_vec();
    }
    let neighbor = ((NEIGHBOR_SHARE * positions.len() as f64) as usize).clamp(1, NEIGHBOR);
    let lonely = distances(positions, neighbor);
    match limit(lonely.clone()) {
        Some(limit) if are_strewn(positions, &lonely, limit) => {
            positions.iter().zip(&lonely).filter(|(_, away)| **away < limit).map(|(&p, _)| p).collect()
        }
        _ => positions.to_vec(),
    }
}

/// The least distance to neighbors beyond a jump: of several jumps, the first that leaves few enough beyond it.
fn limit(mut lonely: Vec<f64>) -> Option<f64> {
    lonely.sort_unstable_by(f64::total_cmp);
    let num = lonely.len();
    let least = num - (MOST * num as f64) as usize;
    (least.max(1)..num).find_map(|first| {
        let before = lonely[..first].partition_point(|&away| away * JUMP < lonely[first]);
        let (between, beyond) = (first - before, num - first);
        (before > 0 && surely(between as f64) <= BETWEEN * beyond as f64).then_some(lonely[first])
    })
}

/// The largest value that a number that came about by chance could have had.
fn surely(num: f64) -> f64 {
    num + 2.0 * num.sqrt()
}

/// True if those lonelier than a limit lie as far from each other as if they were strewn all around.
fn are_strewn(positions: &[DVec3], lonely: &[f64], limit: f64) -> bool {
    let middle = DVec3::from_array([0, 1, 2].map(|axis| median(positions.iter().map(|p| p[axis]).collect())));
    let beyond: Vec<DVec3> =
        positions.iter().zip(lonely).filter(|(_, away)| **away >= limit).map(|(&p, _)| p).collect();
    let shares = distances(&beyond, 1).into_iter().zip(&beyond).map(|(away, p)| away / p.distance(middle));
    median(shares.collect()) >= LONELY * STREWN / (beyond.len() as f64).sqrt()
}

fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
#[path = "scattered_tests.rs"]
mod tests;

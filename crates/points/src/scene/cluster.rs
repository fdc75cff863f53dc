//! Finds which of many positions are the scene, and which are strays.
//!
//! Strays that are **scattered** all around are left out (`scattered.rs`). The **core** is the smallest block that
//! still holds most of the other positions: the part that is denser than the rest, wherever it lies. The core then
//! **grows** outwards for as long as there is no empty space that is large against what has been gathered. Emptiness
//! decides there, not density: a terrestrial scan thins out with the square of the distance, yet each of its rings
//! begins where the ring before ends, and a tower, a strip, a wood do the same. Growth along a few **rays** only does
//! not count (`rays.rs`). Positions that many points share count once, because a scanner writes zeros where it saw
//! nothing.

use super::fog::is_fog;
use super::rays;
use super::scattered::gathered;
use base::space::Bounds;
use glam::DVec3;

/// Share of the positions that the core holds, beside [`CORE_NUM`]: the rest may be strays, and a little of the scene.
const CORE_SHARE: f64 = 0.75;
/// Number of positions that the core holds beside their share: of four positions none may be astray, of five one.
const CORE_NUM: f64 = 0.25;
/// Share of the core's positions at either end of an axis that may be strays: a block is up to four times too large.
const CORE_TAIL: f64 = 0.01;
/// Empty space that is bridged, in edges of what has been gathered, and the share of the positions that must be found
/// beyond it, which is larger for wider space.
const BRIDGES: [(f64, f64); 3] = [(0.05, 0.0), (0.25, 1e-4), (2.0, 1e-3)];
/// The shortest bridge is at least this over the number of positions, because few positions lie further apart than
/// many.
const BRIDGE_OF_FEW: f64 = 20.0;
/// Nothing is astray if nothing lies further away than this many edges.
const FAR: f64 = 1.0;
/// Empty space, in edges, that is bridged to reach something that is built like what has been gathered: a second
/// building, but no fog.
const COPY_GAP: f64 = 20.0;
/// Least share of the positions that must lie around the scene for another thing that is built like it.
const COPY_SHARE: f64 = 0.02;
/// Least and largest edge of such a thing, against that of what has been gathered.
const COPY_EDGE: [f64; 2] = [0.125, 2.0];
/// Nothing further from the core than this many of its edges belongs to the scene.
const REACH: f64 = 64.0;
/// Cells per axis of the grid in which the densest block is sought; a block has half as many.
const GRID: usize = 4;

/// The box of the scene among `positions`, all finite; `None` if there are none.
pub(crate) fn find(mut positions: Vec<DVec3>) -> Option<Bounds> {
    distinct(&mut positions);
    let all = Bounds::around(&positions);
    if is_all(&core(&positions)?, &all) {
        return Some(all);
    }
    let scene = rays::without(&gathered(&positions), |positions| grown(positions).unwrap_or_default());
    Some(if is_all(&scene, &all) { all } else { scene })
}

/// The box of the core, and of all that follows it without large empty space.
fn grown(all: &[DVec3]) -> Option<Bounds> {
    let core = core(all)?;
    let num = all.len() as f64;
    let limit = core.grown(REACH * core.edge());
    let mut positions: Vec<DVec3> =
        all.iter().copied().filter(|&p| !core.contains(p) && limit.contains(p)).collect();
    let mut scene = core;
    let mut bridges = BRIDGES;
    bridges[0].0 = bridges[0].0.max(BRIDGE_OF_FEW / num);
    while let Some(more) = bridges
        .iter()
        .find_map(|&(gap, share)| beyond(&positions, &scene, gap, share * num))
        .or_else(|| reference(&positions, &scene, all))
    {
        scene = scene.union(more);
        positions.retain(|&p| !scene.contains(p));
    }
    Some(scene)
}

/// True if nothing lies far from what has been gathered.
fn is_all(scene: &Bounds, all: &Bounds) -> bool {
    let near = scene.grown(FAR * scene.edge());
    near.contains(all.min) && near.contains(all.max)
}

/// The box of the part that is denser than the rest.
fn core(positions: &[DVec3]) -> Option<Bounds> {
    let needed = CORE_SHARE * positions.len() as f64 + CORE_NUM;
    Some(trimmed(positions, &densest(positions, needed)?))
}

/// The part of a block in which nearly all of its positions are.
fn trimmed(positions: &[DVec3], block: &Bounds) -> Bounds {
    let mut core = *block;
    for axis in 0..3 {
        let inside = positions.iter().filter(|p| block.contains(**p));
        let mut values: Vec<f64> = inside.map(|p| p[axis]).collect();
        let tail = (CORE_TAIL * values.len() as f64) as usize;
        let last = values.len() - 1;
        core.min[axis] = *values.select_nth_unstable_by(tail, f64::total_cmp).1;
        core.max[axis] = *values.select_nth_unstable_by(last - tail, f64::total_cmp).1;
    }
    core
}

/// Box of the positions that are at most `gap` edges from the scene, if there are at least `needed`.
fn beyond(positions: &[DVec3], scene: &Bounds, gap: f64, needed: f64) -> Option<Bounds> {
    let reach = scene.grown(gap * scene.edge());
    let found = positions.iter().filter(|p| reach.contains(**p));
    let (bounds, num) = found.fold((Bounds::EMPTY, 0u32), |(bounds, num), &p| (bounds.with(p), num + 1));
    (num > 0 && f64::from(num) >= needed).then_some(bounds)
}

/// True for a position that is further above or below a scene than beside it, as clouds are and no building is.
fn hangs(p: DVec3, scene: &Bounds) -> bool {
    let gap = (scene.min - p).max(p - scene.max).max(DVec3::ZERO);
    gap.z > gap.truncate().length()
}

/// Box of something that lies further away, but is built like the scene.
fn reference(positions: &[DVec3], scene: &Bounds, all: &[DVec3]) -> Option<Bounds> {
    let edge = scene.edge();
    let around = scene.grown(COPY_GAP * edge);
    let is_around = |p: &DVec3| around.contains(*p) && !hangs(*p, scene);
    let around: Vec<DVec3> = positions.iter().copied().filter(is_around).collect();
    if (around.len() as f64) < COPY_SHARE * all.len() as f64 {
        return None;
    }
    let reference = densest(&around, 0.5 * around.len() as f64)?;
    let inside =
        |bounds: &Bounds| -> Vec<DVec3> { all.iter().copied().filter(|&p| bounds.contains(p)).collect() };
    let is_alike = (COPY_EDGE[0] * edge..=COPY_EDGE[1] * edge).contains(&reference.edge())
        && (!is_fog(&inside(&reference)) || is_fog(&inside(scene)));
    is_alike.then_some(reference)
}

/// The box of the densest block with at least `needed` positions: takes the half that has them again and again.
fn densest(positions: &[DVec3], needed: f64) -> Option<Bounds> {
    let mut inside = positions.to_vec();
    let mut bounds = Bounds::around(&inside);
    if bounds.is_empty() {
        return None;
    }
    loop {
        let edge = bounds.edge();
        let cell = |p: &DVec3| {
            ((*p - bounds.min) * (GRID as f64 / edge)).to_array().map(|c| (c as usize).min(GRID - 1))
        };
        let mut counts = [0u32; GRID * GRID * GRID];
        inside.iter().map(cell).for_each(|[x, y, z]| counts[x + GRID * (y + GRID * z)] += 1);
        let (corner, count) = densest_block(&counts);
        if f64::from(count) < needed || edge == 0.0 {
            return Some(bounds);
        }
        inside.retain(|p| cell(p).iter().zip(corner).all(|(&c, low)| (low..low + GRID / 2).contains(&c)));
        let smaller = Bounds::around(&inside);
        if smaller.edge() >= edge {
            return Some(bounds);
        }
        bounds = smaller;
    }
}

/// First cell and count of the block with most positions, of half the grid's edge; the first of equal blocks.
fn densest_block(counts: &[u32; GRID * GRID * GRID]) -> ([usize; 3], u32) {
    let places = GRID / 2 + 1;
    let mut best = ([0; 3], 0);
    for place in 0..places * places * places {
        let corner = [place % places, place / places % places, place / (places * places)];
        let cells = (0..counts.len()).filter(|cell| {
            let at = [cell % GRID, cell / GRID % GRID, cell / (GRID * GRID)];
            at.iter().zip(corner).all(|(&c, low)| (low..low + GRID / 2).contains(&c))
        });
        let count = cells.map(|cell| counts[cell]).sum();
        if count > best.1 {
            best = (corner, count);
        }
    }
    best
}

/// Sorts positions, and keeps one of each.
fn distinct(positions: &mut Vec<DVec3>) {
    let order =
        |a: &DVec3, b: &DVec3| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z));
    positions.sort_unstable_by(order);
    positions.dedup();
}

#[cfg(test)]
#[path = "cluster_tests.rs"]
mod tests;

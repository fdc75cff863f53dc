//! A part of a scene that is so long and thin that a viewer who saw all of it would see a line: a corridor, a road, a
//! strip.

use base::space::Bounds;
use glam::{DVec2, DVec3};
use points::Scene;
use std::borrow::Cow;

/// Cells of the floor plan along each side of a square around the scene.
const CELLS: usize = 16;
/// A thin scene reaches from one side to the other, except for at most this many rows of cells.
const BESIDE: usize = 2;
/// A thin scene is in at most this many cells: a line from corner to corner touches up to three a row.
const MOST_CELLS: usize = 5 * CELLS;

/// The part around the middle of a long and thin scene, halved until it is no longer thin or would be shorter than
/// `least`, world units. Any other scene is returned whole.
pub(super) fn part(scene: &Scene, least: f64) -> Cow<'_, Scene> {
    let mut part = Cow::Borrowed(scene);
    while is_thin(&part) && part.bounds.edge() > 2.0 * least {
        let Some(middle) = middle(&part) else { break };
        let reach = 0.25 * part.bounds.size().truncate().max_element();
        part = Cow::Owned(part.part(|p| (*p - middle).truncate().abs().max_element() <= reach));
    }
    part
}

/// The sample that is nearest to the middle of all samples.
fn middle(scene: &Scene) -> Option<DVec3> {
    let (x, y) = (scene.quarters(0)?, scene.quarters(1)?);
    let middle = DVec2::new(x[1], y[1]);
    let away = |p: &&DVec3| p.truncate().distance_squared(middle);
    scene.samples.iter().min_by(|a, b| away(a).total_cmp(&away(b))).copied()
}

/// True if the scene, seen from above, is a line, straight or not.
fn is_thin(scene: &Scene) -> bool {
    let Bounds { min, max } = scene.bounds;
    let edge = (max - min).truncate().max_element();
    // Any scene of few points would be in few cells.
    if scene.samples.len() < CELLS * CELLS || edge <= 0.0 {
        return false;
    }
    let mut is_in = [[false; CELLS]; CELLS];
    for p in &scene.samples {
        let [x, y] =
            [0, 1].map(|axis| (((p[axis] - min[axis]) / edge * CELLS as f64) as usize).min(CELLS - 1));
        is_in[x][y] = true;
    }
    let num_cells = is_in.as_flattened().iter().filter(|is_in| **is_in).count();
    let num_columns = is_in.iter().filter(|column| column.contains(&true)).count();
    let num_rows = (0..CELLS).filter(|&y| is_in.iter().any(|column| column[y])).count();
    num_cells <= MOST_CELLS && num_columns.max(num_rows) >= CELLS - BESIDE
}

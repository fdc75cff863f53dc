//! CPU reference of `spt/cull.wgsl`: which batches of discs and triangles are drawn.

use super::{Tree, tolerance};
use crate::reference::cull::{HALF_CELLS, head_place, in_frustum, in_slices, planes_needed};
use crate::reference::sizes::nearest_depth;
use crate::technique::tree::{
    DiscBatch, RUN_ONE_SIDED, RUN_TRIANGLES, SLICE_PIXELS, VISIBLE_DISCS, VISIBLE_TRIANGLES,
};
use cloud::format::{STEP_MASK, UNTIL_SHIFT};
use render::layout::{
    ALL_PLANES, COARSE_PLANES, CULL_SLACK, DRAWN_WHOLE, EyeUniform, MAX_SLICES, OWN_NONE_WORD,
    VISIBLE_BY_EYE, VISIBLE_FILL, VISIBLE_WIDE, ViewUniform, VisibleBatch,
};

/// Returns the visible batches in batch order; the GPU's order is arbitrary.
#[must_use]
pub fn cull(view: &ViewUniform, num_eyes: usize, tree: &Tree) -> Vec<VisibleBatch> {
    in_slices(tree.batches.iter().filter_map(|batch| cull_batch(view, num_eyes, tree, batch)))
}

/// Number of workgroups that draw a batch of triangles.
fn num_slices_of_triangles(tree: &Tree, batch: &DiscBatch, eye: &EyeUniform, depth: f32) -> u32 {
    let side_px = tree.scale().length((batch.interval >> UNTIL_SHIFT) as u8) * eye.pixels_per_radian / depth;
    let num_pixels = (side_px * side_px).min(eye.width as f32 * eye.height as f32);
    (num_pixels / SLICE_PIXELS as f32).clamp(1.0, MAX_SLICES as f32) as u32
}

/// Returns the batch, if it is seen, and the number of workgroups that draw it.
fn cull_batch(
    view: &ViewUniform,
    num_eyes: usize,
    tree: &Tree,
    batch: &DiscBatch,
) -> Option<(VisibleBatch, u32)> {
    let axes = |f: &dyn Fn(usize) -> f32| [f(0), f(1), f(2)];
    let half_edge = batch.cell.map(|c| c * HALF_CELLS);
    let head_hi = axes(&|i| view.head_hi[i] - batch.min_hi[i]);
    let head_lo = axes(&|i| view.head_lo[i] - batch.min_lo[i]);
    let center = axes(&|i| half_edge[i] - head_hi[i] - head_lo[i]);

    let mut flags = 0;
    for (number, eye) in view.eyes[..num_eyes].iter().enumerate() {
        if in_frustum(view, eye, center, half_edge)
            && is_needed((view, number), tree, batch, center, half_edge)
        {
            flags |= VISIBLE_BY_EYE << number;
        }
    }
    if flags == 0 {
        return None;
    }
    let is_of_triangles = tree.runs[batch.run as usize].flags & RUN_TRIANGLES != 0;
    flags |= if is_of_triangles { VISIBLE_TRIANGLES } else { VISIBLE_FILL | VISIBLE_WIDE | VISIBLE_DISCS };
    let longest = 2.0 * half_edge[0].max(half_edge[1].max(half_edge[2]));
    let mut planes = view.forced_planes.max(COARSE_PLANES);
    let mut slices = 1;
    for eye in &view.eyes[..num_eyes] {
        let [x, y, z, _] = eye.row_w.map(f32::abs);
        let reach = x * half_edge[0] + y * half_edge[1] + z * half_edge[2];
        let depth = nearest_depth(view, eye, center, half_edge, reach);
        let edge_px = longest * eye.pixels_per_radian / depth;
        if view.forced_planes == 0 {
            planes = planes.max(planes_needed(edge_px));
        }
        if is_of_triangles {
            slices = slices.max(num_slices_of_triangles(tree, batch, eye, depth));
        }
    }
    if is_of_triangles {
        planes = ALL_PLANES;
    }
    let (head_cell, offset) = head_place(head_hi, head_lo, batch.cell, batch.steps_per_unit, planes);
    let visible = VisibleBatch {
        head_cell,
        first_point: batch.first_point,
        offset,
        num_points: batch.num_points,
        cell: batch.cell,
        flags: flags | planes,
        spacing: [0; 4],
        own: [OWN_NONE_WORD; 2],
        drawn: DRAWN_WHOLE,
        spacing_step: 1.0,
        sample_spacing: 0.0,
        reserved: 0,
        reserved_end: [0; 2],
    };
    Some((visible, slices))
}

fn is_needed(
    (view, number): (&ViewUniform, usize),
    tree: &Tree,
    batch: &DiscBatch,
    center: [f32; 3],
    half_edge: [f32; 3],
) -> bool {
    let (uniform, run) = (&tree.uniform, &tree.runs[batch.run as usize]);
    let eye = &view.eyes[number];
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let from_eye: [f32; 3] = std::array::from_fn(|i| center[i] - eye.eye_in_head[i]);
    let near: [f32; 3] = std::array::from_fn(|i| (from_eye[i].abs() - half_edge[i]).max(0.0));
    let far: [f32; 3] = std::array::from_fn(|i| from_eye[i].abs() + half_edge[i]);
    let step = |tolerance: f32| u32::from(tree.scale().step_below(tolerance));
    let farthest = dot(far, far).sqrt();
    let change = tolerance::steepest(view, uniform, number) * dot(half_edge, half_edge).sqrt();
    let middle = tolerance::of(view, uniform, number, from_eye);
    let least = (uniform.tolerance_rad[number] * dot(near, near).sqrt()).max(middle - change);
    let most = (tolerance::outer_rad(view, uniform, number) * farthest).min(middle + change);
    let slack = CULL_SLACK * tolerance::outer_rad(view, uniform, number) * farthest;
    if step((least - slack).max(0.0)) >= batch.interval >> UNTIL_SHIFT
        || step(most + slack) < batch.interval & STEP_MASK
    {
        return false;
    }
    if run.flags & RUN_ONE_SIDED == 0 {
        return true;
    }
    let [x, y, z, sin] = run.behind;
    let along = dot(from_eye, [x, y, z]);
    let distance_sq = dot(from_eye, from_eye);
    let across = (distance_sq - along * along).max(0.0).sqrt();
    let inside = along * sin - across * (1.0 - sin * sin).sqrt();
    inside < dot(half_edge, half_edge).sqrt() + CULL_SLACK * distance_sq.sqrt()
}

//! CPU reference of `cull`: frustum, precision, and the head in each batch's cells.

use super::points::radius;
use super::sizes::nearest_depth;
use render::layout::{
    ALL_PLANES, CELLS, CHILD_ABSENT, COARSE_PLANES, CULL_SLACK, DRAWN_WHOLE, EyeUniform, FINE_THRESHOLD_PX,
    GpuBatch, GpuNode, HEAD_CELL_LIMIT, HEAD_CELL_STEP, MAX_EXTRA_SLICES, MIDDLE_PLANES, NO_CHILD, NODE_ROOT,
    NUM_SLICES_SHIFT, OWN_BITS, OWN_FILL_RADIUS, OWN_NONE, OWN_PER_WORD, OWN_SHIFT, POINTS_COVER,
    POINTS_PER_LOAD, PRECISION_THRESHOLD_PX, SAMPLES_COVER, SLICE_SHIFT, STATE_PARTS, STATE_SHIFT,
    VISIBLE_BY_EYE, VISIBLE_FILL, VISIBLE_WIDE, ViewUniform, VisibleBatch, WIDE_SLICE_PIXELS, WORKGROUP_SIZE,
};

/// Half the number of cells along a box edge.
pub(super) const HALF_CELLS: f32 = 0.5 * CELLS;

/// Returns the visible batches in batch order; the GPU's order is arbitrary. `states` are those that `lod` left.
#[must_use]
pub fn cull(
    view: &ViewUniform,
    num_eyes: usize,
    batches: &[GpuBatch],
    nodes: &[GpuNode],
    states: &[u32],
) -> Vec<VisibleBatch> {
    let one = |batch: &GpuBatch| {
        let node = &nodes[batch.node as usize];
        let drawn = states[batch.node as usize];
        if drawn == 0 {
            return None;
        }
        let (visible, num_slices) = cull_batch(view, num_eyes, batch, node, drawn)?;
        let own = own_colors(node, states);
        Some((VisibleBatch { own, drawn, ..visible }, num_slices))
    };
    in_slices(batches.iter().filter_map(one))
}

/// Splits each batch into as many slices as it asks for, while there is room for them.
pub(super) fn in_slices(batches: impl Iterator<Item = (VisibleBatch, u32)>) -> Vec<VisibleBatch> {
    let mut room = MAX_EXTRA_SLICES;
    let slices = |(batch, num_slices): (VisibleBatch, u32)| {
        let num_extra = (num_slices - 1).min(room);
        room -= num_extra;
        (0..=num_extra).map(move |slice| {
            let of_slice = slice << SLICE_SHIFT | num_extra << NUM_SLICES_SHIFT;
            VisibleBatch { flags: batch.flags | of_slice, ..batch }
        })
    };
    batches.flat_map(slices).collect()
}

/// Number of workgroups that draw a batch of points whose splats have this radius; one if each point is one pixel.
fn num_slices_of_points(num_points: u32, radius: f32) -> u32 {
    if radius == 0.0 {
        return 1;
    }
    let side = 2.0 * radius + 1.0;
    let most = POINTS_PER_LOAD * num_points.div_ceil(POINTS_PER_LOAD).div_ceil(WORKGROUP_SIZE);
    (num_points as f32 * (side * side) / WIDE_SLICE_PIXELS as f32).clamp(1.0, most as f32) as u32
}

/// Counts the nodes of visible batches, which are in batch order; `node_of` returns the node of the batch that begins
/// with a point.
pub fn num_nodes(visible: &[VisibleBatch], node_of: impl Fn(u32) -> u32) -> u32 {
    let node = |visible: &VisibleBatch| node_of(visible.first_point);
    visible.chunk_by(|a, b| node(a) == node(b)).count() as u32
}

/// State of the child in each octant, in [`OWN_BITS`] bits: [`OWN_NONE`] where there is no child, 0 where it is not
/// there yet.
fn own_colors(node: &GpuNode, states: &[u32]) -> [u32; 2] {
    let mut own = [0; 2];
    for (octant, &child) in (0..).zip(&node.children) {
        let drawn = match child {
            NO_CHILD => OWN_NONE,
            CHILD_ABSENT => 0,
            child => states[child as usize] >> OWN_SHIFT,
        };
        own[(octant / OWN_PER_WORD) as usize] |= drawn << (OWN_BITS * (octant % OWN_PER_WORD));
    }
    own
}

/// Distance between a node's drawn samples, as a share of its edge. It is larger where the root is drawn with a part of
/// them.
fn spacing_drawn(node: &GpuNode, drawn: u32) -> f32 {
    if node.flags & NODE_ROOT == 0 || drawn == DRAWN_WHOLE {
        return node.sample_spacing;
    }
    node.sample_spacing / (((drawn >> STATE_SHIFT) + 1) as f32 / STATE_PARTS as f32).sqrt()
}

/// Returns the batch, if it is seen, and the number of workgroups that draw it.
fn cull_batch(
    view: &ViewUniform,
    num_eyes: usize,
    batch: &GpuBatch,
    node: &GpuNode,
    drawn: u32,
) -> Option<(VisibleBatch, u32)> {
    let axes = |f: &dyn Fn(usize) -> f32| [f(0), f(1), f(2)];
    let half_edge = batch.cell.map(|c| c * HALF_CELLS);
    let head_hi = axes(&|i| view.head_hi[i] - batch.min_hi[i]);
    let head_lo = axes(&|i| view.head_lo[i] - batch.min_lo[i]);
    let center = axes(&|i| half_edge[i] - head_hi[i] - head_lo[i]);

    let longest = 2.0 * half_edge[0].max(half_edge[1].max(half_edge[2]));
    let widest = shares(node.spacing).into_iter().fold(0.0, f32::max);
    let step = node.spacing_step;
    let widest = POINTS_COVER * widest * (step * step * step);
    let sample_spacing = spacing_drawn(node, drawn);
    let mut flags = 0;
    for (number, eye) in view.eyes[..num_eyes].iter().enumerate() {
        if in_frustum(view, eye, center, half_edge) {
            flags |= VISIBLE_BY_EYE << number;
        }
    }
    if flags == 0 {
        return None;
    }
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
        let corner = axes(&|i| (center[i] - eye.eye_in_head[i]).abs() + half_edge[i]);
        let far = (corner[0] * corner[0] + corner[1] * corner[1] + corner[2] * corner[2]).sqrt() / depth;
        let open_px = widest_open_px(view, eye, edge_px, far, widest, sample_spacing);
        if open_px
            .iter()
            .zip(view.fill_reach_px)
            .any(|(&open_px, reach_px)| open_px > (1.0 - CULL_SLACK) * reach_px)
        {
            flags |= VISIBLE_FILL;
        }
        let radius = radius(view, (1.0 + CULL_SLACK) * open_px.into_iter().fold(0.0, f32::max));
        if radius > OWN_FILL_RADIUS as f32 {
            flags |= VISIBLE_WIDE;
        }
        slices = slices.max(num_slices_of_points(batch.num_points, radius));
    }
    let (head_cell, offset) = head_place(head_hi, head_lo, batch.cell, batch.steps_per_unit, planes);
    let visible = VisibleBatch {
        head_cell,
        first_point: batch.first_point,
        offset,
        num_points: batch.num_points,
        cell: batch.cell,
        flags: flags | planes,
        spacing: node.spacing,
        own: [0; 2],
        drawn: 0,
        spacing_step: node.spacing_step,
        sample_spacing,
        reserved: 0,
        reserved_end: [0; 2],
    };
    Some((visible, slices))
}

/// The head's cell in a batch, and that cell's place relative to the head.
pub(super) fn head_place(
    head_hi: [f32; 3],
    head_lo: [f32; 3],
    cell: [f32; 3],
    steps_per_unit: [f32; 3],
    planes: u32,
) -> ([i32; 3], [f32; 3]) {
    let axes = |f: &dyn Fn(usize) -> f32| [f(0), f(1), f(2)];
    let limit = (HEAD_CELL_LIMIT / HEAD_CELL_STEP) as f32;
    let steps = axes(&|i| (head_hi[i] * steps_per_unit[i]).round_ties_even().clamp(-limit, limit));
    let head_cell = steps.map(|s| s as i32 * HEAD_CELL_STEP);
    let mut offset = axes(&|i| head_cell[i] as f32 * cell[i] - head_hi[i] - head_lo[i]);
    if planes == ALL_PLANES {
        offset = axes(&|i| offset[i] + 0.5 * cell[i]);
    }
    (head_cell, offset)
}

pub(super) fn in_frustum(
    view: &ViewUniform,
    eye: &EyeUniform,
    center: [f32; 3],
    half_edge: [f32; 3],
) -> bool {
    let first = eye.first_px.map(|px| px - view.margin_px);
    let end = eye.end_px.map(|px| px + view.margin_px);
    let from = |row: [f32; 4], px: f32| std::array::from_fn(|i| row[i] - eye.row_w[i] * px);
    let to = |row: [f32; 4], px: f32| std::array::from_fn(|i| eye.row_w[i] * px - row[i]);
    let [x, y, z, w] = eye.row_w;
    in_front([x, y, z, w - view.near], center, half_edge)
        && in_front(from(eye.row_x, first[0]), center, half_edge)
        && in_front(to(eye.row_x, end[0]), center, half_edge)
        && in_front(from(eye.row_y, first[1]), center, half_edge)
        && in_front(to(eye.row_y, end[1]), center, half_edge)
}

fn in_front(plane: [f32; 4], center: [f32; 3], half_edge: [f32; 3]) -> bool {
    let n = plane.map(f32::abs);
    let c = center.map(f32::abs);
    let distance = plane[0] * center[0] + plane[1] * center[1] + plane[2] * center[2] + plane[3];
    let radius = n[0] * half_edge[0] + n[1] * half_edge[1] + n[2] * half_edge[2];
    let magnitude = n[0] * c[0] + n[1] * c[1] + n[2] * c[2] + n[3];
    distance + radius + CULL_SLACK * magnitude >= 0.0
}

pub(super) fn planes_needed(edge_px: f32) -> u32 {
    match edge_px {
        px if px < PRECISION_THRESHOLD_PX => COARSE_PLANES,
        px if px < FINE_THRESHOLD_PX => MIDDLE_PLANES,
        _ => ALL_PLANES,
    }
}

fn widest_open_px(
    view: &ViewUniform,
    eye: &EyeUniform,
    edge_px: f32,
    far: f32,
    widest: f32,
    sample_spacing: f32,
) -> [f32; 3] {
    let stretch = far.min(1.0 / eye.widest_cos);
    view.undivided_px.map(|undivided_px| {
        let undivided_px = (2.0 * edge_px).min(undivided_px);
        stretch * (widest * edge_px).max(SAMPLES_COVER * sample_spacing * undivided_px)
    })
}

/// Unpacks the eight f16 of [`GpuNode::spacing`].
#[must_use]
pub fn shares(spacing: [u32; 4]) -> [f32; 8] {
    std::array::from_fn(|octant| {
        let bits = spacing[octant / 2] >> (16 * (octant % 2)) & 0xffff;
        half::f16::from_bits(bits as u16).to_f32()
    })
}

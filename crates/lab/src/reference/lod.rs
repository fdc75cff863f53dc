//! CPU reference of `lod`: each node's state.

use super::sizes::nearest_depth;
use render::layout::{
    CUBE_RADIUS, DRAWN_WHOLE, EyeUniform, FADE_BEGIN, FADE_END, GpuNode, HYSTERESIS, LOD_FADE, LOD_SMOOTH,
    NODE_RESIDENT, NODE_ROOT, NODE_WHOLE, STATE_LOW, STATE_PARTS, STATE_SHIFT, ViewUniform,
};

/// Updates each node's state; `states` are those of the frame before, all 0 in a cloud's first frame.
pub fn lod(view: &ViewUniform, num_eyes: usize, nodes: &[GpuNode], states: &mut [u32]) {
    for (node, state) in nodes.iter().zip(states) {
        *state = node_state(view, num_eyes, node, *state);
    }
}

fn node_state(view: &ViewUniform, num_eyes: usize, node: &GpuNode, before: u32) -> u32 {
    if node.flags & NODE_RESIDENT == 0 {
        return 0;
    }
    if node.flags & NODE_WHOLE != 0 {
        return DRAWN_WHOLE;
    }
    let center: [f32; 3] = std::array::from_fn(|i| {
        0.5 * node.edge - (view.head_hi[i] - node.min_hi[i]) - (view.head_lo[i] - node.min_lo[i])
    });
    let largest = view.eyes[..num_eyes]
        .iter()
        .map(|eye| importance(view, eye, center, node.edge))
        .fold(f32::NEG_INFINITY, f32::max);
    if node.flags & NODE_ROOT != 0 {
        state_of(largest * largest)
    } else if view.flags & LOD_FADE != 0 {
        if largest > FADE_BEGIN { state_of((largest - FADE_BEGIN) / (FADE_END - FADE_BEGIN)) } else { 0 }
    } else if largest >= if before != 0 { HYSTERESIS } else { 1.0 } {
        DRAWN_WHOLE
    } else {
        0
    }
}

/// A node's projected edge, in multiples of its threshold.
fn importance(view: &ViewUniform, eye: &EyeUniform, center: [f32; 3], edge: f32) -> f32 {
    let from_eye: [f32; 3] = std::array::from_fn(|i| center[i] - eye.eye_in_head[i]);
    let [x, y, z, _] = eye.row_w.map(f32::abs);
    let depth = nearest_depth(view, eye, center, [0.5 * edge; 3], 0.5 * edge * (x + y + z));
    let edge_px = edge * eye.pixels_per_radian / depth;
    edge_px / threshold_px(view, eye.gaze_in_head, from_eye, CUBE_RADIUS * edge)
}

fn threshold_px(view: &ViewUniform, gaze: [f32; 3], center: [f32; 3], radius: f32) -> f32 {
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let along = dot(center, gaze);
    let across = (dot(center, center) - along * along).max(0.0).sqrt();
    let outside = |ring: usize| across * view.ring_cos[ring] - along * view.ring_sin[ring];
    let (outside_inner, outside_middle) = (outside(0), outside(1));
    let [first, second, third] = view.threshold_px;
    if outside_inner <= radius {
        return first;
    }
    if outside_middle > radius {
        return third;
    }
    if view.flags & LOD_SMOOTH == 0 {
        return second;
    }
    let share = (outside_inner - radius) / (outside_inner - outside_middle);
    first + (third - first) * share.min(1.0)
}

/// State of a node of which this share of the points is drawn, 0 to 1, and at least one point.
fn state_of(share: f32) -> u32 {
    if share >= 1.0 {
        return DRAWN_WHOLE;
    }
    ((share * STATE_PARTS as f32) as u32).min(STATE_PARTS - 1) << STATE_SHIFT | STATE_LOW
}

// lod: which nodes are large enough, in either eye, for where the eye looks, and how much of each is drawn?
// One thread a node. [2022 §3.7]; docs/FRAME.md §4.
//
// Size and ring are judged by the cube's nearest point and by its sphere, so that a node is never judged smaller or
// further out than a node within it: what is drawn is a tree. The nearest point is the one with the least depth, as in
// cull's precision: an edge across the view is as many pixels long as it has pixels per radian over depth, which away
// from the optical axis is less than distance.

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<storage, read> nodes: array<GpuNode>;
@group(0) @binding(2) var<storage, read_write> states: array<u32>;
@group(0) @binding(3) var<storage, read_write> counted: array<u32>;

// Pixels that the edge of a cube needs round `center` (from the eye), by its distance from the gaze.
fn threshold_px(gaze: vec3<f32>, center: vec3<f32>, radius: f32) -> f32 {
    let along = center.x * gaze.x + center.y * gaze.y + center.z * gaze.z;
    let distance_sq = center.x * center.x + center.y * center.y + center.z * center.z;
    let across = sqrt(max(distance_sq - along * along, 0.0));
    // How far the sphere's center lies outside the rings' cones.
    let outside_inner = across * view.ring_cos.x - along * view.ring_sin.x;
    let outside_middle = across * view.ring_cos.y - along * view.ring_sin.y;
    if outside_inner <= radius {
        return view.threshold_px.x;
    }
    if outside_middle > radius {
        return view.threshold_px.z;
    }
    if (view.flags & LOD_SMOOTH) == 0u {
        return view.threshold_px.y;
    }
    // From the first threshold to the third. Both differences are positive here, the second the larger.
    let share = (outside_inner - radius) / (outside_inner - outside_middle);
    return view.threshold_px.x + (view.threshold_px.z - view.threshold_px.x) * min(share, 1.0);
}

// Projected edge as a multiple of its threshold.
fn importance(eye: EyeUniform, center: vec3<f32>, edge: f32) -> f32 {
    let from_eye = center - eye.eye_in_head;
    // This is written as one product, since compilers would make it one, and the CPU reference must match.
    let reach = 0.5 * edge * (abs(eye.row_w.x) + abs(eye.row_w.y) + abs(eye.row_w.z));
    let depth = nearest_depth(eye, center, vec3<f32>(0.5 * edge), reach);
    let edge_px = edge * eye.pixels_per_radian / depth;
    return edge_px / threshold_px(eye.gaze_in_head, from_eye, CUBE_RADIUS * edge);
}

// A share, 0 to 1, of all points as a node's state; at least one point is drawn.
fn state_of(share: f32) -> u32 {
    if share >= 1.0 {
        return DRAWN_WHOLE;
    }
    return (min(u32(share * f32(STATE_PARTS)), STATE_PARTS - 1u) << STATE_SHIFT) | STATE_LOW;
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&nodes) {
        return;
    }
    // `cull`, which comes next, counts nodes from 0.
    counted[id.x] = 0u;
    let node = nodes[id.x];
    if (node.flags & NODE_RESIDENT) == 0u {
        states[id.x] = 0u;
        return;
    }
    if (node.flags & NODE_WHOLE) != 0u {
        states[id.x] = DRAWN_WHOLE;
        return;
    }
    let center = vec3<f32>(0.5 * node.edge) - (view.head_hi - node.min_hi) - (view.head_lo - node.min_lo);
    var largest = importance(view.eyes[0], center, node.edge);
    if NUM_EYES == 2u {
        largest = max(largest, importance(view.eyes[1], center, node.edge));
    }
    var state = 0u;
    if (node.flags & NODE_ROOT) != 0u {
        // The root is always drawn; once it is small, with points by its area, or a pixel would get too many.
        state = state_of(largest * largest);
    } else if (view.flags & LOD_FADE) != 0u {
        if largest > FADE_BEGIN {
            state = state_of((largest - FADE_BEGIN) / (FADE_END - FADE_BEGIN));
        }
    } else if largest >= select(1.0, HYSTERESIS, states[id.x] != 0u) {
        state = DRAWN_WHOLE;
    }
    states[id.x] = state;
}

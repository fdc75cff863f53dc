// cull: which batches of the nodes that `lod` chose does either eye see, at which precision, and where are they
// in head space? One thread a batch. [2022 §3.2, 3.3]; docs/FRAME.md §2 to §4.

@group(0) @binding(1) var<storage, read> batches: array<GpuBatch>;
@group(0) @binding(2) var<storage, read> nodes: array<GpuNode>;
@group(0) @binding(3) var<storage, read> states: array<u32>;

// The widest square that a point is to close, in each ring, of a box whose edge is drawn this large: see `open_px`, in
// which the edge counts at most twice. `far` is the distance of its farthest corner over its least depth.
fn widest_open_px(eye: EyeUniform, edge_px: f32, far: f32, widest: f32, sample_spacing: f32) -> vec3<f32> {
    let stretch = min(far, 1.0 / eye.widest_cos);
    let undivided_px = min(vec3<f32>(2.0 * edge_px), view.undivided_px);
    return stretch * max(vec3<f32>(widest * edge_px), SAMPLES_COVER * sample_spacing * undivided_px);
}

// The largest of a node's eight shares.
fn widest(spacing: vec4<u32>) -> f32 {
    let a = max(unpack2x16float(spacing.x), unpack2x16float(spacing.y));
    let b = max(unpack2x16float(spacing.z), unpack2x16float(spacing.w));
    let widest = max(a, b);
    return max(widest.x, widest.y);
}

// How far apart a node's samples lie, as a share of its edge: further if only a part of the root's samples is drawn.
fn spacing_drawn(node: GpuNode, drawn: u32) -> f32 {
    if (node.flags & NODE_ROOT) == 0u || drawn == DRAWN_WHOLE {
        return node.sample_spacing;
    }
    return node.sample_spacing / sqrt(f32((drawn >> STATE_SHIFT) + 1u) / f32(STATE_PARTS));
}

// State of the child in each octant, in OWN_BITS; OWN_NONE where there is none, 0 where it is not on the GPU.
fn own_colors(node: GpuNode) -> vec2<u32> {
    var own = vec2<u32>(0u);
    for (var octant = 0u; octant < 8u; octant += 1u) {
        let child = node.children[octant];
        var drawn = OWN_NONE;
        if child == CHILD_ABSENT {
            drawn = 0u;
        } else if child != NO_CHILD {
            drawn = states[child] >> OWN_SHIFT;
        }
        own[octant / OWN_PER_WORD] |= drawn << (OWN_BITS * (octant % OWN_PER_WORD));
    }
    return own;
}

// Workgroups that draw a batch of points: more than one if its points cover many pixels. A software driver has no use
// for more than one.
fn num_slices_of_points(num_points: u32, radius: f32) -> u32 {
    if radius == 0.0 || !TOGETHER {
        return 1u;
    }
    let side = 2.0 * radius + 1.0;
    let num_turns = (num_points + POINTS_PER_LOAD - 1u) / POINTS_PER_LOAD;
    let most = POINTS_PER_LOAD * ((num_turns + WORKGROUP_SIZE - 1u) / WORKGROUP_SIZE);
    return u32(clamp(f32(num_points) * (side * side) / f32(WIDE_SLICE_PIXELS), 1.0, f32(most)));
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&batches) {
        return;
    }
    let batch = batches[id.x];
    let drawn = states[batch.node];
    // A batch without points has not come yet.
    if drawn == 0u || batch.num_points == 0u {
        return;
    }
    let node = nodes[batch.node];
    let half_edge = batch.cell * HALF_CELLS;
    let head_hi = view.head_hi - batch.min_hi;
    let head_lo = view.head_lo - batch.min_lo;
    let center = half_edge - head_hi - head_lo;

    let longest = 2.0 * max(half_edge.x, max(half_edge.y, half_edge.z));
    let step = node.spacing_step;
    let widest = POINTS_COVER * widest(node.spacing) * (step * step * step);
    let sample_spacing = spacing_drawn(node, drawn);
    var flags = 0u;
    for (var eye = 0u; eye < NUM_EYES; eye += 1u) {
        if is_seen(view.eyes[eye], center, half_edge) {
            flags |= VISIBLE_BY_EYE << eye;
        }
    }
    if flags == 0u {
        return;
    }
    // Both eyes count, whichever sees the batch, so that one eye's picture does not depend on where the other's ends.
    var planes = max(view.forced_planes, COARSE_PLANES);
    var num_slices = 1u;
    for (var eye = 0u; eye < NUM_EYES; eye += 1u) {
        let along = abs(view.eyes[eye].row_w.xyz);
        let reach = along.x * half_edge.x + along.y * half_edge.y + along.z * half_edge.z;
        let depth = nearest_depth(view.eyes[eye], center, half_edge, reach);
        let edge_px = longest * view.eyes[eye].pixels_per_radian / depth;
        if view.forced_planes == 0u {
            planes = max(planes, planes_needed(edge_px));
        }
        let corner = abs(center - view.eyes[eye].eye_in_head) + half_edge;
        let far = sqrt(corner.x * corner.x + corner.y * corner.y + corner.z * corner.z) / depth;
        let open_px = widest_open_px(view.eyes[eye], edge_px, far, widest, sample_spacing);
        // False if no point is to close more than its ring's kernel does.
        if any(open_px > (1.0 - CULL_SLACK) * view.fill_reach_px) {
            flags |= VISIBLE_FILL;
        }
        let radius = radius_of((1.0 + CULL_SLACK) * max(open_px.x, max(open_px.y, open_px.z)));
        if radius > f32(OWN_FILL_RADIUS) {
            flags |= VISIBLE_WIDE;
        }
        num_slices = max(num_slices, num_slices_of_points(batch.num_points, radius));
    }

    let head = head_place(head_hi, head_lo, batch.cell, batch.steps_per_unit, planes);
    let listed = VisibleBatch(
        head.cell, batch.first_point, head.offset, batch.num_points, batch.cell, flags | planes, node.spacing,
        own_colors(node), drawn, node.spacing_step, sample_spacing, 0u, vec2<u32>(0u),
    );
    show(listed, batch.node, num_slices, arrayLength(&batches));
}

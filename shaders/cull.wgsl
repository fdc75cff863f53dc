// cull: which batches of the nodes that `lod` chose does either eye see, at which precision, and where are they
// in head space? One thread a batch. [2022 §3.2, 3.3]; docs/FRAME.md §2 to §4.

struct CullCounters {
    num_visible: atomic<u32>,
    workgroups_y: u32,
    workgroups_z: u32,
    num_points: atomic<u32>,
    num_nodes: atomic<u32>,
    num_extra: atomic<u32>,
    reserved: vec2<u32>,
}

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<storage, read> batches: array<Batch>;
@group(0) @binding(2) var<storage, read> nodes: array<Node>;
@group(0) @binding(3) var<storage, read> states: array<u32>;
@group(0) @binding(4) var<storage, read_write> visible: array<VisibleBatch>;
@group(0) @binding(5) var<storage, read_write> counters: CullCounters;
// Nodes that are among those of `counters.num_nodes` already: one may have several batches, in several chunks.
@group(0) @binding(6) var<storage, read_write> counted: array<atomic<u32>>;

/// Half as many cells as a box edge has.
const HALF_CELLS: f32 = 0.5 * CELLS;

// True unless the box is certainly outside. The terms are added in the twin's order.
fn in_front(plane: vec4<f32>, center: vec3<f32>, half_edge: vec3<f32>) -> bool {
    let n = abs(plane);
    let c = abs(center);
    let distance = plane.x * center.x + plane.y * center.y + plane.z * center.z + plane.w;
    let radius = n.x * half_edge.x + n.y * half_edge.y + n.z * half_edge.z;
    let magnitude = n.x * c.x + n.y * c.y + n.z * c.z + n.w;
    return distance + radius + CULL_SLACK * magnitude >= 0.0;
}

// Discs of points beyond the image reach into it.
fn in_frustum(eye: EyeUniform, center: vec3<f32>, half_edge: vec3<f32>) -> bool {
    let first = eye.first_px - view.margin_px;
    let end = eye.end_px + view.margin_px;
    return in_front(eye.row_w - vec4<f32>(0.0, 0.0, 0.0, view.near), center, half_edge)
        && in_front(eye.row_x - eye.row_w * first.x, center, half_edge)
        && in_front(eye.row_w * end.x - eye.row_x, center, half_edge)
        && in_front(eye.row_y - eye.row_w * first.y, center, half_edge)
        && in_front(eye.row_w * end.y - eye.row_y, center, half_edge);
}

// Planes that a box whose edge is drawn so large asks for: 1 below the first threshold, 2 below the second, else 3.
fn planes_needed(edge_px: f32) -> u32 {
    if edge_px < PRECISION_THRESHOLD_PX {
        return 1u;
    }
    return select(3u, 2u, edge_px < FINE_THRESHOLD_PX);
}

// The widest square in each ring that a point of a box is to close whose edge is drawn so large: see `open_px`, in which the
// edge counts at most twice. `far` is the distance of its farthest corner over its least depth.
fn widest_open_px(eye: EyeUniform, edge_px: f32, far: f32, widest: f32, sample_spacing: f32) -> vec3<f32> {
    let stretch = min(far, 1.0 / eye.widest_cos);
    let undivided_px = min(vec3<f32>(2.0 * edge_px), view.undivided_px);
    return stretch * max(vec3<f32>(widest * edge_px), SAMPLES_COVER * sample_spacing * undivided_px);
}

// Radians that the tolerance spans in the outer ring.
fn outer_tolerance_rad(eye: EyeUniform) -> f32 {
    return eye.tolerance_rad + eye.tolerance_growth * (view.ring_cos.x - view.ring_cos.y);
}

// The most that the tolerance grows by on a way of length 1: see Detail::tolerance_growth.
fn steepest_tolerance(eye: EyeUniform) -> f32 {
    let cos = view.ring_cos;
    let steepness = sqrt(max(cos.x * cos.x + 1.0 - 2.0 * cos.x * cos.y, 0.0));
    return max(eye.tolerance_rad + eye.tolerance_growth * steepness, outer_tolerance_rad(eye));
}

// False if no disc of a batch is drawn: none has the tolerances that the eye has there, or all show it their backs.
// [SPT §3.7, 3.10]
fn is_needed(batch: Batch, node: Node, number: u32, center: vec3<f32>, half_edge: vec3<f32>) -> bool {
    if (node.flags & NODE_DISCS) == 0u {
        return true;
    }
    let eye = view.eyes[number];
    let from_eye = center - eye.eye_in_head;
    let near = max(abs(from_eye) - half_edge, vec3<f32>(0.0));
    let far = abs(from_eye) + half_edge;
    let nearest = sqrt(near.x * near.x + near.y * near.y + near.z * near.z);
    let farthest = sqrt(far.x * far.x + far.y * far.y + far.z * far.z);
    let radius = sqrt(half_edge.x * half_edge.x + half_edge.y * half_edge.y + half_edge.z * half_edge.z);
    // The tolerance in the box, at least and at most: by its ends, and by what it may change from the centre on.
    let change = steepest_tolerance(eye) * radius;
    let middle = tolerance_of(number, from_eye.x, from_eye.y, from_eye.z);
    let least = max(eye.tolerance_rad * nearest, middle - change);
    let most = min(outer_tolerance_rad(eye) * farthest, middle + change);
    let slack = CULL_SLACK * outer_tolerance_rad(eye) * farthest;
    if step_below(max(least - slack, 0.0)) >= batch.interval >> UNTIL_SHIFT
        || step_below(most + slack) < (batch.interval & STEP_MASK) {
        return false;
    }
    if (node.flags & NODE_ONE_SIDED) == 0u {
        return true;
    }
    // A sphere round the box lies in the cone of directions in which only backs are seen.
    let behind = bitcast<vec4<f32>>(node.spacing);
    let along = from_eye.x * behind.x + from_eye.y * behind.y + from_eye.z * behind.z;
    let distance_sq = from_eye.x * from_eye.x + from_eye.y * from_eye.y + from_eye.z * from_eye.z;
    let across = sqrt(max(distance_sq - along * along, 0.0));
    let inside = along * behind.w - across * sqrt(1.0 - behind.w * behind.w);
    return inside < radius + CULL_SLACK * sqrt(distance_sq);
}

// The largest of a node's eight shares.
fn widest(spacing: vec4<u32>) -> f32 {
    let a = max(unpack2x16float(spacing.x), unpack2x16float(spacing.y));
    let b = max(unpack2x16float(spacing.z), unpack2x16float(spacing.w));
    let widest = max(a, b);
    return max(widest.x, widest.y);
}

// How far apart a node's samples lie, as a share of its edge: further where the root is drawn with a part of them.
fn spacing_drawn(node: Node, drawn: u32) -> f32 {
    if (node.flags & NODE_ROOT) == 0u || drawn == DRAWN_WHOLE {
        return node.sample_spacing;
    }
    return node.sample_spacing / sqrt(f32((drawn >> STATE_SHIFT) + 1u) / f32(STATE_PARTS));
}

// State of the child in each octant, in OWN_BITS; OWN_NONE where there is none, 0 where it is not on the GPU.
fn own_colors(node: Node) -> vec2<u32> {
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

// Workgroups that draw a batch of triangles: more than one where one of them may cover many pixels. The longest side
// says how many.
fn num_slices_of_triangles(batch: Batch, eye: EyeUniform, depth: f32) -> u32 {
    let side_px = length_of(batch.interval >> UNTIL_SHIFT) * eye.pixels_per_radian / depth;
    let num_pixels = min(side_px * side_px, f32(eye.width) * f32(eye.height));
    return u32(clamp(num_pixels / f32(SLICE_PIXELS), 1.0, f32(MAX_SLICES)));
}

// Workgroups that draw a batch of points: more than one where points cover many pixels. A software driver has no use for more.
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
        let is_seen = (view.flags & KEEP_UNSEEN) != 0u || in_frustum(view.eyes[eye], center, half_edge);
        if is_seen && (!DISCS || is_needed(batch, node, eye, center, half_edge)) {
            flags |= VISIBLE_BY_EYE << eye;
        }
    }
    if flags == 0u {
        return;
    }
    // Both eyes count, whichever sees it: what one eye's picture shows does not depend on where the other's ends.
    var planes = max(view.forced_planes, 1u);
    var num_slices = 1u;
    for (var eye = 0u; eye < NUM_EYES; eye += 1u) {
        let along = abs(view.eyes[eye].row_w.xyz);
        let reach = along.x * half_edge.x + along.y * half_edge.y + along.z * half_edge.z;
        let depth = nearest_depth(view.eyes[eye], center, half_edge, reach);
        let edge_px = longest * view.eyes[eye].pixels_per_radian / depth;
        if view.forced_planes == 0u {
            planes = max(planes, planes_needed(edge_px));
        }
        if DISCS && (node.flags & NODE_TRIANGLES) != 0u {
            num_slices = max(num_slices, num_slices_of_triangles(batch, view.eyes[eye], depth));
            continue;
        }
        if DISCS && (node.flags & NODE_DISCS) != 0u {
            flags |= VISIBLE_FILL | VISIBLE_WIDE | VISIBLE_DISCS;
            continue;
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
    if DISCS && (node.flags & NODE_TRIANGLES) != 0u {
        flags |= VISIBLE_TRIANGLES;
        // Corners are where those of the batches beside put them: half a pixel away there would be gaps.
        planes = 3u;
    }

    // The head's cell, in coarse steps: step and cell have 12 bits each, so their product is exact.
    let limit = vec3<f32>(f32(HEAD_CELL_LIMIT / HEAD_CELL_STEP));
    let steps = clamp(round(head_hi * batch.steps_per_unit), -limit, limit);
    let head_cell = vec3<i32>(steps) * HEAD_CELL_STEP;
    var offset = vec3<f32>(head_cell) * batch.cell - head_hi - head_lo;
    if planes == 3u {
        offset += 0.5 * batch.cell;
    }

    if num_slices > 1u {
        let room = min(MAX_EXTRA_SLICES, arrayLength(&visible) - arrayLength(&batches));
        let num_taken = min(atomicAdd(&counters.num_extra, num_slices - 1u), room);
        num_slices = 1u + min(num_slices - 1u, room - num_taken);
    }
    let slot = atomicAdd(&counters.num_visible, num_slices);
    atomicAdd(&counters.num_points, batch.num_points);
    if atomicExchange(&counted[batch.node], 1u) == 0u {
        atomicAdd(&counters.num_nodes, 1u);
    }
    let own = own_colors(node);
    for (var slice = 0u; slice < num_slices; slice += 1u) {
        let of_slice = (slice << SLICE_SHIFT) | ((num_slices - 1u) << NUM_SLICES_SHIFT);
        visible[slot + slice] = VisibleBatch(
            head_cell, batch.first_point, offset, batch.num_points, batch.cell, flags | planes | of_slice,
            node.spacing, own, drawn, id.x, vec2<u32>(0u), node.spacing_step, sample_spacing,
        );
    }
}

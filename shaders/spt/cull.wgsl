// cull of a sequential point tree: which batches have discs or triangles that either eye's tolerance draws, at which
// precision, and where are they in head space? One thread a batch. [SPT §3.7, 3.8, 3.10]

@group(0) @binding(1) var<storage, read> batches: array<DiscBatch>;
@group(0) @binding(2) var<storage, read> runs: array<Run>;

// Radians that the tolerance spans in the outer ring.
fn outer_tolerance_rad(eye: u32) -> f32 {
    return tree.tolerance_rad[eye] + tree.tolerance_growth[eye] * (view.ring_cos.x - view.ring_cos.y);
}

// The most that the tolerance grows by on a way of length 1: see TreeUniform.
fn steepest_tolerance(eye: u32) -> f32 {
    let cos = view.ring_cos;
    let steepness = sqrt(max(cos.x * cos.x + 1.0 - 2.0 * cos.x * cos.y, 0.0));
    return max(tree.tolerance_rad[eye] + tree.tolerance_growth[eye] * steepness, outer_tolerance_rad(eye));
}

// False if no disc of a batch is drawn: none has the tolerances that the eye has there, or all show it their backs.
// [SPT §3.7, 3.10]
fn is_needed(batch: DiscBatch, run: Run, eye: u32, center: vec3<f32>, half_edge: vec3<f32>) -> bool {
    let from_eye = center - view.eyes[eye].eye_in_head;
    let near = max(abs(from_eye) - half_edge, vec3<f32>(0.0));
    let far = abs(from_eye) + half_edge;
    let nearest = sqrt(near.x * near.x + near.y * near.y + near.z * near.z);
    let farthest = sqrt(far.x * far.x + far.y * far.y + far.z * far.z);
    let radius = sqrt(half_edge.x * half_edge.x + half_edge.y * half_edge.y + half_edge.z * half_edge.z);
    // The tolerance in the box, at least and at most: by the box's ends, and by what it may change from the center on.
    let change = steepest_tolerance(eye) * radius;
    let middle = tolerance_of(eye, from_eye.x, from_eye.y, from_eye.z);
    let least = max(tree.tolerance_rad[eye] * nearest, middle - change);
    let most = min(outer_tolerance_rad(eye) * farthest, middle + change);
    let slack = CULL_SLACK * outer_tolerance_rad(eye) * farthest;
    if step_below(max(least - slack, 0.0)) >= batch.interval >> UNTIL_SHIFT
        || step_below(most + slack) < (batch.interval & STEP_MASK) {
        return false;
    }
    if (run.flags & RUN_ONE_SIDED) == 0u {
        return true;
    }
    // A sphere round the box lies in the cone of directions in which only backs are seen.
    let behind = run.behind;
    let along = from_eye.x * behind.x + from_eye.y * behind.y + from_eye.z * behind.z;
    let distance_sq = from_eye.x * from_eye.x + from_eye.y * from_eye.y + from_eye.z * from_eye.z;
    let across = sqrt(max(distance_sq - along * along, 0.0));
    let inside = along * behind.w - across * sqrt(1.0 - behind.w * behind.w);
    return inside < radius + CULL_SLACK * sqrt(distance_sq);
}

// Workgroups that draw a batch of triangles: more than one if a triangle may cover many pixels, which the longest side
// tells.
fn num_slices_of_triangles(batch: DiscBatch, eye: EyeUniform, depth: f32) -> u32 {
    let side_px = length_of(batch.interval >> UNTIL_SHIFT) * eye.pixels_per_radian / depth;
    let num_pixels = min(side_px * side_px, f32(eye.width) * f32(eye.height));
    return u32(clamp(num_pixels / f32(SLICE_PIXELS), 1.0, f32(MAX_SLICES)));
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&batches) {
        return;
    }
    let batch = batches[id.x];
    let run = runs[batch.run];
    let half_edge = batch.cell * HALF_CELLS;
    let head_hi = view.head_hi - batch.min_hi;
    let head_lo = view.head_lo - batch.min_lo;
    let center = half_edge - head_hi - head_lo;

    var flags = 0u;
    for (var eye = 0u; eye < NUM_EYES; eye += 1u) {
        if is_seen(view.eyes[eye], center, half_edge) && is_needed(batch, run, eye, center, half_edge) {
            flags |= VISIBLE_BY_EYE << eye;
        }
    }
    if flags == 0u {
        return;
    }
    let is_of_triangles = (run.flags & RUN_TRIANGLES) != 0u;
    flags |= select(VISIBLE_FILL | VISIBLE_WIDE | VISIBLE_DISCS, VISIBLE_TRIANGLES, is_of_triangles);
    // Both eyes count, whichever sees the batch, so that one eye's picture does not depend on where the other's ends.
    let longest = 2.0 * max(half_edge.x, max(half_edge.y, half_edge.z));
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
        if is_of_triangles {
            num_slices = max(num_slices, num_slices_of_triangles(batch, view.eyes[eye], depth));
        }
    }
    if is_of_triangles {
        // Corners are where the batches beside put theirs: half a pixel of difference would leave gaps.
        planes = ALL_PLANES;
    }

    let head = head_place(head_hi, head_lo, batch.cell, batch.steps_per_unit, planes);
    let listed = VisibleBatch(
        head.cell, batch.first_point, head.offset, batch.num_points, batch.cell, flags | planes, vec4<u32>(0u),
        vec2<u32>(OWN_NONE_WORD), DRAWN_WHOLE, 1.0, 0.0, 0u, vec2<u32>(0u),
    );
    show(listed, batch.run, num_slices, arrayLength(&batches));
}

// What every cull needs: frustum, precision, and the list of visible batches.
// [2022 §3.2, 3.3]; docs/FRAME.md §2, §3.

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
@group(0) @binding(4) var<storage, read_write> visible: array<VisibleBatch>;
@group(0) @binding(5) var<storage, read_write> counters: CullCounters;
// Nodes that are counted in `counters.num_nodes` already: a node may have several batches, in several chunks.
@group(0) @binding(6) var<storage, read_write> counted: array<atomic<u32>>;

/// Half the number of cells that a box edge has.
const HALF_CELLS: f32 = 0.5 * CELLS;

// False only if the box is certainly outside. The terms are added in the CPU reference's order.
fn in_front(plane: vec4<f32>, center: vec3<f32>, half_edge: vec3<f32>) -> bool {
    let n = abs(plane);
    let c = abs(center);
    let distance = plane.x * center.x + plane.y * center.y + plane.z * center.z + plane.w;
    let radius = n.x * half_edge.x + n.y * half_edge.y + n.z * half_edge.z;
    let magnitude = n.x * c.x + n.y * c.y + n.z * c.z + n.w;
    return distance + radius + CULL_SLACK * magnitude >= 0.0;
}

// True unless the box is certainly outside the frustum, widened by how far splats of points beyond the image reach into
// it.
fn in_frustum(eye: EyeUniform, center: vec3<f32>, half_edge: vec3<f32>) -> bool {
    let first = eye.first_px - view.margin_px;
    let end = eye.end_px + view.margin_px;
    return in_front(eye.row_w - vec4<f32>(0.0, 0.0, 0.0, view.near), center, half_edge)
        && in_front(eye.row_x - eye.row_w * first.x, center, half_edge)
        && in_front(eye.row_w * end.x - eye.row_x, center, half_edge)
        && in_front(eye.row_y - eye.row_w * first.y, center, half_edge)
        && in_front(eye.row_w * end.y - eye.row_y, center, half_edge);
}

// Planes to read of a box whose edge is drawn this large.
fn planes_needed(edge_px: f32) -> u32 {
    if edge_px < PRECISION_THRESHOLD_PX {
        return COARSE_PLANES;
    }
    return select(ALL_PLANES, MIDDLE_PLANES, edge_px < FINE_THRESHOLD_PX);
}

// Where the head is among a batch's cells; see VisibleBatch.
struct HeadPlace {
    cell: vec3<i32>,
    offset: vec3<f32>,
}

// The head's cell, in coarse steps: step and cell have 12 bits each, so their product is exact.
fn head_place(head_hi: vec3<f32>, head_lo: vec3<f32>, cell: vec3<f32>, steps_per_unit: vec3<f32>, planes: u32) -> HeadPlace {
    let limit = vec3<f32>(f32(HEAD_CELL_LIMIT / HEAD_CELL_STEP));
    let steps = clamp(round(head_hi * steps_per_unit), -limit, limit);
    let head_cell = vec3<i32>(steps) * HEAD_CELL_STEP;
    var offset = vec3<f32>(head_cell) * cell - head_hi - head_lo;
    if planes == ALL_PLANES {
        offset += 0.5 * cell;
    }
    return HeadPlace(head_cell, offset);
}

// Adds a batch of a node to the list of visible ones, which holds at most `num_batches` without extra slices, in as
// many slices as there is room for.
fn show(batch: VisibleBatch, node: u32, wanted_slices: u32, num_batches: u32) {
    var num_slices = wanted_slices;
    if num_slices > 1u {
        let room = min(MAX_EXTRA_SLICES, arrayLength(&visible) - num_batches);
        let num_taken = min(atomicAdd(&counters.num_extra, num_slices - 1u), room);
        num_slices = 1u + min(num_slices - 1u, room - num_taken);
    }
    let slot = atomicAdd(&counters.num_visible, num_slices);
    atomicAdd(&counters.num_points, batch.num_points);
    if atomicExchange(&counted[node], 1u) == 0u {
        atomicAdd(&counters.num_nodes, 1u);
    }
    for (var slice = 0u; slice < num_slices; slice += 1u) {
        let of_slice = (slice << SLICE_SHIFT) | ((num_slices - 1u) << NUM_SLICES_SHIFT);
        visible[slot + slice] = VisibleBatch(
            batch.head_cell, batch.first_point, batch.offset, batch.num_points, batch.cell, batch.flags | of_slice,
            batch.spacing, batch.own, batch.drawn, batch.spacing_step, batch.sample_spacing, 0u, vec2<u32>(0u),
        );
    }
}

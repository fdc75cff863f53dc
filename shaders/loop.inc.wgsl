// The loop of the geometry stages: a workgroup a visible batch, each point read once and put into both eyes' pixels. A
// batch of wide points comes in slices, a workgroup each. A workgroup draws its share of the parts: a part is a turn of
// every thread, or, if there are more slices than that, one point of such a turn.
//
// A stage adds its targets from binding 5 on, and what it does with a point in a pixel of an eye, 0 or 1:
//   fn put(eye: u32, pixel: u32, w: f32, id: u32)

// Number of this thread in its workgroup.
var<private> this_thread: u32;

fn of_ring(ring: u32, values: vec3<f32>) -> f32 {
    return select(select(values.z, values.y, ring == 1u), values.x, ring == 0u);
}

/// The place of a float's exponent.
const EXPONENT_SHIFT: u32 = 23u;

// The edge of the finest nodes that are drawn whole where a point of a node with this edge lies: edges halve from level
// to level, and the finest is more than half of `undivided_px`. While nodes below these fade in, with SAMPLES_BELOW times
// as many samples, samples lie less far apart, and the edge is shorter by as much.
fn open_edge_px(edge_px: f32, undivided_px: f32) -> f32 {
    let larger = bitcast<u32>(max(edge_px, undivided_px)) >> EXPONENT_SHIFT;
    let octaves = larger - (bitcast<u32>(undivided_px) >> EXPONENT_SHIFT);
    let near_px = bitcast<f32>(bitcast<u32>(edge_px) - (octaves << EXPONENT_SHIFT));
    let whole_px = near_px * select(select(1.0, 0.5, near_px > undivided_px), 2.0, near_px <= 0.5 * undivided_px);
    if (view.flags & LOD_FADE) == 0u {
        return whole_px;
    }
    let below = FADE_END * whole_px / undivided_px;
    let share = clamp((below - FADE_BEGIN) / (FADE_END - FADE_BEGIN), 0.0, 1.0);
    return whole_px / sqrt(1.0 + (SAMPLES_BELOW - 1.0) * share);
}

// Width in pixels of the square that a point is to close: by its distance from others, `spacing` world units, and by
// what level of detail leaves open, a share of the finest nodes' edge. Away from the optical axis a length along the
// radius is longer in pixels than one across, by distance over depth. The terms are added in the CPU reference's order.
fn open_px(eye: u32, batch: VisibleBatch, p_in_head: vec3<f32>, w: f32, spacing: f32) -> f32 {
    let gaze = view.eyes[eye].gaze_in_head;
    let p = p_in_head - view.eyes[eye].eye_in_head;
    let distance_sq = p.x * p.x + p.y * p.y + p.z * p.z;
    let ring = ring_of(p.x * gaze.x + p.y * gaze.y + p.z * gaze.z, distance_sq);
    let per_w = 1.0 / w;
    let px_per_unit = view.eyes[eye].pixels_per_radian * per_w;
    let stretch = sqrt(distance_sq) * per_w;
    let edge = CELLS * max(batch.cell.x, max(batch.cell.y, batch.cell.z));
    let edge_px = open_edge_px(edge * px_per_unit, of_ring(ring, view.undivided_px));
    let apart_px = batch.sample_spacing * edge_px * stretch;
    let samples_px = min(SAMPLES_COVER * apart_px, max(FILL_OVERLAP * apart_px, view.fill_reach_px.z));
    return max(cover_px(spacing * px_per_unit * stretch, of_ring(ring, view.fill_reach_px)), samples_px);
}

fn draw(eye: u32, batch: VisibleBatch, points: Turn, spacing: vec4<f32>) {
    var p = seen(eye, batch, points);
    let id = points.id;
    if FILL && (batch.flags & VISIBLE_FILL) != 0u {
        let is_there = p.w > vec4<f32>(0.0);
        var radius = vec4<f32>(0.0);
        for (var i = 0u; i < POINTS_PER_TURN; i += 1u) {
            let p_in_head = vec3<f32>(points.x[i], points.y[i], points.z[i]);
            let open_px = open_px(eye, batch, p_in_head, p.w[i], spacing[i]);
            radius[i] = select(0.0, radius_of(open_px), is_there[i]);
            p.w[i] = bitcast<f32>(bitcast<u32>(p.w[i]) | reach_of(open_px));
        }
        if any(radius > vec4<f32>(0.0)) {
            for (var i = 0u; i < POINTS_PER_TURN; i += 1u) {
                if is_there[i] {
                    put_wide(eye, vec2<f32>(p.x[i], p.y[i]), p.w[i], id[i], radius[i]);
                }
            }
            return;
        }
    }
    put_turn(eye, p, id);
}

fn draw_batch(batch: VisibleBatch) {
    let num_turns = (batch.num_points + POINTS_PER_TURN - 1u) / POINTS_PER_TURN;
    let stays = stays(batch);
    let num_slices = num_slices_of(batch);
    let num_whole = (num_turns + WORKGROUP_SIZE - 1u) / WORKGROUP_SIZE;
    let parts_per_turn = select(1u, POINTS_PER_TURN, num_slices > num_whole);

    for (var part = slice_of(batch); part < parts_per_turn * num_whole; part += num_slices) {
        let own_turn = part / parts_per_turn * WORKGROUP_SIZE + this_thread;
        if !stays && own_turn >= num_turns {
            break;
        }
        let turn = min(own_turn, num_turns - 1u);
        var points = points_of(batch, turn);
        points.exists = points.exists & vec4<bool>(own_turn < num_turns);
        if parts_per_turn > 1u {
            points.exists = points.exists & (vec4<u32>(0u, 1u, 2u, 3u) == vec4<u32>(part % parts_per_turn));
        }
        var spacing = vec4<f32>(0.0);
        if FILL && (batch.flags & VISIBLE_FILL) != 0u {
            let edge = CELLS * max(batch.cell.x, max(batch.cell.y, batch.cell.z));
            spacing = spacings(batch, points.at, points.octant, edge);
        }
        if sees(0u, batch) {
            draw(0u, batch, points, spacing);
            if stays {
                put_waiting(0u);
            }
        }
        if NUM_EYES == 2u && sees(1u, batch) {
            draw(1u, batch, points, spacing);
            if stays {
                put_waiting(1u);
            }
        }
    }
}

// Triangles of meshes, beside the discs of a sequential point tree. [SPT §3.8] Their corners are the batch's points;
// the word beside point i is triangle i: corner | corner≪8 | corner≪16 | step of its longest side≪24.
//
// A pixel belongs to a triangle if its center does, or lies less than TRIANGLE_SLACK_PX beside it. Edge functions are
// of homogeneous coordinates, so that triangles need not be clipped at the near plane. [1997]
//
// A thread draws a triangle; large ones wait until all threads draw them together. If threads ask each other
// (CONVERGED), all triangles wait. If some may be larger still, a batch comes in slices: each is a workgroup that draws
// its share of the pixels of the large ones.

/// Pixels in the box of a triangle that a thread draws alone.
const OWN_PIXELS: i32 = 64;

struct Triangle {
    /// The corners' pixel coordinates times w, and w.
    x: vec3<f32>,
    y: vec3<f32>,
    w: vec3<f32>,
    /// How far below 0 the edge functions may be.
    slack: vec3<f32>,
    /// The pixels to look at, both included; none if the triangle is not drawn.
    first: vec2<i32>,
    last: vec2<i32>,
    /// Numbers in the chunk of the corners' points.
    points: vec3<u32>,
}

/// Triangles that all threads are to draw together, by their numbers in the batch.
var<workgroup> waiting: array<u32, WORKGROUP_SIZE>;
var<workgroup> num_waiting: atomic<u32>;

/// The triangle that an odd id is of, for `put`: its corners' points, and their shares of the pixel.
var<private> mixed_points: vec3<u32>;
var<private> mixed_shares: vec3<f32>;

fn word_of(point: u32) -> u32 {
    return shapes[point / POINTS_PER_LOAD][point % POINTS_PER_LOAD];
}

// A corner's position in head space. Batches of triangles are always read at 30 bits.
fn corner_in_head(batch: VisibleBatch, point: u32) -> vec3<f32> {
    let load = point / POINTS_PER_LOAD;
    let lane = point % POINTS_PER_LOAD;
    let shift = vec3<u32>(0u, Y_SHIFT, Z_SHIFT);
    let hi = (vec3<u32>(plane_hi[load][lane]) >> shift) & vec3<u32>(PLANE_MASK);
    let mid = (vec3<u32>(plane_mid[load][lane]) >> shift) & vec3<u32>(PLANE_MASK);
    let lo = (vec3<u32>(plane_lo[load][lane]) >> shift) & vec3<u32>(PLANE_MASK);
    let cells = (hi << vec3<u32>(COARSE_SHIFT)) | (mid << vec3<u32>(MIDDLE_SHIFT)) | lo;
    return vec3<f32>(vec3<i32>(cells) - batch.head_cell) * batch.cell + batch.offset;
}

fn corner_row(r: vec4<f32>, x: vec3<f32>, y: vec3<f32>, z: vec3<f32>) -> vec3<f32> {
    return r.x * x + r.y * y + r.z * z + r.w;
}

// Triangle `number` of the batch as an eye sees it.
fn triangle_of(eye: u32, batch: VisibleBatch, number: u32) -> Triangle {
    var t: Triangle;
    t.last = vec2<i32>(-1);
    if number >= batch.num_points {
        return t;
    }
    let word = word_of(batch.first_point + number);
    let shift = vec3<u32>(0u, SECOND_CORNER_SHIFT, THIRD_CORNER_SHIFT);
    t.points = vec3<u32>(batch.first_point) + ((vec3<u32>(word) >> shift) & vec3<u32>(CORNER_MASK));
    let a = corner_in_head(batch, t.points.x);
    let b = corner_in_head(batch, t.points.y);
    let c = corner_in_head(batch, t.points.z);
    let x = vec3<f32>(a.x, b.x, c.x);
    let y = vec3<f32>(a.y, b.y, c.y);
    let z = vec3<f32>(a.z, b.z, c.z);

    // The least tolerance at a corner.
    let from_eye = view.eyes[eye].eye_in_head;
    let dx = x - from_eye.x;
    let dy = y - from_eye.y;
    let dz = z - from_eye.z;
    let tolerance = min(
        tolerance_of(eye, dx.x, dy.x, dz.x),
        min(tolerance_of(eye, dx.y, dy.y, dz.y), tolerance_of(eye, dx.z, dy.z, dz.z)),
    );
    if step_below(tolerance) >= word >> SIDE_SHIFT {
        return t;
    }

    t.x = corner_row(view.eyes[eye].row_x, x, y, z);
    t.y = corner_row(view.eyes[eye].row_y, x, y, z);
    t.w = corner_row(view.eyes[eye].row_w, x, y, z);
    // An edge function grows by this much a pixel.
    let growth_x = t.x.zxy * t.w.yzx - t.x.yzx * t.w.zxy;
    let growth_y = t.y.zxy * t.w.yzx - t.y.yzx * t.w.zxy;
    t.slack = TRIANGLE_SLACK_PX * sqrt(growth_x * growth_x + growth_y * growth_y);

    let first = view.eyes[eye].first_px;
    let end = view.eyes[eye].end_px;
    if min(t.w.x, min(t.w.y, t.w.z)) > view.near {
        // Centers of pixels lie at halves.
        let u = t.x / t.w - 0.5;
        let v = t.y / t.w - 0.5;
        let low = vec2<f32>(min(u.x, min(u.y, u.z)), min(v.x, min(v.y, v.z))) - TRIANGLE_SLACK_PX;
        let high = vec2<f32>(max(u.x, max(u.y, u.z)), max(v.x, max(v.y, v.z))) + TRIANGLE_SLACK_PX;
        t.first = vec2<i32>(clamp(ceil(low), first, end));
        t.last = vec2<i32>(clamp(floor(high), first - 1.0, end - 1.0));
    } else if max(t.w.x, max(t.w.y, t.w.z)) > view.near {
        t.first = vec2<i32>(first);
        t.last = vec2<i32>(end) - 1;
    }
    return t;
}

fn num_pixels_of(t: Triangle) -> i32 {
    let size = max(t.last - t.first + 1, vec2<i32>(0));
    return size.x * size.y;
}

// Puts a triangle into pixel number `at` of those to look at, if it covers it.
fn put_triangle(eye: u32, t: Triangle, at: i32, exists: bool) {
    let width = max(t.last.x - t.first.x + 1, 1);
    let px = t.first + vec2<i32>(at % width, at / width);
    // The corners seen from the pixel's center, times w.
    let x = t.x - (f32(px.x) + 0.5) * t.w;
    let y = t.y - (f32(px.y) + 0.5) * t.w;
    let edge = x.yzx * y.zxy - x.zxy * y.yzx;
    let is_front = all(edge >= -t.slack);
    let is_back = all(edge <= t.slack);
    // The corners' shares in space, whose sum is not 1 yet: their mean has the pixel's depth.
    let shares = max(select(-edge, edge, is_front), vec3<f32>(0.0));
    let sum = shares.x + shares.y + shares.z;
    let w = without_reach(vec4<f32>((t.w.x * shares.x + t.w.y * shares.y + t.w.z * shares.z) / sum)).x;
    let is_inside = exists && (is_front || is_back) && sum > 0.0 && w > view.near;

    mixed_points = t.points;
    mixed_shares = shares / sum;
    // The corner with the largest share gives the id.
    var point = select(t.points.y, t.points.x, shares.x >= shares.y);
    point = select(t.points.z, point, max(shares.x, shares.y) >= shares.z);
    let corner = px - vec2<i32>(view.eyes[eye].first_px);
    let pixel = u32(corner.y) * view.eyes[eye].width + u32(corner.x);
    put_seen(eye, select(NO_PIXEL, pixel, is_inside), w, (point << ID_SHIFT) | ID_ODD);
}

// Draws a small triangle, by one thread.
fn put_own(eye: u32, t: Triangle, num_pixels: i32) {
    for (var at = 0; at < num_pixels; at += 1) {
        put_triangle(eye, t, at, true);
    }
}

// Draws this thread's pixels of a triangle of which the workgroup draws a slice.
fn put_slice(eye: u32, batch: VisibleBatch, number: u32) {
    let t = triangle_of(eye, batch, number);
    let num_pixels = num_pixels_of(t);
    let first_at = i32(slice_of(batch) * WORKGROUP_SIZE);
    for (var at = first_at; at < num_pixels; at += i32(num_slices_of(batch) * WORKGROUP_SIZE)) {
        let own_at = at + i32(this_thread);
        put_triangle(eye, t, own_at, own_at < num_pixels);
    }
}

fn draw_triangle_each(eye: u32, batch: VisibleBatch, number: u32) {
    let slice = slice_of(batch);
    let own = triangle_of(eye, batch, number);
    let num_own = num_pixels_of(own);
    if !CONVERGED && num_own <= OWN_PIXELS {
        put_own(eye, own, select(0, num_own, slice == 0u));
    } else if num_own > i32(slice * WORKGROUP_SIZE) {
        waiting[atomicAdd(&num_waiting, 1u)] = number;
    }
    workgroupBarrier();
    let num_together = atomicLoad(&num_waiting);
    for (var i = 0u; i < num_together; i += 1u) {
        put_slice(eye, batch, waiting[i]);
    }
    workgroupBarrier();
    if this_thread == 0u {
        atomicStore(&num_waiting, 0u);
    }
    workgroupBarrier();
}

// All threads of the workgroup come here together.
fn draw_triangles(batch: VisibleBatch) {
    for (var first = 0u; first < batch.num_points; first += WORKGROUP_SIZE) {
        for (var eye = 0u; eye < NUM_EYES; eye += 1u) {
            if sees(eye, batch) {
                draw_triangle_each(eye, batch, first + this_thread);
            }
        }
    }
}

// The larger splats of a turn wait until all threads of the workgroup draw them together, with a team for each splat
// and a thread for each pixel: so no thread is held up by a neighbor's large splat, and the pixels that a team looks at
// lie beside each other.

/// Threads that draw a splat together.
const TEAM: u32 = 32u;
/// Is added to the coordinates of a splat's pixel, which may lie left of the image or above it, to make them positive.
const BEFORE_PX: i32 = i32(MAX_FILL_RADIUS);
/// The place of y in a waiting splat's pixel.
const WAITING_Y_SHIFT: u32 = 16u;
const WAITING_X_MASK: u32 = (1u << WAITING_Y_SHIFT) - 1u;

/// Splats that wait: their pixel, x | y≪16, plus BEFORE_PX each; depth; id; radius.
var<workgroup> waiting_splats: array<vec4<u32>, WORKGROUP_SIZE * POINTS_PER_TURN>;
var<workgroup> num_waiting_splats: atomic<u32>;

// True if all threads of the workgroup stay until the last turn of a batch.
fn stays(batch: VisibleBatch) -> bool {
    return (batch.flags & VISIBLE_WIDE) != 0u;
}

// True if a splat that reaches into the image waits.
fn waits(center: vec2<i32>, w: f32, id: u32, radius: i32) -> bool {
    if radius <= i32(OWN_FILL_RADIUS) {
        return false;
    }
    let pixel = vec2<u32>(center + BEFORE_PX);
    let splat = vec4<u32>(pixel.x | (pixel.y << WAITING_Y_SHIFT), bitcast<u32>(w), id, u32(radius));
    waiting_splats[atomicAdd(&num_waiting_splats, 1u)] = splat;
    return true;
}

// Draws this thread's pixels of a splat that waits.
fn put_share(eye: u32, number: u32) {
    let size = vec2<i32>(i32(view.eyes[eye].width), i32(view.eyes[eye].height));
    let splat = waiting_splats[number];
    let radius = i32(splat.w);
    let corner = vec2<i32>(vec2<u32>(splat.x & WAITING_X_MASK, splat.x >> WAITING_Y_SHIFT)) - BEFORE_PX - radius;
    let side = 2 * radius + 1;
    let per_side = 1.0 / f32(side);
    for (var at = i32(this_thread % TEAM); at < side * side; at += i32(TEAM)) {
        // Half a pixel is more than rounding loses.
        let y = i32((f32(at) + 0.5) * per_side);
        let from_corner = vec2<i32>(at - y * side, y);
        let pixel = corner + from_corner;
        let is_inside = all(pixel >= vec2<i32>(0)) && all(pixel < size);
        if is_inside && is_on_splat(from_corner - radius, radius) {
            put(eye, u32(pixel.y * size.x + pixel.x), bitcast<f32>(splat.y), splat.z);
        }
    }
}

// Draws the splats that wait. All threads of the workgroup come here together.
fn put_waiting(eye: u32) {
    workgroupBarrier();
    let num_splats = atomicLoad(&num_waiting_splats);
    for (var i = this_thread / TEAM; i < num_splats; i += WORKGROUP_SIZE / TEAM) {
        put_share(eye, i);
    }
    workgroupBarrier();
    if this_thread == 0u {
        atomicStore(&num_waiting_splats, 0u);
    }
    workgroupBarrier();
}

// The larger discs of a turn wait until all threads of the workgroup draw them together, a team a disc and a thread a pixel: so
// no thread is held up by a neighbour's large disc, and the pixels that a team looks at lie beside each other.

/// Threads that draw a disc together.
const TEAM: u32 = 32u;
/// What makes the pixel of a disc positive that lies left of the image or above it.
const BEFORE_PX: i32 = i32(MAX_FILL_RADIUS);
/// A pixel of a waiting disc was asked for.
const WAITING_ASKED: u32 = 0x80000000u;
/// The place of y in a waiting disc's pixel.
const WAITING_Y_SHIFT: u32 = 16u;
const WAITING_X_MASK: u32 = (1u << WAITING_Y_SHIFT) - 1u;

/// Discs that wait: their pixel, x | y≪16, plus BEFORE_PX each; depth; id; radius, and WAITING_ASKED.
var<workgroup> waiting_discs: array<vec4<u32>, WORKGROUP_SIZE * POINTS_PER_TURN>;
var<workgroup> num_waiting_discs: atomic<u32>;

// Whether all threads of the workgroup stay until the last turn of a batch.
fn stays(batch: VisibleBatch) -> bool {
    return (batch.flags & VISIBLE_WIDE) != 0u;
}

// Whether a disc that reaches into the image waits.
fn waits(center: vec2<i32>, w: f32, id: u32, radius: i32) -> bool {
    if radius <= i32(OWN_FILL_RADIUS) {
        return false;
    }
    let pixel = vec2<u32>(center + BEFORE_PX);
    let disc = vec4<u32>(pixel.x | (pixel.y << WAITING_Y_SHIFT), bitcast<u32>(w), id, u32(radius));
    waiting_discs[atomicAdd(&num_waiting_discs, 1u)] = disc;
    return true;
}

// The discs that wait. All threads of the workgroup come here together.
fn put_waiting(eye: u32) {
    workgroupBarrier();
    let num_discs = atomicLoad(&num_waiting_discs);
    let size = vec2<i32>(i32(view.eyes[eye].width), i32(view.eyes[eye].height));
    for (var i = this_thread / TEAM; i < num_discs; i += WORKGROUP_SIZE / TEAM) {
        let disc = waiting_discs[i];
        let radius = i32(disc.w & ~WAITING_ASKED);
        let corner = vec2<i32>(vec2<u32>(disc.x & WAITING_X_MASK, disc.x >> WAITING_Y_SHIFT)) - BEFORE_PX - radius;
        let side = 2 * radius + 1;
        let per_side = 1.0 / f32(side);
        for (var at = i32(this_thread % TEAM); at < side * side; at += i32(TEAM)) {
            // Half a pixel is more than rounding loses.
            let y = i32((f32(at) + 0.5) * per_side);
            let from_corner = vec2<i32>(at - y * side, y);
            let pixel = corner + from_corner;
            let is_inside = all(pixel >= vec2<i32>(0)) && all(pixel < size);
            if is_inside && is_on_disc(from_corner - radius, radius) {
                put(eye, u32(pixel.y * size.x + pixel.x), bitcast<f32>(disc.y), disc.z);
            }
        }
        if take_asked() {
            waiting_discs[i].w = disc.w | WAITING_ASKED;
        }
    }
    workgroupBarrier();
    for (var i = this_thread; i < num_discs; i += WORKGROUP_SIZE) {
        count_once((waiting_discs[i].w & WAITING_ASKED) != 0u);
    }
    if this_thread == 0u {
        atomicStore(&num_waiting_discs, 0u);
    }
    workgroupBarrier();
}

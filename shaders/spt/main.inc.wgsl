// Where the geometry stages of a point tree begin: at triangles, or at discs.

// Number of this workgroup, for functions that `put` calls.
var<private> this_group: u32;

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    this_group = group.x;
    this_thread = thread;
    let batch = visible[group.x];
    if (batch.flags & VISIBLE_TRIANGLES) != 0u {
        draw_triangles(batch);
    } else {
        draw_batch(batch);
    }
}

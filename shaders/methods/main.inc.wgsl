// Where the geometry stages of a method begin that looks at its batch again.

// Number of this workgroup, for functions that `put` calls.
var<private> this_group: u32;

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    this_group = group.x;
    this_thread = thread;
    draw_batch(visible[group.x]);
}

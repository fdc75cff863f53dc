// Where the geometry stages begin.

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    this_thread = thread;
    draw_batch(visible[group.x]);
}

// lod of a sequential point tree: all runs are always drawn. The tolerance says which of their discs are, in `cull` and
// in the geometry stages.

@group(0) @binding(2) var<storage, read_write> states: array<u32>;
@group(0) @binding(3) var<storage, read_write> counted: array<u32>;

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&states) {
        states[id.x] = DRAWN_WHOLE;
        // `cull`, which comes next, counts nodes from 0.
        counted[id.x] = 0u;
    }
}

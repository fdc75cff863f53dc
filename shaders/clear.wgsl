// clear: every pixel of both eyes to "no point", every chunk's counters to "nothing visible".

@group(0) @binding(0) var<storage, read_write> depth_left: array<vec4<u32>>;
@group(0) @binding(1) var<storage, read_write> depth_right: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read_write> counters: array<vec4<u32>>;

const COUNTERS_WORDS: u32 = COUNTERS_STRIDE / 16u;

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let stride = groups.x * WORKGROUP_SIZE;
    let empty = vec4<u32>(EMPTY_DEPTH);
    for (var i = id.x; i < arrayLength(&depth_left); i += stride) {
        depth_left[i] = empty;
    }
    if NUM_EYES == 2u {
        for (var i = id.x; i < arrayLength(&depth_right); i += stride) {
            depth_right[i] = empty;
        }
    }
    // num_visible = 0, one row, one layer, num_points = 0: see CullCounters.
    for (var i = id.x; i * COUNTERS_WORDS < arrayLength(&counters); i += stride) {
        counters[i * COUNTERS_WORDS] = vec4<u32>(0u, 1u, 1u, 0u);
    }
}

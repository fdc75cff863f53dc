// clear: a pair of targets, an eye each, to one value; every chunk's counters to "nothing visible".

@group(0) @binding(0) var<uniform> clear: ClearUniform;
@group(0) @binding(1) var<storage, read_write> left: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read_write> right: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read_write> counters: array<vec4<u32>>;

const COUNTERS_WORDS: u32 = COUNTERS_STRIDE / 16u;

@compute @workgroup_size(WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let stride = groups.x * WORKGROUP_SIZE;
    let value = vec4<u32>(clear.value);
    for (var i = id.x; i < clear.num_left; i += stride) {
        left[i] = value;
    }
    if NUM_EYES == 2u {
        for (var i = id.x; i < clear.num_right; i += stride) {
            right[i] = value;
        }
    }
    // Sets num_visible to 0, one row, one layer, and all else to 0: see CullCounters.
    for (var i = id.x; i * COUNTERS_WORDS < arrayLength(&counters); i += stride) {
        counters[i * COUNTERS_WORDS] = vec4<u32>(0u, 1u, 1u, 0u);
        counters[i * COUNTERS_WORDS + 1u] = vec4<u32>(0u);
    }
}

// A stage that needs few registers: 64-bit atomics as `depth` uses them.
@group(0) @binding(0) var<storage, read> values: array<u32>;
@group(0) @binding(1) var<storage, read_write> nearest: array<atomic<u64>>;

@compute @workgroup_size(128)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let value = values[id.x];
    atomicMin(&nearest[value >> 8u], (u64(value) << 32u) | u64(id.x));
}

// A stage that no compiler keeps in registers: a large private array, indexed by data.
@group(0) @binding(0) var<storage, read_write> values: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    var held: array<u32, 1024>;
    for (var i = 0u; i < 1024u; i++) {
        held[(values[i] + id.x) % 1024u] += values[id.x + i];
    }
    values[id.x] = held[values[id.x] % 1024u];
}

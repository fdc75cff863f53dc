// A turn of a thread: one point, as in the papers' methods. [2022 §3.2] The four values of its vectors are the same.

/// Points that a thread draws before it goes on.
const POINTS_PER_TURN: u32 = 1u;

// Words of the coarse plane for a turn.
fn hi_of(load: u32, turn: u32) -> vec4<u32> {
    return vec4<u32>(plane_hi[load][turn % POINTS_PER_LOAD]);
}

// Words of the middle plane for a turn.
fn mid_of(load: u32, turn: u32) -> vec4<u32> {
    return vec4<u32>(plane_mid[load][turn % POINTS_PER_LOAD]);
}

// Words of the fine plane for a turn.
fn lo_of(load: u32, turn: u32) -> vec4<u32> {
    return vec4<u32>(plane_lo[load][turn % POINTS_PER_LOAD]);
}

// A turn of a thread: one point, as in the papers' methods. [2022 §3.2] The four values of its vectors are the same.

/// Points that a thread draws before it goes on.
const POINTS_PER_TURN: u32 = 1u;

// Words of the coarse plane for the turn at a place.
fn hi_of(at: u32) -> vec4<u32> {
    return vec4<u32>(plane_hi[at / POINTS_PER_LOAD][at % POINTS_PER_LOAD]);
}

// Words of the middle plane for the turn at a place.
fn mid_of(at: u32) -> vec4<u32> {
    return vec4<u32>(plane_mid[at / POINTS_PER_LOAD][at % POINTS_PER_LOAD]);
}

// Words of the fine plane for the turn at a place.
fn lo_of(at: u32) -> vec4<u32> {
    return vec4<u32>(plane_lo[at / POINTS_PER_LOAD][at % POINTS_PER_LOAD]);
}

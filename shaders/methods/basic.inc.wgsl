// A turn of a thread: one point, as the papers' methods have it. [2022 §3.2] Its four numbers are the same.

/// Points that a thread draws before it goes on.
const POINTS_PER_TURN: u32 = 1u;

// What a turn gets of each plane.
fn hi_of(load: u32, turn: u32) -> vec4<u32> {
    return vec4<u32>(plane_hi[load][turn % POINTS_PER_LOAD]);
}

fn mid_of(load: u32, turn: u32) -> vec4<u32> {
    return vec4<u32>(plane_mid[load][turn % POINTS_PER_LOAD]);
}

fn lo_of(load: u32, turn: u32) -> vec4<u32> {
    return vec4<u32>(plane_lo[load][turn % POINTS_PER_LOAD]);
}

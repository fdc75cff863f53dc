// A turn of a thread: as many points as it loads at once. [2022 §3.4]

/// Points that a thread draws before it goes on.
const POINTS_PER_TURN: u32 = POINTS_PER_LOAD;

// Words of the coarse plane for a turn.
fn hi_of(load: u32, turn: u32) -> vec4<u32> {
    return plane_hi[load];
}

// Words of the middle plane for a turn.
fn mid_of(load: u32, turn: u32) -> vec4<u32> {
    return plane_mid[load];
}

// Words of the fine plane for a turn.
fn lo_of(load: u32, turn: u32) -> vec4<u32> {
    return plane_lo[load];
}

// A turn of a thread: as many points as it loads at once. [2022 §3.4]

/// Points that a thread draws before it goes on.
const POINTS_PER_TURN: u32 = POINTS_PER_LOAD;

// Words of the coarse plane for the turn at a place.
fn hi_of(at: u32) -> vec4<u32> {
    return plane_hi[at];
}

// Words of the middle plane for the turn at a place.
fn mid_of(at: u32) -> vec4<u32> {
    return plane_mid[at];
}

// Words of the fine plane for the turn at a place.
fn lo_of(at: u32) -> vec4<u32> {
    return plane_lo[at];
}

// A turn of a thread: as many points as it loads at once. [2022 §3.4]

/// Points that a thread draws before it goes on.
const POINTS_PER_TURN: u32 = POINTS_PER_LOAD;

// What a turn gets of each plane.
fn hi_of(load: u32, turn: u32) -> vec4<u32> {
    return plane_hi[load];
}

fn mid_of(load: u32, turn: u32) -> vec4<u32> {
    return plane_mid[load];
}

fn lo_of(load: u32, turn: u32) -> vec4<u32> {
    return plane_lo[load];
}

// Words of the column of shapes for a turn of one point.

fn shapes_of(load: u32, turn: u32) -> vec4<u32> {
    return vec4<u32>(shapes[load][turn % POINTS_PER_LOAD]);
}

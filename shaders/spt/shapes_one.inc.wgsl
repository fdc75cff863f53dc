// Words of the column of shapes for a turn of one point.

fn shapes_of(at: u32) -> vec4<u32> {
    return vec4<u32>(shapes[at / POINTS_PER_LOAD][at % POINTS_PER_LOAD]);
}

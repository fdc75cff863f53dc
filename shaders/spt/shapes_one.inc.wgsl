// What a turn of one point gets of the column of shapes.

fn shapes_of(load: u32, turn: u32) -> vec4<u32> {
    return vec4<u32>(shapes[load][turn % POINTS_PER_LOAD]);
}

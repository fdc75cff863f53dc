// Words of the column of shapes for a turn.

fn shapes_of(load: u32, turn: u32) -> vec4<u32> {
    return shapes[load];
}

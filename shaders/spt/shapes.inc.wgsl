// What a turn gets of the column of shapes.

fn shapes_of(load: u32, turn: u32) -> vec4<u32> {
    return shapes[load];
}

// Words of the column of shapes for the turn at a place.

fn shapes_of(at: u32) -> vec4<u32> {
    return shapes[at];
}

// The surface as `shade` left it, row by row: .x is the linear depth's bits, EMPTY_DEPTH where there is nothing; .y the
// stored color, r | g≪8 | b≪16 | a≪24.

@group(0) @binding(2) var<storage, read> surface: array<vec2<u32>>;

fn surface_depth(pixel: u32) -> u32 {
    return surface[pixel].x;
}

fn surface_color(pixel: u32) -> u32 {
    return surface[pixel].y;
}

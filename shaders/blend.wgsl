// resolve, first step in `hqs` quality where gaps stay open: sums to colors, one eye.

fn finish(pixel: u32) {
    let w = surface_depth(pixel);
    if w == EMPTY_DEPTH {
        surface[pixel] = vec2<u32>(EMPTY_DEPTH, 0u);
        return;
    }
    surface[pixel] = vec2<u32>(w, surface_color(pixel));
}

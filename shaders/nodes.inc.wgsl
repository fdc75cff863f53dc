// Points of flat clouds and of an octree's nodes: `cull` has chosen them, and their node knows how far apart they lie.

// Where an eye sees the points of a turn.
fn seen(eye: u32, batch: VisibleBatch, points: Turn) -> Projected {
    return project(eye, points.x, points.y, points.z, points.exists);
}

// World units that points lie apart, in a batch with this longest edge: the spacing of their octant, times a power of
// their node's step.
fn spacings(batch: VisibleBatch, at: u32, octant: vec4<u32>, edge: f32) -> vec4<f32> {
    let exponent = hi_of(at) >> vec4<u32>(SPACING_EXPONENT_SHIFT);
    let step = batch.spacing_step;
    let powers = vec4<f32>(1.0, step, step * step, step * step * step);
    var apart: vec4<f32>;
    for (var i = 0u; i < POINTS_PER_TURN; i += 1u) {
        let pair = unpack2x16float(batch.spacing[octant[i] >> 1u]);
        apart[i] = edge * select(pair.x, pair.y, (octant[i] & 1u) != 0u) * powers[exponent[i]];
    }
    return apart;
}

// Width of the square that a point is to close which lies `spacing_px` pixels from the next, where the ring's kernel
// closes `kernel_px` in any case.
fn cover_px(spacing_px: f32, kernel_px: f32) -> f32 {
    return min(POINTS_COVER * spacing_px, FILL_OVERLAP * spacing_px + kernel_px);
}

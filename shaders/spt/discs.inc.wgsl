// Discs of a sequential point tree: each has its own size, and the steps of tolerance that it is drawn at. This test is
// the whole of the tree's traversal. [SPT §3.6, 3.7]

/// A disc's interval and diameter: from | until≪8 | diameter≪16.
@group(0) @binding(14) var<storage, read> shapes: array<vec4<u32>>;

// Which discs of a turn this eye is to see.
fn is_chosen(eye: u32, points: Turn) -> vec4<bool> {
    let dx = points.x - view.eyes[eye].eye_in_head.x;
    let dy = points.y - view.eyes[eye].eye_in_head.y;
    let dz = points.z - view.eyes[eye].eye_in_head.z;
    var step: vec4<u32>;
    for (var i = 0u; i < POINTS_PER_TURN; i += 1u) {
        step[i] = step_below(tolerance_of(eye, dx[i], dy[i], dz[i]));
    }
    let shape = shapes_of(points.at);
    let mask = vec4<u32>(STEP_MASK);
    return (step >= (shape & mask)) & (step < ((shape >> vec4<u32>(UNTIL_SHIFT)) & mask));
}

// Where an eye sees the discs of a turn that it is to see.
fn seen(eye: u32, batch: VisibleBatch, points: Turn) -> Projected {
    return project(eye, points.x, points.y, points.z, points.exists & is_chosen(eye, points));
}

// Widths of discs in world units, which stand for the distances between points.
fn spacings(batch: VisibleBatch, at: u32, octant: vec4<u32>, edge: f32) -> vec4<f32> {
    let step = (shapes_of(at) >> vec4<u32>(DIAMETER_SHIFT)) & vec4<u32>(STEP_MASK);
    return vec4<f32>(length_of(step.x), length_of(step.y), length_of(step.z), length_of(step.w));
}

// A disc closes a square as wide as itself.
fn cover_px(spacing_px: f32, kernel_px: f32) -> f32 {
    return spacing_px;
}

// Lengths of sequential point trees, as steps (see crates/cloud/src/spt/steps.rs), and the tolerance that they are compared with.

/// The largest step that is not more than a length ≥ 0.
fn step_below(length: f32) -> u32 {
    return min(max(bitcast<u32>(length) >> STEP_SHIFT, tree.step_base) - tree.step_base, ENDLESS_STEP - 1u);
}

/// The length of a step.
fn length_of(step: u32) -> f32 {
    return select(bitcast<f32>((tree.step_base + step) << STEP_SHIFT), 0.0, step == 0u);
}

// The tolerance at a distance from an eye, of which `along` lies along the gaze: it grows between the ends of the inner
// and the middle ring. The terms are added in the CPU reference's order.
fn tolerance_at(eye: u32, distance: f32, along: f32) -> f32 {
    let cos = view.ring_cos;
    let outside = min(max(cos.x * distance - along, 0.0), (cos.x - cos.y) * distance);
    return tree.tolerance_rad[eye] * distance + tree.tolerance_growth[eye] * outside;
}

// The tolerance at a place relative to the eye.
fn tolerance_of(eye: u32, x: f32, y: f32, z: f32) -> f32 {
    let gaze = view.eyes[eye].gaze_in_head;
    return tolerance_at(eye, sqrt(x * x + y * y + z * z), x * gaze.x + y * gaze.y + z * gaze.z);
}

// Lengths of sequential point trees, as steps: see cloud/spt/steps.rs.

/// The largest step that is not more than a length ≥ 0.
fn step_below(length: f32) -> u32 {
    return min(max(bitcast<u32>(length) >> STEP_SHIFT, view.step_base) - view.step_base, ENDLESS_STEP - 1u);
}

/// The length of a step.
fn length_of(step: u32) -> f32 {
    return select(bitcast<f32>((view.step_base + step) << STEP_SHIFT), 0.0, step == 0u);
}

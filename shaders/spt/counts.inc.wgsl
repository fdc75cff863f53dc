// Counts the discs of a turn that the tolerance draws, in the picture or not.
fn count_chosen(chosen: vec4<bool>) {
    let ones = select(vec4<u32>(0u), vec4<u32>(1u), chosen);
    let num_chosen = select(ones.x + ones.y + ones.z + ones.w, ones.x, POINTS_PER_TURN == 1u);
    atomicAdd(&count_bins[bin()].num_chosen, num_chosen);
}

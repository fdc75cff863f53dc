// Discs are not counted but for `bench`.
fn count_chosen(chosen: vec4<bool>) {}

// Discs are counted for `bench` only.
fn count_chosen(chosen: vec4<bool>) {}

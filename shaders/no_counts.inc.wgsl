// Empty counters of what the geometry stages do: the frame does not count it.

fn count_point() {}
fn count_once(is_drawn: bool) {}
fn count_ask() {}
fn count_share(splat: u32) {}
fn count_waiting(num_splats: u32) {}
fn count_look() {}
fn count_color() {}

// Nothing is counted but for `bench`: see counts.inc.wgsl.

fn count_point() {}
fn count_once(is_drawn: bool) {}
fn count_ask() {}
fn take_asked() -> bool {
    return false;
}
fn count_look() {}
fn count_color() {}
fn count_chosen(chosen: vec4<bool>) {}

// What the geometry stages do, for those who count it. The frame does not.

fn count_point() {}
fn count_once(is_drawn: bool) {}
fn count_ask() {}
fn take_asked() -> bool {
    return false;
}
fn count_look() {}
fn count_color() {}

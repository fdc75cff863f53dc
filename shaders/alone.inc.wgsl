// Each thread draws its own points' splats: for software drivers, which pay dearly for threads that wait for each
// other.

fn stays(batch: VisibleBatch) -> bool {
    return false;
}

fn waits(center: vec2<i32>, w: f32, id: u32, radius: i32) -> bool {
    return false;
}
fn put_waiting(eye: u32) {}

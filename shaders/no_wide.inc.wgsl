// Points wider than a pixel where there are none.

fn stays(batch: VisibleBatch) -> bool {
    return false;
}

fn put_wide(eye: u32, at: vec2<f32>, w: f32, id: u32, radius_px: f32) {}
fn put_waiting(eye: u32) {}

// Points wider than a pixel, of which there are none here. All threads stay until the end, since they ask each other.

fn stays(batch: VisibleBatch) -> bool {
    return true;
}

fn put_wide(eye: u32, at: vec2<f32>, w: f32, id: u32, radius_px: f32) {}
fn put_waiting(eye: u32) {}

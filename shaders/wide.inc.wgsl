// Points that are drawn wider than a pixel, as splats: discs round their own pixel. Either each thread draws its
// points' (alone.inc.wgsl), or the larger ones wait for all threads of the workgroup (together.inc.wgsl).

fn is_on_splat(d: vec2<i32>, radius: i32) -> bool {
    return d.x * d.x + d.y * d.y <= radius * (radius + 1);
}

// Draws a point as a splat, whose own pixel may lie outside the image.
fn put_wide(eye: u32, at: vec2<f32>, w: f32, id: u32, radius_px: f32) {
    let radius = i32(radius_px);
    let width = i32(view.eyes[eye].width);
    let size = vec2<f32>(f32(width), f32(view.eyes[eye].height));
    // There are no pixels if the whole splat lies outside.
    let center_px = at - view.eyes[eye].first_px;
    let first_px = clamp(center_px - radius_px, vec2<f32>(0.0), size);
    let last_px = clamp(center_px + radius_px, vec2<f32>(-1.0), size - 1.0);
    if all(first_px <= last_px) && waits(vec2<i32>(center_px), w, id, radius) {
        return;
    }
    let center = vec2<i32>(center_px);
    let last = vec2<i32>(last_px);
    for (var y = i32(first_px.y); y <= last.y; y += 1) {
        for (var x = i32(first_px.x); x <= last.x; x += 1) {
            if is_on_splat(vec2<i32>(x, y) - center, radius) {
                put(eye, u32(y * width + x), w, id);
            }
        }
    }
}

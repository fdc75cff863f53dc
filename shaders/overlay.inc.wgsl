// What overlays share. An overlay is drawn over the window's copy of an eye's image; `dilate.eye` says which eye's.

// Depths of the finished pixels.
@group(0) @binding(2) var<storage, read> image_depth: array<u32>;

fn palette(number: u32) -> vec3<f32> {
    var colors = PALETTE;
    return linear_from_srgb(colors[number % PALETTE_COLORS]);
}

// Depth of the finished pixel at a position in the image.
fn depth_at(position: vec4<f32>) -> u32 {
    let width = view.eyes[dilate.eye].width - 2u * GUARD_PX;
    return image_depth[u32(position.y) * image_pitch_px(width) + u32(position.x)];
}

// What overlays share. An overlay is drawn over the window's copy of an eye's image; `dilate.eye` says which eye's.

// Depths of the finished pixels.
@group(0) @binding(2) var<storage, read> image_depth: array<u32>;

/// Colors in sRGB that color-blind people can tell apart too: rings and precisions have the first ones, levels of nodes
/// take turns.
const PALETTE: array<vec3<f32>, 8> = array<vec3<f32>, 8>(
    vec3<f32>(0.337, 0.706, 0.914), vec3<f32>(0.0, 0.62, 0.451), vec3<f32>(0.902, 0.624, 0.0),
    vec3<f32>(0.8, 0.475, 0.655), vec3<f32>(0.941, 0.894, 0.259), vec3<f32>(0.0, 0.447, 0.698),
    vec3<f32>(0.835, 0.369, 0.0), vec3<f32>(0.9, 0.9, 0.9),
);

fn palette(number: u32) -> vec3<f32> {
    var colors = PALETTE;
    return linear_from_srgb(colors[number % 8u]);
}

// Depth of the finished pixel at a position in the image.
fn depth_at(position: vec4<f32>) -> u32 {
    let width = view.eyes[dilate.eye].width - 2u * GUARD_PX;
    return image_depth[u32(position.y) * image_pitch_px(width) + u32(position.x)];
}

// The test that all forms of `color` share: which points count.

@group(0) @binding(6) var<storage, read> depth_left: array<u32>;
@group(0) @binding(7) var<storage, read> depth_right: array<u32>;
@group(0) @binding(8) var<storage, read> colors: array<u32>;

fn counts(eye: u32, pixel: u32, w: f32) -> bool {
    var nearest: u32;
    if eye == 0u {
        nearest = depth_left[pixel];
    } else {
        nearest = depth_right[pixel];
    }
    return w <= SURFACE_TOLERANCE * bitcast<f32>(nearest);
}

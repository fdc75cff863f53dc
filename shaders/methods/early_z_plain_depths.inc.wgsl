// Stands in for early_z_plain_keys.inc.wgsl where a key is the depth alone.

@group(0) @binding(16) var<storage, read_write> depth_left_again: array<u32>;
@group(0) @binding(17) var<storage, read_write> depth_right_again: array<u32>;

fn plain_depth_in(eye: u32, pixel: u32) -> u32 {
    if eye == 0u {
        return depth_left_again[pixel];
    }
    return depth_right_again[pixel];
}

// True if a key may still win the pixel.
fn may_win(eye: u32, pixel: u32, key: Key) -> bool {
    return key < plain_depth_in(eye, pixel);
}

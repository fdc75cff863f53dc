// Early-z's reading of a pixel by a plain load, which a GPU may answer from its first cache, as the papers' is; atomic
// loads bypass it on some. The targets are bound a second time for that. The value seen may be out of date: then it is
// farther than the present one, and costs an atomic operation. Only the depth is looked at, one word: of two words, one
// could be from before an exchange and one from after. If depths are equal all threads ask, and the smallest id wins as
// always.

@group(0) @binding(16) var<storage, read_write> keys_left_again: array<vec2<u32>>;
@group(0) @binding(17) var<storage, read_write> keys_right_again: array<vec2<u32>>;

fn plain_depth_in(eye: u32, pixel: u32) -> u32 {
    if eye == 0u {
        return keys_left_again[pixel].y;
    }
    return keys_right_again[pixel].y;
}

// True if a key may still win the pixel.
fn may_win(eye: u32, pixel: u32, key: Key) -> bool {
    return u32(key >> KEY_DEPTH_SHIFT) <= plain_depth_in(eye, pixel);
}

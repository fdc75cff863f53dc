// Early-z's reading of a pixel, by an atomic load.

// True if a key may still win the pixel.
fn may_win(eye: u32, pixel: u32, key: Key) -> bool {
    return key < key_in(eye, pixel);
}

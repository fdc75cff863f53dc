//! Twin of `clear`.

use render::layout::EMPTY_DEPTH;

/// A key that no point has reached.
pub const EMPTY: u64 = (EMPTY_DEPTH as u64) << 32 | EMPTY_DEPTH as u64;

/// An eye's pixels, all of one value.
#[must_use]
pub fn pixels<T: Clone>([width, height]: [u32; 2], value: T) -> Vec<T> {
    vec![value; width as usize * height as usize]
}

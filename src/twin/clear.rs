//! Twin of `clear`.

use crate::layout::EMPTY_DEPTH;

/// A pixel that no point has reached.
pub const EMPTY: u64 = (EMPTY_DEPTH as u64) << 32 | EMPTY_DEPTH as u64;

/// An eye's pixels, empty.
#[must_use]
pub fn pixels([width, height]: [u32; 2]) -> Vec<u64> {
    vec![EMPTY; width as usize * height as usize]
}

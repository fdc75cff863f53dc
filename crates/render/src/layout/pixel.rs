//! A pixel of a picture, as it is read back.

use super::EMPTY_DEPTH;

/// Bits of linear depth, and color r | g≪8 | b≪16 | 255≪24 as stored.
pub type Pixel = [u32; 2];

/// Linear depth of a pixel; infinite where there is no point.
#[must_use]
pub fn depth_of([depth, _]: Pixel) -> f32 {
    if depth == EMPTY_DEPTH { f32::INFINITY } else { f32::from_bits(depth) }
}

//! Twin of `resolve`: point indices to stored colours.

use super::clear::EMPTY;

/// The image of an eye, r | g≪8 | b≪16 | 255≪24 a pixel, as the sRGB target holds it.
#[must_use]
pub fn resolve(pixels: &[u64], colors: &[u32], background: [u8; 3]) -> Vec<u32> {
    let [r, g, b] = background;
    let background = u32::from_le_bytes([r, g, b, 255]);
    let color = |&pixel: &u64| if pixel == EMPTY { background } else { colors[pixel as u32 as usize] };
    pixels.iter().map(color).collect()
}

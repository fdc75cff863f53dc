//! CPU reference of `resolve`: what each pixel shows, before gaps are filled.

use super::color::Sum;
use render::layout::{BLUE_SHIFT, EMPTY_DEPTH, GREEN_SHIFT, KEY_DEPTH_SHIFT, OPAQUE, Pixel};

/// A pixel without points.
pub const EMPTY: Pixel = [EMPTY_DEPTH, 0];

/// `closest` quality: an eye's keys to colors; `color_of` tells the color of an id.
#[must_use]
pub fn shade(keys: &[u64], color_of: &dyn Fn(u32) -> u32) -> Vec<Pixel> {
    let pixel = |&key: &u64| match (key >> KEY_DEPTH_SHIFT) as u32 {
        EMPTY_DEPTH => EMPTY,
        depth => [depth, color_of(key as u32)],
    };
    keys.iter().map(pixel).collect()
}

/// `hqs` quality: an eye's sums to colors.
#[must_use]
pub fn blend(depth: &[u32], sums: &[Sum]) -> Vec<Pixel> {
    let pixel = |(&depth, &[r, g, b, count]): (&u32, &Sum)| {
        if depth == EMPTY_DEPTH {
            return EMPTY;
        }
        let mean = |sum: u32| (sum + count / 2) / count;
        [depth, mean(r) | mean(g) << GREEN_SHIFT | mean(b) << BLUE_SHIFT | OPAQUE]
    };
    depth.iter().zip(sums).map(pixel).collect()
}

/// An eye's image: r | g≪8 | b≪16 | 255≪24 a pixel, as the sRGB target holds it.
#[must_use]
pub fn image(pixels: &[Pixel], background: u32) -> Vec<u32> {
    pixels.iter().map(|&[depth, color]| if depth == EMPTY_DEPTH { background } else { color }).collect()
}

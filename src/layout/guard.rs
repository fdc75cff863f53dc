//! The guard band: pixels that the stages draw beyond each edge of an image and that nobody sees. What dilation takes
//! from there is what it would take in a larger image, so that an image's border looks like its middle.

use super::DILATE_REACH_PX;

/// Pixels of the guard band on each side of an eye's image.
pub const GUARD_PX: u32 = DILATE_REACH_PX;

/// The size of an image with its guard band.
#[must_use]
pub fn guarded(size_px: [u32; 2]) -> [u32; 2] {
    size_px.map(|size| size + 2 * GUARD_PX)
}

/// An image's own pixels, row by row, of those of an image of `size_px` with its guard band; what comes after them in
/// `pixels` is left out.
///
/// # Panics
/// If there are fewer pixels.
#[must_use]
pub fn without_guard<T: Clone>(pixels: &[T], size_px: [u32; 2]) -> Vec<T> {
    let [width, height] = size_px.map(|size| size as usize);
    let (guard, stride) = (GUARD_PX as usize, guarded(size_px)[0] as usize);
    (guard..guard + height).flat_map(|y| &pixels[y * stride + guard..][..width]).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_image_lies_within_its_guard_band() {
        let [width, height] = guarded([4, 2]);
        let pixels: Vec<[u32; 2]> = (0..height).flat_map(|y| (0..width).map(move |x| [x, y])).collect();
        let g = GUARD_PX;
        let want = [
            [g, g],
            [g + 1, g],
            [g + 2, g],
            [g + 3, g],
            [g, g + 1],
            [g + 1, g + 1],
            [g + 2, g + 1],
            [g + 3, g + 1],
        ];
        assert_eq!(without_guard(&pixels, [4, 2]), want);
    }
}

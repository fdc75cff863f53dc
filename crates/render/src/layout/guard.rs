//! The guard band: pixels that the stages draw beyond each edge of an image and that nobody sees. What dilation takes
//! from there is what it would take in a larger image, so that an image's border looks like its middle. Finished pixels
//! have none.

use super::DILATE_REACH_PX;

/// Pixels of the guard band on each side of an eye's image.
pub const GUARD_PX: u32 = DILATE_REACH_PX;

/// The size of an image with its guard band.
#[must_use]
pub fn guarded(size_px: [u32; 2]) -> [u32; 2] {
    size_px.map(|size| size + 2 * GUARD_PX)
}

/// The pixels of an image of `size_px`, row by row, from `pixels` that have its guard band too; what comes after them
/// in `pixels` is left out.
///
/// # Panics
/// If there are fewer pixels.
#[must_use]
pub fn without_guard<T: Clone>(pixels: &[T], size_px: [u32; 2]) -> Vec<T> {
    let [width, height] = size_px.map(|size| size as usize);
    let (guard, stride) = (GUARD_PX as usize, guarded(size_px)[0] as usize);
    (guard..guard + height).flat_map(|y| &pixels[y * stride + guard..][..width]).cloned().collect()
}

/// A row of a finished image takes a multiple of this many pixels: copies into textures want rows to begin at multiples
/// of 256 bytes.
pub const IMAGE_PITCH_PX: u32 = 64;

/// Pixels from a row of a finished image to the next.
#[must_use]
pub fn image_pitch_px(width: u32) -> u32 {
    width.next_multiple_of(IMAGE_PITCH_PX)
}

/// The pixels of an image of `size_px`, row by row, from a buffer of finished pixels in rows of [`image_pitch_px`];
/// what comes after them is left out.
///
/// # Panics
/// If there are fewer pixels.
#[must_use]
pub fn of_image<T: Clone>(pixels: &[T], size_px: [u32; 2]) -> Vec<T> {
    let [width, height] = size_px.map(|size| size as usize);
    let rows = pixels.chunks(image_pitch_px(size_px[0]) as usize).take(height);
    let image: Vec<T> = rows.flat_map(|row| &row[..width]).cloned().collect();
    assert_eq!(image.len(), width * height, "an image's pixels");
    image
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

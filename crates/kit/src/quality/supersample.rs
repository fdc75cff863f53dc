//! A picture with 4 × 4 samples a pixel: drawn as 4 × 4 pictures of its own size, each a part of the field of view
//! (so that it fits wherever the picture itself does), then averaged.

use super::picture::{EyePicture, only_eye};
use base::space::{Eye, Fov, View};

/// Samples of a pixel along each axis, and parts of the field of view along each axis.
pub const FACTOR: u32 = 4;

/// The view of a part: `column` and `row` from the top left.
pub fn part(view: &View, [column, row]: [u32; 2]) -> View {
    let eye = only_eye(view);
    let [width, height] = eye.size_px;
    assert!(width.is_multiple_of(FACTOR) && height.is_multiple_of(FACTOR), "parts are whole pixels");
    let at = |from: f64, to: f64, part: u32| from + (to - from) * f64::from(part) / f64::from(FACTOR);
    let Fov { left, right, up, down } = eye.fov;
    let fov = Fov {
        left: at(left, right, column),
        right: at(left, right, column + 1),
        up: at(up, down, row),
        down: at(up, down, row + 1),
    };
    View { eyes: vec![Eye { fov, ..*eye }], near: view.near }
}

/// Puts together what the parts' pictures show; `parts` row by row.
pub fn filtered(parts: &[EyePicture], background: [u8; 3]) -> EyePicture {
    let factor = FACTOR as usize;
    let size_px = parts[0].size_px;
    let [width, height] = size_px.map(|s| s as usize);
    let (part_width, part_height) = (width / factor, height / factor);
    let pixel = |i: usize| {
        let (x, y) = (i % width, i / width);
        let part = &parts[y / part_height * factor + x / part_width];
        let first = (y % part_height * width + x % part_width) * factor;
        let samples: [usize; (FACTOR * FACTOR) as usize] =
            std::array::from_fn(|s| first + s / factor * width + s % factor);
        average(samples.map(|s| (part.rgb[s], part.depth[s])), background)
    };
    let (rgb, depth) = (0..width * height).map(pixel).unzip();
    EyePicture { size_px, rgb, depth }
}

/// Two samples are of one surface if the farther is at most this many times the nearer, as in high-quality shading.
const SAME_SURFACE: f32 = 1.01;

/// The nearest surface's samples, averaged as stored; its depth is the nearest sample's. Samples without a point do not
/// count, since there is still the surface between its points. Samples of what lies behind do not count either, since
/// one sees that through the same gaps. Without any sample the pixel is background.
pub fn average<const N: usize>(samples: [([u8; 3], f32); N], background: [u8; 3]) -> ([u8; 3], f32) {
    let nearest = samples.iter().map(|(_, depth)| *depth).fold(f32::INFINITY, f32::min);
    if nearest.is_infinite() {
        return (background, nearest);
    }
    let surface = || samples.iter().filter(|(_, depth)| *depth <= SAME_SURFACE * nearest);
    let num_samples = surface().count() as u32;
    let channel = |c: usize| {
        let sum: u32 = surface().map(|(rgb, _)| u32::from(rgb[c])).sum();
        // The mean is at most 255, as the samples are.
        ((sum + num_samples / 2) / num_samples) as u8
    };
    (std::array::from_fn(channel), nearest)
}

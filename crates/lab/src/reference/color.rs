//! CPU reference of `color`: sums of the colors of the points within the tolerance of each pixel's nearest.

use super::points::Put;
use render::layout::{BLUE_SHIFT, CHANNEL_MASK, GREEN_SHIFT, SURFACE_TOLERANCE};

/// Red, green, blue, count.
pub type Sum = [u32; 4];

/// Adds a point's color to its pixel's sum, if the point is within the tolerance of the pixel's nearest.
pub fn add(sums: &mut [Vec<Sum>], depth: &[Vec<u32>], Put { eye, pixel, w, .. }: Put, color: u32) {
    if w <= SURFACE_TOLERANCE * f32::from_bits(depth[eye][pixel]) {
        let sum = &mut sums[eye][pixel];
        for (shift, sum) in [0, GREEN_SHIFT, BLUE_SHIFT].into_iter().zip(&mut *sum) {
            *sum += color >> shift & CHANNEL_MASK;
        }
        sum[3] += 1;
    }
}

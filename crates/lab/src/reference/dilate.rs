//! CPU reference of `dilate`: the gaps between points of one surface, closed by rows and columns.

use super::resolve::EMPTY;
use super::rings::ring;
use render::layout::{
    BLUE_SHIFT, CHANNEL_MASK, DILATE_FALLOFF_BITS, DILATE_REACH_PX, EMPTY_DEPTH, GREEN_SHIFT, OPAQUE, Pixel,
    REACH_MASK, SURFACE_TOLERANCE, ViewUniform,
};

/// The nearest surface in a pixel's window of its row.
#[derive(Clone, Copy, Debug)]
struct RowSurface {
    /// The surface's nearest depth.
    nearest: u32,
    /// Sums of the surface's colors times weights: r, g, b, a.
    sums: [u32; 4],
}

/// The image of an eye, whose pixels are `surface`, row by row.
///
/// A pixel that lies farther than the nearest surface of its window, or has no point, takes that surface's nearest
/// depth and the blend of its colors, in which closer pixels weigh more. The first pass goes over rows, the second over
/// columns of the first's results. A pixel reaches as far as the last bits of its depth say, and at least as far as its
/// ring's kernel.
///
/// # Panics
/// If `surface` is smaller than the eye's image.
#[must_use]
pub fn dilate(view: &ViewUniform, eye: usize, surface: &[Pixel]) -> Vec<Pixel> {
    let (width, height) = (view.eyes[eye].width as usize, view.eyes[eye].height as usize);
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let reaching = |(x, y)| with_reach(surface[y * width + x], radius_px(view, eye, x, y));
    let reaching: Vec<Pixel> = pixels.clone().map(reaching).collect();
    let rows: Vec<RowSurface> =
        pixels.clone().map(|(x, y)| sum_row(&reaching[y * width..][..width], x)).collect();
    pixels
        .map(|(x, y)| {
            let window = window(y, height).map(|from| (y.abs_diff(from), rows[from * width + x]));
            let window = window.filter(|&(distance, row)| is_taken(row.nearest, distance));
            filled(surface[y * width + x], window)
        })
        .collect()
}

/// Widens a pixel's reach to that of a kernel of `radius`, unless it is wider already.
fn with_reach([depth, color]: Pixel, radius: usize) -> Pixel {
    [depth & !REACH_MASK | (depth & REACH_MASK).max(radius as u32), color]
}

/// Reach of the kernel of the pixel in this column and row: 1, 2 or 3 by the ring that the pixel's center lies in.
#[must_use]
pub fn radius_px(view: &ViewUniform, eye: usize, x: usize, y: usize) -> usize {
    let eye = &view.eyes[eye];
    let gaze = eye.gaze_in_view;
    let right = eye.tangent_origin[0] + eye.tangent_per_px[0] * (x as f32 + eye.first_px[0] + 0.5);
    let up = eye.tangent_origin[1] + eye.tangent_per_px[1] * (y as f32 + eye.first_px[1] + 0.5);
    let along = right * gaze[0] + up * gaze[1] - gaze[2];
    1 + ring(view, along, right * right + up * up + 1.0)
}

/// Positions that `center` may take from on an axis of `length` pixels.
fn window(center: usize, length: usize) -> std::ops::Range<usize> {
    let reach = DILATE_REACH_PX as usize;
    center.saturating_sub(reach)..(center + reach + 1).min(length)
}

/// True if a pixel of this depth reaches this far.
fn is_taken(depth: u32, distance_px: usize) -> bool {
    distance_px <= (depth & REACH_MASK) as usize
}

/// The farthest depth of the surface whose nearest depth is given; 0, which no point has, if there is no surface.
fn surface_end(nearest: u32) -> u32 {
    if nearest == EMPTY_DEPTH { 0 } else { (SURFACE_TOLERANCE * f32::from_bits(nearest)).to_bits() }
}

/// Weight of a neighbor along one axis.
fn weight(distance_px: usize) -> u32 {
    1 << (DILATE_FALLOFF_BITS * (DILATE_REACH_PX - distance_px as u32))
}

fn sum_row(row: &[Pixel], x: usize) -> RowSurface {
    let window = window(x, row.len()).filter(|&from| is_taken(row[from][0], x.abs_diff(from)));
    let nearest = window.clone().fold(EMPTY_DEPTH, |nearest, from| nearest.min(row[from][0]));
    let mut sums = [0; 4];
    for from in window.filter(|&from| row[from][0] <= surface_end(nearest)) {
        let rgba = (row[from][1] | OPAQUE).to_le_bytes();
        for (sum, channel) in sums.iter_mut().zip(rgba) {
            *sum += weight(x.abs_diff(from)) * u32::from(channel);
        }
    }
    RowSurface { nearest, sums }
}

/// The finished pixel from its own surface and its column: distances and the rows' results.
fn filled(own: Pixel, column: impl Iterator<Item = (usize, RowSurface)> + Clone) -> Pixel {
    let nearest = column.clone().fold(EMPTY_DEPTH, |nearest, (_, row)| nearest.min(row.nearest));
    let end = surface_end(nearest);
    if own[0] <= end {
        return [own[0], own[1] | OPAQUE];
    }
    let mut sums = [0; 4];
    for (distance, row) in column.filter(|(_, row)| row.nearest <= end) {
        for (sum, of_row) in sums.iter_mut().zip(row.sums) {
            *sum += weight(distance) * of_row;
        }
    }
    let [r, g, b, a] = sums;
    if a == 0 {
        return EMPTY;
    }
    let weights = a / CHANNEL_MASK;
    let mean = |sum: u32| (sum + weights / 2) / weights;
    [nearest & !REACH_MASK, mean(r) | mean(g) << GREEN_SHIFT | mean(b) << BLUE_SHIFT | OPAQUE]
}

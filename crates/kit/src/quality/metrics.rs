//! Metrics that say one thing of a picture in one number. All values are 8-bit sRGB as stored, since that is what the
//! display gets. `docs/bench/quality/README.md` says what each number means to a person.

use super::picture::EyePicture;
use base::space::Eye;

/// Peak signal-to-noise ratio in dB over the pixels that `counts` accepts, all three channels alike; infinite for equal
/// pictures, NaN where nothing counts.
pub fn psnr_db(a: &EyePicture, b: &EyePicture, counts: impl Fn(usize) -> bool) -> f64 {
    let (mut squares, mut num_values) = (0u64, 0u64);
    for (_, (a, b)) in a.rgb.iter().zip(&b.rgb).enumerate().filter(|(pixel, _)| counts(*pixel)) {
        squares += a.iter().zip(b).map(|(a, b)| u64::from(a.abs_diff(*b)).pow(2)).sum::<u64>();
        num_values += 3;
    }
    if num_values == 0 {
        return f64::NAN;
    }
    10.0 * (255.0 * 255.0 * num_values as f64 / squares as f64).log10()
}

/// The pixels whose center is at most `deg` degrees from the gaze.
pub fn within_ring(eye: &Eye, deg: f64) -> Vec<bool> {
    let [width, height] = eye.size_px;
    let fov = eye.fov;
    let gaze = eye.gaze_in_view.normalize();
    let mut inside = Vec::with_capacity(width as usize * height as usize);
    for y in 0..height {
        for x in 0..width {
            let right = fov.left + (fov.right - fov.left) * (f64::from(x) + 0.5) / f64::from(width);
            let up = fov.up + (fov.down - fov.up) * (f64::from(y) + 0.5) / f64::from(height);
            let direction = glam::DVec3::new(right, up, -1.0).normalize();
            inside.push(direction.dot(gaze) >= deg.to_radians().cos());
        }
    }
    inside
}

/// Side of SSIM's window.
const WINDOW_PX: usize = 11;
/// Spread of the weights in SSIM's window, as the standard deviation of a Gaussian.
const WINDOW_SIGMA_PX: f64 = 1.5;

/// Structural similarity of luma (Rec. 601 weights), constants 0.01 and 0.03: the mean over all windows that lie within
/// the picture, 11 × 11 pixels with Gaussian weights (σ = 1.5). 1 for equal pictures.
pub fn ssim(a: &EyePicture, b: &EyePicture) -> f64 {
    let width = a.size_px[0] as usize;
    let (a, b) = (luma(a), luma(b));
    let mean = |values: Vec<f64>| blur(&values, width);
    let product = |x: &[f64], y: &[f64]| mean(x.iter().zip(y).map(|(x, y)| x * y).collect());
    let (aa, bb, ab) = (product(&a, &a), product(&b, &b), product(&a, &b));
    let (a, b) = (mean(a), mean(b));
    let [c1, c2] = [0.01f64, 0.03].map(|k| (255.0 * k).powi(2));
    let similarity = |i: usize| {
        let (variances, covariance) = (aa[i] - a[i] * a[i] + bb[i] - b[i] * b[i], ab[i] - a[i] * b[i]);
        let luminance = (2.0 * a[i] * b[i] + c1) / (a[i] * a[i] + b[i] * b[i] + c1);
        luminance * (2.0 * covariance + c2) / (variances + c2)
    };
    (0..a.len()).map(similarity).sum::<f64>() / a.len() as f64
}

fn luma(picture: &EyePicture) -> Vec<f64> {
    let luma = |&[r, g, b]: &[u8; 3]| 0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b);
    picture.rgb.iter().map(luma).collect()
}

/// Weighted means over every window that lies within the picture.
fn blur(values: &[f64], width: usize) -> Vec<f64> {
    let weight = |i: usize| {
        let offset = i as f64 - (WINDOW_PX / 2) as f64;
        (-0.5 * (offset / WINDOW_SIGMA_PX).powi(2)).exp()
    };
    let mut weights: [f64; WINDOW_PX] = std::array::from_fn(weight);
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);

    let mean = |at: &dyn Fn(usize) -> f64| (0..WINDOW_PX).map(|i| weights[i] * at(i)).sum::<f64>();
    let narrow = (width + 1).saturating_sub(WINDOW_PX);
    let rows: Vec<f64> = values
        .chunks_exact(width)
        .flat_map(|row| (0..narrow).map(move |x| (row, x)))
        .map(|(row, x)| mean(&|i| row[x + i]))
        .collect();
    let num_means = rows.len().saturating_sub((WINDOW_PX - 1) * narrow);
    (0..num_means).map(|first| mean(&|i| rows[first + i * narrow])).collect()
}

/// Two depths are of one surface if the farther is at most this many times the nearer, as in high-quality shading.
const SAME_SURFACE: f32 = 1.01;

/// Pixels in which a surface is missing that the truth shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Holes {
    /// Pixels that show nothing.
    pub empty: usize,
    /// Pixels that show something behind the surface: one looks through it.
    pub behind: usize,
    /// Pixels that could have been holes: they and their eight neighbors show something in the truth.
    pub judged: usize,
}

impl Holes {
    /// A pixel is a hole if its depth is more than 1 % behind the true depths of the pixel and of all its neighbors.
    /// The neighbors keep edges and slanted surfaces from being holes, where half a pixel decides what a pixel shows.
    pub fn of(picture: &EyePicture, truth: &EyePicture) -> Self {
        let [width, height] = truth.size_px.map(|s| s as usize);
        let mut holes = Self::default();
        for y in 0..height {
            for x in 0..width {
                let farthest = (y.saturating_sub(1)..height.min(y + 2))
                    .flat_map(|y| (x.saturating_sub(1)..width.min(x + 2)).map(move |x| y * width + x))
                    .map(|pixel| truth.depth[pixel])
                    .fold(0.0, f32::max);
                if farthest.is_infinite() {
                    continue;
                }
                holes.judged += 1;
                let depth = picture.depth[y * width + x];
                holes.empty += usize::from(depth.is_infinite());
                holes.behind += usize::from(depth.is_finite() && depth > SAME_SURFACE * farthest);
            }
        }
        holes
    }

    /// Share of the judged pixels; NaN if there are none.
    pub fn share(&self) -> f64 {
        (self.empty + self.behind) as f64 / self.judged as f64
    }
}

/// Mean absolute difference over pixels and channels, 0 to 255.
pub fn mean_change(a: &EyePicture, b: &EyePicture) -> f64 {
    let changes = a.rgb.as_flattened().iter().zip(b.rgb.as_flattened());
    changes.map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / (3 * a.rgb.len()) as f64
}

/// Mean absolute difference, over channels and the pixels that the truth covers in both frames, between a
/// contestant's change from frame to frame and the truth's: the part of the flicker that is its own. 0 to 255; NaN
/// where the truth covers nothing.
pub fn mean_own_change(picture: [&EyePicture; 2], truth: [&EyePicture; 2]) -> f64 {
    let (mut sum, mut num_values) = (0u64, 0u64);
    for pixel in (0..truth[0].rgb.len()).filter(|&pixel| truth.iter().all(|t| t.depth[pixel].is_finite())) {
        for channel in 0..3 {
            let change = |of: [&EyePicture; 2]| {
                i32::from(of[1].rgb[pixel][channel]) - i32::from(of[0].rgb[pixel][channel])
            };
            sum += u64::from(change(picture).abs_diff(change(truth)));
            num_values += 1;
        }
    }
    sum as f64 / num_values as f64
}

/// Side of the patches that may pop.
const PATCH_PX: usize = 16;

/// The largest [`mean_change`] of a patch of 16 × 16 pixels; patches at the right and lower edge may be smaller.
pub fn largest_patch_change(a: &EyePicture, b: &EyePicture) -> f64 {
    let width = a.size_px[0] as usize;
    let num_patches = width.div_ceil(PATCH_PX);
    let mut largest = 0.0;
    let rows = PATCH_PX * width;
    for (a, b) in a.rgb.chunks(rows).zip(b.rgb.chunks(rows)) {
        let mut sums = vec![(0u64, 0u64); num_patches];
        for (pixel, (a, b)) in a.iter().zip(b).enumerate() {
            let (change, count) = &mut sums[pixel % width / PATCH_PX];
            *change += a.iter().zip(b).map(|(a, b)| u64::from(a.abs_diff(*b))).sum::<u64>();
            *count += 3;
        }
        largest = sums.iter().map(|&(sum, count)| sum as f64 / count as f64).fold(largest, f64::max);
    }
    largest
}

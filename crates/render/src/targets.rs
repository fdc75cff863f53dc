//! Buffers that the stages draw into, some for each eye, in rows of the image's drawn part with its guard band; and the
//! finished pixels, without it.

use crate::gpu::Gpu;
use crate::layout::{guarded, image_pitch_px};

/// The eyes' pixels; made anew when an eye's size changes.
#[derive(Debug)]
pub struct Targets {
    /// Width, height of each eye's image.
    pub sizes_px: Vec<[u32; 2]>,
    /// Width, height of the part that is drawn, from the top left corner.
    pub drawn_px: Vec<[u32; 2]>,
    /// 8 bytes a pixel: depth ≪ 32 | id in `closest` quality, sums in `hqs` quality.
    pub keys: [wgpu::Buffer; 2],
    /// 4 bytes a pixel: the nearest depth, where it is not part of a key.
    pub depth: [wgpu::Buffer; 2],
    /// 16 bytes a pixel: sums in four u32, if packed ones are not enough; else next to nothing.
    pub wide: [wgpu::Buffer; 2],
    /// 8 bytes a pixel, (depth, color), before gaps are filled, where that is a step of its own.
    pub surface: [wgpu::Buffer; 2],
    /// 4 bytes a pixel: the finished colors, as the image holds them, in rows of [`image_pitch_px`].
    pub image_color: [wgpu::Buffer; 2],
    /// 4 bytes a pixel: the finished depths, in rows of [`image_pitch_px`].
    pub image_depth: [wgpu::Buffer; 2],
}

/// Why targets could not be made.
#[derive(Debug, thiserror::Error)]
#[error(
    "an eye of {width} × {height} pixels needs {bytes} bytes in one buffer, and this GPU allows {limit}; choose a smaller size"
)]
pub struct TargetTooLarge {
    width: u32,
    height: u32,
    bytes: u64,
    limit: u64,
}

impl Targets {
    /// Targets for one or two eyes. A one-eyed frame has tiny ones for the other, since shaders bind two.
    ///
    /// # Errors
    /// If an eye's image does not fit the device's largest binding.
    pub fn new(gpu: &Gpu, sizes_px: &[[u32; 2]], has_wide: bool) -> Result<Self, TargetTooLarge> {
        let limit = gpu.binding_limit();
        let bytes_per_px = if has_wide { 16 } else { 8 };
        for &[width, height] in sizes_px {
            let bytes = bytes_of([width, height], bytes_per_px);
            if bytes > limit {
                return Err(TargetTooLarge { width, height, bytes, limit });
            }
        }
        let pair = |labels: [&'static str; 2], bytes_per_px: u64| {
            [0, 1].map(|eye: usize| {
                let size_px = sizes_px.get(eye).copied().unwrap_or([1, 1]);
                let size_px = if bytes_per_px == 0 { [1, 1] } else { size_px };
                let size = bytes_of(size_px, bytes_per_px.max(4));
                gpu.buffer(labels[eye], size, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC)
            })
        };
        let finished = |labels: [&'static str; 2]| {
            [0, 1].map(|eye: usize| {
                let size = bytes_of_image(sizes_px.get(eye).copied().unwrap_or([1, 1]));
                gpu.buffer(labels[eye], size, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC)
            })
        };
        Ok(Self {
            sizes_px: sizes_px.to_vec(),
            drawn_px: sizes_px.to_vec(),
            keys: pair(["keys left", "keys right"], 8),
            depth: pair(["depth left", "depth right"], 4),
            wide: pair(["wide left", "wide right"], if has_wide { 16 } else { 0 }),
            surface: pair(["surface left", "surface right"], 8),
            image_color: finished(["image left", "image right"]),
            image_depth: finished(["image depth left", "image depth right"]),
        })
    }

    /// True if there is room for sums in four u32.
    #[must_use]
    pub fn has_wide(&self) -> bool {
        self.wide[0].size() == bytes_of(self.sizes_px[0], 16)
    }

    /// 16-byte words that an eye's drawn part takes in a target of `bytes_per_px` bytes a pixel.
    #[must_use]
    pub(super) fn num_words(&self, eye: usize, bytes_per_px: u64) -> u32 {
        (bytes_of(self.drawn_px.get(eye).copied().unwrap_or([1, 1]), bytes_per_px) / 16) as u32
    }

    /// 16-byte words of an eye's finished colors, and of its depths.
    #[must_use]
    pub(super) fn num_image_words(&self, eye: usize) -> u32 {
        (bytes_of_image(self.drawn_px.get(eye).copied().unwrap_or([1, 1])) / 16) as u32
    }
}

/// The largest size of the same shape, `size_px` at most, whose targets fit this GPU in every quality, and whose image is
/// one that it can make.
#[must_use]
pub fn fitting_px(gpu: &Gpu, size_px: [u32; 2]) -> [u32; 2] {
    let (limit, edge) = (gpu.binding_limit(), gpu.device.limits().max_texture_dimension_2d);
    largest_px(size_px, |size| size.iter().all(|&px| px <= edge) && bytes_of(size, 16) <= limit)
}

/// The largest size of the same shape that fits, found by halving the range of scales.
fn largest_px(size_px: [u32; 2], fits: impl Fn([u32; 2]) -> bool) -> [u32; 2] {
    if fits(size_px) {
        return size_px;
    }
    let scaled = |scale: f64| size_px.map(|px| ((f64::from(px) * scale) as u32).max(1));
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..32 {
        let middle = 0.5 * (low + high);
        if fits(scaled(middle)) { low = middle } else { high = middle }
    }
    scaled(low)
}

/// Bytes of the finished pixels of an eye's image, 4 each, in rows of [`image_pitch_px`]: a multiple of 16.
fn bytes_of_image([width, height]: [u32; 2]) -> u64 {
    4 * u64::from(image_pitch_px(width)) * u64::from(height)
}

/// Bytes of the pixels of an eye's image and its guard band, rounded up to the 16 that `clear` writes at once.
fn bytes_of(size_px: [u32; 2], bytes_per_px: u64) -> u64 {
    let [width, height] = guarded(size_px);
    (u64::from(width) * u64::from(height) * bytes_per_px).next_multiple_of(16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_that_does_not_fit_becomes_the_largest_of_its_shape() {
        let limit = 128 << 20;
        let fits = |size: [u32; 2]| size.iter().all(|&px| px <= 16_384) && bytes_of(size, 16) <= limit;
        assert_eq!(largest_px([1920, 1872], fits), [1920, 1872]);
        for wanted in [[3840, 3744], [20_000, 20_000], [32_768, 16]] {
            let [width, height] = largest_px(wanted, fits);
            assert!(fits([width, height]) && width < wanted[0], "{width} x {height}");
            let shape = f64::from(wanted[0]) / f64::from(wanted[1]);
            assert!(
                (f64::from(width) - shape * f64::from(height)).abs() <= shape.max(1.0) + 1.0,
                "{width} x {height}"
            );
            // A hundredth more does not fit.
            assert!(!fits([width, height].map(|px| px + px / 100 + 1)), "{width} x {height}");
        }
        assert_eq!(largest_px([100, 100], |_| false), [1, 1]);
    }
}

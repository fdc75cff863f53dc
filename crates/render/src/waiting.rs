//! The picture while there is no scan: a bar that fills, and below it how many hundredths are done. They are rectangles
//! that stand in the room, which need no text and no window.

use super::Setup;
use crate::gpu::drawing::Drawing;
use crate::gpu::{Gpu, QueueGuard};
use base::space::{Eye, Pose};
use glam::DVec3;

/// A rectangle from its lower left to its upper right corner, in meters from the bar's middle, and its brightness.
type Rectangle = ([f64; 4], f32);
/// A corner in clip coordinates, and its brightness.
type Vertex = [f32; 5];

/// The bar, meters.
const BAR: [f64; 4] = [-0.4, -0.02, 0.4, 0.02];
/// Brightness of the part that is done and of the part that is not, in linear light.
const BRIGHTNESS: [f32; 2] = [0.6, 0.04];
/// A digit's width and height, how thick its strokes are, and how far apart digits are: meters.
const DIGIT: [f64; 4] = [0.05, 0.1, 0.012, 0.075];
/// Upper edge of the digits.
const DIGITS_TOP: f64 = -0.07;
/// Rectangles at most: the bar's two parts, and three digits of seven strokes.
const MOST_RECTANGLES: usize = 2 + 3 * 7;
const CORNERS_EACH: usize = 6;
const MOST_CORNERS: usize = MOST_RECTANGLES * CORNERS_EACH;
/// Strokes of the digits 0 to 9. Bits: top, upper right, lower right, bottom, lower left, upper left, middle.
const STROKES: [u8; 10] = [0x3f, 0x06, 0x5b, 0x4f, 0x66, 0x6d, 0x7d, 0x07, 0x7f, 0x6f];

/// The bar's corners, made anew for each frame.
#[derive(Debug)]
pub(super) struct LoadingBar {
    pipeline: wgpu::RenderPipeline,
    corners: wgpu::Buffer,
    is_shown: bool,
}

impl LoadingBar {
    pub(super) fn new(gpu: &Gpu, setup: &Setup) -> Self {
        let corners = wgpu::VertexBufferLayout {
            array_stride: size_of::<Vertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32],
        };
        let pipeline = Drawing {
            name: "waiting",
            wgsl: include_str!("../../../shaders/waiting.wgsl"),
            entries: ["vertex", "fragment"],
            buffers: &[Some(corners)],
            target: Some(setup.color_format.into()),
            depth_format: setup.depth_format,
        }
        .pipeline(gpu);
        let num_bytes = setup.sizes_px.len() * MOST_CORNERS * size_of::<Vertex>();
        let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
        Self { pipeline, corners: gpu.buffer("waiting", num_bytes as u64, usage), is_shown: false }
    }

    /// Sets what frames show from the one on that is submitted next through the same guard: the part of the work that
    /// is done. `None` shows nothing. Whether frames recorded before show anything stays as it was.
    pub(super) fn set(
        &mut self,
        queue: &QueueGuard,
        eyes: &[Eye],
        near: f64,
        world_from_bar: &Pose,
        fraction: Option<f64>,
    ) {
        self.is_shown = fraction.is_some();
        let Some(fraction) = fraction else { return };
        let mut rectangles = [([0.0; 4], 0.0); MOST_RECTANGLES];
        let num = lay(fraction, &mut rectangles);
        for (number, eye) in eyes.iter().enumerate() {
            let mut corners: [Vertex; MOST_CORNERS] = [[0.0; 5]; MOST_CORNERS];
            for (rectangle, corners) in rectangles[..num].iter().zip(corners.chunks_exact_mut(CORNERS_EACH)) {
                let ([left, bottom, right, top], brightness) = *rectangle;
                let places = [
                    (left, bottom),
                    (right, bottom),
                    (right, top),
                    (left, bottom),
                    (right, top),
                    (left, top),
                ];
                for ((x, y), corner) in places.into_iter().zip(corners) {
                    let p_in_world = world_from_bar.matrix().transform_point3(DVec3::new(x, y, 0.0));
                    let [x, y, z, w] = eye.clip_from_world(p_in_world, near);
                    *corner = [x, y, z, w, brightness];
                }
            }
            let offset = number * size_of_val(&corners);
            queue.write_buffer(&self.corners, offset as u64, bytemuck::cast_slice(&corners));
        }
    }

    /// Draws an eye's part into its image.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass, eye: usize) {
        if self.is_shown {
            // Unused corners all lie in one point and draw nothing.
            let first = (eye * MOST_CORNERS) as u32;
            pass.set_pipeline(&self.pipeline);
            pass.set_vertex_buffer(0, self.corners.slice(..));
            pass.draw(first..first + MOST_CORNERS as u32, 0..1);
        }
    }
}

/// Lays out the rectangles for a part done, and returns their number.
fn lay(fraction: f64, rectangles: &mut [Rectangle; MOST_RECTANGLES]) -> usize {
    let fraction = fraction.clamp(0.0, 1.0);
    let [left, bottom, right, top] = BAR;
    let middle = left + fraction * (right - left);
    let mut num = 0;
    let mut put = |rectangle, brightness| {
        rectangles[num] = (rectangle, brightness);
        num += 1;
    };
    put([left, bottom, middle, top], BRIGHTNESS[0]);
    put([middle, bottom, right, top], BRIGHTNESS[1]);
    let percent = (100.0 * fraction).floor() as usize;
    let num_digits = 1 + usize::from(percent > 9) + usize::from(percent > 99);
    let [width, height, thick, apart] = DIGIT;
    let mut rest = percent;
    for place in 0..num_digits {
        // Digits are laid from the last one on, round the middle.
        let x = (0.5 * num_digits as f64 - place as f64 - 1.0) * apart + 0.5 * (apart - width);
        let (x1, y1) = (x + width, DIGITS_TOP);
        let (y, half) = (y1 - height, y1 - 0.5 * height);
        let strokes = [
            [x, y1 - thick, x1, y1],
            [x1 - thick, half, x1, y1],
            [x1 - thick, y, x1, half],
            [x, y, x1, y + thick],
            [x, y, x + thick, half],
            [x, half, x + thick, y1],
            [x, half - 0.5 * thick, x1, half + 0.5 * thick],
        ];
        let drawn = STROKES[rest % 10];
        strokes
            .into_iter()
            .enumerate()
            .filter(|(bit, _)| drawn >> bit & 1 == 1)
            .for_each(|(_, s)| put(s, BRIGHTNESS[0]));
        rest /= 10;
    }
    num
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_fills_and_the_number_counts() {
        let laid = |fraction: f64| {
            let mut rectangles = [([0.0; 4], 0.0); MOST_RECTANGLES];
            let num = lay(fraction, &mut rectangles);
            rectangles[..num].to_vec()
        };
        let filled = |fraction: f64| {
            let [left, _, right, _] = laid(fraction)[0].0;
            (right - left) / (BAR[2] - BAR[0])
        };
        for fraction in [0.0, 0.25, 0.999, 1.0] {
            assert!((filled(fraction) - fraction).abs() < 1e-12);
        }
        assert_eq!((filled(-3.0), filled(7.0)), (0.0, 1.0));
        // Strokes: 8 has seven, 1 two, 0 six.
        let strokes = |fraction: f64| laid(fraction).len() - 2;
        assert_eq!([0.0, 0.01, 0.08, 0.11, 0.88, 1.0].map(strokes), [6, 2, 7, 4, 14, 14]);
        // Digits stand beside one another, within the bar.
        for percent in 0..=100 {
            let laid = laid(0.01 * f64::from(percent) + 1e-9);
            assert!(laid[2..].iter().all(|([left, bottom, right, top], _)| {
                *left > BAR[0] && *right < BAR[2] && right > left && top > bottom && *top < BAR[1]
            }));
        }
    }
}

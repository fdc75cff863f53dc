//! The surface that is dilated: a bright plate before a dark wall, as far too few points show them.

use base::space::{Bounds, Eye, Fov, Pose, Split, View};
use glam::{DQuat, DVec3};
use kit::frames::SAMPLE_DETAIL;
use render::layout::{EMPTY_DEPTH, ViewUniform};

/// Depth bits and color of each pixel. `empty_percent` of the pixels of the plate and of the wall are missing, and the
/// wall shows through the gaps of the plate.
pub fn two_layers([width, height]: [u32; 2], empty_percent: u32) -> Vec<[u32; 2]> {
    let mut state = 1u32;
    let mut missing = || {
        // xorshift32
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state % 100 < empty_percent
    };
    let mut pixels = Vec::with_capacity(width as usize * height as usize);
    for y in 0..height {
        for x in 0..width {
            let (u, v) = (f64::from(x) / f64::from(width) - 0.5, f64::from(y) / f64::from(height) - 0.5);
            let on_plate = u * u + v * v < 0.1;
            let (r, g) = ((255.0 * (u + 0.5)) as u32, (255.0 * (v + 0.5)) as u32);
            let (no_plate, no_wall) = (missing(), missing());
            pixels.push(if on_plate && !no_plate {
                [(2.0 + 0.5 * u as f32).to_bits(), r | g << 8 | 0xffc0_0000]
            } else if !no_wall {
                [(5.0 + v as f32).to_bits(), (r / 4) | ((g / 4) << 8) | 0xff20_0000]
            } else {
                [EMPTY_DEPTH, 0]
            });
        }
    }
    pixels
}

/// One eye with an image of this size, all of it in the outer ring.
pub fn view(size_px: [u32; 2]) -> ViewUniform {
    let fov = Fov { left: -1.2, right: 1.0, up: 1.1, down: -1.2 };
    let pose = Pose { position: DVec3::ZERO, orientation: DQuat::IDENTITY };
    let eye = Eye { world_from_view: pose, fov, size_px, gaze_in_view: Eye::AHEAD };
    let view = View { eyes: vec![eye], near: 0.05 };
    // No direction has these cosines, so all are in the outer ring.
    ViewUniform {
        ring_cos: [2.0; 2],
        ..ViewUniform::new(&view, &Split::of(&Bounds::EMPTY, &Bounds::EMPTY), &SAMPLE_DETAIL)
    }
}

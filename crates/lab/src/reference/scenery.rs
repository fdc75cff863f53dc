//! The stage `scenery` on the CPU: the surround, in linear light, as the shader computes it. The GPU encodes the colors
//! for the image by itself, so the two are compared to a step of the image's colors.

use glam::{Vec2, Vec3, Vec3Swizzles};
use render::layout::SceneryUniform;

/// Half the width of a line of the grid, meters; every tenth line is wider.
const LINE_M: [f32; 2] = [0.008, 0.02];
/// Distance at which the grid is faint, meters.
const GRID_REACH_M: f32 = 14.0;

/// The color of the surround at a place in the image, pixels from its top left corner.
#[must_use]
pub fn surround(uniform: &SceneryUniform, px: [f32; 2]) -> [f32; 3] {
    let [ray, right, down] = [uniform.ray, uniform.ray_right, uniform.ray_down].map(Vec3::from);
    let ray = ray + right * px[0] + down * px[1];
    let up = ray.y / ray.length();
    let end = Vec3::from(if up > 0.0 { uniform.sky } else { uniform.ground });
    let mut color = Vec3::from(uniform.horizon).lerp(end, 1.0 - (-4.0 * up.abs()).exp());
    if uniform.has_grid != 0 {
        color = color.lerp(Vec3::from(uniform.line), grid(uniform, ray));
    }
    color.to_array()
}

/// How strongly the grid is seen in a direction.
fn grid(uniform: &SceneryUniform, ray: Vec3) -> f32 {
    let eye = Vec3::from(uniform.eye_in_grid);
    let far = -eye.y / ray.y;
    if far <= 0.0 {
        return 0.0;
    }
    let at = eye.xz() + far * ray.xz();
    let across = |step: [f32; 3]| {
        let step = Vec3::from(step);
        far * (step.xz() - ray.xz() * (step.y / ray.y))
    };
    let width = (across(uniform.ray_right).abs() + across(uniform.ray_down).abs()).max(Vec2::splat(1e-4));
    let distance = (far * ray).length();
    let seen = (0.6 * lines(at, width, 1.0, LINE_M[0])).max(lines(at, width, 10.0, LINE_M[1]));
    seen * (-distance / GRID_REACH_M).exp()
}

fn lines(at: Vec2, width: Vec2, cell: f32, half_line: f32) -> f32 {
    let across = covered(at.x, width.x, cell, half_line);
    let along = covered(at.y, width.y, cell, half_line);
    across + along - across * along
}

/// How much of a pixel, `width` wide along an axis at `at`, lines at whole multiples of `cell` cover.
fn covered(at: f32, width: f32, cell: f32, half_line: f32) -> f32 {
    let [low, high] = [-0.5, 0.5].map(|side: f32| (at + side * width + half_line) / cell);
    let line = 2.0 * half_line / cell;
    let below = |at: f32| at.floor() * line + (at - at.floor()).min(line);
    (below(high) - below(low)) / (high - low).max(1e-6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_is_covered_by_the_lines_in_it() {
        assert_eq!(covered(0.0, 0.01, 1.0, 0.008), 1.0);
        assert_eq!(covered(0.5, 0.01, 1.0, 0.008), 0.0);
        // A pixel that holds many cells has their mean.
        assert!((covered(3.3, 50.0, 1.0, 0.008) - 0.016).abs() < 1e-3);
        // Half of this pixel is on the line.
        assert!((covered(7.008, 0.004, 1.0, 0.008) - 0.5).abs() < 1e-3);
    }
}

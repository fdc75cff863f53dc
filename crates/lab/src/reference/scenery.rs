//! The stage `scenery` on the CPU: surround, shapes and vignette, in linear light, as the shader computes them. The GPU
//! rasterizes, blends, and encodes the colors for the image by itself, so the two are compared to a step of the image's
//! colors, and where no triangle's edge is near the middle of the pixel.

use glam::{DVec3, Mat4, Vec2, Vec3, Vec3Swizzles, Vec4, Vec4Swizzles};
use render::layout::{
    CARD_BEHIND_ALPHA, CARD_STEP, CARD_TURN, EMPTY_DEPTH, GRID_CELL_M, GRID_LEAST_CELLS, GRID_LEAST_WIDTH_M,
    GRID_LINE_ALPHA, GRID_LINE_M, GRID_REACH_M, GRID_WIDE_CELL_M, GRID_WIDE_LINE_M, HORIZON_FALLOFF,
    SURFACE_TOLERANCE, SceneryUniform, VIGNETTE_EDGE_COS, VIGNETTE_NARROW_COS, VIGNETTE_RISE,
    VIGNETTE_WIDE_COS,
};
use render::scenery::ShapeCorner;

/// Part of a pixel by which rasterizers may place a corner otherwise: Vulkan asks for 1/16, and drivers have 1/256.
const NEAR_EDGE_PX: f64 = 1.0 / 16.0;
/// Part of a depth that two ways of computing it may differ by.
const DEPTH_ROUNDING: f32 = 1e-5;

/// What the stage draws over an eye's image.
#[derive(Clone, Copy, Debug)]
pub struct SceneryFrame<'a> {
    /// What the shader is told.
    pub uniform: &'a SceneryUniform,
    /// Pixels of the image.
    pub size_px: [u32; 2],
    /// Corners of the shapes, three a triangle.
    pub corners: &'a [ShapeCorner],
    /// The card's picture.
    pub card: &'a CardPicture,
}

/// The picture that a card shows, in linear light, row by row.
#[derive(Clone, Debug)]
pub struct CardPicture {
    /// Pixels of a row.
    pub width: usize,
    /// Colors of all pixels.
    pub rgb: Vec<Vec3>,
}

impl SceneryFrame<'_> {
    /// Colors that are blended over a pixel, in their order, each with how strongly it covers what is below. `depth` are the
    /// bits of the pixel's depth. `None`: rasterizers may differ about the pixel, or about what lies behind its point.
    #[must_use]
    pub fn layers(&self, [x, y]: [u32; 2], depth: u32) -> Option<Vec<[f32; 4]>> {
        let middle = [x, y].map(|at| f64::from(at) + 0.5);
        let px = middle.map(|at| at as f32);
        let mut layers = vec![];
        if self.uniform.has_surround != 0 && depth == EMPTY_DEPTH {
            layers.push(Vec3::from(surround(self.uniform, px)).extend(1.0).to_array());
        }
        for corners in self.corners.as_chunks().0 {
            let Some(triangle) = SceneryTriangle::new(self, corners) else { continue };
            let is_covered = triangle.covers(middle);
            let near = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
            let near =
                near.map(|to: [f64; 2]| [0, 1].map(|axis: usize| middle[axis] + NEAR_EDGE_PX * to[axis]));
            if near.into_iter().any(|px| triangle.covers(px) != is_covered) {
                return None;
            }
            if is_covered {
                layers.push(self.shape(&triangle, [x, y], depth)?);
            }
        }
        if self.uniform.vignette > 0.0 {
            layers.push([0.0, 0.0, 0.0, vignette(self.uniform, px)]);
        }
        Some(layers)
    }

    /// A triangle's color in a pixel that it covers; `None` if it may or may not be behind the pixel's point.
    fn shape(&self, triangle: &SceneryTriangle, [x, y]: [u32; 2], nearest: u32) -> Option<[f32; 4]> {
        let seen = |x: f64, y: f64| triangle.seen([x + 0.5, y + 0.5]);
        let (x, y) = (f64::from(x), f64::from(y));
        let (color, on_card, depth_m) = seen(x, y);
        let is_card = on_card.x >= 0.0;
        let mut rgb = color.xyz();
        if is_card {
            // Steps to the next pixel are those within two by two pixels.
            let even = |at: f64| at - at % 2.0;
            let right = CARD_STEP * (seen(even(x) + 1.0, y).1 - seen(even(x), y).1);
            let down = CARD_STEP * (seen(x, even(y) + 1.0).1 - seen(x, even(y)).1);
            let places = [
                right + CARD_TURN * down,
                -right - CARD_TURN * down,
                down - CARD_TURN * right,
                -down + CARD_TURN * right,
            ];
            rgb *= places.map(|step| self.card.at(on_card + step)).into_iter().sum::<Vec3>()
                / places.len() as f32;
        }
        let mut alpha = color.w;
        if nearest != EMPTY_DEPTH {
            let (depth, from) =
                (depth_m * self.uniform.units_per_m, SURFACE_TOLERANCE * f32::from_bits(nearest));
            if (depth - from).abs() < DEPTH_ROUNDING * from {
                return None;
            }
            if depth > from {
                alpha *= if is_card { CARD_BEHIND_ALPHA } else { on_card.y };
            }
        }
        Some(rgb.extend(alpha).to_array())
    }
}

impl CardPicture {
    /// The color at a place, from the top left corner to (1, 1): between the middles of four pixels.
    fn at(&self, place: Vec2) -> Vec3 {
        let size = [self.width, self.rgb.len() / self.width];
        let axis = |axis: usize| {
            let at = (place[axis] * size[axis] as f32 - 0.5).clamp(0.0, (size[axis] - 1) as f32);
            (at as usize, (at as usize + 1).min(size[axis] - 1), at.fract())
        };
        let ((left, right, across), (above, below, down)) = (axis(0), axis(1));
        let row = |y: usize| self.rgb[y * self.width + left].lerp(self.rgb[y * self.width + right], across);
        row(above).lerp(row(below), down)
    }
}

/// A triangle of a shape, as an eye sees it.
struct SceneryTriangle<'a> {
    corners: &'a [ShapeCorner; 3],
    /// The corners' depths, meters.
    depths_m: [f32; 3],
    /// The near plane's distance, meters.
    near_m: f64,
    /// The product of one of these with (x, y, 1), in pixels, is a corner's share of the place there over its depth.
    share: [DVec3; 3],
}

impl<'a> SceneryTriangle<'a> {
    /// `None` for a triangle that is seen from its edge.
    fn new(frame: &SceneryFrame, corners: &'a [ShapeCorner; 3]) -> Option<Self> {
        let clip_from_stage = Mat4::from_cols_array_2d(&frame.uniform.clip_from_stage);
        let clip = corners.map(|corner| clip_from_stage * Vec3::from(corner.p_in_stage).extend(1.0));
        let [width, height] = frame.size_px.map(f64::from);
        let in_px = |clip: Vec4| {
            let [x, y, w] = [clip.x, clip.y, clip.w].map(f64::from);
            DVec3::new(0.5 * width * (w + x), 0.5 * height * (w - y), w)
        };
        let [a, b, c] = clip.map(in_px);
        let volume = a.dot(b.cross(c));
        let share = [b.cross(c), c.cross(a), a.cross(b)].map(|across| across / volume);
        let is_seen = share.iter().all(|share| share.is_finite());
        is_seen.then(|| Self {
            corners,
            depths_m: clip.map(|corner| corner.w),
            near_m: clip[0].z.into(),
            share,
        })
    }

    fn shares(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        self.share.map(|share| share.dot(DVec3::new(x, y, 1.0)))
    }

    fn covers(&self, px: [f64; 2]) -> bool {
        let shares = self.shares(px);
        shares.iter().all(|share| *share >= 0.0) && self.near_m * shares.iter().sum::<f64>() <= 1.0
    }

    /// Color, place on the card and depth at a place in the image, or in the triangle's plane beside it.
    fn seen(&self, px: [f64; 2]) -> (Vec4, Vec2, f32) {
        let shares = self.shares(px);
        let sum: f64 = shares.iter().sum();
        let [a, b, c] = shares.map(|share| (share / sum) as f32);
        let [p, q, r] = self.corners;
        let color = a * Vec4::from(p.color) + b * Vec4::from(q.color) + c * Vec4::from(r.color);
        let on_card = a * Vec2::from(p.on_card) + b * Vec2::from(q.on_card) + c * Vec2::from(r.on_card);
        (color, on_card, a * self.depths_m[0] + b * self.depths_m[1] + c * self.depths_m[2])
    }
}

/// The direction through a place in the image.
fn ray_at(uniform: &SceneryUniform, px: [f32; 2]) -> Vec3 {
    let [ray, right, down] = [uniform.ray, uniform.ray_right, uniform.ray_down].map(Vec3::from);
    ray + right * px[0] + down * px[1]
}

/// The color of the surround at a place in the image, pixels from its top left corner.
#[must_use]
pub fn surround(uniform: &SceneryUniform, px: [f32; 2]) -> [f32; 3] {
    let ray = ray_at(uniform, px);
    let up = ray.y / ray.length();
    let end = Vec3::from(if up > 0.0 { uniform.sky } else { uniform.ground });
    let mut color = Vec3::from(uniform.horizon).lerp(end, 1.0 - (-HORIZON_FALLOFF * up.abs()).exp());
    if uniform.has_grid != 0 {
        color = color.lerp(Vec3::from(uniform.line), grid(uniform, ray));
    }
    color.to_array()
}

/// How much the vignette darkens a place in the image.
fn vignette(uniform: &SceneryUniform, px: [f32; 2]) -> f32 {
    let ray = ray_at(uniform, px);
    let from_ahead = ray.dot(Vec3::from(uniform.ahead)) / ray.length();
    let begin = VIGNETTE_WIDE_COS + uniform.vignette * (VIGNETTE_NARROW_COS - VIGNETTE_WIDE_COS);
    let within = ((from_ahead - (begin - VIGNETTE_EDGE_COS)) / VIGNETTE_EDGE_COS).clamp(0.0, 1.0);
    let dark = 1.0 - within * within * (3.0 - 2.0 * within);
    dark * (VIGNETTE_RISE * uniform.vignette).min(1.0)
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
    let width = across(uniform.ray_right).abs() + across(uniform.ray_down).abs();
    let width = width.max(Vec2::splat(GRID_LEAST_WIDTH_M));
    let distance = (far * ray).length();
    let narrow = lines(at, width, GRID_CELL_M, GRID_LINE_M);
    let seen = (GRID_LINE_ALPHA * narrow).max(lines(at, width, GRID_WIDE_CELL_M, GRID_WIDE_LINE_M));
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
    (below(high) - below(low)) / (high - low).max(GRID_LEAST_CELLS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_card_is_smooth_between_the_middles_of_its_pixels() {
        let card = CardPicture { width: 2, rgb: vec![Vec3::ZERO, Vec3::ONE, Vec3::ZERO, Vec3::ONE] };
        let red = |x: f32| card.at(Vec2::new(x, 0.3)).x;
        assert_eq!([0.0, 0.25, 0.5, 0.75, 1.0].map(red), [0.0, 0.0, 0.5, 1.0, 1.0]);
    }

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

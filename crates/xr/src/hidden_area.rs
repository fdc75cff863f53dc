//! The part of an eye's image that the lenses hide, from the runtime's triangles to one bit a pixel.
//!
//! The triangles come in tangents, so they fit any field of view and resolution; the frame wants pixels. A pixel is
//! hidden only if hidden triangles cover its whole square: at the border too many pixels are drawn rather than too few.

use base::space::Fov;
use glam::DVec2;
use render::layout::mask_words_per_row;

/// Pieces of a pixel this small, in pixels of area, count as covered: the corners are rounded to f32, which
/// leaves them between triangles that touch, and along the image's border.
const SLIVER: f64 = 1e-3;
/// Corners further away than this many pixels would make the arithmetic coarse: their triangles hide nothing.
const REACH_PX: f64 = (1u64 << 24) as f64;

/// The hidden part of one eye's view.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HiddenArea {
    /// Corners as tangents in the view's plane z = −1: x right, y up. Any winding; they may overlap and reach
    /// beyond the field of view.
    pub triangles: Vec<[[f32; 2]; 3]>,
}

impl HiddenArea {
    /// From an indexed mesh; triangles that name a vertex which is not there are left out.
    #[must_use]
    pub fn from_mesh(vertices: &[[f32; 2]], indices: &[u32]) -> Self {
        let vertex = |index: u32| vertices.get(index as usize).copied();
        let corners = indices.chunks_exact(3).map(|corner| {
            let [a, b, c] = [corner[0], corner[1], corner[2]].map(vertex);
            Some([a?, b?, c?])
        });
        Self { triangles: corners.flatten().collect() }
    }

    /// One bit a pixel of an image of `size_px`, set where the pixel is hidden: row by row from the top,
    /// [`mask_words_per_row`] words each. Bits beyond the width are 0.
    #[must_use]
    pub fn rasterize(&self, fov: &Fov, size_px: [u32; 2]) -> Vec<u32> {
        let triangles: Vec<PixelTriangle> = self
            .triangles
            .iter()
            .filter_map(|corners| PixelTriangle::in_pixels(corners, fov, size_px))
            .collect();
        let mut mask = Mask::new(size_px);
        // Columns of the row that a triangle covers in part, with that triangle.
        let mut partly = Vec::new();
        for y in 0..size_px[1] {
            partly.clear();
            for triangle in triangles.iter().filter(|triangle| triangle.meets(y)) {
                let covered = triangle.covered(y, size_px[0]);
                let touched = triangle.touched(y, size_px[0]);
                partly.extend(touched.filter(|x| !covered.contains(x)).map(|x| (x, triangle)));
                mask.hide(y, covered);
            }
            partly.sort_unstable_by_key(|(x, _)| *x);
            for pixel in partly.chunk_by(|(a, _), (b, _)| a == b) {
                let x = pixel[0].0;
                if !mask.is_hidden(x, y) && cover_together(pixel.iter().map(|(_, triangle)| *triangle), x, y)
                {
                    mask.hide(y, x..x + 1);
                }
            }
        }
        mask.words
    }
}

/// A bit for each pixel of an image.
struct Mask {
    words: Vec<u32>,
    words_per_row: usize,
}

impl Mask {
    fn new([width, height]: [u32; 2]) -> Self {
        let words_per_row = mask_words_per_row(width) as usize;
        Self { words: vec![0; words_per_row * height as usize], words_per_row }
    }

    fn hide(&mut self, y: u32, columns: std::ops::Range<u32>) {
        let row = y as usize * self.words_per_row;
        for word in columns.start / 32..columns.end.div_ceil(32) {
            let [from, to] =
                [columns.start, columns.end].map(|x| x.clamp(32 * word, 32 * word + 32) - 32 * word);
            let bits = ((1u64 << to) - (1u64 << from.min(to))) as u32;
            self.words[row + word as usize] |= bits;
        }
    }

    fn is_hidden(&self, x: u32, y: u32) -> bool {
        self.words[y as usize * self.words_per_row + (x / 32) as usize] >> (x % 32) & 1 == 1
    }
}

/// The side of a line on which `normal · p + offset ≥ 0`.
#[derive(Clone, Copy)]
struct HalfPlane {
    normal: DVec2,
    offset: f64,
}

impl HalfPlane {
    fn at(&self, p: DVec2) -> f64 {
        self.normal.dot(p) + self.offset
    }

    /// The columns whose pixels in row `y` lie inside: wholly (`all`), or with at least a corner.
    fn columns(&self, y: u32, all: bool) -> [f64; 2] {
        // The corner of the pixel that is least, or most, inside.
        let corner = |slope: f64| if (slope < 0.0) == all { 1.0 } else { 0.0 };
        let DVec2 { x: slope, y: slope_y } = self.normal;
        let rest = slope_y * (f64::from(y) + corner(slope_y)) + self.offset + slope * corner(slope);
        // slope · x + rest ≥ 0
        if slope > 0.0 {
            [-rest / slope, f64::INFINITY]
        } else if slope < 0.0 {
            [f64::NEG_INFINITY, -rest / slope]
        } else if rest >= 0.0 {
            [f64::NEG_INFINITY, f64::INFINITY]
        } else {
            [f64::INFINITY, f64::NEG_INFINITY]
        }
    }
}

/// A triangle in pixels: the area inside all of its sides.
struct PixelTriangle {
    corners: [DVec2; 3],
    sides: [HalfPlane; 3],
}

impl PixelTriangle {
    /// `None` if it has no area, or a corner that is no number or too far away.
    fn in_pixels(corners: &[[f32; 2]; 3], fov: &Fov, size_px: [u32; 2]) -> Option<Self> {
        let [width, height] = size_px.map(f64::from);
        let [a, b, c] = corners.map(|[x, y]| {
            DVec2::new(
                (f64::from(x) - fov.left) / (fov.right - fov.left) * width,
                (fov.up - f64::from(y)) / (fov.up - fov.down) * height,
            )
        });
        let area = (b - a).perp_dot(c - a);
        let corners = if area > 0.0 { [a, b, c] } else { [a, c, b] };
        let is_one = area != 0.0 && [a, b, c].iter().all(|corner| corner.abs().max_element() <= REACH_PX);
        let side = |i: usize| {
            let (from, along) = (corners[i], corners[(i + 1) % 3] - corners[i]);
            let normal = along.perp();
            HalfPlane { normal, offset: -normal.dot(from) }
        };
        is_one.then(|| Self { corners, sides: [0, 1, 2].map(side) })
    }

    /// True if it reaches into row `y`.
    fn meets(&self, y: u32) -> bool {
        let (low, high) = self.reach(|corner| corner.y);
        low < f64::from(y + 1) && high > f64::from(y)
    }

    /// Columns whose pixels in row `y` lie wholly inside.
    fn covered(&self, y: u32, width: u32) -> std::ops::Range<u32> {
        let [from, to] = self.columns(y, true);
        pixels(from.ceil(), to.floor() + 1.0, width)
    }

    /// Columns whose pixels in row `y` may lie inside in part.
    fn touched(&self, y: u32, width: u32) -> std::ops::Range<u32> {
        let [from, to] = self.columns(y, false);
        let (low, high) = self.reach(|corner| corner.x);
        pixels(from.max(low.floor()).floor(), (to.floor() + 1.0).min(high.ceil()), width)
    }

    fn columns(&self, y: u32, all: bool) -> [f64; 2] {
        let sides = self.sides.iter().map(|side| side.columns(y, all));
        sides.fold([f64::NEG_INFINITY, f64::INFINITY], |[from, to], [a, b]| [from.max(a), to.min(b)])
    }

    fn reach(&self, axis: impl Fn(DVec2) -> f64) -> (f64, f64) {
        let values = self.corners.map(axis);
        (
            values.into_iter().fold(f64::INFINITY, f64::min),
            values.into_iter().fold(f64::NEG_INFINITY, f64::max),
        )
    }
}

/// The whole numbers from `from` up to, not including, `to`, within 0 to `size`.
fn pixels(from: f64, to: f64, size: u32) -> std::ops::Range<u32> {
    // `as` saturates: nothing reaches beyond the image.
    (from as u32).min(size)..(to as u32).min(size)
}

/// True if the triangles together cover the pixel. Each one is cut out of the pixel's square, until nothing is left.
fn cover_together<'a>(triangles: impl Iterator<Item = &'a PixelTriangle>, x: u32, y: u32) -> bool {
    let mut left = vec![ConvexPolygon::square(f64::from(x), f64::from(y))];
    for triangle in triangles {
        let mut outside = Vec::new();
        for mut piece in left {
            for side in &triangle.sides {
                if piece.is_inside(side) {
                    continue;
                }
                // A pixel whose pieces get too many corners is drawn.
                let Some([within, without]) = piece.split(side) else { return false };
                if without.area() > SLIVER {
                    outside.push(without);
                }
                piece = within;
            }
        }
        left = outside;
    }
    left.is_empty()
}

/// Corners that a [`ConvexPolygon`] can have.
const MAX_CORNERS: usize = 12;

/// A convex part of a pixel.
#[derive(Clone, Copy)]
struct ConvexPolygon {
    corners: [DVec2; MAX_CORNERS],
    num_corners: usize,
}

impl ConvexPolygon {
    const EMPTY: Self = Self { corners: [DVec2::ZERO; MAX_CORNERS], num_corners: 0 };

    fn square(x: f64, y: f64) -> Self {
        let mut square = Self { num_corners: 4, ..Self::EMPTY };
        for (corner, (i, j)) in
            square.corners.iter_mut().zip([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
        {
            *corner = DVec2::new(x + i, y + j);
        }
        square
    }

    fn push(&mut self, corner: DVec2) -> Option<()> {
        *self.corners.get_mut(self.num_corners)? = corner;
        self.num_corners += 1;
        Some(())
    }

    fn is_inside(&self, side: &HalfPlane) -> bool {
        self.corners[..self.num_corners].iter().all(|&corner| side.at(corner) >= 0.0)
    }

    /// The parts inside and outside of a half plane; `None` if one has too many corners.
    fn split(&self, side: &HalfPlane) -> Option<[Self; 2]> {
        let [mut within, mut without] = [Self::EMPTY; 2];
        let corners = &self.corners[..self.num_corners];
        for (i, &from) in corners.iter().enumerate() {
            let to = corners[(i + 1) % corners.len()];
            let (at_from, at_to) = (side.at(from), side.at(to));
            if at_from >= 0.0 {
                within.push(from)?;
            }
            if at_from <= 0.0 {
                without.push(from)?;
            }
            if at_from * at_to < 0.0 {
                let crossing = from.lerp(to, at_from / (at_from - at_to));
                within.push(crossing)?;
                without.push(crossing)?;
            }
        }
        Some([within, without])
    }

    fn area(&self) -> f64 {
        let Some((&first, rest)) = self.corners[..self.num_corners].split_first() else { return 0.0 };
        0.5 * rest.windows(2).map(|pair| (pair[0] - first).perp_dot(pair[1] - first)).sum::<f64>().abs()
    }
}

#[cfg(test)]
#[path = "hidden_area_tests.rs"]
mod tests;

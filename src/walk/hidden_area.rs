//! The part of an eye's image that the lenses hide, from the runtime's triangles to one bit a pixel.
//!
//! The triangles come in tangents, so they fit any field of view and resolution; the frame wants pixels. A
//! pixel is hidden only if hidden triangles cover its whole square: at the border a pixel too many is drawn, and
//! none is missing.

use crate::space::Fov;
use glam::DVec2;

/// Pieces of a pixel this small, in pixels of area, count as covered: rounding leaves them between two triangles
/// that touch.
const SLIVER: f64 = 1e-8;
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
    /// [`words_per_row`] words each, pixel x in bit x mod 32 of word x / 32. Bits beyond the width are 0.
    #[must_use]
    pub fn rasterize(&self, fov: &Fov, size_px: [u32; 2]) -> Vec<u32> {
        let triangles: Vec<Triangle> =
            self.triangles.iter().filter_map(|corners| Triangle::in_pixels(corners, fov, size_px)).collect();
        let mut mask = Mask::new(size_px);
        // Pixels that a triangle covers in part, with that triangle.
        let mut partly = Vec::new();
        for (number, triangle) in triangles.iter().enumerate() {
            for y in triangle.rows(size_px[1]) {
                let covered = triangle.covered(y, size_px[0]);
                mask.hide(y, covered.clone());
                let touched = triangle.touched(y, size_px[0]);
                let part = touched.filter(|x| !covered.contains(x));
                partly.extend(part.map(|x| (y, x, number)));
            }
        }
        partly.sort_unstable();
        for pixel in partly.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let (y, x, _) = pixel[0];
            if !mask.is_hidden(x, y) && cover_together(pixel.iter().map(|part| &triangles[part.2]), x, y) {
                mask.hide(y, x..x + 1);
            }
        }
        mask.words
    }
}

/// Words that a row of `width` bits takes.
#[must_use]
pub fn words_per_row(width: u32) -> usize {
    width.div_ceil(32) as usize
}

/// Both eyes' hidden pixels, made anew only when there is a reason to.
#[derive(Clone, Debug, Default)]
pub struct HiddenPixels {
    /// `None` while the headset has told nothing.
    areas: Option<[HiddenArea; 2]>,
    made_for: Option<[(Fov, [u32; 2]); 2]>,
}

impl HiddenPixels {
    /// New triangles, left then right.
    pub fn set_areas(&mut self, areas: [HiddenArea; 2]) {
        self.areas = Some(areas);
        self.made_for = None;
    }

    /// Masks as [`HiddenArea::rasterize`] makes them, if triangles, fields of view or sizes are not those of the
    /// last call.
    pub fn update(&mut self, fovs: [Fov; 2], sizes_px: [[u32; 2]; 2]) -> Option<[Vec<u32>; 2]> {
        let areas = self.areas.as_ref()?;
        let wanted = [(fovs[0], sizes_px[0]), (fovs[1], sizes_px[1])];
        if self.made_for == Some(wanted) {
            return None;
        }
        self.made_for = Some(wanted);
        Some([0, 1].map(|eye: usize| areas[eye].rasterize(&fovs[eye], sizes_px[eye])))
    }
}

/// Bits of an image.
struct Mask {
    words: Vec<u32>,
    words_per_row: usize,
}

impl Mask {
    fn new([width, height]: [u32; 2]) -> Self {
        let words_per_row = words_per_row(width);
        Self { words: vec![0; words_per_row * height as usize], words_per_row }
    }

    /// Word and bit of a pixel.
    fn place(&self, x: u32, y: u32) -> (usize, u32) {
        (y as usize * self.words_per_row + (x / 32) as usize, 1 << (x % 32))
    }

    fn hide(&mut self, y: u32, columns: std::ops::Range<u32>) {
        for x in columns {
            let (word, bit) = self.place(x, y);
            self.words[word] |= bit;
        }
    }

    fn is_hidden(&self, x: u32, y: u32) -> bool {
        let (word, bit) = self.place(x, y);
        self.words[word] & bit != 0
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

/// A triangle in pixels: what lies inside all of its sides.
struct Triangle {
    corners: [DVec2; 3],
    sides: [HalfPlane; 3],
}

impl Triangle {
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

    /// Rows of pixels that it meets.
    fn rows(&self, height: u32) -> std::ops::Range<u32> {
        let (low, high) = self.reach(|corner| corner.y);
        pixels(low.floor(), high.ceil(), height)
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

/// Whether the triangles together cover the pixel: cuts each out of its square and sees what is left.
fn cover_together<'a>(triangles: impl Iterator<Item = &'a Triangle>, x: u32, y: u32) -> bool {
    let (x, y) = (f64::from(x), f64::from(y));
    let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(i, j)| DVec2::new(x + i, y + j));
    let mut left = vec![square.to_vec()];
    for triangle in triangles {
        let mut outside = Vec::new();
        for mut piece in left {
            for side in &triangle.sides {
                let (within, without) = split(&piece, side);
                outside.push(without);
                piece = within;
            }
        }
        left = outside;
        left.retain(|piece| area(piece) > SLIVER);
    }
    left.is_empty()
}

/// A convex polygon's parts inside and outside of a half plane.
fn split(piece: &[DVec2], side: &HalfPlane) -> (Vec<DVec2>, Vec<DVec2>) {
    let (mut within, mut without) = (Vec::new(), Vec::new());
    for (i, &from) in piece.iter().enumerate() {
        let to = piece[(i + 1) % piece.len()];
        let (at_from, at_to) = (side.at(from), side.at(to));
        if at_from >= 0.0 {
            within.push(from);
        }
        if at_from <= 0.0 {
            without.push(from);
        }
        if at_from * at_to < 0.0 {
            let crossing = from.lerp(to, at_from / (at_from - at_to));
            within.push(crossing);
            without.push(crossing);
        }
    }
    (within, without)
}

/// Area of a convex polygon.
fn area(piece: &[DVec2]) -> f64 {
    let Some((&first, rest)) = piece.split_first() else { return 0.0 };
    0.5 * rest.windows(2).map(|pair| (pair[0] - first).perp_dot(pair[1] - first)).sum::<f64>().abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Asymmetric, as headsets are.
    const FOV: Fov = Fov { left: -1.2, right: 0.9, up: 1.0, down: -1.1 };
    /// No multiple of a word.
    const SIZE_PX: [u32; 2] = [45, 37];

    fn is_set(words: &[u32], x: u32, y: u32) -> bool {
        words[y as usize * words_per_row(SIZE_PX[0]) + (x / 32) as usize] >> (x % 32) & 1 == 1
    }

    fn tangents(x: f64, y: f64) -> [f64; 2] {
        let [width, height] = SIZE_PX.map(f64::from);
        [FOV.left + x / width * (FOV.right - FOV.left), FOV.up - y / height * (FOV.up - FOV.down)]
    }

    /// A fraction of a pixel, in tangents.
    const MARGIN: f64 = 1e-5;

    /// How far inside the triangle a point lies, in tangents; negative: outside.
    fn depth_in(corners: &[[f32; 2]; 3], [x, y]: [f64; 2]) -> f64 {
        let [a, b, c] = corners.map(|[x, y]| DVec2::new(x.into(), y.into()));
        let turn = (b - a).perp_dot(c - a).signum();
        let depth = |from: DVec2, to: DVec2| {
            turn * (to - from).perp_dot(DVec2::new(x, y) - from) / (to - from).length()
        };
        depth(a, b).min(depth(b, c)).min(depth(c, a))
    }

    /// Hidden pixels with a spot that no triangle hides, of 5 × 5 spots each.
    fn num_wrongly_hidden(area: &HiddenArea, words: &[u32]) -> usize {
        let all = (0..SIZE_PX[1]).flat_map(|y| (0..SIZE_PX[0]).map(move |x| (x, y)));
        let visible_spot = |x: u32, y: u32| {
            (0..25).any(|i| {
                let spot =
                    tangents(f64::from(x) + 0.25 * f64::from(i % 5), f64::from(y) + 0.25 * f64::from(i / 5));
                area.triangles.iter().all(|triangle| depth_in(triangle, spot) < -MARGIN)
            })
        };
        all.filter(|&(x, y)| is_set(words, x, y) && visible_spot(x, y)).count()
    }

    /// Pixels that one triangle covers by a margin and that are not hidden.
    fn num_missed(area: &HiddenArea, words: &[u32]) -> usize {
        let all = (0..SIZE_PX[1]).flat_map(|y| (0..SIZE_PX[0]).map(move |x| (x, y)));
        let covered = |x: u32, y: u32, triangle: &[[f32; 2]; 3]| {
            [(0, 0), (1, 0), (0, 1), (1, 1)]
                .iter()
                .all(|(i, j)| depth_in(triangle, tangents(f64::from(x + i), f64::from(y + j))) > MARGIN)
        };
        let any = |x, y| area.triangles.iter().any(|triangle| covered(x, y, triangle));
        all.filter(|&(x, y)| !is_set(words, x, y) && any(x, y)).count()
    }

    fn rasterize(area: &HiddenArea) -> Vec<u32> {
        area.rasterize(&FOV, SIZE_PX)
    }

    fn corner() -> impl Strategy<Value = [f32; 2]> {
        [-1.6f32..1.6, -1.6f32..1.6]
    }

    proptest! {
        #[test]
        fn hidden_is_what_triangles_cover(triangles in prop::collection::vec([corner(), corner(), corner()], 0..12)) {
            let area = HiddenArea { triangles };
            let words = rasterize(&area);
            prop_assert_eq!(num_wrongly_hidden(&area, &words), 0);
            prop_assert_eq!(num_missed(&area, &words), 0);
            let beyond = words.chunks_exact(2).any(|row| row[1] >> (SIZE_PX[0] - 32) != 0);
            prop_assert!(!beyond, "bits beyond the width");
        }

        /// A surface of many triangles hides the pixels on its inner edges too, and an overlap changes nothing.
        #[test]
        fn a_fan_round_any_point_hides_everything(hub in corner(), turn in 0.0f32..1.0, num in 3usize..40) {
            let rim = |i: usize| {
                let angle = std::f32::consts::TAU * ((i % num) as f32 + turn) / num as f32;
                [hub[0] + 9.0 * angle.cos(), hub[1] + 9.0 * angle.sin()]
            };
            let mut area = HiddenArea { triangles: (0..num).map(|i| [hub, rim(i), rim(i + 1)]).collect() };
            let words = rasterize(&area);
            let num_hidden: u32 = words.iter().map(|word| word.count_ones()).sum();
            prop_assert_eq!(num_hidden, SIZE_PX[0] * SIZE_PX[1]);
            let twice = area.triangles.clone();
            area.triangles.extend(twice);
            prop_assert_eq!(rasterize(&area), words);
        }
    }

    #[test]
    fn both_counts_can_fail() {
        let area = HiddenArea { triangles: vec![[[-1.2, 1.0], [-1.2, -1.1], [0.9, -1.1]]] };
        let words = rasterize(&area);
        assert_eq!((num_wrongly_hidden(&area, &words), num_missed(&area, &words)), (0, 0));
        let everything = vec![!0; words.len()];
        assert!(num_wrongly_hidden(&area, &everything) > 700);
        assert!(num_missed(&area, &vec![0; words.len()]) > 700);
    }

    /// What a test of corners and centre alone would hide.
    #[test]
    fn a_hole_between_corners_keeps_its_pixel() {
        let fov = Fov { left: -1.0, right: 1.0, up: 1.0, down: -1.0 };
        // Everything but a strip through the only pixel, between its centre and its corners.
        let (below, above) = ([[-9.0, -9.0], [9.0, -9.0]], [[-9.0, 9.0], [9.0, 9.0]]);
        let band = |[a, b]: [[f32; 2]; 2], y: f32| [[a, b, [9.0, y]], [a, [9.0, y], [-9.0, y]]];
        let strip = |from, to| HiddenArea { triangles: [band(below, from), band(above, to)].concat() };
        assert_eq!(strip(0.4, 0.6).rasterize(&fov, [1, 1]), [0]);
        assert_eq!(strip(0.5, 0.5).rasterize(&fov, [1, 1]), [1]);
    }

    #[test]
    fn up_is_up_and_left_is_left() {
        let fov = Fov { left: -1.0, right: 1.0, up: 1.0, down: -1.0 };
        let top_left = HiddenArea { triangles: vec![[[-1.0, 1.0], [1.0, 1.0], [-1.0, -1.0]]] };
        assert_eq!(top_left.rasterize(&fov, [4, 4]), [0b0111, 0b0011, 0b0001, 0]);
        // The same corners the other way round.
        let reversed = HiddenArea { triangles: vec![[[-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]] };
        assert_eq!(reversed.rasterize(&fov, [4, 4]), [0b0111, 0b0011, 0b0001, 0]);
    }

    #[test]
    fn nonsense_hides_nothing() {
        let mesh = HiddenArea::from_mesh(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], &[0, 1, 2, 0, 1, 3, 2, 1]);
        assert_eq!(mesh.triangles, [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]]);
        for odd in [f32::NAN, f32::INFINITY, f32::MAX] {
            let area = HiddenArea { triangles: vec![[[-9.0, -9.0], [odd, -9.0], [0.0, 9.0]]] };
            assert!(rasterize(&area).iter().all(|word| *word == 0), "{odd}");
        }
        let line = HiddenArea { triangles: vec![[[-1.0, -1.0], [0.0, 0.0], [1.0, 1.0]]] };
        assert!(rasterize(&line).iter().all(|word| *word == 0));
        let flat = Fov { left: 0.5, right: 0.5, ..FOV };
        assert!(mesh.rasterize(&flat, SIZE_PX).iter().all(|word| *word == 0));
    }

    #[test]
    fn pixels_are_made_anew_for_a_reason_only() {
        let mut pixels = HiddenPixels::default();
        let (fovs, sizes) = ([FOV, FOV.mirrored()], [SIZE_PX; 2]);
        assert_eq!(pixels.update(fovs, sizes), None, "the headset told nothing");
        let area = HiddenArea { triangles: vec![[[-1.2, 1.0], [-1.2, -1.1], [0.9, -1.1]]] };
        pixels.set_areas([area.clone(), HiddenArea::default()]);
        let [left, right] = pixels.update(fovs, sizes).expect("new triangles");
        assert_eq!(left, rasterize(&area));
        assert!(right.iter().all(|word| *word == 0));
        assert_eq!(pixels.update(fovs, sizes), None);
        assert!(pixels.update(fovs, [SIZE_PX, [20, 20]]).is_some(), "another size");
        assert!(pixels.update([FOV, FOV], [SIZE_PX, [20, 20]]).is_some(), "another field of view");
        pixels.set_areas([HiddenArea::default(), area]);
        assert!(pixels.update([FOV, FOV], [SIZE_PX, [20, 20]]).is_some(), "other triangles");
    }
}

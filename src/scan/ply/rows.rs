//! What was read of rows so far: a point's columns as the file has them, triangles by the file's numbers.

use super::plan::{Color, Intensity, Kept};
use std::collections::TryReserveError;
use std::ops::Range;

/// Values of a point that are kept, in this order.
pub(super) const SLOT_PLACE: Range<usize> = 0..3;
pub(super) const SLOT_RGB: Range<usize> = 3..6;
pub(super) const SLOT_INTENSITY: usize = 6;
pub(super) const SLOT_NORMAL: Range<usize> = 7..10;
pub(super) const NUM_SLOTS: usize = 10;

/// Columns, empty or as long as `places`, and what faces say.
#[derive(Debug, Default)]
pub(super) struct Rows {
    /// World positions; held as f64 until all are known, because only then the lattice is.
    pub places: Vec<[f64; 3]>,
    /// Colours of integer types.
    pub rgb: Vec<[u16; 3]>,
    /// Colours of float types.
    pub float_rgb: Vec<[f32; 3]>,
    pub intensity: Vec<f32>,
    /// Unit length or NaN.
    pub normals: Vec<[f32; 3]>,
    /// Of the numbers that points have in the file.
    pub triangles: Vec<[u32; 3]>,
    /// Rows of faces or strips, also those without triangles.
    pub num_faces: u64,
    /// Faces and strips that name points which there are not.
    pub num_bad_faces: u64,
    /// Numbers that faces may name are less than this.
    pub num_points_announced: u64,
    /// The corners of the row that is being read.
    pub corners: Vec<f64>,
}

impl Rows {
    /// None yet, of a file with so many points.
    pub fn new(num_points_announced: u64) -> Self {
        Self { num_points_announced, ..Self::default() }
    }

    /// Makes room for points.
    pub fn reserve(&mut self, num_points: u64, has: Kept) -> Result<(), TryReserveError> {
        // What exceeds usize exceeds memory.
        let more = |needed: bool| if needed { usize::try_from(num_points).unwrap_or(usize::MAX) } else { 0 };
        self.places.try_reserve_exact(more(true))?;
        self.rgb.try_reserve_exact(more(matches!(has.color, Color::Integers(_))))?;
        self.float_rgb.try_reserve_exact(more(has.color == Color::Floats))?;
        self.intensity.try_reserve_exact(more(has.intensity != Intensity::Absent))?;
        self.normals.try_reserve_exact(more(has.normal))
    }

    /// Adds a point; NaN where a value is unknown.
    pub fn push_point(&mut self, has: Kept, values: &[f64; NUM_SLOTS]) {
        let three =
            |range: Range<usize>| [values[range.start], values[range.start + 1], values[range.start + 2]];
        self.places.push(three(SLOT_PLACE));
        match has.color {
            Color::Absent => {}
            Color::Integers(largest) => {
                let rgb = three(SLOT_RGB);
                self.rgb.push(std::array::from_fn(|channel| unsigned(rgb[channel], largest[channel])));
            }
            Color::Floats => self.float_rgb.push(three(SLOT_RGB).map(|c| c as f32)),
        }
        if has.intensity != Intensity::Absent {
            self.intensity.push(values[SLOT_INTENSITY] as f32);
        }
        if has.normal {
            self.normals.push(unit(three(SLOT_NORMAL)));
        }
    }

    /// Adds the polygon of `corners` as a fan round its first.
    pub fn push_face(&mut self) {
        self.num_faces += 1;
        if !self.corners.iter().all(|corner| self.names_a_point(*corner)) {
            self.num_bad_faces += 1;
            return;
        }
        for i in 2..self.corners.len() {
            self.push_triangle([0, i - 1, i]);
        }
    }

    /// Adds the strips of `corners`: each triangle has two corners of the one before, and the other orientation.
    pub fn push_strips(&mut self) {
        self.num_faces += 1;
        let mut start = 0;
        for end in 0..=self.corners.len() {
            if self.corners.get(end).is_some_and(|corner| *corner >= 0.0) {
                continue;
            }
            if self.corners[start..end].iter().all(|corner| self.names_a_point(*corner)) {
                for i in start + 2..end {
                    let flipped = (i - start) % 2;
                    self.push_triangle([i - 2 + flipped, i - 1 - flipped, i]);
                }
            } else {
                self.num_bad_faces += 1;
            }
            start = end + 1;
        }
    }

    /// Adds what was read after this.
    pub fn append(&mut self, mut later: Self) {
        self.places.append(&mut later.places);
        self.rgb.append(&mut later.rgb);
        self.float_rgb.append(&mut later.float_rgb);
        self.intensity.append(&mut later.intensity);
        self.normals.append(&mut later.normals);
        self.triangles.append(&mut later.triangles);
        self.num_faces += later.num_faces;
        self.num_bad_faces += later.num_bad_faces;
    }

    fn names_a_point(&self, corner: f64) -> bool {
        // NaN is none; numbers beyond u32 cannot be kept.
        corner >= 0.0 && corner < self.num_points_announced.min(1 << 32) as f64
    }

    /// Adds a triangle of three checked places in `corners`, unless it has no area.
    fn push_triangle(&mut self, at: [usize; 3]) {
        let [a, b, c] = at.map(|i| self.corners[i] as u32);
        if a != b && b != c && c != a {
            self.triangles.push([a, b, c]);
        }
    }
}

/// An integer of 8 or 16 bits, whether it was stored with a sign or not.
fn unsigned(value: f64, largest: u16) -> u16 {
    let value = if value < 0.0 { value + f64::from(largest) + 1.0 } else { value };
    // `as` saturates, and makes 0 of NaN.
    (value as u16).min(largest)
}

/// The same direction with length 1; NaN where there is none.
fn unit(v: [f64; 3]) -> [f32; 3] {
    let v = glam::DVec3::from_array(v);
    // Scaled first: the square of a length need not be finite.
    let v = v / v.abs().max_element();
    (v / v.length()).as_vec3().to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(corners: &[f64], push: fn(&mut Rows)) -> (Vec<[u32; 3]>, u64, u64) {
        let mut rows = Rows { corners: corners.to_vec(), ..Rows::new(6) };
        push(&mut rows);
        (rows.triangles, rows.num_faces, rows.num_bad_faces)
    }

    #[test]
    fn polygons_become_fans() {
        let face = |corners: &[f64]| triangles(corners, Rows::push_face);
        assert_eq!(face(&[3.0, 1.0, 2.0, 5.0, 0.0]), (vec![[3, 1, 2], [3, 2, 5], [3, 5, 0]], 1, 0));
        assert_eq!(face(&[3.0, 1.0, 1.0, 5.0]), (vec![[3, 1, 5]], 1, 0));
        assert_eq!(face(&[3.0, 1.0]), (vec![], 1, 0));
        for bad in [6.0, -1.0, f64::NAN, 1e12] {
            assert_eq!(face(&[0.0, 1.0, 2.0, bad]), (vec![], 1, 1), "{bad}");
        }
    }

    #[test]
    fn strips_alternate_and_start_again() {
        let strips = |corners: &[f64]| triangles(corners, Rows::push_strips);
        assert_eq!(strips(&[0.0, 1.0, 2.0, 3.0, 4.0]), (vec![[0, 1, 2], [2, 1, 3], [2, 3, 4]], 1, 0));
        let parted = [0.0, 1.0, 2.0, -1.0, 1.0, 2.0, 3.0, -1.0, 4.0, 5.0, 6.0, -1.0];
        assert_eq!(strips(&parted), (vec![[0, 1, 2], [1, 2, 3]], 1, 1));
    }

    #[test]
    fn signed_bytes_are_their_bits() {
        assert_eq!([-1.0, -128.0, 64.0, 300.0, f64::NAN].map(|v| unsigned(v, 255)), [255, 128, 64, 255, 0]);
        assert_eq!([-1.0, 70_000.0].map(|v| unsigned(v, u16::MAX)), [u16::MAX; 2]);
    }

    #[test]
    fn normals_have_unit_length_or_are_none() {
        assert_eq!(unit([0.0, -3.0, 4.0]), [0.0, -0.6, 0.8]);
        assert_eq!(unit([1e200, 0.0, 0.0]), [1.0, 0.0, 0.0]);
        assert_eq!(unit([0.0, 1e-300, 0.0]), [0.0, 1.0, 0.0]);
        for none in [[0.0; 3], [f64::NAN, 1.0, 0.0], [f64::INFINITY, 0.0, 0.0]] {
            assert!(unit(none)[0].is_nan(), "{none:?}");
        }
    }
}

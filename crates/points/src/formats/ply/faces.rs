//! Turns polygons and strips of a mesh into triangles, by the numbers that points have in the file.

use super::point;
use super::reader::{Color, RowValues};

/// Triangles and colors of the faces so far.
#[derive(Debug, Default)]
pub(super) struct Faces {
    pub triangles: Vec<[u32; 3]>,
    /// One color per triangle, or none at all.
    pub colors: Vec<[u16; 3]>,
    /// Rows of faces or strips, also those without triangles.
    pub num_faces: u64,
    /// Faces and strips that name points that do not exist.
    pub num_bad: u64,
    /// Faces with a list of colors of neither 3 nor 4 values.
    pub num_odd_lists: u64,
    /// Numbers that faces may name are less than this.
    pub num_points: u64,
}

impl Faces {
    /// No faces yet, in a file with this many points.
    pub fn new(num_points: u64) -> Self {
        Self { num_points, ..Self::default() }
    }

    /// Adds the polygon of a row as a fan round its first corner.
    pub fn push_face(&mut self, color: Color, row: &RowValues) {
        self.num_faces += 1;
        self.num_odd_lists += u64::from(row.has_odd_list);
        if !row.corners.iter().all(|corner| self.names_a_point(*corner)) {
            self.num_bad += 1;
            return;
        }
        let before = self.triangles.len();
        for i in 2..row.corners.len() {
            self.push_triangle(&row.corners, [0, i - 1, i]);
        }
        if color != Color::Absent {
            let color = rgb(color, row);
            self.colors.extend((before..self.triangles.len()).map(|_| color));
        }
    }

    /// Adds the strips of a row: each triangle has two corners of the triangle before, and the other orientation.
    pub fn push_strips(&mut self, row: &RowValues) {
        self.num_faces += 1;
        let mut start = 0;
        for end in 0..=row.corners.len() {
            if row.corners.get(end).is_some_and(|corner| *corner >= 0.0) {
                continue;
            }
            if row.corners[start..end].iter().all(|corner| self.names_a_point(*corner)) {
                for i in start + 2..end {
                    let flipped = (i - start) % 2;
                    self.push_triangle(&row.corners, [i - 2 + flipped, i - 1 - flipped, i]);
                }
            } else {
                self.num_bad += 1;
            }
            start = end + 1;
        }
    }

    /// Appends the faces that follow these.
    pub fn append(&mut self, mut later: Self) {
        self.triangles.append(&mut later.triangles);
        self.colors.append(&mut later.colors);
        self.num_faces += later.num_faces;
        self.num_bad += later.num_bad;
        self.num_odd_lists += later.num_odd_lists;
    }

    fn names_a_point(&self, corner: f64) -> bool {
        // NaN names no point, and numbers beyond u32 cannot be kept.
        corner >= 0.0 && corner < self.num_points.min(1 << 32) as f64
    }

    /// Adds a triangle of the corners at three indices, unless two of them are the same.
    fn push_triangle(&mut self, corners: &[f64], at: [usize; 3]) {
        let [a, b, c] = at.map(|i| corners[i] as u32);
        if a != b && b != c && c != a {
            self.triangles.push([a, b, c]);
        }
    }

    /// Leaves out triangles of points that are `gone`, which has rising numbers, and gives the others the numbers that
    /// points have then, less than `num_left`.
    pub fn renumber(&mut self, gone: &[u32], num_left: usize) {
        let new = |corner: u32| {
            let before = if gone.is_empty() { 0 } else { gone.binary_search(&corner).err()? };
            Some(corner - before as u32).filter(|&corner| (corner as usize) < num_left)
        };
        let mut kept = Vec::new();
        let mut is_kept = |is_kept: bool| {
            if !self.colors.is_empty() {
                kept.push(is_kept);
            }
            is_kept
        };
        self.triangles.retain_mut(|corners| {
            let renumbered = corners.map(new);
            let [Some(a), Some(b), Some(c)] = renumbered else { return is_kept(false) };
            *corners = [a, b, c];
            is_kept(true)
        });
        let mut kept = kept.into_iter();
        self.colors.retain(|_| kept.next().unwrap_or(false));
    }

    /// The colors of points, taken from the first face that each belongs to; black where it belongs to none. Empty if
    /// faces have no color.
    pub fn colors_of_points(&self, num_points: usize) -> Vec<[u16; 3]> {
        if self.colors.is_empty() {
            return Vec::new();
        }
        let mut rgb = vec![[0; 3]; num_points];
        for (corners, color) in self.triangles.iter().zip(&self.colors).rev() {
            corners.iter().for_each(|&corner| rgb[corner as usize] = *color);
        }
        rgb
    }
}

/// A face's color. Floats, which are 0 to 1 or 0 to 255, become 16 bits.
fn rgb(color: Color, row: &RowValues) -> [u16; 3] {
    let rgb = point::rgb(color, row, 65535.0);
    let is_above_one = color == Color::Floats && row.three(super::reader::SLOT_RGB).iter().any(|&c| c > 1.0);
    if is_above_one { point::rgb(color, row, 257.0) } else { rgb }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(corners: &[f64]) -> RowValues {
        RowValues { corners: corners.to_vec(), ..RowValues::default() }
    }

    #[test]
    fn polygons_become_fans() {
        let face = |corners: &[f64]| {
            let mut faces = Faces::new(6);
            faces.push_face(Color::Absent, &row(corners));
            (faces.triangles, faces.num_faces, faces.num_bad)
        };
        assert_eq!(face(&[3.0, 1.0, 2.0, 5.0, 0.0]), (vec![[3, 1, 2], [3, 2, 5], [3, 5, 0]], 1, 0));
        assert_eq!(face(&[3.0, 1.0, 1.0, 5.0]), (vec![[3, 1, 5]], 1, 0));
        assert_eq!(face(&[3.0, 1.0]), (vec![], 1, 0));
        for bad in [6.0, -1.0, f64::NAN, 1e12] {
            assert_eq!(face(&[0.0, 1.0, 2.0, bad]), (vec![], 1, 1), "{bad}");
        }
    }

    #[test]
    fn strips_alternate_and_start_again() {
        let strips = |corners: &[f64]| {
            let mut faces = Faces::new(6);
            faces.push_strips(&row(corners));
            (faces.triangles, faces.num_faces, faces.num_bad)
        };
        assert_eq!(strips(&[0.0, 1.0, 2.0, 3.0, 4.0]), (vec![[0, 1, 2], [2, 1, 3], [2, 3, 4]], 1, 0));
        let parted = [0.0, 1.0, 2.0, -1.0, 1.0, 2.0, 3.0, -1.0, 4.0, 5.0, 6.0, -1.0];
        assert_eq!(strips(&parted), (vec![[0, 1, 2], [1, 2, 3]], 1, 1));
    }

    #[test]
    fn points_that_are_gone_take_their_triangles_along() {
        let mut faces = Faces::new(9);
        faces.triangles = vec![[0, 2, 4], [0, 1, 2], [4, 2, 0], [2, 3, 4], [0, 2, 7]];
        faces.colors = (1..=5).map(|c| [c; 3]).collect();
        faces.renumber(&[1, 3], 3);
        assert_eq!(
            (&faces.triangles[..], &faces.colors[..]),
            (&[[0, 1, 2], [2, 1, 0]][..], &[[1; 3], [3; 3]][..])
        );
        faces.triangles.push([0, 1, 3]);
        faces.colors.push([9; 3]);
        faces.renumber(&[], 3);
        assert_eq!((faces.triangles.len(), faces.colors.len()), (2, 2));
    }

    #[test]
    fn corners_have_the_color_of_their_first_face() {
        let mut faces = Faces::new(5);
        let mut row = row(&[0.0, 1.0, 2.0, 3.0]);
        row.values[3..6].copy_from_slice(&[7.0, 8.0, 9.0]);
        faces.push_face(Color::Integers([255; 3]), &row);
        row.corners = vec![2.0, 3.0, 4.0];
        row.values[3..6].copy_from_slice(&[1.0, 2.0, 3.0]);
        faces.push_face(Color::Integers([255; 3]), &row);
        let expected = [[7, 8, 9], [7, 8, 9], [7, 8, 9], [7, 8, 9], [1, 2, 3], [0; 3]];
        assert_eq!(faces.colors_of_points(6), expected);
        assert!(Faces::new(5).colors_of_points(6).is_empty());
        row.values[3..6].copy_from_slice(&[1.0, 0.5, 0.0]);
        assert_eq!(rgb(Color::Floats, &row), [65535, 32768, 0]);
        row.values[3..6].copy_from_slice(&[255.0, 1.0, 0.0]);
        assert_eq!(rgb(Color::Floats, &row), [65535, 257, 0]);
    }
}

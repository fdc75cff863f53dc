//! From what the survey found to how rows become columns, and from rows to the columns of a scan.

use super::grid::Grid;
use super::plan::{Color, Intensity};
use super::point::Meaning;
use super::rows::{How, Rows};
use super::survey::Found;
use crate::scan::stats::Stats;
use crate::scan::{Columns, Points};
use rayon::prelude::*;

/// Points of a task for a core.
const BLOCK: usize = 1 << 16;

/// How to put the points of a file into columns.
pub(super) fn how<'a>(meaning: &'a Meaning, found: &Found, has_faces: bool, num_announced: u64) -> How<'a> {
    How {
        meaning,
        grid: Grid::over(found.sample.clone(), found.bounds),
        color_factor: float_factor(found.bright, found.num_kept).0,
        intensity: intensity_ramp(found.intensity, meaning.has.intensity),
        has_faces,
        num_announced,
    }
}

/// What is left out with faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Loss {
    /// Triangles of points that are left out.
    pub num_triangles: u64,
    /// Faces that name points which there are not.
    pub num_faces: u64,
}

/// The columns of a file, whose faces have colors of this kind.
pub(super) fn columns(mut rows: Rows, how: &How, found: &Found, of_faces: Color) -> (Columns, Loss) {
    let (num_points, num_triangles) = (rows.xyz.len(), rows.faces.triangles.len());
    rows.faces.renumber(&rows.gone, num_points);
    let num_triangles = (num_triangles - rows.faces.triangles.len()) as u64;
    let loss = Loss { num_triangles, num_faces: rows.faces.num_bad };
    if rows.rgb.is_empty() {
        rows.rgb = rows.faces.colors_of_points(num_points);
    }
    let mut stats = stats(&rows.xyz, &rows.rgb, &rows.intensity);
    stats.colors.known = white(how.meaning, found, of_faces);
    let triangles = rows.faces.triangles;
    let Rows { xyz, rgb, intensity, normals, .. } = rows;
    let points = Points { xyz, rgb, intensity, normals, ..Points::default() };
    (Columns { lattice: how.grid.lattice, points, triangles, stats, warnings: Vec::new() }, loss)
}

/// The largest that a color can be, where the file or its format says so.
fn white(meaning: &Meaning, found: &Found, of_faces: Color) -> Option<u16> {
    match (meaning.has.color, of_faces) {
        (Color::Floats, _) => Some(float_factor(found.bright, found.num_kept).1),
        (Color::Absent, Color::Floats) => Some(u16::MAX),
        _ => meaning.white(),
    }
}

fn stats(xyz: &[[i32; 3]], rgb: &[[u16; 3]], intensity: &[u16]) -> Stats {
    let xyz = xyz.par_chunks(BLOCK).map(|block| Stats::of(block, &[], &[]));
    let rgb = rgb.par_chunks(BLOCK).map(|block| Stats::of(&[], block, &[]));
    let intensity = intensity.par_chunks(BLOCK).map(|block| Stats::of(&[], &[], block));
    xyz.chain(rgb).chain(intensity).reduce(|| Stats::EMPTY, Stats::union)
}

/// What float colors are multiplied by, and what white is then: 0 to 1 is what float colors should be, but some
/// programs write 0 to 255, or to 65535. Single values beyond an end are wrong and prove nothing. `bright`: how many
/// channels are above 1, and above 255.
fn float_factor(bright: [u64; 2], num_points: u64) -> (f64, u16) {
    let most_wrong = 3 * num_points / 500;
    match bright.map(|count| count > most_wrong) {
        [false, _] => (65535.0, u16::MAX),
        [true, false] => (1.0, 255),
        [true, true] => (1.0, u16::MAX),
    }
}

/// What intensities have subtracted, and are then multiplied by. Integers stay if 16 bits hold them; others are
/// spread so that the smallest becomes 0 and the largest 65535.
fn intensity_ramp((low, high): (f64, f64), kind: Intensity) -> (f64, f64) {
    if kind == Intensity::Integers && low >= 0.0 && high <= 65535.0 {
        (0.0, 1.0)
    } else if low < high {
        // Halved first: the difference need not be finite.
        (low, 32767.5 / (0.5 * high - 0.5 * low))
    } else {
        // The same everywhere says nothing.
        (low, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integer_intensities_stay_and_others_are_spread() {
        let spread = |values: &[f64], kind| {
            let finite = values.iter().copied().filter(|value| value.is_finite());
            let range = finite.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
            let (start, factor) = intensity_ramp(range, kind);
            values.iter().map(|v| ((v - start) * factor).round() as u16).collect::<Vec<_>>()
        };
        assert_eq!(spread(&[0.0, 7.0, 65535.0], Intensity::Integers), [0, 7, 65535]);
        assert_eq!(spread(&[-1.0, 0.0, 1.0], Intensity::Integers), [0, 32768, 65535]);
        assert_eq!(spread(&[0.0, 0.25, f64::NAN, 0.5], Intensity::Floats), [0, 32768, 0, 65535]);
        let (min, max) = (f64::from(f32::MIN), f64::from(f32::MAX));
        assert_eq!(spread(&[min, max, f64::INFINITY], Intensity::Floats), [0, 65535, 65535]);
        assert_eq!(spread(&[3.5, 3.5], Intensity::Floats), [0, 0]);
        assert_eq!(spread(&[f64::NAN], Intensity::Floats), [0]);
    }

    #[test]
    fn float_colors_are_as_bright_as_they_say() {
        assert_eq!(float_factor([0, 0], 10), (65535.0, u16::MAX));
        assert_eq!(float_factor([1, 0], 10), (1.0, 255));
        assert_eq!(float_factor([30, 1], 10), (1.0, u16::MAX));
        // Single values beyond the end are wrong.
        assert_eq!(float_factor([12, 12], 2000), (65535.0, u16::MAX));
        assert_eq!(float_factor([6000, 12], 2000), (1.0, 255));
    }
}

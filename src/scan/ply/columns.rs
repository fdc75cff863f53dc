//! From what the rows say to the columns of a scan: points without a place go, numbers become lattice
//! coordinates, colours and intensities of 16 bits.

use super::grid;
use super::plan::{Color, Intensity, Kept};
use super::rows::Rows;
use crate::scan::stats::Stats;
use crate::scan::{Columns, Lattice, Points};
use rayon::prelude::*;

/// Points of a task for a core.
const BLOCK: usize = 1 << 16;

/// What leaving points out cost.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Loss {
    /// Points without a place.
    pub num_points: u64,
    /// Triangles of points that are not there.
    pub num_triangles: u64,
}

/// Leaves out points without a place, and triangles of points that are not there; renumbers the rest.
pub(super) fn leave_out(rows: &mut Rows) -> Loss {
    let before = rows.triangles.len();
    let placed: Vec<bool> = rows.places.par_iter().map(grid::is_place).collect();
    let num_placed = placed.par_iter().filter(|&&placed| placed).count();
    let num_lost = placed.len() - num_placed;
    if num_lost > 0 {
        let new_numbers = new_numbers(&placed);
        rows.triangles = std::mem::take(&mut rows.triangles)
            .into_iter()
            .filter_map(|corners| {
                let new = corners.map(|corner| new_numbers.get(corner as usize).copied().flatten());
                Some([new[0]?, new[1]?, new[2]?])
            })
            .collect();
        keep(&mut rows.places, &placed);
        keep(&mut rows.rgb, &placed);
        keep(&mut rows.float_rgb, &placed);
        keep(&mut rows.intensity, &placed);
        keep(&mut rows.normals, &placed);
    } else {
        // Faces may stand before points that the file then has not got.
        let is_there = |corner: &u32| (*corner as usize) < num_placed;
        rows.triangles.retain(|corners| corners.iter().all(is_there));
    }
    Loss { num_points: num_lost as u64, num_triangles: (before - rows.triangles.len()) as u64 }
}

/// The number that each point has once those without a place are gone.
fn new_numbers(placed: &[bool]) -> Vec<Option<u32>> {
    let mut next = 0u32;
    let number = |&placed: &bool| {
        let number = placed.then_some(next);
        // Beyond u32 no triangle names a point.
        next = next.saturating_add(u32::from(placed));
        number
    };
    placed.iter().map(number).collect()
}

fn keep<T>(column: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    column.retain(|_| kept.next().copied().unwrap_or(false));
}

/// The columns of at least one point, all of which have a place.
pub(super) fn columns(rows: Rows, has: Kept, warnings: Vec<String>) -> Columns {
    let lattice: Lattice = grid::lattice(grid::bounds(&rows.places));
    let xyz = grid::snap(&lattice, &rows.places);
    drop(rows.places);
    let (rgb, depth) = match has.color {
        Color::Floats => float_colors(&rows.float_rgb),
        _ => (rows.rgb, None),
    };
    let intensity = intensities(&rows.intensity, has.intensity);
    let mut stats = stats(&xyz, &rgb, &intensity);
    if stats.rgb_max > 0 {
        stats.rgb_max = depth.unwrap_or(stats.rgb_max);
    }
    let points = Points { xyz, rgb, intensity, normals: rows.normals };
    Columns { lattice, points, triangles: rows.triangles, stats, warnings }
}

fn stats(xyz: &[[i32; 3]], rgb: &[[u16; 3]], intensity: &[u16]) -> Stats {
    let xyz = xyz.par_chunks(BLOCK).map(|block| Stats::of(block, &[], &[]));
    let rgb = rgb.par_chunks(BLOCK).map(|block| Stats::of(&[], block, &[]));
    let intensity = intensity.par_chunks(BLOCK).map(|block| Stats::of(&[], &[], block));
    xyz.chain(rgb).chain(intensity).reduce(|| Stats::EMPTY, Stats::union)
}

/// Colours as integers, and the largest that white would have: 0 to 1 is what float colours should be, but some
/// programs write 0 to 255, or to 65535.
fn float_colors(rgb: &[[f32; 3]]) -> (Vec<[u16; 3]>, Option<u16>) {
    // `max` passes over NaN.
    let brightest =
        rgb.par_iter().map(|rgb| rgb.iter().fold(0f32, |a, &b| a.max(b))).reduce(|| 0.0, f32::max);
    let (factor, white) = match brightest {
        ..=1.0 => (65535.0, u16::MAX),
        ..=255.0 => (1.0, 255),
        _ => (1.0, u16::MAX),
    };
    // `as` saturates, and makes 0 of NaN.
    let integers = rgb.par_iter().map(|rgb| rgb.map(|c| (c * factor).round() as u16)).collect();
    (integers, Some(white))
}

/// Integers as they are if 16 bits hold them; others so that the smallest becomes 0 and the largest 65535.
fn intensities(values: &[f32], kind: Intensity) -> Vec<u16> {
    let finite = values.par_iter().filter(|value| value.is_finite());
    let (low, high) = finite
        .map(|&value| (value, value))
        .reduce(|| (f32::MAX, f32::MIN), |a, b| (a.0.min(b.0), a.1.max(b.1)));
    let (low, high) = (f64::from(low), f64::from(high));
    let (start, factor) = if kind == Intensity::Integers && low >= 0.0 && high <= 65535.0 {
        (0.0, 1.0)
    } else if low < high {
        (low, 65535.0 / (high - low))
    } else {
        // The same everywhere says nothing.
        (low, 0.0)
    };
    // `as` saturates, and makes 0 of NaN.
    values.par_iter().map(|&value| ((f64::from(value) - start) * factor).round() as u16).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan::ColorSource;
    use crate::scan::color;

    const BARE: Kept = Kept { color: Color::Absent, intensity: Intensity::Absent, normal: false };

    #[test]
    fn points_without_a_place_take_their_triangles_along() {
        let mut rows = Rows::new(5);
        rows.places = [0.0, f64::NAN, 2.0, f64::INFINITY, 4.0].map(|x| [x, 0.0, 0.0]).into();
        rows.intensity = vec![0.0, 1.0, 2.0, 3.0, 4.0];
        rows.triangles = vec![[0, 2, 4], [0, 1, 2], [4, 2, 0], [2, 3, 4], [0, 2, 7]];
        assert_eq!(leave_out(&mut rows), Loss { num_points: 2, num_triangles: 3 });
        assert_eq!(rows.triangles, [[0, 1, 2], [2, 1, 0]]);
        assert_eq!(rows.intensity, [0.0, 2.0, 4.0]);
        assert_eq!(leave_out(&mut rows), Loss::default());
        rows.triangles.push([0, 1, 3]);
        assert_eq!(leave_out(&mut rows), Loss { num_points: 0, num_triangles: 1 });
    }

    #[test]
    fn integer_intensities_stay_and_others_are_spread() {
        let spread = |values: &[f32], kind| intensities(values, kind);
        assert_eq!(spread(&[0.0, 7.0, 65535.0], Intensity::Integers), [0, 7, 65535]);
        assert_eq!(spread(&[-1.0, 0.0, 1.0], Intensity::Integers), [0, 32768, 65535]);
        assert_eq!(spread(&[0.0, 0.25, f32::NAN, 0.5], Intensity::Floats), [0, 32768, 0, 65535]);
        assert_eq!(spread(&[f32::MIN, f32::MAX, f32::INFINITY], Intensity::Floats), [0, 65535, 65535]);
        assert_eq!(spread(&[3.5, 3.5], Intensity::Floats), [0, 0]);
        assert_eq!(spread(&[f32::NAN], Intensity::Floats), [0]);
    }

    #[test]
    fn float_colors_are_as_bright_as_they_say() {
        let first = |rgb: Vec<[f32; 3]>| {
            let rows = Rows { places: vec![[0.0; 3]; rgb.len()], float_rgb: rgb, ..Rows::default() };
            let columns = columns(rows, Kept { color: Color::Floats, ..BARE }, vec![]);
            (columns.points.rgb[0], color::source(&columns.stats))
        };
        assert_eq!(first(vec![[0.0, 0.5, 1.0]]), ([0, 32768, 65535], ColorSource::Rgb16));
        // Dark to the last point is still 16 bits, or it would be shown 257 times as bright.
        assert_eq!(first(vec![[0.001; 3]]), ([66; 3], ColorSource::Rgb16));
        assert_eq!(first(vec![[0.0, 128.4, -3.0], [255.0; 3]]), ([0, 128, 0], ColorSource::Rgb8));
        assert_eq!(first(vec![[0.0, 300.0, f32::NAN]]), ([0, 300, 0], ColorSource::Rgb16));
        assert!(matches!(first(vec![[0.0; 3]]).1, ColorSource::Height { .. }));
    }
}

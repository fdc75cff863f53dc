//! Decides by what the survey found how rows become columns, and completes columns by what faces say.

use super::point::Meaning;
use super::reader::{Color, Intensity};
use super::rows::{How, Rows};
use super::survey::Found;
use crate::Attribute;
use crate::column::Type;
use crate::grid::FittedGrid;

/// How to put the points of a file into columns.
pub(super) fn how<'a>(
    meaning: &'a Meaning,
    found: &Found,
    extras: Vec<(Attribute, Type)>,
    (has_opacity, has_faces): (bool, bool),
    num_announced: u64,
) -> How<'a> {
    How {
        meaning,
        fitted: FittedGrid::over(found.sample.clone(), found.bounds),
        color_factor: float_factor(found.channels, found.num_kept).0,
        intensity: intensity_ramp(intensity_ends(found.intensity, &found.intensities), meaning.has.intensity),
        has_opacity,
        extras,
        has_faces,
        num_announced,
    }
}

/// What is left out of faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Loss {
    /// Triangles of points that are left out.
    pub num_triangles: u64,
    /// Faces that name points that do not exist.
    pub num_faces: u64,
    /// Colors of faces in lists of neither 3 nor 4 values.
    pub num_colors: u64,
}

/// Leaves out triangles of points that are left out, and gives points without a color those of their faces. To be
/// called once all rows are taken in.
pub(super) fn settle_faces(rows: &mut Rows) -> Loss {
    let (num_points, num_triangles) = (rows.num_kept(), rows.faces.triangles.len());
    rows.faces.renumber(&rows.gone, num_points);
    let num_triangles = (num_triangles - rows.faces.triangles.len()) as u64;
    if rows.rgb.is_empty() {
        rows.rgb = rows.faces.colors_of_points(num_points);
    }
    Loss { num_triangles, num_faces: rows.faces.num_bad, num_colors: rows.faces.num_odd_lists }
}

/// The largest value of a color, where the file or its format says so. The colors of the file's faces are stored as
/// `of_faces`.
pub(super) fn white(meaning: &Meaning, found: &Found, of_faces: Color) -> Option<u16> {
    match (meaning.has.color, of_faces) {
        (Color::Floats, _) => Some(float_factor(found.channels, found.num_kept).1),
        (Color::Absent, Color::Floats) => Some(u16::MAX),
        _ => meaning.white(),
    }
}

/// The factor of float colors, and the white that they have then. Float colors should be 0 to 1, but some programs
/// write 0 to 255, or to 65535. Single values beyond an end are wrong and prove nothing. Overexposed channels above 1
/// prove nothing either, while more channels lie between 0 and 1. The array counts channels between 0 and 1, above 1,
/// and above 255.
fn float_factor([within, above_one, above_255]: [u64; 3], num_points: u64) -> (f64, u16) {
    let most_wrong = 3 * num_points / 500;
    if above_one <= most_wrong.max(within) {
        (65535.0, u16::MAX)
    } else if above_255 <= most_wrong {
        (1.0, 255)
    } else {
        (1.0, u16::MAX)
    }
}

/// The ends of a file's intensities, given the least, the largest and some of them. A few values far beyond the others,
/// such as -1e10 for "none", do not count.
fn intensity_ends((least, most): (f64, f64), some: &[f64]) -> (f64, f64) {
    let mut sample = some.to_vec();
    sample.sort_unstable_by(f64::total_cmp);
    // None of so few values can be said to lie beyond the others.
    if sample.len() < 20 {
        return (least, most);
    }
    let tail = (sample.len() / 200).max(1);
    let (low, high) = (sample[tail], sample[sample.len() - 1 - tail]);
    if low == high {
        return (least, most);
    }
    let width = high - low;
    (least.max(low - width), most.min(high + width))
}

/// The number that is subtracted from intensities, and the factor that they are then multiplied by. Integers stay if 16
/// bits hold them; other intensities are spread so that the smallest becomes 0 and the largest 65535.
fn intensity_ramp((low, high): (f64, f64), kind: Intensity) -> (f64, f64) {
    if kind == Intensity::Integers && low >= 0.0 && high <= 65535.0 {
        (0.0, 1.0)
    } else if low < high {
        // The ends are halved first, because their difference need not be finite.
        (low, 32767.5 / (0.5 * high - 0.5 * low))
    } else {
        // An intensity that is the same everywhere says nothing.
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
        assert_eq!(float_factor([20, 0, 0], 10), (65535.0, u16::MAX));
        assert_eq!(float_factor([0, 1, 0], 10), (1.0, 255));
        assert_eq!(float_factor([0, 30, 1], 10), (1.0, u16::MAX));
        // Single values beyond the end are wrong.
        assert_eq!(float_factor([0, 12, 12], 2000), (65535.0, u16::MAX));
        assert_eq!(float_factor([0, 6000, 12], 2000), (1.0, 255));
        // Scenes are overexposed from some channels to a third of all; a dark scene has colors of 0 to 255.
        for overexposed in [20, 300, 2000] {
            assert_eq!(float_factor([6000 - overexposed, overexposed, 0], 2000), (65535.0, u16::MAX));
        }
        assert_eq!(float_factor([900, 4000, 0], 2000), (1.0, 255));
    }

    #[test]
    fn wild_intensities_leave_the_others_apart() {
        let ends = |values: &[f64]| {
            let range = values.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
            intensity_ends(range, values)
        };
        let even: Vec<f64> = (0..1000).map(|i| f64::from(i) / 1000.0).collect();
        assert_eq!(ends(&even), (0.0, 0.999));
        for wild in [-1e10, 1e20, f64::MAX, 2_147_483_647.0] {
            for num in [1, 5, 6] {
                let (low, high) = ends(&[even.clone(), vec![wild; num]].concat());
                let is_close = (-1.1..=0.0).contains(&low) && (0.999..=2.1).contains(&high);
                assert_eq!(is_close, num < 6, "{wild} {num}: {low} {high}");
            }
        }
        // Bright spots that are no accident stay, and so do the ends of a few points.
        assert_eq!(ends(&[even.clone(), vec![1.9; 30]].concat()), (0.0, 1.9));
        assert_eq!(ends(&[0.0, 1.0, 1e9]), (0.0, 1e9));
        assert_eq!(ends(&[vec![5.0; 100], vec![9.0]].concat()), (5.0, 9.0));
    }
}

//! Decides by what the survey found how rows become columns, and completes columns by what faces say.

use super::point::Meaning;
use super::reader::{Color, Intensity};
use super::rows::{How, Rows};
use super::survey::Found;
use crate::Attribute;
use crate::column::Type;
use crate::formats::measured::{float_factor, intensity_ends, intensity_ramp};
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
        intensity: intensity_ramp(
            intensity_ends(found.intensity, &found.intensities),
            meaning.has.intensity == Intensity::Integers,
        ),
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

//! Names by which the properties of points and faces are known.

use super::header::{Element, Property, PropertyType};
use super::reader::NUM_SLOTS;
use super::value::Scalar;

/// Names of coordinates.
pub(super) const PLACE: [&str; 3] = ["x", "y", "z"];
/// Names of the colors of Gaussian splats: constant terms of spherical harmonics.
pub(super) const HARMONICS: [&str; 3] = ["f_dc_0", "f_dc_1", "f_dc_2"];
/// Names of a color in a list of red, green, blue and perhaps alpha.
pub(super) const LISTED_RGB: [&str; 8] =
    ["rgb", "rgba", "color", "colors", "colour", "colours", "vertex_color", "face_color"];
/// Names of a color in one value of 32 bits.
pub(super) const PACKED_RGB: [&str; 2] = ["rgb", "rgba"];
/// Names of the list of a face's corners.
const CORNERS: [&str; 3] = ["vertex_indices", "vertex_index", "vertex_indexes"];
/// Names of the box of a compressed splat's chunk: positions, then colors, which older files do not have.
pub(super) const CHUNK: [&str; NUM_SLOTS] = [
    "min_x", "min_y", "min_z", "max_x", "max_y", "max_z", "min_r", "min_g", "min_b", "max_r", "max_g",
    "max_b",
];

/// A property that can be asked for by name.
#[derive(Clone, Debug)]
pub(super) struct NamedScalar {
    /// Its number among the element's properties.
    pub at: usize,
    pub name: String,
    pub kind: Scalar,
    /// True if its value is known by another attribute, or makes up a splat.
    pub is_detail: bool,
}

/// Index of the list of a face's corners.
pub(super) fn corners(element: &Element) -> Option<usize> {
    let is_corners = |property: &Property| CORNERS.contains(&property.name.to_ascii_lowercase().as_str());
    element.properties.iter().position(is_corners)
}

/// Index and type of the value with this name, in whatever case.
pub(super) fn find(element: &Element, name: &str) -> Option<(usize, Scalar)> {
    element.properties.iter().enumerate().find_map(|(at, property)| match property.kind {
        PropertyType::Value(kind) if property.name.eq_ignore_ascii_case(name) => Some((at, kind)),
        _ => None,
    })
}

/// Index and type of the value that is an intensity.
pub(super) fn intensity(element: &Element) -> Option<(usize, Scalar)> {
    let values = element.properties.iter().enumerate().filter_map(|(at, property)| match property.kind {
        PropertyType::Value(kind) => Some((at, kind, property.name.as_str())),
        PropertyType::List(..) => None,
    });
    let values: Vec<(usize, Scalar, &str)> = values.collect();
    let names: Vec<&str> = values.iter().map(|(.., name)| *name).collect();
    crate::formats::names::intensity(&names).map(|number| (values[number].0, values[number].1))
}

/// True for properties that splats have by the dozen and points do not need.
pub(super) fn is_of_splats(name: &str) -> bool {
    ["f_dc_", "f_rest_", "scale_", "rot_", "packed_", "nx", "ny", "nz"]
        .iter()
        .any(|start| name.starts_with(start))
}

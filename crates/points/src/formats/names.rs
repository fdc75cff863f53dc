//! Names by which formats that name their values as they please call what all files have.

use crate::Attribute;
use crate::column::Type;

/// Names of coordinates across; the first two that a file has count.
const ACROSS: [[&str; 2]; 9] = [
    ["x", "y"],
    ["easting", "northing"],
    ["east", "north"],
    ["e", "n"],
    ["longitude", "latitude"],
    ["lon", "lat"],
    ["long", "lat"],
    ["lng", "lat"],
    ["coord_x", "coord_y"],
];
/// Names of the coordinate upward; the first that a file has counts.
const UPWARD: [&str; 9] = ["z", "height", "elevation", "altitude", "elev", "alt", "h", "up", "coord_z"];
/// Names of the coordinates of normals.
pub(super) const NORMAL: [&str; 3] = ["nx", "ny", "nz"];
/// Other names of the coordinates of normals.
pub(super) const NORMAL_XYZ: [[&str; 3]; 2] =
    [["normal_x", "normal_y", "normal_z"], ["normalx", "normaly", "normalz"]];
/// Names of red, green and blue; the first three that a file has count.
pub(super) const RGB: [[&str; 3]; 12] = [
    ["red", "green", "blue"],
    ["r", "g", "b"],
    ["diffuse_red", "diffuse_green", "diffuse_blue"],
    ["scalar_red", "scalar_green", "scalar_blue"],
    ["scalar_r", "scalar_g", "scalar_b"],
    ["scalar_rf", "scalar_gf", "scalar_bf"],
    ["vertex_red", "vertex_green", "vertex_blue"],
    ["color_red", "color_green", "color_blue"],
    ["color_r", "color_g", "color_b"],
    ["colorr", "colorg", "colorb"],
    ["rf", "gf", "bf"],
    ["ambient_red", "ambient_green", "ambient_blue"],
];
/// Names of intensity, the likeliest first.
const INTENSITY: [&str; 15] = [
    "intensity",
    "scalar_intensity",
    "reflectance",
    "scalar_reflectance",
    "reflectivity",
    "amplitude",
    "i",
    "scalar_i",
    "scalar_scalar_field",
    "gray",
    "grey",
    "grayvalue",
    "greyvalue",
    "luminance",
    "scalar_gray",
];
/// Parts of names that only an intensity has.
const INTENSITY_PARTS: [&str; 4] = ["intensit", "reflect", "amplitude", "remission"];

/// Numbers of the names of a place's coordinates.
pub(super) fn place(names: &[&str]) -> Option<[usize; 3]> {
    let across = ACROSS.iter().find_map(|[x, y]| Some([find(names, x)?, find(names, y)?]))?;
    let upward = UPWARD.iter().find_map(|name| find(names, name))?;
    Some([across[0], across[1], upward])
}

/// True for the name of any coordinate of a place.
pub(super) fn is_coordinate(name: &str) -> bool {
    ACROSS.iter().flatten().chain(&UPWARD).any(|known| name.eq_ignore_ascii_case(known))
}

/// Number of the name among `names` that is an intensity's.
pub(super) fn intensity(names: &[&str]) -> Option<usize> {
    let by_part = || {
        names.iter().position(|name| {
            let name = name.to_ascii_lowercase();
            INTENSITY_PARTS.iter().any(|part| name.contains(part))
        })
    };
    let (likely, unlikely) = INTENSITY.split_at(6);
    let by_name = |known: &[&str]| known.iter().find_map(|known| find(names, known));
    by_name(likely).or_else(by_part).or_else(|| by_name(unlikely))
}

/// Number of a name, in whatever case.
pub(super) fn find(names: &[&str], name: &str) -> Option<usize> {
    names.iter().position(|other| other.eq_ignore_ascii_case(name))
}

/// Numbers of three names.
pub(super) fn find_three(names: &[&str], three: &[&str; 3]) -> Option<[usize; 3]> {
    let [a, b, c] = three.map(|name| find(names, name));
    Some([a?, b?, c?])
}

/// The attribute of a name that is none of place, color, intensity and normal, and the type that it has in a column that is
/// stored as `kind`: flags become marks. All other names are the file's own.
pub(super) fn attribute(name: &str, kind: Type) -> (Attribute, Type) {
    let plain: String =
        name.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_ascii_lowercase();
    let plain = plain.strip_prefix("scalar").unwrap_or(&plain);
    let is_byte = kind == Type::U8;
    let known = match plain {
        "classification" if is_byte => Attribute::Classification,
        "returnnumber" if is_byte => Attribute::ReturnNumber,
        "numberofreturns" | "numreturns" if is_byte => Attribute::NumReturns,
        "scandirectionflag" | "scandirection" if is_byte => return (Attribute::ScanDirection, Type::Bool),
        "edgeofflightline" | "edgeofflightlineflag" if is_byte => {
            return (Attribute::EdgeOfFlightLine, Type::Bool);
        }
        "scananglerank" | "scanangle" => Attribute::ScanAngle,
        "userdata" if is_byte => Attribute::UserData,
        "pointsourceid" if kind == Type::U16 => Attribute::SourceId,
        "gpstime" => Attribute::GpsTime,
        "nir" | "infrared" | "nearinfrared" if kind == Type::U16 => Attribute::NearInfrared,
        _ => Attribute::Named(name.to_owned()),
    };
    (known, kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_mean_the_same_in_any_case() {
        assert_eq!(intensity(&["x", "Remission", "I"]), Some(1));
        assert_eq!(intensity(&["x", "I"]), Some(1));
        assert_eq!(intensity(&["x", "label"]), None);
        assert_eq!(find_three(&["X", "z", "Y"], &["x", "y", "z"]), Some([0, 2, 1]));
        assert_eq!(attribute("Scalar_Classification", Type::U8), (Attribute::Classification, Type::U8));
        assert_eq!(attribute("EdgeOfFlightLine", Type::U8).1, Type::Bool);
        assert_eq!(attribute("classification", Type::F64).0, Attribute::Named("classification".into()));
    }
}

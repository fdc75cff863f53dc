//! `scanwalk info`: what is in the files, for people or as JSON.

mod attributes;

pub use attributes::attributes_text;

use super::{
    Blank, ColorSource, FARTHEST, Header, InFile, ReadOptions, Scan, ScanError, ScanFile, UpAxis,
    WorldFromFile, read, unit,
};
use base::space::Bounds;
use base::task::Task;
use base::words::{agreeing, counted, grouped};
use glam::DVec3;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::PathBuf;

/// What `--json` prints; the names are a contract.
#[derive(Debug, Serialize)]
struct Description {
    points: usize,
    bbox: [[f64; 3]; 2],
    format: String,
    attributes: Vec<String>,
    not_read: Vec<String>,
    color_bits: Option<u8>,
    color_white: Option<u16>,
    normals: bool,
    triangles: usize,
    crs: Option<String>,
    unit_m: Option<f64>,
    vertical_unit_m: Option<f64>,
    up: Option<&'static str>,
    files: Vec<FileDescription>,
    scene: [[f64; 3]; 2],
    withheld: u64,
    noise: usize,
    warnings: Vec<String>,
}

/// One file of a scan, as `--json` prints it.
#[derive(Debug, Serialize)]
struct FileDescription {
    path: String,
    points: usize,
    bbox: [[f64; 3]; 2],
}

/// Reads the files to their ends and says what is in them: true counts and boxes, not those of the headers. Points
/// that are withheld count too.
///
/// # Errors
/// See [`super::read()`].
pub fn text(paths: &[PathBuf], json: bool, options: &ReadOptions, task: &Task) -> Result<String, ScanError> {
    let options = ReadOptions { show_withheld: true, ..options.clone() };
    let (mut scan, headers) = read::read_with_headers(paths, &options, task)?;
    let asides: Vec<String> = scan.files.iter().zip(&headers).flat_map(asides).collect();
    scan.warnings.extend(asides);
    if !json {
        return Ok(for_people(&scan, &headers));
    }
    // Numbers, texts and lists of them always have a form in JSON.
    Ok(serde_json::to_string_pretty(&describe(&scan, &headers)).expect("JSON") + "\n")
}

/// How a scan's coordinates were understood, name and words for people: the unit, the axis that points up.
#[must_use]
pub fn placing_words(scan: &Scan) -> [(&'static str, String); 2] {
    let unit = unit_words(scan, vertical_unit_m(scan));
    [("unit", unit), ("up", up(scan).map_or("away from the earth", UpAxis::name).into())]
}

fn describe(scan: &Scan, headers: &[Header]) -> Description {
    let file = |file: &ScanFile| FileDescription {
        path: file.path.display().to_string(),
        points: file.points.xyz.len(),
        bbox: bbox(file.in_file.bounds),
    };
    let white = scan.files.iter().filter_map(|file| file.coloring.source.white()).max();
    Description {
        points: scan.num_points(),
        bbox: bbox(scan.bounds_in_file()),
        format: distinct(headers.iter().map(|header| header.format.clone())).join("; "),
        attributes: distinct(headers.iter().flat_map(Header::attributes)),
        not_read: attributes::not_read(headers),
        color_bits: white.map(|white| if white == 255 { 8 } else { 16 }),
        color_white: white,
        normals: scan.files.iter().any(|file| !file.points.normals.is_empty()),
        triangles: scan.files.iter().map(|file| file.triangles.len()).sum(),
        crs: scan.crs.clone(),
        unit_m: scan.unit_in_file_m,
        vertical_unit_m: vertical_unit_m(scan),
        up: up(scan).map(UpAxis::name),
        files: scan.files.iter().map(file).collect(),
        scene: bbox(scan.scene.bounds),
        withheld: scan.files.iter().map(|file| file.points.num_withheld).sum(),
        noise: scan.files.iter().map(num_noise).sum(),
        warnings: scan.warnings.clone(),
    }
}

/// Number of points of a noise class that are not withheld.
fn num_noise(file: &ScanFile) -> usize {
    file.points.noise.count().saturating_sub(file.points.num_withheld as usize)
}

/// Sentences about points that the view does not go by, and about splats that may lie on their side.
fn asides((file, header): (&ScanFile, &Header)) -> Vec<String> {
    let (path, num_noise, num_withheld) = (file.path.display(), num_noise(file), file.points.num_withheld);
    let mut sentences = Vec::new();
    if num_withheld > 0 {
        sentences.push(format!(
            "{path}: {} {} withheld, which means deleted: {} not drawn, unless cloud.show_withheld is set",
            counted(num_withheld, "point"),
            agreeing(num_withheld, "is", "are"),
            agreeing(num_withheld, "it is", "they are"),
        ));
    }
    if num_noise > 0 {
        sentences.push(format!(
            "{path}: {} {} noise (class 7 or 18): drawn, but the view does not go by {}",
            counted(num_noise, "point"),
            agreeing(num_noise, "is", "are"),
            agreeing(num_noise, "it", "them"),
        ));
    }
    let stands_as_stored = matches!(file.world_from_file, WorldFromFile::Axes { up: UpAxis::Z, .. });
    if header.is_splats && header.up.is_none() && stands_as_stored {
        sentences.push(format!(
            "{path}: most programs train splats in coordinates whose y points down: if it lies on its side, \
             --set cloud.up=-y stands it upright"
        ));
    }
    sentences
}

fn bbox(bounds: Bounds) -> [[f64; 3]; 2] {
    [bounds.min.to_array(), bounds.max.to_array()]
}

/// Distinct values in the order of their first appearance.
fn distinct(values: impl Iterator<Item = String>) -> Vec<String> {
    let mut seen = Vec::new();
    values.for_each(|value| {
        if !seen.contains(&value) {
            seen.push(value);
        }
    });
    seen
}

fn for_people(scan: &Scan, headers: &[Header]) -> String {
    // A file that is drawn elsewhere than its coordinates say has a scene elsewhere too.
    let in_place = scan.files.iter().all(|file| file.in_file.grid == file.grid);
    let scene = in_place.then_some(scan.scene.bounds).filter(|_| !scan.scene.is_empty());
    let decimals = decimals(&scan.files, scene);
    let described = describe(scan, headers);
    let mut lines: Vec<(&str, String)> = Vec::new();
    lines.push(("points", grouped(described.points)));
    lines.extend(box_lines(scan.bounds_in_file(), size_m(scan), decimals));
    if in_place && scan.scene.bounds != scan.bounds() {
        let names = ["scene from", "to", "size"];
        let of_scene = box_lines(scan.scene.bounds, None, decimals);
        lines.extend(names.into_iter().zip(of_scene).map(|(name, (_, value))| (name, value)));
    }
    lines.push(("format", described.format));
    lines.push(("attributes", described.attributes.join(", ")));
    lines.push(("not read", described.not_read.join(", ")));
    lines.push(("color", distinct(scan.files.iter().map(color_words)).join("; ")));
    lines.push(("normals", if described.normals { "yes".into() } else { String::new() }));
    let triangles = (described.triangles > 0).then(|| grouped(described.triangles));
    lines.push(("triangles", triangles.unwrap_or_default()));
    lines.push(("system", described.crs.unwrap_or_else(|| "not stated".into())));
    lines.extend(placing_words(scan));
    let software = distinct(headers.iter().filter_map(|header| header.software.clone()));
    let created = distinct(headers.iter().filter_map(|header| header.created.clone()));
    lines.push(("written by", software.join("; ")));
    lines.push(("written on", created.join("; ")));
    if scan.files.len() > 1 {
        let file = |file: &ScanFile| {
            format!("{} ({})", file.path.display(), counted(grouped(file.points.xyz.len()), "point"))
        };
        lines
            .extend(scan.files.iter().enumerate().map(|(i, f)| (if i == 0 { "files" } else { "" }, file(f))));
    }
    lines.extend(described.warnings.into_iter().map(|warning| ("warning", warning)));
    let mut text = String::new();
    for (name, value) in lines.iter().filter(|(_, value)| !value.is_empty()) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name:<11} {value}");
    }
    text
}

/// Meters per unit of height, where it differs from the unit across.
fn vertical_unit_m(scan: &Scan) -> Option<f64> {
    match scan.world_from_file() {
        WorldFromFile::Axes { across_scale, height_scale, .. } => {
            let unit_m = scan.unit_in_file_m.filter(|_| height_scale != across_scale)?;
            Some(height_scale / across_scale * unit_m)
        }
        WorldFromFile::Geocentric { .. } => None,
        WorldFromFile::Geographic { height_m, .. } => Some(height_m),
    }
}

/// The axis of the files' coordinates (the first file's, if they differ) that points up; `None` for places on the
/// earth.
fn up(scan: &Scan) -> Option<UpAxis> {
    match scan.world_from_file() {
        WorldFromFile::Axes { up, .. } => Some(up),
        WorldFromFile::Geographic { .. } | WorldFromFile::Geocentric { .. } => None,
    }
}

/// Size of the scan in meters along the files' axes, or along the drawn axes if the files have places on the earth.
fn size_m(scan: &Scan) -> Option<DVec3> {
    let size = scan.bounds().size() * scan.unit_m?;
    Some(match up(scan) {
        Some(UpAxis::Y | UpAxis::MinusY) => DVec3::new(size.x, size.z, size.y),
        Some(UpAxis::Z) | None => size,
    })
}

fn box_lines(bounds: Bounds, size_m: Option<DVec3>, decimals: [usize; 3]) -> [(&'static str, String); 3] {
    let size = bounds.size();
    // Decimals would show nothing of a box this small.
    let is_tiny = (1e-300..1e-8).contains(&size.max_element());
    let three = |v: DVec3, between: &str| {
        // Nobody reads the digits of large numbers.
        let texts = [0, 1, 2].map(|axis| match v[axis] {
            c if c.abs() < FARTHEST && !is_tiny => format!("{c:.*}", decimals[axis]),
            c => format!("{c:.4e}"),
        });
        texts.join(between)
    };
    let mut size_text = three(size, " x ");
    if let Some(size_m) = size_m {
        if (size_m - size).abs().max_element() <= 1e-9 * size.max_element() {
            size_text += " m";
        } else {
            // The longest edge shows at least two digits.
            let decimals = (1.0 - size_m.max_element().log10().floor()).clamp(1.0, 9.0) as usize;
            // Writing to a string cannot fail.
            let _ = write!(
                size_text,
                " ({:.decimals$} x {:.decimals$} x {:.decimals$} m)",
                size_m.x, size_m.y, size_m.z
            );
        }
    }
    [("from", three(bounds.min, "  ")), ("to", three(bounds.max, "  ")), ("size", size_text)]
}

fn color_words(file: &ScanFile) -> String {
    let blank = file.coloring.blank.as_ref().map(Blank::words);
    let none = blank.as_ref().map_or("none".into(), |blank| format!("none (all points are {blank})"));
    let bits = match file.coloring.source {
        ColorSource::Rgb8 => "8 bits",
        ColorSource::Rgb10 => "10 bits (next to nothing exceeds 1023)",
        ColorSource::Rgb12 => "12 bits (next to nothing exceeds 4095)",
        ColorSource::Rgb16 => "16 bits",
        ColorSource::Intensity { low, high } => {
            return format!("{none}; shown by intensity, {low:.0} to {high:.0}");
        }
        ColorSource::Height { low, high } => {
            return format!("{none}; shown by height, {low:.2} to {high:.2}");
        }
    };
    let (Some(Blank { num_others, by_intensity, .. }), Some(blank)) = (file.coloring.blank, blank) else {
        return bits.into();
    };
    let num_all = file.points.xyz.len();
    let (num, all) = (grouped(num_all.saturating_sub(num_others)), grouped(num_all));
    let by = if by_intensity { "intensity" } else { "height" };
    format!("{bits}; none at {num} of {all} points, which are {blank} and shown by {by}, in grays")
}

fn unit_words(scan: &Scan, vertical_unit_m: Option<f64>) -> String {
    let across = match (scan.world_from_file(), scan.unit_in_file_m) {
        (WorldFromFile::Geographic { angle, .. }, _) => angle.name().into(),
        (_, Some(unit_m)) => unit::words(unit_m),
        (_, None) => "not stated".into(),
    };
    match vertical_unit_m {
        Some(vertical_m) => format!("{across}; of heights {}", unit::words(vertical_m)),
        None => across,
    }
}

/// Digits behind the point that the finest grid needs along each axis. Seven digits of a file's size are enough, or of
/// the scene's size where strays make the file larger.
fn decimals(files: &[ScanFile], scene: Option<Bounds>) -> [usize; 3] {
    [0, 1, 2].map(|axis| {
        let step = |file: &ScanFile| {
            let InFile { grid, bounds } = file.in_file;
            let size = scene.map_or(f64::INFINITY, |scene| scene.size()[axis]).min(bounds.size()[axis]);
            grid.scale[axis].abs().max(1e-7 * size.min(1e6))
        };
        let finest = files.iter().map(step).fold(1.0, f64::min);
        (-finest.log10()).ceil().clamp(0.0, 9.0) as usize
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Grid, ScanBuilder};

    #[test]
    fn json_has_the_names_of_the_contract() {
        let grid = Grid { scale: DVec3::splat(0.5), offset: DVec3::ZERO };
        let made = ScanBuilder::new(grid, vec![[1, 2, 3], [-1, 0, 9]]).path("a.las");
        let scan = made.rgb(vec![[300, 0, 0]; 2]).color(ColorSource::Rgb16).scan().with_scene();
        let json = serde_json::to_value(describe(&scan, &[])).unwrap();
        let expected = serde_json::json!({
            "points": 2, "bbox": [[-0.5, 0.0, 1.5], [0.5, 1.0, 4.5]], "format": "", "attributes": [], "not_read": [],
            "color_bits": 16, "color_white": 65535, "normals": false, "triangles": 0, "crs": null, "unit_m": null,
            "vertical_unit_m": null, "up": "z", "warnings": [],
            "scene": [[-0.5, 0.0, 1.5], [0.5, 1.0, 4.5]], "withheld": 0, "noise": 0,
            "files": [{"path": "a.las", "points": 2, "bbox": [[-0.5, 0.0, 1.5], [0.5, 1.0, 4.5]]}],
        });
        assert_eq!(json, expected);
    }

    #[test]
    fn people_see_sizes_in_meters() {
        let bounds = Bounds { min: DVec3::ZERO, max: DVec3::new(10.0, 20.0, 30.0) };
        let lines = |size_m| box_lines(bounds, size_m, [3, 2, 1]).map(|(_, text)| text);
        let feet = lines(Some(bounds.size() * 0.3048));
        assert_eq!(
            feet,
            ["0.000  0.00  0.0", "10.000  20.00  30.0", "10.000 x 20.00 x 30.0 (3.0 x 6.1 x 9.1 m)"]
        );
        assert_eq!(lines(Some(bounds.size() * 1e-3))[2], "10.000 x 20.00 x 30.0 (0.010 x 0.020 x 0.030 m)");
        assert_eq!(lines(Some(bounds.size()))[2], "10.000 x 20.00 x 30.0 m");
        assert_eq!(lines(None)[2], "10.000 x 20.00 x 30.0");
    }

    #[test]
    fn distinct_keeps_the_first_order() {
        assert_eq!(distinct(["b", "a", "b"].map(String::from).into_iter()), ["b", "a"]);
    }
}

//! `scanwalk info`: what is in the files, for people or as JSON.

use super::{ColorSource, Header, ReadOptions, Scan, ScanFile, read};
use crate::progress::Stop;
use crate::space::Bounds;
use serde::Serialize;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;

/// What `--json` prints; the names are a contract.
#[derive(Debug, Serialize)]
struct Description {
    points: usize,
    bbox: [[f64; 3]; 2],
    format: String,
    attributes: Vec<String>,
    color_bits: Option<u8>,
    normals: bool,
    triangles: usize,
    crs: Option<String>,
    unit_m: Option<f64>,
    files: Vec<FileDescription>,
    warnings: Vec<String>,
}

/// One file of it.
#[derive(Debug, Serialize)]
struct FileDescription {
    path: String,
    points: usize,
    bbox: [[f64; 3]; 2],
}

/// Reads the files to their ends and prints what is in them: true counts and boxes, not those of the headers.
///
/// # Errors
/// What [`super::read()`] reports; a closed standard output.
pub fn print(paths: &[PathBuf], json: bool, options: &ReadOptions, stop: &Stop) -> anyhow::Result<()> {
    let (scan, headers) = read::read_with_headers(paths, options, stop)?;
    let scan = scan.with_scene();
    let text = if json {
        serde_json::to_string_pretty(&describe(&scan, &headers))? + "\n"
    } else {
        for_people(&scan, &headers)
    };
    std::io::stdout().lock().write_all(text.as_bytes())?;
    Ok(())
}

fn describe(scan: &Scan, headers: &[Header]) -> Description {
    let file = |file: &ScanFile| FileDescription {
        path: file.path.display().to_string(),
        points: file.points.xyz.len(),
        bbox: bbox(file.bounds),
    };
    Description {
        points: scan.num_points(),
        bbox: bbox(scan.bounds()),
        format: distinct(headers.iter().map(|header| header.format.clone())).join("; "),
        attributes: distinct(headers.iter().flat_map(|header| header.attributes.clone())),
        color_bits: scan.files.iter().filter_map(color_bits).max(),
        normals: scan.files.iter().any(|file| !file.points.normals.is_empty()),
        triangles: scan.files.iter().map(|file| file.triangles.len()).sum(),
        crs: scan.crs.clone(),
        unit_m: scan.unit_m,
        files: scan.files.iter().map(file).collect(),
        warnings: scan.warnings.clone(),
    }
}

fn bbox(bounds: Bounds) -> [[f64; 3]; 2] {
    [bounds.min.to_array(), bounds.max.to_array()]
}

fn color_bits(file: &ScanFile) -> Option<u8> {
    match file.color {
        ColorSource::Rgb8 => Some(8),
        ColorSource::Rgb16 => Some(16),
        ColorSource::Intensity { .. } | ColorSource::Height { .. } => None,
    }
}

/// In the order of first appearance.
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
    let decimals = decimals(&scan.files);
    let described = describe(scan, headers);
    let mut lines: Vec<(&str, String)> = Vec::new();
    lines.push(("points", grouped(described.points)));
    lines.extend(box_lines(scan.bounds(), scan.unit_m, decimals));
    lines.push(("format", described.format));
    lines.push(("attributes", described.attributes.join(", ")));
    lines.push(("colour", distinct(scan.files.iter().map(|file| color_words(file.color))).join("; ")));
    lines.push(("normals", if described.normals { "yes".into() } else { String::new() }));
    let triangles = (described.triangles > 0).then(|| grouped(described.triangles));
    lines.push(("triangles", triangles.unwrap_or_default()));
    lines.push(("system", described.crs.unwrap_or_else(|| "not stated".into())));
    lines.push(("unit", unit_words(scan.unit_m)));
    let software = distinct(headers.iter().filter_map(|header| header.software.clone()));
    let created = distinct(headers.iter().filter_map(|header| header.created.clone()));
    lines.push(("written by", software.join("; ")));
    lines.push(("written on", created.join("; ")));
    if scan.files.len() > 1 {
        let file =
            |file: &ScanFile| format!("{} ({} points)", file.path.display(), grouped(file.points.xyz.len()));
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

fn box_lines(bounds: Bounds, unit_m: Option<f64>, decimals: usize) -> [(&'static str, String); 3] {
    let three = |v: glam::DVec3| format!("{:.decimals$}  {:.decimals$}  {:.decimals$}", v.x, v.y, v.z);
    let size = bounds.size();
    let mut size_text = three(size).replace("  ", " x ");
    match unit_m {
        Some(1.0) => size_text += " m",
        Some(unit_m) => {
            let metres = size * unit_m;
            // Writing to a string cannot fail.
            let _ = write!(size_text, " ({:.1} x {:.1} x {:.1} m)", metres.x, metres.y, metres.z);
        }
        None => {}
    }
    [("from", three(bounds.min)), ("to", three(bounds.max)), ("size", size_text)]
}

fn color_words(color: ColorSource) -> String {
    match color {
        ColorSource::Rgb8 => "8 bits".into(),
        ColorSource::Rgb16 => "16 bits".into(),
        ColorSource::Intensity { low, high } => format!("none; shown by intensity, {low} to {high}"),
        ColorSource::Height { low, high } => format!("none; shown by height, {low:.2} to {high:.2}"),
    }
}

fn unit_words(unit_m: Option<f64>) -> String {
    match unit_m {
        None => "not stated".into(),
        Some(1.0) => "metre".into(),
        Some(0.3048) => "foot (0.3048 m)".into(),
        Some(unit_m) => format!("{unit_m} m"),
    }
}

/// Digits behind the point that the finest lattice needs, within reason: seven of a file's size are enough.
fn decimals(files: &[ScanFile]) -> usize {
    let step = |file: &ScanFile| {
        let readable = 1e-7 * file.bounds.size().max_element();
        file.lattice.scale.abs().min_element().max(readable)
    };
    let finest = files.iter().map(step).fold(1.0, f64::min);
    (-finest.log10()).ceil().clamp(0.0, 9.0) as usize
}

/// 1234567 as 1,234,567.
pub(crate) fn grouped(count: usize) -> String {
    grouped_by(count as u64, ',')
}

/// A count whose thousands have `separator` between them.
pub(crate) fn grouped_by(count: u64, separator: char) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(separator);
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan::{Lattice, Points};
    use glam::DVec3;

    #[test]
    fn counts_are_grouped() {
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
    }

    #[test]
    fn json_has_the_names_of_the_contract() {
        let points = Points {
            xyz: vec![[1, 2, 3], [-1, 0, 9]],
            rgb: vec![[300, 0, 0]; 2],
            intensity: vec![0; 2],
            ..Points::default()
        };
        let lattice = Lattice { scale: DVec3::splat(0.5), offset: DVec3::ZERO };
        let bounds = Bounds { min: DVec3::new(-0.5, 0.0, 1.5), max: DVec3::new(0.5, 1.0, 4.5) };
        let (path, color) = (PathBuf::from("a.las"), ColorSource::Rgb16);
        let file = ScanFile {
            path,
            format: "LAS 1.2".into(),
            lattice,
            points,
            color,
            bounds,
            ..ScanFile::default()
        };
        let scan = Scan { files: vec![file], ..Scan::default() };
        let json = serde_json::to_value(describe(&scan, &[])).unwrap();
        let expected = serde_json::json!({
            "points": 2, "bbox": [[-0.5, 0.0, 1.5], [0.5, 1.0, 4.5]], "format": "", "attributes": [],
            "color_bits": 16, "normals": false, "triangles": 0, "crs": null, "unit_m": null, "warnings": [],
            "files": [{"path": "a.las", "points": 2, "bbox": [[-0.5, 0.0, 1.5], [0.5, 1.0, 4.5]]}],
        });
        assert_eq!(json, expected);
    }

    #[test]
    fn people_see_sizes_in_metres() {
        let bounds = Bounds { min: DVec3::ZERO, max: DVec3::new(10.0, 20.0, 30.0) };
        let [_, _, (name, size)] = box_lines(bounds, Some(0.3048), 2);
        assert_eq!((name, size.as_str()), ("size", "10.00 x 20.00 x 30.00 (3.0 x 6.1 x 9.1 m)"));
    }

    #[test]
    fn distinct_keeps_the_first_order() {
        assert_eq!(distinct(["b", "a", "b"].map(String::from).into_iter()), ["b", "a"]);
    }
}

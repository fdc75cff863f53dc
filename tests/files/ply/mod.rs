//! PLY files, written here in all three encodings and read back: every column, and whatever can be wrong.

mod broken;
mod colors;
pub mod made;
mod real;
mod world;

use crate::PROGRAM;
use crate::bytes::read_bytes;
use base::task::CancelToken;
use kit::program;
use made::{MadeEncoding, MadeFace, MadePly, MadePoint};
use points::{ColorSource, ReadOptions, ScanFile, peek, read};
use proptest::prelude::*;

/// The name by which bytes are read here.
const NAME: &str = "scan.ply";

/// Reads bytes as a file; returns the file and the warnings.
fn read_one(bytes: &[u8]) -> (ScanFile, Vec<String>) {
    let mut scan = read_bytes(NAME, bytes).unwrap();
    (scan.files.remove(0), scan.warnings)
}

/// How a file differs from what was written into it, or nothing.
fn difference(file: &ScanFile, made: &MadePly) -> Option<String> {
    let kept: Vec<&MadePoint> = made.points.iter().filter(|point| point.has_place()).collect();
    if file.points.xyz.len() != kept.len() {
        return Some(format!("{} points, not {}", file.points.xyz.len(), kept.len()));
    }
    let half_step = file.grid.scale * 0.5 * (1.0 + 1e-6);
    for (i, point) in kept.iter().enumerate() {
        let moved = file.grid.p_in_world(file.points.xyz[i]) - glam::DVec3::from_array(point.place);
        if moved.abs().cmpgt(half_step).any() {
            return Some(format!("point {i} moved by {moved}"));
        }
        if file.points.rgb[i] != point.rgb.map(u16::from) {
            return Some(format!("point {i} has color {:?}", file.points.rgb[i]));
        }
        if file.points.intensity[i] != point.intensity {
            return Some(format!("point {i} has intensity {}", file.points.intensity[i]));
        }
        let (ours, theirs) = (file.points.normals[i], point.unit_normal());
        if !ours.iter().zip(theirs).all(|(a, b)| (a - b).abs() < 1e-6 || a.is_nan() && b.is_nan()) {
            return Some(format!("point {i} has normal {ours:?}, not {theirs:?}"));
        }
    }
    (file.triangles != made.triangles())
        .then(|| format!("triangles {:?}, not {:?}", file.triangles, made.triangles()))
}

#[test]
fn all_encodings_hold_the_same_points_and_faces() {
    for made in [MadePly::new(1000), MadePly::new(40_000), MadePly::new(4)] {
        for encoding in MadeEncoding::ALL {
            for (faces_first, lists) in [(false, true), (true, false), (false, false), (true, true)] {
                let made = MadePly { faces_first, lists, ..made.clone() };
                let (file, warnings) = read_one(&made.bytes(encoding));
                assert_eq!(difference(&file, &made), None, "{encoding:?}, {} points", made.points.len());
                assert_eq!(file.coloring.source, ColorSource::Rgb8);
                let bad = made.num_bad_faces();
                let faces = if bad == 1 { "face" } else { "faces" };
                let sentence = format!("scan.ply: has {bad} {faces} with points that are not there");
                assert!(warnings.len() == 1 && warnings[0].contains(&sentence), "{warnings:?}");
                assert!(!file.triangles.is_empty());
            }
        }
    }
}

/// The file has more points than are read at once, binary and as text whose lines end as those of old Macs did.
#[test]
fn many_points_keep_their_order() {
    let num_points = 1_300_000u32;
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex {num_points}\n\
             property int x\nproperty short y\nproperty float z\nend_header\n"
        )
    };
    let place = |i: u32| [i as i32, i32::from(i as i16), 3];
    let mut binary = header("binary_little_endian").into_bytes();
    let mut text = header("ascii");
    for [x, y, z] in (0..num_points).map(place) {
        binary.extend(x.to_le_bytes());
        binary.extend((y as i16).to_le_bytes());
        binary.extend((z as f32).to_le_bytes());
        text += &format!("{x} {y} {z}\n");
    }
    for bytes in [binary, text.replace('\n', "\r").into_bytes()] {
        let (file, warnings) = read_one(&bytes);
        assert_eq!((file.points.xyz.len(), warnings.len()), (num_points as usize, 0));
        let wrong = (0..num_points)
            .zip(&file.points.xyz)
            .find(|&(i, &xyz)| file.grid.p_in_world(xyz) != glam::DVec3::from_array(place(i).map(f64::from)));
        assert_eq!(wrong, None);
    }
}

#[test]
fn the_comparison_can_fail() {
    let made = MadePly::new(10);
    let (file, _) = read_one(&made.bytes(MadeEncoding::BigEndian));
    let changed = |change: fn(&mut MadePly)| {
        let mut other = made.clone();
        change(&mut other);
        difference(&file, &other).unwrap_or_default()
    };
    assert!(changed(|made| made.points[3].place[1] += 1e-6).contains("point 3 moved"));
    assert!(changed(|made| made.points[9].rgb[2] ^= 1).contains("point 9 has color"));
    assert!(changed(|made| made.points[0].intensity ^= 1).contains("point 0 has intensity"));
    assert!(changed(|made| made.points[5].normal[0] += 0.01).contains("point 5 has normal"));
    assert!(changed(|made| made.faces[5].0.reverse()).contains("triangles"));
    assert!(changed(|made| made.points.truncate(9)).contains("10 points, not 9"));
}

#[test]
fn points_without_a_place_are_left_out_and_faces_renumbered() {
    let mut made = MadePly::new(200);
    for (i, value) in [(3, f64::NAN), (4, f64::INFINITY), (150, f64::NEG_INFINITY)] {
        made.points[i].place[i % 3] = value;
    }
    for encoding in MadeEncoding::ALL {
        let (file, warnings) = read_one(&made.bytes(encoding));
        assert_eq!(difference(&file, &made), None, "{encoding:?}");
        assert!(warnings[0].contains("has 3 points without a finite place"), "{warnings:?}");
        assert!(warnings[1].contains("triangles of points that are left out"), "{warnings:?}");
    }
    made.points.iter_mut().for_each(|point| point.place[0] = f64::NAN);
    let error = read_bytes(NAME, &made.bytes(MadeEncoding::LittleEndian)).unwrap_err().to_string();
    assert!(error.contains("scan.ply: holds no points: its header announces 200, none has"), "{error}");
}

#[test]
fn the_header_says_what_is_in_the_file() {
    for (encoding, format) in
        MadeEncoding::ALL.into_iter().zip(["ascii", "binary little-endian", "binary big-endian"])
    {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scan.ply");
        let made = MadePly::new(100);
        std::fs::write(&path, made.bytes(encoding)).unwrap();
        let header = &peek(&[path], &ReadOptions::AS_FILES_SAY).unwrap()[0];
        assert_eq!(header.format, format!("PLY, {format}"));
        assert_eq!(header.num_points, 100);
        let faces = format!("faces: {}", made.faces.len());
        let expected = ["rgb", "intensity", "normals", "extra:Quality", &faces];
        assert_eq!(header.attributes(), expected);
        assert_eq!(header.schema.unread, ["weights"], "lists");
        assert_eq!(header.software.as_deref(), Some("a test"));
    }
}

#[test]
fn reading_stops_when_asked() {
    let folder = tempfile::tempdir().unwrap();
    let stop = CancelToken::default();
    stop.cancel();
    for encoding in MadeEncoding::ALL {
        let path = folder.path().join("scan.ply");
        std::fs::write(&path, MadePly::new(20).bytes(encoding)).unwrap();
        let error = read(&[path], &ReadOptions::AS_FILES_SAY, &stop).unwrap_err().to_string();
        assert!(error.contains("stopped"), "{error}");
    }
}

/// An ascii file with these properties of one vertex element, and these rows.
fn text(properties: &str, rows: &str) -> Vec<u8> {
    let properties: String =
        properties.split(", ").map(|property| format!("property {property}\n")).collect();
    let count = rows.lines().count();
    format!("ply\nformat ascii 1.0\nelement vertex {count}\n{properties}end_header\n{rows}").into_bytes()
}

#[test]
fn colors_are_scaled_by_their_type() {
    let first = |properties: &str, rows: &str| {
        let (file, _) = read_one(&text(&format!("float x, float y, float z, {properties}"), rows));
        (file.points.rgb[0], file.coloring.source, file.color(0) & 0xff_ffff)
    };
    let bytes = first("uchar r, uchar g, uchar b", "0 0 0 1 2 255\n");
    assert_eq!(bytes, ([1, 2, 255], ColorSource::Rgb8, 0xff_02_01));
    let words =
        first("ushort diffuse_red, ushort diffuse_green, ushort diffuse_blue", "0 0 0 257 514 65535\n");
    assert_eq!(words, ([257, 514, 65535], ColorSource::Rgb16, 0xff_02_01));
    for names in [
        ["scalar_R", "scalar_G", "scalar_B"],
        ["scalar_Rf", "scalar_Gf", "scalar_Bf"],
        ["vertex_red", "vertex_green", "vertex_blue"],
        ["color_r", "color_g", "color_b"],
        ["colorR", "colorG", "colorB"],
        ["ambient_red", "ambient_green", "ambient_blue"],
    ] {
        let [r, g, b] = names.map(|name| format!("uchar {name}"));
        assert_eq!(first(&format!("{r}, {g}, {b}"), "0 0 0 1 2 255\n"), bytes, "{names:?}");
    }
    let floats = first("float red, float green, float blue", "0 0 0 0.5 0 1\n");
    assert_eq!(floats, ([32768, 0, 65535], ColorSource::Rgb16, 0xff_00_80));
    let doubles = first("double RED, double Green, double Blue", "0 0 0 0.004 0 0\n");
    assert_eq!(doubles, ([262, 0, 0], ColorSource::Rgb16, 1));
    let signed = first("uchar red, uchar green, char blue", "0 0 0 63 200 -56\n");
    assert_eq!(signed, ([63, 200, 200], ColorSource::Rgb8, 0xc8_c8_3f));
}

#[test]
fn without_color_a_file_goes_by_intensity_or_height() {
    let rows = "0 0 0 -1.5\n0 0 1 0\n0 0 2 1.5\n";
    let (file, _) = read_one(&text("double x, double y, double z, float scalar_Intensity", rows));
    assert_eq!(file.points.intensity, [0, 32768, 65535]);
    assert_eq!(file.coloring.source, ColorSource::Intensity { low: 0.0, high: 65535.0 });
    let (file, _) = read_one(&text("double x, double y, double z, int I", "0 0 0 7\n0 0 0 900\n"));
    assert_eq!(file.points.intensity, [7, 900]);
    let (file, _) = read_one(&text("double x, double y, double z, float other", rows));
    assert_eq!(file.coloring.source, ColorSource::Height { low: 0.0, high: 2.0 });
    assert!(file.points.intensity.is_empty() && file.points.normals.is_empty());
}

#[test]
fn coordinates_may_be_of_any_type_and_order() {
    let rows = "0 -3 7 2.5\n0 100 8 -1.25\n";
    let (file, warnings) = read_one(&text("uchar flag, char z, uint x, double y", rows));
    assert_eq!(file.bounds.min.to_array(), [7.0, -1.25, -3.0]);
    assert_eq!(file.bounds.max.to_array(), [8.0, 2.5, 100.0]);
    assert!(warnings.is_empty());
}

#[test]
fn one_point_and_equal_points_have_a_place() {
    for rows in ["1.5 -2 1234567890.12345\n", "1.5 -2 1234567890.12345\n1.5 -2 1234567890.12345\n"] {
        let (file, _) = read_one(&text("double x, double y, double z", rows));
        assert_eq!(file.bounds.min.to_array(), [1.5, -2.0, 1_234_567_890.123_45]);
        assert_eq!(file.bounds.max, file.bounds.min);
        assert!(file.grid.scale.cmpgt(glam::DVec3::ZERO).all());
    }
}

#[test]
fn strips_are_triangles() {
    let rows = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
    let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                  element tristrips 1\nproperty list int int vertex_indices\nend_header\n";
    let (file, warnings) = read_one(format!("{header}{rows}8 0 1 2 3 -1 3 2 1\n").as_bytes());
    assert_eq!(file.triangles, [[0, 1, 2], [2, 1, 3], [3, 2, 1]]);
    assert!(warnings.is_empty());
}

#[test]
fn info_counts_triangles() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scan.ply");
    let made = MadePly { faces: vec![MadeFace(vec![0, 1, 2, 3])], ..MadePly::new(4) };
    std::fs::write(&path, made.bytes(MadeEncoding::LittleEndian)).unwrap();
    let say = |options: &[&str]| {
        let mut command = program::command(PROGRAM);
        program::run(command.arg("info").arg(&path).args(options)).ok().text().to_owned()
    };
    let text = say(&[]);
    let line = |name: &str| text.lines().find_map(|line| line.strip_prefix(name)).unwrap_or("missing").trim();
    assert_eq!(
        ["points", "normals", "triangles", "format"].map(line),
        ["4", "yes", "2", "PLY, binary little-endian"]
    );
    let json: serde_json::Value = serde_json::from_str(&say(&["--json"])).unwrap();
    assert_eq!((&json["triangles"], &json["normals"]), (&2.into(), &true.into()));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_places_come_back(
        places in proptest::collection::vec(proptest::array::uniform3(-1e7..1e7), 1..60),
        encoding in prop::sample::select(MadeEncoding::ALL.to_vec()),
    ) {
        let mut made = MadePly::new(places.len());
        made.points.iter_mut().zip(places).for_each(|(point, place)| point.place = place);
        let (file, _) = read_one(&made.bytes(encoding));
        prop_assert_eq!(difference(&file, &made), None);
        let extent = file.bounds.size() / 4e9;
        for (i, point) in made.points.iter().enumerate() {
            let moved = file.grid.p_in_world(file.points.xyz[i]) - glam::DVec3::from_array(point.place);
            prop_assert!(moved.abs().cmple(extent).all(), "point {} moved by {}", i, moved);
        }
    }
}

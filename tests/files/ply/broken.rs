//! Broken PLY files give a clear error or the part that can be read; never a panic, a hang, or memory that is only
//! claimed.

use super::NAME;
use super::made::{MadeEncoding, MadePly};
use crate::bytes::{assert_refused, read_bytes, world};
use glam::DVec3;
use kit::damage::{MOST_KIB, assert_sound, damaged, peak_kib};
use proptest::prelude::*;

const XYZ: &str = "property float x\nproperty float y\nproperty float z\nend_header\n";

/// A file of three coordinates a point.
fn file(format: &str, count: impl std::fmt::Display, body: &[u8]) -> Vec<u8> {
    let header = format!("ply\nformat {format} 1.0\nelement vertex {count}\n{XYZ}");
    [header.as_bytes(), body].concat()
}

#[test]
fn headers_that_make_no_sense_name_their_line() {
    assert_refused(NAME, b"ply", "line 1: the header has no line end_header");
    assert_refused(NAME, b"ply\nformat ascii 1.0\nend_header\n", "no element named vertex");
    assert_refused(NAME, b"ply\nend_header\n", "line 2: no line before says the format");
    let no_z = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty list uchar float y\nend_header\n1 0\n";
    assert_refused(NAME, no_z.as_bytes(), "line 3: the element vertex has no y and no z");
    assert_refused(NAME, &file("ascii", -1, b""), "line 3: the element \"vertex\" has no count");
    assert_refused(NAME, &file("ascii", "", b""), "line 3: ");
    assert_refused(NAME, &file("binary", 1, b""), "line 2: the format \"binary\" is not known");
    let typo = "ply\nformat ascii 1.0\nelement vertex 1\nproperty flaot x\nend_header\n";
    assert_refused(NAME, typo.as_bytes(), "line 4: \"flaot\" is no type");
}

#[test]
fn no_points_is_an_error() {
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        assert_refused(NAME, &file(format, 0, b""), "holds no points: its header announces none");
        assert_refused(NAME, &file(format, 7, b""), "7 should follow byte");
        assert_refused(NAME, &file(format, u64::MAX, b""), "get it again");
    }
    assert_refused(NAME, &file("ascii", 2, b"one two\n3 4\n"), "none could be read, see line 8, \"one two\"");
}

#[test]
fn counts_that_lie_cost_nothing() {
    let place = [1f32, 2.0, 3.0].map(f32::to_le_bytes).concat();
    for (format, body) in [("ascii", b"1 2 3\n".to_vec()), ("binary_little_endian", place)] {
        for count in [2, 1_000_000_000_000, u64::MAX] {
            let scan = read_bytes(NAME, &file(format, count, &body.repeat(1))).unwrap();
            assert_eq!(scan.num_points(), 1, "{format}");
            let sentence = format!("scan.ply: announces {count} points, but only 1 could be read");
            assert!(scan.warnings[0].contains(&sentence), "{:?}", scan.warnings);
        }
        // Elements before the points that claim this many rows leave nothing for the points.
        let text = String::from_utf8(file(format, 1, b"")).unwrap();
        for property in ["property list uint double more\n", "property double more\n"] {
            let more = format!("element more {}\n{property}element vertex", u64::MAX);
            let bytes = [text.replace("element vertex", &more).as_bytes(), &body].concat();
            assert_refused(NAME, &bytes, "1 should follow byte");
        }
        // Other elements leave all for the points if their rows are empty.
        let more = format!("element more {}\nelement vertex", u64::MAX);
        let bytes = [text.replace("element vertex", &more).as_bytes(), &body].concat();
        assert_eq!(read_bytes(NAME, &bytes).unwrap().num_points(), 1);
    }
}

#[test]
fn lines_that_are_no_numbers_are_left_out() {
    let body = b"0 0 0\n\n 1 0\n2 0 zero\n\xff\x00 1 2\r\n4 0 0 and more\n";
    let scan = read_bytes(NAME, &file("ascii", 5, body)).unwrap();
    let xs: Vec<f64> = scan.files[0].points.xyz.iter().map(|&p| scan.files[0].grid.p_in_world(p).x).collect();
    assert_eq!(xs, [0.0, 4.0]);
    assert_eq!(scan.warnings.len(), 1);
    let expected = "scan.ply: has 3 lines that could not be read and were left out, first line 10, \"1 0\"; get or export it again";
    assert!(scan.warnings[0].ends_with(expected), "{:?}", scan.warnings);
}

#[test]
fn a_file_cut_anywhere_gives_its_whole_points() {
    for encoding in MadeEncoding::ALL {
        for (faces_first, lists) in [(false, false), (true, true)] {
            let made = MadePly { faces_first, lists, ..MadePly::new(12) };
            let bytes = made.bytes(encoding);
            let (mut num_partial, mut most) = (0, 0);
            for len in 0..bytes.len() {
                let Ok(scan) = read_bytes(NAME, &bytes[..len]) else {
                    assert_eq!(most, 0, "{encoding:?} cut at {len}: nothing, though less gave something");
                    continue;
                };
                let places = world(&scan);
                assert!(places.len() >= most);
                most = places.len();
                for (place, point) in places.iter().zip(&made.points) {
                    let moved = *place - DVec3::from_array(point.place);
                    let near = moved.abs().cmplt(DVec3::splat(1e-6)).all();
                    assert!(near, "{encoding:?} cut at {len}: {place}, not {:?}", point.place);
                }
                let said = format!("announces 12 points, but only {most} could be read");
                assert_eq!(scan.warnings.iter().any(|warning| warning.contains(&said)), most < 12);
                assert!(!scan.warnings.iter().any(|warning| warning.contains("to its end")));
                num_partial += usize::from(most < 12);
                let num_points = most as u32;
                assert!(scan.files[0].triangles.iter().flatten().all(|&corner| corner < num_points));
            }
            assert!(num_partial > 100 && most == 12, "{encoding:?}: {num_partial} cuts, {most} points");
        }
    }
}

#[test]
fn missing_faces_are_counted() {
    for encoding in MadeEncoding::ALL {
        let made = MadePly::new(60);
        let bytes = made.bytes(encoding);
        let scan = read_bytes(NAME, &bytes[..bytes.len() - 40]).unwrap();
        assert_eq!(scan.num_points(), 60);
        let said = format!("announces {} faces, but only", made.faces.len());
        assert!(scan.warnings[0].contains(&said), "{:?}", scan.warnings);
        assert!(made.triangles().starts_with(&scan.files[0].triangles));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_end_well(
        body in proptest::collection::vec(any::<u8>(), 0..1000),
        lines in proptest::collection::vec(prop::sample::select(LINES.to_vec()), 0..12),
    ) {
        let header: String = lines.iter().map(|line| format!("{line}\n")).collect();
        if let Ok(scan) = read_bytes(NAME, &[b"ply\n", header.as_bytes(), b"end_header\n", &body].concat()) {
            assert_sound(&scan);
        }
        let _ = read_bytes(NAME, &[b"ply\n", &body[..]].concat());
        prop_assert!(peak_kib().unwrap_or(0) < MOST_KIB);
    }

    #[test]
    fn damaged_files_end_well(
        encoding in prop::sample::select(MadeEncoding::ALL.to_vec()),
        lists in any::<bool>(),
        faces_first in any::<bool>(),
        damage in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        cut in any::<prop::sample::Index>(),
        cutting in any::<bool>(),
    ) {
        let whole = MadePly { faces_first, lists, ..MadePly::new(60) }.bytes(encoding);
        let bytes = damaged(whole, &damage, cutting.then_some(cut));
        if let Ok(scan) = read_bytes(NAME, &bytes) {
            assert_sound(&scan);
        }
        prop_assert!(peak_kib().unwrap_or(0) < MOST_KIB);
    }
}

/// Lines of headers that may follow each other in any order.
const LINES: [&str; 14] = [
    "format ascii 1.0",
    "format binary_little_endian 1.0",
    "format binary_big_endian 1.0",
    "element vertex 1000000000000",
    "element vertex 18446744073709551615",
    "element vertex 3",
    "element face 4000000000",
    "element face 2",
    "property float x\nproperty float y\nproperty float z",
    "property uchar x\nproperty int y\nproperty uint z",
    "property list uint double vertex_indices",
    "property list uchar uchar vertex_index",
    "property float red\nproperty short green\nproperty uchar blue",
    "property float i",
];

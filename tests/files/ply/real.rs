//! Real PLY files, where `SCANWALK_TEST_DATA` names a folder of scans: counts and boxes as other readers found them.

use kit::real_scans::{folder, read_in};
use points::{ColorSource, ReadOptions, Scan, peek};

/// Path, points, triangles, smallest and largest corner rounded to thousandths.
type PlyRow = (&'static str, usize, usize, [f64; 3], [f64; 3]);

#[rustfmt::skip]
const TABLE: &[PlyRow] = &[
    ("ply/Guanyin.ply", 238154, 0, [-0.511, 0.002, -0.37], [0.475, 1.293, 0.454]),
    ("ply/mesh.ply", 4, 2, [1.0, 1.0, 0.0], [2.0, 2.0, 2.0]),
    ("ply/simple_binary.ply", 3, 0, [-1.0, 0.0, 0.0], [1.0, 1.0, 0.0]),
    ("ply/source.ply", 69792, 0, [-23.759, -52.001, -3.021], [18.48, 6.508, 9.173]),
    ("ply/text_extradim.ply", 1, 0, [-2.649, -13.095, 0.006], [-2.649, -13.095, 0.006]),
    ("malformed/ply/issue_2421.ply", 1, 0, [1.235, 12345.679, 1234567890.123], [1.235, 12345.679, 1234567890.123]),
    ("malformed/ply/simple_text.ply", 3, 0, [-1.0, 0.0, 0.0], [1.0, 1.0, 0.0]),
];

/// Tells what differs from the row, if anything does.
fn difference(scan: &Scan, (name, num_points, num_triangles, min, max): &PlyRow) -> Option<String> {
    let bounds = scan.bounds();
    let near = |a: [f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 0.00051);
    let counts = (scan.num_points(), scan.files[0].triangles.len());
    let same = counts == (*num_points, *num_triangles)
        && near(bounds.min.into(), min)
        && near(bounds.max.into(), max)
        && scan.warnings.is_empty();
    (!same).then(|| format!("{name}: {counts:?}, {bounds:?}, {:?}", scan.warnings))
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn counts_and_boxes_are_those_of_other_readers() {
    let folder = folder();
    for row in TABLE {
        let scan = read_in(&folder, row.0).unwrap();
        assert_eq!(difference(&scan, row), None);
        // The comparison can fail.
        assert!(difference(&scan, &(row.0, row.1 + 1, row.2, row.3, row.4)).is_some());
        assert!(difference(&scan, &(row.0, row.1, row.2, row.3, row.4.map(|c| c + 0.01))).is_some());
    }
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn colors_normals_and_programs_are_recognized() {
    let folder = folder();
    let color = |name: &str| read_in(&folder, name).unwrap().files[0].coloring.source;
    assert_eq!(color("ply/Guanyin.ply"), ColorSource::Rgb8);
    assert!(matches!(color("ply/source.ply"), ColorSource::Intensity { .. }));
    assert!(matches!(color("ply/mesh.ply"), ColorSource::Height { .. }));
    let extra = read_in(&folder, "ply/text_extradim.ply").unwrap().files.remove(0);
    assert_eq!(extra.points.rgb, [[63, 200, 64]]);
    assert!((extra.points.normals[0][2] - 0.999_677).abs() < 1e-5, "{:?}", extra.points.normals);
    let header = |name: &str| peek(&[folder.join(name)], &ReadOptions::AS_FILES_SAY).unwrap().remove(0);
    let source = header("ply/source.ply");
    assert_eq!(source.software.as_deref(), Some("CloudCompare v2.11.1 (Anoia)"));
    assert_eq!((source.created.as_deref(), source.num_points), (Some("2024-03-21"), 69792));
    assert_eq!(header("ply/text_extradim.ply").attributes(), ["rgb", "normals", "extra:alpha", "extra:omg"]);
    assert_eq!(header("ply/mesh.ply").attributes(), ["faces: 2"]);
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn unreadable_files_say_why() {
    let folder = folder();
    for (name, reason) in [
        ("malformed/ply/no_vertex.ply", "no element named vertex"),
        ("malformed/ply/sized_dims.ply", "line 4: the element vertex has no z"),
    ] {
        let error = read_in(&folder, name).map(|scan| scan.num_points()).unwrap_err();
        assert!(error.contains(name) && error.contains(reason), "{error}");
    }
}

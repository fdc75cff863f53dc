//! Every point format and version, read by us and by the las crate, point by point.

use base::task::CancelToken;
use kit::las_files::{Fixture, save};
use kit::reading;
use points::{ColorSource, Points, ReadOptions, peek, read};
use std::path::Path;

/// The columns as the las crate's own reader sees them, from its points back to the grid.
fn columns_by_las(path: &Path) -> Points {
    let mut reader = las::Reader::from_path(path).unwrap();
    let transforms = *reader.header().transforms();
    let all = reader.read_all().unwrap();
    let mut points = Points::default();
    for point in all.points() {
        let point = point.unwrap();
        let step = |value: f64, t: &las::Transform| ((value - t.offset) / t.scale).round() as i32;
        let xyz = [step(point.x, &transforms.x), step(point.y, &transforms.y), step(point.z, &transforms.z)];
        points.xyz.push(xyz);
        points.intensity.push(point.intensity);
        points.rgb.extend(point.color.map(|c| [c.red, c.green, c.blue]));
    }
    if points.rgb.iter().flatten().all(|&c| c == 0) {
        points.rgb.clear();
    }
    points
}

fn fixtures() -> Vec<Fixture> {
    let mut all: Vec<Fixture> = (0..=10).map(Fixture::new).collect();
    all.extend((0..=8).map(|format| Fixture::new(format).compressed()));
    // These have records longer than their format, older versions, LAS 1.4 with old formats, more than one chunk.
    all.extend([3, 6].map(|format| Fixture { extra_bytes: 5, ..Fixture::new(format) }));
    all.extend([3, 7].map(|format| Fixture { extra_bytes: 5, ..Fixture::new(format) }.compressed()));
    all.extend([0, 1].map(|format| Fixture { minor: 0, ..Fixture::new(format) }));
    all.extend([0, 1].map(|format| Fixture { minor: 1, ..Fixture::new(format) }));
    all.extend((0..=5).map(|format| Fixture { minor: 4, ..Fixture::new(format) }));
    all.extend([2, 7].map(|format| Fixture::new(format).with_points(120_001).compressed()));
    all.push(Fixture::new(3).with_points(50_001));
    all
}

#[test]
fn all_formats_equal_the_las_crate() {
    for fixture in fixtures() {
        let (_folder, path) = save("scan.las", &fixture.bytes());
        let scan = reading::file(&path).unwrap();
        assert!(scan.warnings.is_empty(), "{fixture:?}: {:?}", scan.warnings);
        let (ours, theirs) = (&scan.files[0].points, columns_by_las(&path));
        assert_eq!(ours.xyz.len(), fixture.num_points, "{fixture:?}");
        assert!(*ours == theirs, "{fixture:?} differs from the las crate");
        let letter = if fixture.compressed { 'Z' } else { 'S' };
        let expected = format!("LA{letter} 1.{}, point format {}", fixture.minor, fixture.point_format);
        assert_eq!(scan.files[0].format, expected);
        assert_eq!(
            peek(std::slice::from_ref(&path), &ReadOptions::AS_FILES_SAY).unwrap()[0].num_points,
            fixture.num_points as u64
        );
        let has_rgb = [2, 3, 5, 7, 8, 10].contains(&fixture.point_format);
        let by_rgb = scan.files[0].coloring.source == ColorSource::Rgb16;
        assert_eq!(by_rgb, has_rgb, "{fixture:?}");
    }
}

#[test]
fn the_comparison_with_the_las_crate_can_fail() {
    let mut bytes = Fixture::new(3).bytes();
    let (_a, path) = save("a.las", &bytes);
    let theirs = columns_by_las(&path);
    let num_bytes = bytes.len();
    for (from_end, what) in [(34, "x"), (34 - 12, "intensity"), (6, "red")] {
        bytes[num_bytes - from_end] ^= 1;
        let (_b, changed) = save("b.las", &bytes);
        assert!(
            reading::file(&changed).unwrap().files[0].points != theirs,
            "a changed {what} was not noticed"
        );
        bytes[num_bytes - from_end] ^= 1;
    }
}

#[test]
fn the_grid_is_kept_exactly() {
    let (_folder, path) = save("scan.las", &Fixture::new(6).bytes());
    let scan = reading::file(&path).unwrap();
    let file = &scan.files[0];
    assert_eq!(file.grid.scale.to_array(), [0.01, 0.01, 0.001]);
    assert_eq!(file.grid.offset.to_array(), [500_000.0, 4_000_000.0, 100.0]);
    let mut bounds = base::space::Bounds::EMPTY;
    for &xyz in &file.points.xyz {
        bounds = bounds.with(file.grid.p_in_world(xyz));
    }
    assert_eq!(file.bounds, bounds);
    assert_eq!(scan.bounds(), bounds);
}

#[test]
fn several_files_keep_their_order_and_share_nothing_but_the_ramp() {
    let a = save("a.laz", &Fixture::new(1).compressed().bytes());
    let b = save("b.las", &Fixture::new(1).with_points(10).bytes());
    let scan = reading::files(&[a.1.clone(), b.1.clone()]).unwrap();
    assert_eq!(scan.num_points(), 1010);
    assert_eq!([&scan.files[0].path, &scan.files[1].path], [&a.1, &b.1]);
    assert_eq!(scan.files[0].coloring.source, scan.files[1].coloring.source);
    assert!(matches!(scan.files[0].coloring.source, ColorSource::Intensity { .. }));
    // Ten points alone have another range, so the ranges above were really shared.
    assert_ne!(reading::file(&b.1).unwrap().files[0].coloring.source, scan.files[1].coloring.source);
}

#[test]
fn reading_stops_when_asked() {
    let stop = CancelToken::default();
    stop.cancel();
    for bytes in [Fixture::new(3).bytes(), Fixture::new(3).compressed().bytes()] {
        let (_folder, path) = save("scan.las", &bytes);
        let error = read(&[path], &ReadOptions::AS_FILES_SAY, &stop).unwrap_err().to_string();
        assert!(error.contains("stopped"), "{error}");
    }
}

//! Real scans, where `SCANWALK_TEST_DATA` names a folder of them: counts and boxes as other readers found them.

use base::task::CancelToken;
use kit::reading;
use kit::real_scans::{folder, read_in};
use points::{ColorSource, ReadOptions, Scan, read};

/// Path, points, smallest and largest corner rounded to thousandths.
type ScanRow = (&'static str, usize, [f64; 3], [f64; 3]);

const AUTZEN_SMALL: ([f64; 3], [f64; 3]) = ([635619.85, 848899.7, 406.59], [638982.55, 853535.43, 586.38]);
const POINT: [f64; 3] = [470692.44, 4602888.9, 16.0];
const NINE: ([f64; 3], [f64; 3]) = ([0.0; 3], [9.0; 3]);

#[rustfmt::skip]
const TABLE: &[ScanRow] = &[
    ("copc/lone-star.copc.laz", 518862, [515368.602, 4918340.364, 2322.896], [515401.043, 4918381.124, 2338.575]),
    ("copc/simple_with_page.copc.laz", 1065, AUTZEN_SMALL.0, AUTZEN_SMALL.1),
    ("las-small/1.2-with-color.las", 1065, AUTZEN_SMALL.0, AUTZEN_SMALL.1),
    ("las-small/epsg_4326.las", 5380, [-94.683, 31.037, 39.081], [-94.661, 31.047, 78.119]),
    ("las-small/extrabytes.las", 1065, AUTZEN_SMALL.0, AUTZEN_SMALL.1),
    ("las-small/interesting.las", 1065, AUTZEN_SMALL.0, AUTZEN_SMALL.1),
    ("las-small/sample_c.las", 14408, [674521.92, 1206740.08, 627.53], [674605.32, 1206814.96, 656.23]),
    ("las-small/simple.laz", 1065, AUTZEN_SMALL.0, AUTZEN_SMALL.1),
    ("las-small/simple1_3.las", 999, [-235434.519, 5800843.145, 265.094], [-234935.841, 5800946.249, 273.811]),
    ("las-small/test1_4.las", 1000, [1694038.446, 1816492.706, 5592.75], [1694539.677, 1816497.976, 5599.07]),
    ("las-versions/1.0_0.las", 1, POINT, POINT),
    ("las-versions/1.0_1.las", 1, POINT, POINT),
    ("las-versions/1.1_0.las", 1, POINT, POINT),
    ("las-versions/1.1_1.las", 1, POINT, POINT),
    ("las-versions/1.2_0.las", 1, POINT, POINT),
    ("las-versions/1.2_1.las", 1, POINT, POINT),
    ("las-versions/1.2_2.las", 1, POINT, POINT),
    ("las-versions/1.2_3.las", 1, POINT, POINT),
    ("laz-aerial-autzen/autzen_trim.laz", 110000, [636001.76, 848935.2, 406.26], [637179.22, 849497.9, 520.51]),
    ("laz-aerial-nocolour-bcts/bcts_1.laz", 531662, [885022.37, 629157.18, 325.83], [885210.15, 629399.99, 358.28]),
    ("laz-aerial-rgbnir-ign/las_with_several_extra_byte_bloc.laz", 697721, [484649.36, 6632629.73, 99.65], [484999.99, 6632999.99, 120.42]),
    ("laz-indoor-rooms/indoor-rooms.laz", 3234126, [0.937, 0.005, 0.758], [15.482, 11.284, 4.361]),
    ("laz-tiles-lone-star/split-1.laz", 122893, [515393.0, 4918340.364, 2323.1], [515400.002, 4918365.0, 2338.482]),
    ("laz-tiles-lone-star/split-2.laz", 154561, [515368.602, 4918341.038, 2322.896], [515393.0, 4918365.0, 2338.497]),
    ("laz-tiles-lone-star/split-3.laz", 132693, [515393.0, 4918365.0, 2324.287], [515401.043, 4918379.744, 2338.031]),
    ("laz-tiles-lone-star/split-4.laz", 108715, [515378.12, 4918365.0, 2323.675], [515393.0, 4918381.124, 2338.575]),
    ("laz-tls-tree/pine.laz", 73851, [-1.249, -1.24, -0.224], [1.241, 1.24, 19.936]),
    ("malformed/las/1.2-with-color-clipped.las", 1064, AUTZEN_SMALL.0, AUTZEN_SMALL.1),
    ("malformed/las/append-bug-cpy.laz", 37807, [0.0; 3], [699000.0, 6260000.0, 266.03]),
    ("malformed/las/bad-geotiff-keys.las", 10, [289814.15, 4320978.61, 170.58], [289818.5, 4320980.59, 170.76]),
    ("malformed/las/gps-time-nan.las", 1, [0.0; 3], [0.0; 3]),
    ("malformed/las/lots_of_vlr.las", 1, [715001.346, 839349.171, 17.275], [715001.346, 839349.171, 17.275]),
    ("malformed/las/malformed_extrabytes.las", 10, [0.0; 3], [9.0, 9.0, 0.9]),
    ("malformed/las/simple-laszip-compressor-version-1.2r0.laz", 1065, AUTZEN_SMALL.0, AUTZEN_SMALL.1),
    ("malformed/las/spurious.las", 1065, [-124.069, 44.05, 123.93], [-123.063, 44.062, 178.73]),
    ("malformed/las/unregistered_extra_bytes.las", 4, [1.0; 3], [4.0; 3]),
];

/// Tells what differs from the row, if anything does.
fn difference(scan: &Scan, (name, num_points, min, max): &ScanRow) -> Option<String> {
    let bounds = scan.bounds_in_file();
    let near = |a: [f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 0.00051);
    let same =
        scan.num_points() == *num_points && near(bounds.min.into(), min) && near(bounds.max.into(), max);
    (!same).then(|| format!("{name}: {} points, {bounds:?}", scan.num_points()))
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn counts_and_boxes_are_those_of_other_readers() {
    let folder = folder();
    for row in TABLE {
        let scan = read_in(&folder, row.0).unwrap();
        assert_eq!(difference(&scan, row), None);
    }
    for format in 0..=10 {
        for kind in ["las", "laz"] {
            let name: &'static str = format!("las-point-formats/10_points_format_{format}.{kind}").leak();
            // Some of the points are marked as withheld.
            let all = ReadOptions { show_withheld: true, ..ReadOptions::AS_FILES_SAY };
            let scan = read(&[folder.join(name)], &all, &CancelToken::default()).unwrap();
            assert_eq!(difference(&scan, &(name, 10, NINE.0, NINE.1)), None);
        }
    }
}

#[test]
fn a_wrong_row_is_noticed() {
    let (_folder, path) = kit::las_files::save("a.las", &kit::las_files::Fixture::new(0).bytes());
    let scan = reading::file(&path).unwrap();
    let (min, max) = (scan.bounds().min.to_array(), scan.bounds().max.to_array());
    assert_eq!(difference(&scan, &("a", 1000, min, max)), None);
    assert!(difference(&scan, &("a", 999, min, max)).is_some());
    assert!(difference(&scan, &("a", 1000, min, [max[0], max[1], max[2] + 0.01])).is_some());
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn the_same_points_are_the_same_in_every_packing() {
    let folder = folder();
    let points = |name: &str| read_in(&folder, name).unwrap().files.remove(0).points;
    let plain = points("las-small/1.2-with-color.las");
    assert!(plain == points("las-small/simple.laz"));
    assert!(plain == points("malformed/las/simple-laszip-compressor-version-1.2r0.laz"));
    assert!(plain == points("las-small/extrabytes.las"));
    for format in 0..=10 {
        let name = |kind| format!("las-point-formats/10_points_format_{format}.{kind}");
        assert!(points(&name("las")) == points(&name("laz")), "point format {format}");
    }
    // The comparison can fail.
    assert!(plain != points("malformed/las/1.2-with-color-clipped.las"));
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn four_tiles_hold_the_points_of_the_whole() {
    let folder = folder();
    let tiles: Vec<_> = (1..=4).map(|i| folder.join(format!("laz-tiles-lone-star/split-{i}.laz"))).collect();
    let tiles = reading::files(&tiles).unwrap();
    let whole = read_in(&folder, "copc/lone-star.copc.laz").unwrap();
    let sorted = |scan: &Scan| {
        // All five files share steps of 0.25 mm.
        let places = scan.files.iter().flat_map(|file| {
            let grid = file.grid;
            file.points.xyz.iter().map(move |&p| (grid.p_in_world(p) * 4e3).round().as_i64vec3().to_array())
        });
        let mut places: Vec<_> = places.collect();
        places.sort_unstable();
        places
    };
    assert!(sorted(&tiles) == sorted(&whole));
    assert_eq!(tiles.files[0].coloring.source, tiles.files[3].coloring.source);
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn colors_and_units_are_recognized() {
    let folder = folder();
    let scan = |name: &str| read_in(&folder, name).unwrap();
    assert_eq!(scan("laz-aerial-autzen/autzen_trim.laz").files[0].coloring.source, ColorSource::Rgb8);
    assert_eq!(scan("las-small/sample_c.las").files[0].coloring.source, ColorSource::Rgb16);
    // A part of these rooms was not photographed.
    let rooms = scan("laz-indoor-rooms/indoor-rooms.laz");
    let blank = rooms.files[0].coloring.blank.unwrap();
    assert_eq!(
        (rooms.files[0].coloring.source, blank.color, blank.num_others),
        (ColorSource::Rgb16, [0; 3], 2_804_520)
    );
    assert!(matches!(scan("laz-tls-tree/pine.laz").files[0].coloring.source, ColorSource::Height { .. }));
    assert!(matches!(
        scan("las-small/simple1_3.las").files[0].coloring.source,
        ColorSource::Intensity { .. }
    ));
    assert_eq!(scan("laz-aerial-autzen/autzen_trim.laz").unit_m, Some(0.3048));
    assert_eq!(scan("laz-aerial-rgbnir-ign/las_with_several_extra_byte_bloc.laz").unit_m, Some(1.0));
    let degrees = scan("las-small/epsg_4326.las");
    assert_eq!((degrees.crs.as_deref(), degrees.unit_in_file_m), (Some("EPSG:4326, WGS 84"), None));
    assert!(degrees.warnings[0].contains("in degrees"));
    // The scan is two kilometers across, upright, in meters.
    let size = degrees.bounds().size();
    assert!((2000.0..2200.0).contains(&size.x) && (1050.0..1200.0).contains(&size.y), "{size}");
    assert!((38.0..41.0).contains(&size.z) && degrees.unit_m == Some(1.0), "{size}");
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn unreadable_files_say_why() {
    let folder = folder();
    for (name, reason) in [
        ("malformed/las/1.2-no-points.las", "1065 should start at byte 229"),
        ("malformed/las/no-points.las", "holds no points"),
        ("malformed/las/lfs-pointer.laz", "git lfs pull"),
        ("malformed/las/ept-invalid-tile-2-2-2-2.laz", "header is damaged"),
        ("malformed/potree20-lfs-pointers", "git lfs pull"),
    ] {
        let error = read_in(&folder, name).map(|scan| scan.num_points()).unwrap_err();
        assert!(error.contains(name) && error.contains(reason), "{error}");
    }
    let garbage = read_in(&folder, "malformed/las/garbage_nVariableLength.las").unwrap();
    assert_eq!((garbage.num_points(), garbage.warnings.len()), (718, 1));
}

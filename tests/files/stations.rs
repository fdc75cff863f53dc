//! Real E57 and PTX files, where `SCANWALK_TEST_DATA` names a folder of them: points, boxes, sums and ranges as other readers
//! found them (E57: pye57 0.4.19 on libE57Format, poses applied; PTX: Python's `float` on the words of each line).

use base::task::Progress;
use glam::DVec3;
use kit::reading;
use kit::real_scans::{folder, read_in};
use points::{Attribute, Block, Column, Header, OpenHints, StationKind, Trailer, open};

/// Path, points, sums of their coordinates, smallest and largest corner.
type StationRow = (&'static str, usize, [f64; 3], [f64; 3], [f64; 3]);

#[rustfmt::skip]
const TABLE: &[StationRow] = &[
    ("e57/ColouredCubeFloat.e57", 7680, [-49.720_847_696_065_9, 17.862_877_547_740_936, -30.592_817_962_169_647], [-0.5; 3], [0.5; 3]),
    ("e57/bunnyInt21.e57", 30571, [-841.093_298, 3_151.198_742, 264.243_972], [-0.094_689, 0.040_011, -0.061_873], [0.061_009, 0.187_321, 0.058_799]),
    ("e57/cartesian_invalid_state_single.e57", 1, [-1.0, -2.0, -3.0], [-1.0, -2.0, -3.0], [-1.0, -2.0, -3.0]),
    ("e57/float_intensity_without_min_max.e57", 1, [1.0; 3], [1.0; 3], [1.0; 3]),
    ("e57/integer_intensity.e57", 2, [5.5, 7.7, 9.9], [1.1, 2.2, 3.3], [4.4, 5.5, 6.6]),
    ("e57/pumpAVisualReferenceImage.e57", 155_201, [-74_913.309_953, -409_112.126_518, -147_000.510_634], [-2.903_763, -5.301_102, -1.899_704], [1.721_603, -0.792_648, 1.843_002]),
    ("e57/testWithNormals.e57", 2, [3.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]),
    ("e57/tinyCartesianFloatRgb.e57", 2090, [-16_812.262_330_532, 12_566.194_438_457, 620_734.605_621_338], [-9.779_529_572, 4.513_879_299, 295.524_688_721], [-6.774_238_110, 7.515_460_491, 298.532_165_527]),
    ("e57/tiny_pc_and_images.e57", 2, [1.0; 3], [0.0; 3], [1.0; 3]),
    ("e57/tiny_pc_with_extension.e57", 1, [1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [1.0, 2.0, 3.0]),
    ("e57/tiny_spherical.e57", 180, [89.954_356_669, 0.000_869_022, 114.645_905_078], [0.000_000_634, -0.499_998_573, 0.0], [1.0, 0.499_999_841, 0.999_999_683]),
    ("e57/translationWithoutRotation.e57", 4, [18.0, 22.0, 24.0], [4.0, 5.0, 6.0], [5.0, 6.0, 6.0]),
    ("malformed/e57/corrupt_crc.e57", 2090, [-16_812.262_330_532, 12_566.194_438_457, 620_734.605_621_338], [-9.779_529_572, 4.513_879_299, 295.524_688_721], [-6.774_238_110, 7.515_460_491, 298.532_165_527]),
    ("malformed/e57/no_ext_namespace.e57", 1, [1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [1.0, 2.0, 3.0]),
    ("text/1.2-with-color.ptx", 1065, [678721022.97, 906580758.4899987, 462314.2], [635619.85, 848899.7, 406.59], [638982.55, 853535.43, 586.38]),
    ("text/complex-transform.ptx", 4, [-12.137534318, -12.68587899, -7.294649423], [-3.034407381, -3.173781036, -1.825114625], [-3.03435979, -3.168529921, -1.82206835]),
];

/// All points of a file, with all attributes.
fn whole(name: &str) -> (Header, Block, Trailer) {
    let dataset = open(&folder().join(name), &OpenHints::default()).unwrap();
    let mut blocks = Vec::new();
    let mut take = |block| {
        blocks.push(block);
        Ok(())
    };
    let trailer =
        dataset.read(&dataset.header().schema.projection(), &mut take, &Progress::hidden()).unwrap();
    assert_eq!(blocks.len(), 1);
    (dataset.header().clone(), blocks.remove(0), trailer)
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn points_are_where_other_readers_find_them() {
    for (name, num, sums, low, high) in TABLE {
        let (_, block, trailer) = whole(name);
        assert_eq!((block.xyz.len(), &trailer.losses[..]), (*num, &[][..] as &[String]), "{name}");
        let places = block.xyz.iter().map(|&xyz| block.grid.p_in_world(xyz));
        let start = (DVec3::ZERO, DVec3::INFINITY, DVec3::NEG_INFINITY);
        let found = places.fold(start, |(sum, low, high), p| (sum + p, low.min(p), high.max(p)));
        let near = |a: DVec3, b: &[f64; 3], most: f64| {
            (a - DVec3::from_array(*b)).abs().max_element() <= most * (1.0 + a.abs().max_element())
        };
        let is_same =
            near(found.0, sums, 1e-9 * *num as f64) && near(found.1, low, 2e-9) && near(found.2, high, 2e-9);
        assert!(is_same, "{name}: {found:?}");
    }
}

/// Smallest value, largest value and sum of a column.
macro_rules! extremes {
    ($column:expr, $kind:ident) => {{
        let Some(Column::$kind(values)) = $column else { panic!("{:?}", $column.map(Column::kind)) };
        let values = values.iter().map(|&value| f64::from(value));
        values.fold((f64::MAX, f64::MIN, 0.0), |(low, high, sum), v| (v.min(low), v.max(high), sum + v))
    }};
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn attributes_have_the_ranges_that_other_readers_find() {
    let (header, block, trailer) = whole("e57/pumpAVisualReferenceImage.e57");
    let named = |name: &str| block.column(&Attribute::Named(name.into()));
    // Stored numbers; pye57 has their values as floats of 32 bits: 0.38380077 to 0.6983856.
    let (low, high, _) = extremes!(named("intensity"), U16);
    let scale = header.schema.field(&Attribute::Named("intensity".into())).unwrap().scale;
    assert!((low * scale - 0.383_800_77).abs() < 3e-8 && (high * scale - 0.698_385_6).abs() < 3e-8);
    assert_eq!(extremes!(named("rowIndex"), U16), (0.0, 1073.0, 59_422_135.0));
    assert_eq!(extremes!(named("columnIndex"), U16), (0.0, 344.0, 25_596_424.0));
    assert_eq!(extremes!(block.column(&Attribute::SourceId), U16), (1.0, 1.0, 155_201.0));
    let (low, high, _) = extremes!(block.column(&Attribute::Intensity), U16);
    assert_eq!((low, high, trailer.white), (0.0, 65535.0, Some(255)));
    let Some(Column::U16x3(rgb)) = block.column(&Attribute::Color) else { panic!() };
    let sums: [u64; 3] = std::array::from_fn(|channel| rgb.iter().map(|rgb| u64::from(rgb[channel])).sum());
    assert_eq!(sums, [5_023_067, 5_904_063, 4_008_525]);
    assert!(header.is_on_fixed_grid && block.grid.scale == DVec3::splat(1e-6));
    assert_eq!(
        (header.created.as_deref(), &header.parts[..]),
        (Some("2011-08-03"), &["scans: 1", "images: 1"].map(String::from)[..])
    );
    let (_, block, _) = whole("e57/integer_intensity.e57");
    assert_eq!(extremes!(block.column(&Attribute::Named("intensity".into())), I8), (-66.0, 66.0, 0.0));
    let (_, block, _) = whole("malformed/e57/no_ext_namespace.e57");
    assert_eq!(extremes!(block.column(&Attribute::Named("classification".into())), U16), (42.0, 42.0, 42.0));
    let (_, block, _) = whole("e57/tiny_pc_with_extension.e57");
    assert_eq!(block.column(&Attribute::Normal), Some(&Column::F32x3(vec![[1.0, 0.0, 0.0]])));
    let (_, block, _) = whole("text/1.2-with-color.ptx");
    let (low, high, sum) = extremes!(block.column(&Attribute::Named("intensity".into())), F64);
    assert!(low == 0.0 && high == 0.062012 && (sum - 19.86353499999999).abs() < 1e-6, "{low} {high} {sum}");
    let Some(Column::U16x3(rgb)) = block.column(&Attribute::Color) else { panic!() };
    let sums: [u64; 3] = std::array::from_fn(|channel| rgb.iter().map(|rgb| u64::from(rgb[channel])).sum());
    assert_eq!(sums, [129567, 118582, 134764]);
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn scanners_and_cameras_are_stations() {
    let (header, ..) = whole("e57/translationWithoutRotation.e57");
    let station = &header.stations[0];
    assert_eq!(
        (&station.name[..], station.kind, station.source_id),
        ("Scan 0", StationKind::Scanner, Some(1))
    );
    assert_eq!(station.file_from_station.unwrap().position, DVec3::new(4.0, 5.0, 6.0));
    // One of four images has a pose.
    let (header, ..) = whole("e57/tiny_pc_and_images.e57");
    let camera = &header.stations[1];
    assert_eq!((header.stations.len(), &camera.name[..], camera.kind), (2, "spherical", StationKind::Camera));
    assert_eq!(camera.file_from_station.unwrap().position, DVec3::new(1.0, 2.0, 3.0));
    let (header, ..) = whole("text/complex-transform.ptx");
    let position = header.stations[0].file_from_station.unwrap().position;
    assert_eq!(position, DVec3::new(-3.028_748, -3.819_741, -1.384_333));
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn files_without_points_say_why() {
    let folder = folder();
    for (name, reason) in [
        ("InvalidCVHeader", "its only scan announces none"),
        ("ZeroPoints", "its only scan announces none"),
        ("empty", "it has no scans"),
        ("empty_pc", "its only scan announces none"),
        ("read_error", "all its points are marked as invalid, or at the scanner itself"),
    ] {
        let error = read_in(&folder, &format!("malformed/e57/{name}.e57")).unwrap_err();
        assert!(error.contains(&format!("holds no points: {reason}")), "{error}");
    }
    // What is damaged is said, and the rest is read.
    let scan = read_in(&folder, "malformed/e57/corrupt_crc.e57").unwrap();
    assert!(scan.warnings[0].contains("damaged description (its checksum is wrong)"), "{:?}", scan.warnings);
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn names_of_files_may_have_any_letters() {
    let copy = tempfile::tempdir().unwrap();
    let path = copy.path().join("Größe 測量.e57");
    std::fs::copy(folder().join("e57/tinyCartesianFloatRgb.e57"), &path).unwrap();
    assert_eq!(reading::file(&path).unwrap().num_points(), 2090);
}

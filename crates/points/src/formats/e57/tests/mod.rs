//! Tests of E57 files that are written here: what is read of them, and whatever can be wrong.

mod broken;
mod made;

use super::*;
use crate::block::Block;
use crate::column::{Column, Type};
use crate::{Attribute, Field};
use glam::{DQuat, DVec3};
use made::{MadeE57Scan, MadeE57Stream, doubles, file, singles, whole};

/// What was read of a file.
struct ReadE57 {
    header: Header,
    block: Block,
    trailer: Trailer,
}

impl ReadE57 {
    fn places(&self) -> Vec<DVec3> {
        self.block.xyz.iter().map(|&xyz| self.block.grid.p_in_world(xyz)).collect()
    }

    fn column(&self, attribute: &Attribute) -> &Column {
        self.block.column(attribute).unwrap_or_else(|| panic!("no {attribute:?}"))
    }

    fn named(&self, name: &str) -> &Column {
        self.column(&Attribute::Named(name.to_owned()))
    }

    fn sentences(&self) -> Vec<String> {
        [&self.header.warnings[..], &self.trailer.losses, &self.trailer.warnings].concat()
    }
}

/// Reads all attributes of a file, in one block.
fn read(bytes: &[u8]) -> Result<ReadE57, String> {
    let folder = tempfile::tempdir().unwrap();
    // Real files have such names.
    let path = folder.path().join("Größe 測.e57");
    std::fs::write(&path, bytes).unwrap();
    let file = crate::open(&path, &OpenHints::default()).map_err(|error| error.to_string())?;
    let header = file.header().clone();
    let mut blocks = Vec::new();
    let mut take = |block| {
        blocks.push(block);
        Ok(())
    };
    let trailer = file
        .read(&header.schema.projection(), &mut take, &Progress::hidden())
        .map_err(|error| error.to_string())?;
    assert_eq!(blocks.len(), 1);
    let block = blocks.remove(0);
    assert_eq!(block.stats, block.clone().with_stats().stats);
    for (attribute, column) in &block.columns {
        assert_eq!(column.num_values(), Some(block.xyz.len()), "{attribute:?}");
    }
    Ok(ReadE57 { header, block, trailer })
}

/// Coordinates of point `n` that a grid of 1/1024 holds, and a float too.
fn place(n: usize) -> [f64; 3] {
    [n as f64 / 1024.0, (n % 100) as f64 - 50.0, -((n % 7) as f64)]
}

fn xyz(num: usize, stream: impl Fn(&str, Vec<f64>) -> MadeE57Stream) -> Vec<MadeE57Stream> {
    let axis = |axis: usize| (0..num).map(|n| place(n)[axis]).collect();
    attributes::CARTESIAN.iter().enumerate().map(|(number, name)| stream(name, axis(number))).collect()
}

const POSE: &str = "<pose><rotation><w>0.5</w><x>0.5</x><y>0.5</y><z>0.5</z></rotation>\
                    <translation><x>1000</x><y>-8</y><z/></translation></pose>";

/// A turn that takes x to y, y to z and z to x.
fn posed(p: DVec3) -> DVec3 {
    DVec3::new(p.z + 1000.0, p.x - 8.0, p.y)
}

/// Two scans of different streams, of more points than a part has.
fn two_scans() -> Vec<MadeE57Scan> {
    let (num_a, num_b) = (40_000, 1000);
    let mut a = xyz(num_a, doubles);
    a.push(whole("intensity", (0, 4095), 1.0, (0..num_a as i64).map(|n| n % 4000)));
    for (channel, name) in (0..).zip(attributes::COLOR) {
        a.push(whole(name, (0, 255), 1.0, (0..num_a as i64).map(|n| (n + channel) % 256)));
    }
    a.push(whole("cartesianInvalidState", (0, 2), 1.0, (0..num_a as i64).map(|n| i64::from(n % 1000 == 7))));
    a.push(whole("rowIndex", (-3, 70_000), 1.0, 0..num_a as i64));
    a.push(whole("always", (7, 7), 1.0, (0..num_a).map(|_| 7)));
    let mut b = xyz(num_b, |name, values| singles(name, values.into_iter().map(|v| v as f32)));
    for (name, value) in [("nor:normalX", 0.0), ("nor:normalY", 3.0), ("nor:normalZ", 4.0)] {
        b.push(singles(name, (0..num_b).map(|_| value)));
    }
    b.push(whole("returnIndex", (0, 3), 1.0, (0..num_b as i64).map(|n| n % 4)));
    b.push(whole("returnCount", (0, 4), 1.0, (0..num_b).map(|_| 4)));
    b.push(doubles("timeStamp", (0..num_b).map(|n| n as f64 / 8.0)));
    let start = "<acquisitionStart><dateTimeValue>1e9</dateTimeValue></acquisitionStart><name>second</name>";
    vec![
        MadeE57Scan { streams: a, ..MadeE57Scan::default() },
        MadeE57Scan { streams: b, inner: format!("{POSE}{start}"), announced: None },
    ]
}

#[test]
fn scans_become_one_cloud_each_with_its_pose_and_number() {
    let read = read(&file(&two_scans())).unwrap();
    assert_eq!(
        read.sentences(),
        ["has 40 points that are marked as invalid or have no place; they were left out"]
    );
    let kept: Vec<usize> = (0..40_000).filter(|n| n % 1000 != 7).collect();
    let expected = kept.iter().map(|&n| DVec3::from_array(place(n)));
    let expected: Vec<DVec3> =
        expected.chain((0..1000).map(|n| posed(DVec3::from_array(place(n))))).collect();
    assert_eq!(read.places(), expected);
    let of_both = |of_a: &dyn Fn(usize) -> i64, of_b: &dyn Fn(usize) -> i64| -> Vec<i64> {
        kept.iter().map(|&n| of_a(n)).chain((0..1000).map(of_b)).collect()
    };
    let same = |column: &Column, expected: Vec<i64>| {
        let mut values = Vec::new();
        column.each(0, expected.len(), |value| values.push(value.as_f64() as i64));
        assert!(values == expected, "{:?}", column.kind());
    };
    same(read.column(&Attribute::Intensity), of_both(&|n| (n % 4000) as i64, &|_| 0));
    same(read.column(&Attribute::Color), of_both(&|n| (n % 256) as i64, &|_| 0));
    same(read.named("rowIndex"), of_both(&|n| n as i64, &|_| 0));
    same(read.named("always"), of_both(&|_| 7, &|_| 0));
    same(read.column(&Attribute::SourceId), of_both(&|_| 1, &|_| 2));
    same(read.column(&Attribute::ReturnNumber), of_both(&|_| 0, &|n| (n % 4) as i64 + 1));
    same(read.column(&Attribute::NumReturns), of_both(&|_| 0, &|_| 4));
    let (Column::F64(times), Column::F32x3(normals)) =
        (read.column(&Attribute::GpsTime), read.column(&Attribute::Normal))
    else {
        panic!()
    };
    assert!(times[0].is_nan() && normals[0][0].is_nan());
    assert_eq!((times[kept.len() + 4], normals[kept.len()]), (1e9 + 0.5, [0.8, 0.0, 0.6]));
    assert_eq!((read.trailer.white, read.named("rowIndex").kind()), (Some(255), Type::I32));
    let stations = &read.header.stations;
    assert_eq!((&stations[0].name[..], stations[0].file_from_station), ("1", None));
    assert_eq!((&stations[1].name[..], stations[1].source_id), ("second", Some(2)));
    assert_eq!(stations[1].file_from_station.unwrap().position, DVec3::new(1000.0, -8.0, 0.0));
    assert_eq!((read.header.num_points, &read.header.parts[..]), (41_000, &["scans: 2".to_owned()][..]));
}

#[test]
fn packets_may_have_any_size() {
    let scans = two_scans();
    let whole = read(&file(&scans)).unwrap();
    for packet_bytes in [30, 4096, 40_000] {
        let read = read(&made::paged(&made::content(&scans, "", packet_bytes).0)).unwrap();
        assert!(read.places() == whole.places(), "{packet_bytes}");
        assert_eq!(read.named("rowIndex"), whole.named("rowIndex"));
    }
}

#[test]
fn a_grid_that_all_scans_share_is_kept() {
    let stepped = |name: &str, values: Vec<f64>, scale: f64| {
        whole(name, (-1 << 24, 1 << 24), scale, values.into_iter().map(|v| (v / scale).round() as i64))
    };
    let scan = |scale: f64, inner: &str| MadeE57Scan {
        streams: xyz(500, |name, values| stepped(name, values, scale)),
        inner: inner.into(),
        announced: None,
    };
    let shift = "<pose><translation><x>0.5</x></translation></pose>";
    let of = |scans: &[MadeE57Scan]| {
        let read = read(&file(scans)).unwrap();
        let moved = read.places().into_iter().zip((0..500).map(place));
        let most =
            moved.map(|(p, place)| (p - DVec3::from_array(place)).abs().max_element()).fold(0.0, f64::max);
        (read.block.grid, read.header.is_on_fixed_grid, most)
    };
    let (grid, is_fixed, moved) = of(&[scan(0.0001, ""), scan(0.0001, "")]);
    assert_eq!((grid.scale, grid.offset, is_fixed), (DVec3::splat(0.0001), DVec3::ZERO, true));
    assert!(moved <= 0.00005 + 1e-9);
    let (grid, is_fixed, _) = of(&[scan(0.0001, shift)]);
    assert_eq!((grid.offset, is_fixed), (DVec3::new(0.5, 0.0, 0.0), true));
    for scans in [
        [scan(0.0001, ""), scan(0.001, "")],
        [scan(0.0001, ""), scan(0.0001, shift)],
        [scan(0.0001, ""), scan(0.0001, POSE)],
    ] {
        assert!(!of(&scans).1);
    }
}

#[test]
fn colors_and_intensities_of_other_kinds_are_spread_and_kept() {
    let mut streams = xyz(3, doubles);
    for name in attributes::COLOR {
        streams.push(singles(name, [0.0, 0.5, 1.0]));
    }
    streams.push(whole("isColorInvalid", (0, 1), 1.0, [0, 0, 1]));
    streams.push(whole("intensity", (-66, 66), 1.0, [-66, 0, 66]));
    streams.push(whole("isIntensityInvalid", (0, 1), 1.0, [0; 3]));
    let limits =
        "<colorLimits><colorRedMinimum>0</colorRedMinimum><colorRedMaximum>2</colorRedMaximum></colorLimits>";
    let read = read(&file(&[MadeE57Scan { streams, inner: limits.into(), announced: None }])).unwrap();
    let Column::U16x3(rgb) = read.column(&Attribute::Color) else { panic!() };
    assert_eq!(rgb[..], [[0; 3], [16384, 32768, 32768], [0; 3]]);
    assert_eq!(read.trailer.white, Some(u16::MAX));
    assert_eq!(read.column(&Attribute::Intensity), &Column::U16(vec![0, 32768, 65535]));
    assert_eq!(read.named("intensity"), &Column::I8(vec![-66, 0, 66]));
    assert_eq!(
        read.header.schema.names(),
        ["rgb", "intensity", "point_source_id", "extra:isColorInvalid", "extra:isIntensityInvalid"]
    );
}

#[test]
fn angles_make_places_and_scaled_numbers_keep_their_scale() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let streams = vec![
        doubles("sphericalRange", [2.0, 0.0, 3.0, 4.0]),
        doubles("sphericalAzimuth", [0.0, 0.0, quarter, 0.0]),
        doubles("sphericalElevation", [0.0, 0.0, 0.0, quarter]),
        whole("x:heat", (0, 1000), 0.125, [1, 2, 3, 1000]),
        whole("sphericalInvalidState", (0, 2), 1.0, [0, 0, 0, 1]),
    ];
    let read = read(&file(&[MadeE57Scan { streams, ..MadeE57Scan::default() }])).unwrap();
    let near = |a: DVec3, b: DVec3| (a - b).length() < 1e-9;
    assert!(
        near(read.places()[0], DVec3::new(2.0, 0.0, 0.0))
            && near(read.places()[1], DVec3::new(0.0, 3.0, 0.0))
    );
    assert_eq!(read.named("x:heat"), &Column::U16(vec![1, 3]));
    let field = Field { scale: 0.125, ..Field::plain(Attribute::Named("x:heat".into()), Type::U16) };
    assert!(read.header.schema.fields.contains(&field));
    assert_eq!(
        read.trailer.warnings,
        ["has 2 points that are marked as invalid or have no place; they were left out"]
    );
}

#[test]
fn the_file_says_what_system_it_is_in_and_who_made_it_when() {
    let scan = MadeE57Scan { streams: xyz(2, doubles), ..MadeE57Scan::default() };
    let outer = "<coordinateMetadata>EPSGCODE</coordinateMetadata><e57LibraryVersion>\"made 1\"</e57LibraryVersion>\
                 <creationDateTime><dateTimeValue type=\"Float\">9.9643846577999532e+008</dateTimeValue></creationDateTime>\
                 <images2D><i><pose><translation><z>3</z></translation></pose><pinholeRepresentation/></i><i/></images2D>";
    let wkt = "PROJCS[&quot;WGS 84 / UTM zone 10N&quot;,UNIT[&quot;metre&quot;,1],AUTHORITY[&quot;EPSG&quot;,&quot;32610&quot;]]";
    let read = read(&made::paged(&made::content(&[scan], &outer.replace("EPSGCODE", wkt), 900).0)).unwrap();
    let Header { crs, unit_m, software, created, stations, parts, .. } = read.header;
    assert_eq!(crs.as_deref(), Some("EPSG:32610, WGS 84 / UTM zone 10N"));
    assert_eq!(
        (unit_m, software.as_deref(), created.as_deref()),
        (Some(1.0), Some("made 1"), Some("2011-08-03"))
    );
    assert_eq!(parts, ["scans: 1", "images: 2"]);
    assert_eq!((stations.len(), stations[1].kind, &stations[1].name[..]), (2, StationKind::Camera, "1"));
    let pose = base::space::Pose { position: DVec3::new(0.0, 0.0, 3.0), orientation: DQuat::IDENTITY };
    assert_eq!(stations[1].file_from_station, Some(pose));
}

#[test]
fn days_are_those_of_the_calendar() {
    let days = [
        (0.0, "1980-01-06"),
        (636_076_800.0, "2000-03-03"),
        (635_472_000.0, "2000-02-25"),
        (1_388_016_000.0, "2023-12-31"),
    ];
    for (seconds, expected) in days {
        assert_eq!(day(seconds).as_deref(), Some(expected));
    }
    assert_eq!(day(635_472_000.0 + 4.0 * 86_400.0).as_deref(), Some("2000-02-29"));
    assert_eq!([day(-1e9), day(1e300), day(f64::NAN)].map(|day| day.is_some()), [false, false, true]);
}

//! Tests of PCD files that are made here.

use super::*;
use crate::{Attribute, Block, Column, Points, ReadOptions, ScanFile};
use base::task::CancelToken;
use proptest::prelude::*;

/// How data are stored, by the words of the format.
const ENCODINGS: [&str; 3] = ["ascii", "binary", "binary_compressed"];

/// A field of a made-up file: name, size, type, count, and the values of all points as text.
type MadeField = (&'static str, usize, char, usize, fn(usize, usize) -> String);

/// Fields of every kind; point 3 has no place.
const FIELDS: [MadeField; 11] = [
    ("x", 4, 'F', 1, |n, _| if n == 3 { "nan".into() } else { format!("{}", n as f32 * 0.25) }),
    ("_", 1, 'U', 4, |_, _| "0".into()),
    ("Y", 8, 'F', 1, |n, _| format!("{}", 4_000_000.125 + n as f64)),
    ("z", 2, 'I', 1, |n, _| format!("{}", 7 - n as i64)),
    ("rgb", 4, 'U', 1, |n, _| format!("{}", 0xff00_0000 | (n as u32).wrapping_mul(0x01_0203) & 0xff_ffff)),
    ("intensity", 4, 'F', 1, |n, _| format!("{}", n as f32 * 0.5 - 1.0)),
    ("normal_x", 4, 'F', 1, |_, _| "0".into()),
    ("normal_y", 4, 'F', 1, |_, _| "-3".into()),
    ("normal_z", 4, 'F', 1, |_, _| "4".into()),
    ("label", 4, 'U', 1, |n, _| format!("{}", 4_000_000_000u32 + n as u32)),
    ("stamps", 8, 'U', 2, |n, k| format!("{}", u64::MAX - (2 * n + k) as u64)),
];

fn bytes_of(size: usize, kind: char, text: &str) -> Vec<u8> {
    match (kind, size) {
        ('F', 4) => text.parse::<f32>().unwrap().to_le_bytes().to_vec(),
        ('F', _) => text.parse::<f64>().unwrap().to_le_bytes().to_vec(),
        ('U', _) => text.parse::<u64>().unwrap().to_le_bytes()[..size].to_vec(),
        _ => text.parse::<i64>().unwrap().to_le_bytes()[..size].to_vec(),
    }
}

/// The body of a file of `num` points.
fn body(encoding: &str, fields: &[MadeField], num: usize) -> Vec<u8> {
    let values = |(_, size, kind, count, of): &MadeField, point: usize| {
        (0..*count).flat_map(|k| bytes_of(*size, *kind, &of(point, k))).collect::<Vec<u8>>()
    };
    match encoding {
        "ascii" => {
            let row = |point: usize| {
                let words = fields.iter().flat_map(|field| (0..field.3).map(|k| (field.4)(point, k)));
                words.collect::<Vec<String>>().join(" ") + "\n"
            };
            (0..num).map(row).collect::<String>().into_bytes()
        }
        "binary" => (0..num).flat_map(|n| fields.iter().flat_map(move |field| values(field, n))).collect(),
        _ => {
            let columns = fields.iter().flat_map(|field| (0..num).flat_map(move |n| values(field, n)));
            let bytes: Vec<u8> = columns.collect();
            let packed = lzf::tests::compress(&bytes);
            let sizes = [packed.len() as u32, bytes.len() as u32].map(u32::to_le_bytes).concat();
            [sizes, packed, vec![0; 100]].concat()
        }
    }
}

fn header(encoding: &str, fields: &[MadeField], more: &str) -> String {
    let line = |word: &str, of: fn(&MadeField) -> String| {
        format!("{word} {}\n", fields.iter().map(of).collect::<Vec<String>>().join(" "))
    };
    let lines = [
        line("FIELDS", |field| field.0.into()),
        line("SIZE", |field| field.1.to_string()),
        line("TYPE", |field| field.2.to_string()),
        line("COUNT", |field| field.3.to_string()),
    ];
    format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n{}{more}DATA {encoding}\n",
        lines.concat()
    )
}

fn made(encoding: &str, num: usize) -> Vec<u8> {
    let more = format!("WIDTH {num}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {num}\n");
    [header(encoding, &FIELDS, &more).into_bytes(), body(encoding, &FIELDS, num)].concat()
}

fn opened(bytes: &[u8]) -> Result<(tempfile::TempDir, Box<dyn Dataset>), ScanError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("made.pcd");
    std::fs::write(&path, bytes).unwrap();
    let dataset = crate::open(&path, &OpenHints::default())?;
    Ok((folder, dataset))
}

fn blocks(bytes: &[u8], block_points: usize) -> Result<(Vec<Block>, Trailer, Header), ScanError> {
    let (_folder, dataset) = opened(bytes)?;
    let want = dataset.header().schema.projection().in_blocks_of(block_points);
    let mut blocks = Vec::new();
    let mut take = |block| {
        blocks.push(block);
        Ok(())
    };
    let trailer = dataset.read(&want, &mut take, &Progress::hidden())?;
    Ok((blocks, trailer, dataset.header().clone()))
}

fn scan(bytes: &[u8]) -> Result<(ScanFile, Vec<String>), ScanError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("made.pcd");
    std::fs::write(&path, bytes).unwrap();
    let mut scan = crate::read(&[path], &ReadOptions::AS_FILES_SAY, &CancelToken::default())?;
    Ok((scan.files.remove(0), scan.warnings))
}

#[test]
fn all_encodings_hold_the_same_points() {
    for encoding in ENCODINGS {
        let (blocks, trailer, header) = blocks(&made(encoding, 1000), usize::MAX).unwrap();
        let block = &blocks[0];
        assert_eq!((blocks.len(), block.xyz.len(), header.num_points), (1, 999, 1000), "{encoding}");
        assert_eq!(trailer.warnings, ["has 1 point without a finite place; it was left out"]);
        assert_eq!((trailer.white, &trailer.losses[..]), (Some(255), &[][..]));
        let named = |name: &str| block.column(&Attribute::Named(name.into())).unwrap();
        for (at, n) in (0..1000).filter(|n| *n != 3).enumerate() {
            let p = block.grid.p_in_world(block.xyz[at]);
            assert_eq!(p.to_array(), [0.25 * n as f64, 4_000_000.125 + n as f64, 7.0 - n as f64]);
            let Some(Column::U16x3(rgb)) = block.column(&Attribute::Color) else { panic!("{block:?}") };
            let bits = (n as u32).wrapping_mul(0x01_0203) & 0xff_ffff;
            assert_eq!(rgb[at].map(u32::from), [bits >> 16, bits >> 8 & 255, bits & 255]);
            let Some(Column::F32x3(normals)) = block.column(&Attribute::Normal) else { panic!("{block:?}") };
            assert_eq!(normals[at], [0.0, -0.6, 0.8]);
            let Some(Column::U16(intensity)) = block.column(&Attribute::Intensity) else { panic!() };
            assert_eq!(intensity[at], (n as f64 / 999.0 * 65535.0).round() as u16);
            let Column::U32(labels) = named("label") else { panic!("{block:?}") };
            assert_eq!(labels[at], 4_000_000_000 + n as u32);
            let Column::U64(stamps) = named("stamps_1") else { panic!("{block:?}") };
            assert_eq!(stamps[at], u64::MAX - 2 * n as u64 - 1);
            match named("intensity") {
                Column::F32(raw) => assert_eq!(raw[at], n as f32 * 0.5 - 1.0),
                Column::F64(raw) => assert_eq!(raw[at], n as f64 * 0.5 - 1.0),
                other => panic!("{other:?}"),
            }
        }
        assert_eq!(
            header.attributes(),
            ["rgb", "intensity", "normals", "extra:label", "extra:stamps_0", "extra:stamps_1"]
        );
        assert!(header.stations.is_empty());
    }
}

#[test]
fn blocks_are_as_small_as_asked_for() {
    for encoding in ["ascii", "binary"] {
        let (all, ..) = blocks(&made(encoding, 70_000), usize::MAX).unwrap();
        let (some, ..) = blocks(&made(encoding, 70_000), 1000).unwrap();
        assert!(some.len() >= 2 && all.len() == 1, "{encoding} {}", some.len());
        let xyz: Vec<[i32; 3]> = some.iter().flat_map(|block| block.xyz.iter().copied()).collect();
        assert_eq!(all[0].xyz, xyz);
    }
}

#[test]
fn colors_are_packed_in_floats_or_stand_apart() {
    let place: [MadeField; 3] = [
        ("x", 4, 'F', 1, |n, _| n.to_string()),
        ("y", 4, 'F', 1, |n, _| n.to_string()),
        ("z", 4, 'F', 1, |_, _| "0".into()),
    ];
    let rgb = |fields: &[MadeField]| {
        let fields = [&place[..], fields].concat();
        ENCODINGS.map(|encoding| {
            let file =
                [header(encoding, &fields, "POINTS 2\n").into_bytes(), body(encoding, &fields, 2)].concat();
            let (blocks, ..) = blocks(&file, usize::MAX).unwrap();
            match blocks[0].column(&Attribute::Color) {
                Some(Column::U16x3(rgb)) => rgb[1],
                other => panic!("{other:?}"),
            }
        })
    };
    // As a float, 0x00ff8040 is a subnormal number.
    let packed: MadeField = ("rgb", 4, 'F', 1, |_, _| format!("{:e}", f32::from_bits(0xff_8040)));
    assert_eq!(rgb(&[packed]), [[255, 128, 64]; 3]);
    let alpha: MadeField = ("rgba", 4, 'U', 1, |_, _| 0x80ff_8040u32.to_string());
    assert_eq!(rgb(&[alpha]), [[255, 128, 64]; 3]);
    let three: [MadeField; 3] = [
        ("Red", 1, 'U', 1, |_, _| "255".into()),
        ("Green", 1, 'U', 1, |_, _| "128".into()),
        ("Blue", 1, 'U', 1, |_, _| "64".into()),
    ];
    assert_eq!(rgb(&three), [[255, 128, 64]; 3]);
    let floats: [MadeField; 3] = [
        ("r", 4, 'F', 1, |_, _| "1".into()),
        ("g", 4, 'F', 1, |n, _| format!("{}", 0.5 * n as f32)),
        ("b", 4, 'F', 1, |_, _| "0.25".into()),
    ];
    assert_eq!(rgb(&floats), [[65535, 32768, 16384]; 3]);
}

fn pose_of(viewpoint: &str) -> Option<base::space::Pose> {
    let more = format!("WIDTH 1\nHEIGHT 1\nVIEWPOINT {viewpoint}\nPOINTS 1\n");
    let file = [header("binary", &FIELDS, &more).into_bytes(), body("binary", &FIELDS, 1)].concat();
    let (_folder, dataset) = opened(&file).unwrap();
    dataset.header().stations.first().and_then(|station| station.file_from_station)
}

#[test]
fn a_viewpoint_is_a_station_and_moves_no_point() {
    assert_eq!(pose_of("0 0 0 1 0 0 0"), None);
    assert_eq!(pose_of("0 0 0 0 0 0 0"), None);
    assert_eq!(pose_of("1 2 3"), None);
    assert_eq!(pose_of("1 nan 3 1 0 0 0"), None);
    let turned = pose_of("0 0 0 0 1 0 0").unwrap();
    assert!((turned.orientation * glam::DVec3::Y - glam::DVec3::NEG_Y).length() < 1e-9);
    assert_eq!(pose_of("1 2 3 1 0 0 0").unwrap().position, glam::DVec3::new(1.0, 2.0, 3.0));
}

#[test]
fn headers_of_all_versions_are_read() {
    let format = |text: &str| {
        opened(text.as_bytes()).map(|(_folder, dataset)| {
            let header = dataset.header();
            (header.format.clone(), header.num_points, header.parts.clone(), header.warnings.len())
        })
    };
    let rows = "0 0 0\r\n1 1 1\r\n2 2 2\r\n3 3 3\r\n";
    let old = format!(
        "# .PCD v.5 - Point Cloud Data file format\r\nVERSION .5\r\nCOLUMNS x y z\r\nPOINTS 4\r\nDATA ascii\r\n{rows}"
    );
    assert_eq!(format(&old).unwrap(), ("PCD 0.5, ascii".into(), 4, vec![], 0));
    let sized = "VERSION 0.6\nFIELDS X Y Z\nSIZE 4 4 4\nTYPE F F F\n";
    let organized = format!("{sized}WIDTH 2\nHEIGHT 2\nPOINTS 4\nDATA ascii\n{rows}");
    assert_eq!(
        format(&organized).unwrap(),
        ("PCD 0.6, ascii".into(), 4, vec!["rows: 2 of 2 points".into()], 0)
    );
    let lying = format!("{sized}WIDTH 2\nHEIGHT 2\nPOINTS 9\nDATA ascii\n{rows}");
    assert_eq!(format(&lying).unwrap().3, 1);
    for (text, words) in [
        (format!("{sized}WIDTH 4\n"), "ends at byte"),
        (format!("{sized}DATA zipped\n{rows}"), "line 5: says that the data are \"zipped\""),
        ("VERSION .7\nDATA ascii\n1 2 3\n".into(), "no line FIELDS"),
        ("VERSION .7\nFIELDS a b c\nDATA ascii\n1 2 3\n".into(), "export it with x, y and z"),
        ("VERSION .7\nNONSENSE a b c\nDATA ascii\n1 2 3\n".into(), "begins with \"nonsense\""),
        (format!("{sized}COUNT 1 1 99999999999\nDATA binary\n"), "makes no sense"),
        ("VERSION .7\nFIELDS x y z\nSIZE 4 4\nDATA binary\n1 2 3\n".into(), "3 fields have 2 sizes"),
        (format!("{sized}POINTS 9\nDATA binary\n1"), "the file ends at byte"),
        (format!("{sized}POINTS 0\nDATA binary\n"), "its header announces none"),
    ] {
        let error = blocks(text.as_bytes(), usize::MAX).map(|(.., header)| header).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn headers_that_lie_cost_nothing_and_are_told() {
    for encoding in ENCODINGS {
        for num in ["18446744073709551615", "4000000000", "12"] {
            let more = format!("WIDTH {num}\nHEIGHT 1\nPOINTS {num}\n");
            let file = [header(encoding, &FIELDS, &more).into_bytes(), body(encoding, &FIELDS, 10)].concat();
            let (blocks, trailer, _) = blocks(&file, usize::MAX).unwrap();
            assert_eq!(blocks[0].xyz.len(), 9, "{encoding} {num}");
            let loss = trailer.losses.first().cloned().unwrap_or_default();
            let is_told = loss.contains("but only 10 could be read") || num == "18446744073709551615";
            assert!(is_told, "{encoding} {num} {loss}");
        }
    }
    let more = "WIDTH 5\nHEIGHT 1\nPOINTS 5\n";
    let file = [header("ascii", &FIELDS, more).into_bytes(), body("ascii", &FIELDS, 10)].concat();
    let (blocks, trailer, _) = blocks(&file, usize::MAX).unwrap();
    assert_eq!(
        (blocks[0].xyz.len(), &trailer.warnings[0][..]),
        (9, "announces 5 points and has 10: all are read")
    );
}

#[test]
fn what_was_cut_off_is_read_as_far_as_it_goes() {
    for encoding in ENCODINGS {
        let file = made(encoding, 640);
        let start = header(encoding, &FIELDS, "").len() + 60;
        let mut last = 0;
        for part in 1..16 {
            let cut = start + (file.len() - start) * part / 16;
            let read = blocks(&file[..cut], usize::MAX);
            let num = read.as_ref().map_or(0, |(blocks, ..)| blocks[0].xyz.len());
            assert!(num >= last, "{encoding} {part}: {num} after {last}");
            if let Ok((.., trailer, _)) = &read {
                assert!(!trailer.losses.is_empty(), "{encoding} {part}");
            }
            last = num;
        }
        assert!(last > 500, "{encoding}: {last}");
    }
}

#[test]
fn damage_is_survived() {
    for encoding in ENCODINGS {
        let file = made(encoding, 200);
        let mut random = 12345u64;
        for _ in 0..400 {
            let mut damaged = file.clone();
            for _ in 0..3 {
                random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                let at = (random >> 33) as usize % damaged.len();
                damaged[at] = (random >> 20) as u8;
            }
            if let Ok((blocks, ..)) = blocks(&damaged, usize::MAX) {
                assert!(!blocks[0].xyz.is_empty());
            }
        }
    }
}

#[test]
fn the_first_line_tells_the_format() {
    let is_pcd = |name: &str, head: &str| {
        Pcd.probe(&Candidate { path: Path::new(name), is_folder: false, head: head.as_bytes() })
    };
    for yes in ["# .PCD v0.7\n", "#.pcd v.5\n", "VERSION 0.7\nFIELDS", "VERSION .7\n", "FIELDS x y z rgb\n"] {
        assert!(is_pcd("a", yes), "{yes}");
    }
    assert!(is_pcd("a.pcd", "# made by hand\nFIELDS x y z\n"));
    for no in ["", "# PCD is a format\n", "version of a scan\n", "VERSION abc\n", "ply\n"] {
        assert!(!is_pcd("a.pcd", no), "{no}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn places_of_any_size_are_exact(xyz in proptest::collection::vec((-1000f32..1000.0, -1000f32..1000.0, 500f32..1000.0), 1..50)) {
        let rows: Vec<u8> = xyz.iter().flat_map(|(x, y, z)| [*x, *y, *z].map(f32::to_le_bytes).concat()).collect();
        let text = format!("FIELDS x y z rgb\nSIZE 4 4 4 0\nTYPE F F F F\nPOINTS {}\nDATA binary\n", xyz.len());
        let (file, _) = scan(&[text.into_bytes(), rows].concat()).unwrap();
        let Points { xyz: steps, .. } = &file.points;
        for (step, (x, y, z)) in steps.iter().zip(&xyz) {
            let p = file.in_file.grid.p_in_world(*step);
            prop_assert!((p - glam::DVec3::new((*x).into(), (*y).into(), (*z).into())).abs().max_element() < 1e-6);
        }
    }
}

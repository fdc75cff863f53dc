//! Small made-up scans, whole and broken, and what is read of them.

use crate::block::{Block, Trailer};
use crate::column::Column;
use crate::{Attribute, OpenHints, Projection, ScanError, open};
use base::random::Rng;
use base::task::Progress;
use ruzstd::encoding::{CompressionLevel, compress_to_vec};
use std::io::Read as _;
use std::path::Path;
use tempfile::TempDir;

/// A schema whose coordinates do not come first: 19 bytes.
const SCHEMA: &str = r#"[{"name":"Intensity","type":"unsigned","size":2},
    {"name":"Z","type":"signed","size":4,"scale":0.01,"offset":100},
    {"name":"Classification","type":"unsigned","size":1},
    {"name":"X","type":"signed","size":4,"scale":0.01},{"name":"Y","type":"signed","size":4,"scale":0.01},
    {"name":"Heat","type":"signed","size":4,"scale":0.5,"offset":-20}]"#;

/// The record of a point whose x is this number of steps.
fn record(x: i32) -> Vec<u8> {
    let mut bytes = (x as u16).to_le_bytes().to_vec();
    bytes.extend((x / 2).to_le_bytes());
    bytes.push(if x % 5 == 0 { 7 } else { 2 });
    bytes.extend(x.to_le_bytes());
    bytes.extend((-x).to_le_bytes());
    bytes.extend((3 * x).to_le_bytes());
    bytes
}

fn records(xs: impl IntoIterator<Item = i32>) -> Vec<u8> {
    xs.into_iter().flat_map(record).collect()
}

/// EptFiles of a scan: names and bytes.
type EptFiles = Vec<(String, Vec<u8>)>;

/// A scan of these nodes: their keys, announced points and bytes.
fn scan(packing: &str, schema: &str, nodes: &[(&str, i64, Vec<u8>)]) -> EptFiles {
    let info = format!(
        r#"{{"version":"1.1.0","dataType":"{packing}","points":100,"bounds":[-64,-64,64,64,64,192],"span":128,
           "schema":{schema},"srs":{{}}}}"#
    );
    let counts: Vec<String> = nodes.iter().map(|(key, count, _)| format!("\"{key}\": {count}")).collect();
    let mut files = vec![
        ("ept.json".to_owned(), info.into_bytes()),
        ("ept-hierarchy/0-0-0-0.json".to_owned(), format!("{{{}}}", counts.join(", ")).into_bytes()),
    ];
    let ending = if packing == "binary" { "bin" } else { "zst" };
    for (key, _, bytes) in nodes {
        let bytes = match packing {
            "zstandard" => compress_to_vec(&bytes[..], CompressionLevel::Fastest),
            _ => bytes.clone(),
        };
        files.push((format!("ept-data/{key}.{ending}"), bytes));
    }
    files
}

fn save(files: &EptFiles) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for part in ["ept-data", "ept-hierarchy"] {
        std::fs::create_dir(folder.path().join(part)).unwrap();
    }
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    folder
}

type ReadEpt = Result<(Vec<Block>, Trailer), ScanError>;

fn read_path(path: &Path, block_points: usize) -> ReadEpt {
    let dataset = open(path, &OpenHints::default())?;
    let want = dataset.header().schema.projection().in_blocks_of(block_points);
    let mut blocks = Vec::new();
    let mut take = |block| {
        blocks.push(block);
        Ok(())
    };
    let end = dataset.read(&want, &mut take, &Progress::hidden())?;
    Ok((blocks, end))
}

fn read(files: &EptFiles) -> ReadEpt {
    read_path(save(files).path(), usize::MAX)
}

/// The x of all points in steps.
fn xs(blocks: &[Block]) -> Vec<i32> {
    blocks.iter().flat_map(|block| block.xyz.iter().map(|xyz| xyz[0])).collect()
}

fn nodes() -> [(&'static str, i64, Vec<u8>); 3] {
    [("1-1-0-0", 20, records(40..60)), ("0-0-0-0", 40, records(0..40)), ("2-0-0-0", 40, records(60..100))]
}

#[test]
fn nodes_come_breadth_first_with_all_attributes() {
    for packing in ["binary", "zstandard"] {
        let folder = save(&scan(packing, SCHEMA, &nodes()));
        for path in [folder.path().to_owned(), folder.path().join("ept.json")] {
            let (blocks, end) = read_path(&path, usize::MAX).unwrap();
            assert_eq!((blocks.len(), xs(&blocks)), (1, (0..100).collect()), "{packing}");
            assert!(end.losses.is_empty() && end.warnings.is_empty(), "{end:?}");
            let block = &blocks[0];
            assert_eq!(block.grid.p_in_world(block.xyz[99]).to_array(), [0.99, -0.99, 100.49]);
            let intensity = Column::U16((0..100).collect());
            assert_eq!(block.column(&Attribute::Intensity), Some(&intensity));
            let heat = Column::I32((0..100).map(|x| 3 * x).collect());
            assert_eq!(block.column(&Attribute::Named("Heat".into())), Some(&heat));
            let Some(Column::Bool(noise)) = block.column(&Attribute::Noise) else { panic!("no noise") };
            assert_eq!((noise.count(), noise.get(95)), (20, true));
            assert_eq!((block.stats.xyz_max[0], block.stats.intensity_max), (99, 99));
            let dataset = open(&path, &OpenHints::default()).unwrap();
            let header = dataset.header();
            assert_eq!((header.format.as_str(), header.num_points), (&*format!("EPT 1.1.0, {packing}"), 100));
            let field = header.schema.field(&Attribute::Named("Heat".into())).unwrap();
            assert_eq!((field.scale, field.offset, header.is_on_fixed_grid), (0.5, -20.0, true));
            // Blocks hold as many nodes as they may.
            let sizes = |most| -> Vec<usize> {
                read_path(&path, most).unwrap().0.iter().map(|block| block.xyz.len()).collect()
            };
            assert_eq!((sizes(60), sizes(30)), (vec![60, 40], vec![40, 20, 40]));
        }
    }
}

#[test]
fn no_count_is_believed() {
    let mut nodes = nodes();
    (nodes[0].1, nodes[1].1) = (3, 1_000_000_000_000);
    let (blocks, end) = read(&scan("binary", SCHEMA, &nodes)).unwrap();
    assert_eq!(xs(&blocks).len(), 100);
    assert_eq!(end.losses, ["node 0-0-0-0 has 40 of 1000000000000 points"]);
    assert!(end.warnings[0].contains("1 node with another number of points"), "{end:?}");
    assert!(end.warnings[0].contains("(1-1-0-0)"), "{end:?}");
    nodes[1].1 = 40;
    let (_, end) = read(&scan("zstandard", SCHEMA, &nodes[..2])).unwrap();
    assert!(end.losses.is_empty() && end.warnings[1] == "announces 100 points, but holds 60; all were read");
}

#[test]
fn a_node_that_the_schema_does_not_describe_is_left_out() {
    // The root's records have six bytes more than the schema says.
    let longer =
        |xs: std::ops::Range<i32>| -> Vec<u8> { xs.flat_map(|x| [record(x), vec![9; 6]].concat()).collect() };
    let mut nodes = nodes();
    for (count, expected) in [(40, "1000 bytes for 40 points"), (38, "950 bytes for 38 points")] {
        // 38 · 25 bytes are 50 · 19 bytes.
        (nodes[1].1, nodes[1].2) = (count, longer(0..count as i32));
        let (blocks, end) = read(&scan("binary", SCHEMA, &nodes)).unwrap();
        assert_eq!(xs(&blocks), (40..100).collect::<Vec<_>>());
        assert!(end.losses[0].starts_with(&format!("node 0-0-0-0 has {expected}")), "{end:?}");
    }
    let error = read(&scan("binary", SCHEMA, &nodes[1..2])).unwrap_err().to_string();
    assert!(error.contains("none could be read") && error.contains("950 bytes"), "{error}");
}

#[test]
fn nodes_that_are_missing_or_damaged_lose_only_themselves() {
    let mut files = scan("zstandard", SCHEMA, &nodes());
    files.pop();
    let (blocks, end) = read(&files).unwrap();
    assert_eq!(xs(&blocks), (0..60).collect::<Vec<_>>());
    assert_eq!(end.losses, ["has 1 node whose file is missing (2-0-0-0)"]);
    files[2].1 = b"<html>not found</html>".to_vec();
    let (blocks, end) = read(&files).unwrap();
    assert_eq!(xs(&blocks), (0..40).collect::<Vec<_>>());
    assert!(end.losses[1].starts_with("node 1-1-0-0 is damaged"), "{end:?}");
    // A node of no points needs no file.
    let mut files = scan("binary", SCHEMA, &[("0-0-0-0", 5, records(0..5)), ("1-0-0-0", 0, vec![])]);
    files.pop();
    assert!(read(&files).unwrap().1.losses.is_empty());
}

#[test]
fn a_node_does_not_unfold_without_end() {
    let mut files = scan("zstandard", SCHEMA, &[("0-0-0-0", 2, records(0..2))]);
    files[2].1 = compress_to_vec(std::io::repeat(0).take(1 << 26), CompressionLevel::Fastest);
    let error = read(&files).unwrap_err().to_string();
    assert!(error.contains("unpacks to more than"), "{error}");
}

#[test]
fn floats_and_long_integers_go_on_grids_that_hold_them() {
    let schema = |kind: &str, scale: &str| {
        let dim = |name| format!(r#"{{"name":"{name}","type":"{kind}","size":8{scale}}}"#);
        format!(
            "[{},{},{},{{\"name\":\"Intensity\",\"type\":\"float\",\"size\":4}}]",
            dim("X"),
            dim("Y"),
            dim("Z")
        )
    };
    let floats = |values: &[[f64; 3]]| -> Vec<u8> {
        let record = |p: &[f64; 3]| {
            let mut bytes: Vec<u8> = p.iter().flat_map(|v| v.to_le_bytes()).collect();
            bytes.extend(((p[0] - 5e6) as f32).to_le_bytes());
            bytes
        };
        values.iter().flat_map(record).collect()
    };
    let places: Vec<[f64; 3]> = (0..50).map(|i| [5e6 + f64::from(i) / 7.0, f64::from(i), 0.1]).collect();
    let (root, child) = (floats(&places[..20]), floats(&[&places[20..], &[[f64::NAN; 3]][..]].concat()));
    let files = scan("binary", &schema("float", ""), &[("0-0-0-0", 20, root), ("1-0-0-0", 31, child)]);
    let (blocks, end) = read(&files).unwrap();
    assert_eq!(blocks[0].xyz.len(), 50);
    for (xyz, place) in blocks[0].xyz.iter().zip(&places) {
        let moved = (blocks[0].grid.p_in_world(*xyz) - glam::DVec3::from_array(*place)).abs();
        assert!(moved.max_element() < 1e-8, "{moved}");
    }
    assert!(end.warnings[0].contains("1 point without a place"), "{end:?}");
    // Intensities are spread, and are there as they are, too.
    let Some(Column::U16(intensity)) = blocks[0].column(&Attribute::Intensity) else {
        panic!("no intensity")
    };
    assert_eq!((intensity[0], intensity[49]), (0, 65535));
    let raw = blocks[0].column(&Attribute::Named("Intensity".into())).unwrap();
    assert!(matches!(raw, Column::F32(values) if values[7] == 1.0));
    // Steps beyond 32 bits stay steps.
    let long = |value: i64| -> Vec<u8> {
        let mut bytes: Vec<u8> = [value, 7, -value].iter().flat_map(|v| v.to_le_bytes()).collect();
        bytes.extend(1f32.to_le_bytes());
        bytes
    };
    let records = [long(9_000_000_000_000), long(9_000_000_000_123)].concat();
    let files = scan("binary", &schema("signed", r#","scale":0.001"#), &[("0-0-0-0", 2, records)]);
    let (blocks, _) = read(&files).unwrap();
    let Block { grid, xyz, .. } = &blocks[0];
    assert_eq!((grid.scale.x, xyz[1][0] - xyz[0][0], xyz[0][2] - xyz[1][2]), (0.001, 123, 123));
    assert!((grid.p_in_world(xyz[0]).x - 9e9).abs() < 1e-5);
}

#[test]
fn reading_stops_when_asked() {
    let folder = save(&scan("binary", SCHEMA, &nodes()));
    let cancel = base::task::CancelToken::default();
    cancel.cancel();
    let dataset = open(folder.path(), &OpenHints::default()).unwrap();
    let want = Projection::of([]);
    let error = dataset.read(&want, &mut |_| Ok(()), &Progress::silent(&cancel)).unwrap_err();
    assert!(matches!(error, ScanError::Cancelled(_)), "{error}");
}

#[test]
fn broken_files_never_panic() {
    let mut random = Rng::new(7, 0);
    let mut below = |end: u64| random.bits() % end;
    for packing in ["binary", "zstandard"] {
        let whole = scan(packing, SCHEMA, &nodes());
        for number in 0..whole.len() {
            for sixteenth in 0..16 {
                let mut files = whole.clone();
                let len = files[number].1.len() * sixteenth / 16;
                files[number].1.truncate(len);
                if let Ok((blocks, end)) = read(&files) {
                    let is_less = xs(&blocks).len() < 100;
                    assert!(!is_less || !end.losses.is_empty() || !end.warnings.is_empty(), "{number} {len}");
                }
            }
        }
        for _ in 0..300 {
            let mut files = whole.clone();
            let number = below(files.len() as u64) as usize;
            let bytes = &mut files[number].1;
            for _ in 0..1 + below(3) {
                let at = below(bytes.len() as u64) as usize;
                bytes[at] ^= 1 << below(8);
            }
            let _ = read(&files);
        }
    }
}

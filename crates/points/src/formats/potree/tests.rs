//! Whole scans that are written here, read back: all encodings, and what is left of scans that are damaged.

use super::unfold::fold;
use super::{Potree, morton};
use crate::block::Trailer;
use crate::formats::{self, Format, OpenHints};
use crate::{Attribute, Block, Column, Grid, ScanError};
use base::task::Progress;
use glam::DVec3;
use serde_json::{Value, json};
use std::path::Path;
use tempfile::TempDir;

/// Points of a node: places as they are stored, colors and classes.
type MadeNode = Vec<([i32; 3], [u16; 3], u8)>;

/// Writes a scan of Potree 2 of a root with some children; returns its folder.
fn octree(encoding: &str, nodes: &[MadeNode]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let (mut octree, mut hierarchy) = (Vec::new(), Vec::new());
    let children = (1..nodes.len()).map(|at| 1u8 << (at - 1)).sum::<u8>();
    for (at, points) in nodes.iter().enumerate() {
        let bytes = match encoding {
            "BROTLI" => fold(&arrays(points)),
            _ => points.iter().flat_map(record).collect(),
        };
        hierarchy.extend([u8::from(at > 0), if at == 0 { children } else { 0 }]);
        hierarchy.extend((points.len() as u32).to_le_bytes());
        hierarchy.extend((octree.len() as u64).to_le_bytes());
        hierarchy.extend((bytes.len() as u64).to_le_bytes());
        octree.extend(bytes);
    }
    let metadata = json!({
        "version": "2.0", "name": "a", "points": nodes.iter().map(Vec::len).sum::<usize>(), "projection": "EPSG:32633",
        "hierarchy": {"firstChunkSize": hierarchy.len(), "stepSize": 4, "depth": 9},
        "offset": [100.0, 200.0, 0.5], "scale": [0.01, 0.01, 0.001], "spacing": 1.0,
        "boundingBox": {"min": [100.0, 200.0, 0.5], "max": [108.0, 208.0, 8.5]}, "encoding": encoding,
        "attributes": [
            {"name": "position", "size": 12, "numElements": 3, "elementSize": 4, "type": "int32", "min": "INF"},
            {"name": "rgb", "size": 6, "numElements": 3, "elementSize": 2, "type": "uint16"},
            {"name": "classification", "size": 1, "numElements": 1, "elementSize": 1, "type": "uint8"},
        ],
    });
    // The real converter writes infinite numbers of attributes that no point has.
    let metadata = metadata.to_string().replace("\"INF\"", "[inf, -inf, nan]");
    std::fs::write(folder.path().join("metadata.json"), metadata).unwrap();
    std::fs::write(folder.path().join("hierarchy.bin"), hierarchy).unwrap();
    std::fs::write(folder.path().join("octree.bin"), octree).unwrap();
    folder
}

fn record((xyz, rgb, class): &([i32; 3], [u16; 3], u8)) -> Vec<u8> {
    let rgb = rgb.iter().flat_map(|c| c.to_le_bytes());
    xyz.iter().flat_map(|c| c.to_le_bytes()).chain(rgb).chain([*class]).collect()
}

fn arrays(points: &MadeNode) -> Vec<u8> {
    let mut bytes: Vec<u8> = points.iter().flat_map(|point| morton::position_bytes(point.0)).collect();
    bytes.extend(points.iter().flat_map(|point| morton::code(point.1.map(u32::from)).to_le_bytes()));
    bytes.extend(points.iter().map(|point| point.2));
    bytes
}

fn nodes() -> Vec<MadeNode> {
    let point = |at: i32| ([at * 3, 7 * at, at * at % 800], [(at * 977) as u16; 3], (at % 9) as u8);
    [0..40, 40..55, 55..55, 55..90, 90..91].map(|range| range.map(point).collect()).to_vec()
}

/// All that is read of a scan, as one block.
fn read(path: &Path, block_points: usize) -> Result<(Block, Trailer), ScanError> {
    let dataset = formats::open(path, &OpenHints::default())?;
    let want = dataset.header().schema.projection().in_blocks_of(block_points);
    let mut all: Option<Block> = None;
    let mut take = |block: Block| {
        assert!(!block.xyz.is_empty());
        all = Some(match all.take() {
            Some(before) => super::nodes::joined(before, block),
            None => block,
        });
        Ok(())
    };
    let trailer = dataset.read(&want, &mut take, &Progress::hidden())?;
    Ok((all.expect("a block at least"), trailer))
}

#[test]
fn all_encodings_give_the_same_points() {
    for encoding in ["DEFAULT", "UNCOMPRESSED", "BROTLI"] {
        let folder = octree(encoding, &nodes());
        for name in ["", "metadata.json", "octree.bin", "hierarchy.bin"] {
            let path = folder.path().join(name);
            let header = formats::open(&path, &OpenHints::default()).unwrap().header().clone();
            assert_eq!(header.format, format!("Potree 2.0, {encoding}"));
            assert_eq!(
                (header.num_points, header.parts),
                (91, vec!["octree: 4 nodes on 2 levels".to_owned()])
            );
            assert_eq!(header.crs.unwrap(), "EPSG:32633, WGS 84 / UTM zone 33N");
            for block_points in [1, 50, usize::MAX] {
                let (block, trailer) = read(&path, block_points).unwrap();
                assert_eq!((trailer.losses, trailer.warnings, trailer.white), (vec![], vec![], None));
                let expected: MadeNode = nodes().concat();
                let column = |attribute| block.column(&attribute).cloned().unwrap();
                assert_eq!(block.xyz, expected.iter().map(|point| point.0).collect::<Vec<_>>());
                assert_eq!(
                    column(Attribute::Color),
                    Column::U16x3(expected.iter().map(|point| point.1).collect())
                );
                let classes = expected.iter().map(|point| point.2).collect();
                assert_eq!(column(Attribute::Classification), Column::U8(classes));
                let offset = DVec3::new(100.0, 200.0, 0.5);
                assert_eq!(block.grid, Grid { scale: DVec3::new(0.01, 0.01, 0.001), offset });
            }
        }
    }
}

#[test]
fn a_scan_is_taken_once_by_whatever_name() {
    let folder = octree("DEFAULT", &nodes());
    let main = |name: &str| Potree.main_file(&folder.path().join(name));
    for name in ["", "metadata.json", "octree.bin", "hierarchy.bin"] {
        assert_eq!(main(name), Some(folder.path().join("metadata.json")), "{name}");
    }
    assert_eq!(main("other.bin"), None);
    let paths = ["", "metadata.json", "octree.bin"].map(|name| folder.path().join(name));
    let inputs = crate::inputs::choose(&paths).unwrap();
    assert_eq!((inputs.paths.len(), inputs.remarks.len()), (1, 1));
    // Another file of that name is another matter.
    std::fs::write(folder.path().join("metadata.json"), "{\"type\": \"FeatureCollection\"}").unwrap();
    assert!(formats::open(folder.path(), &OpenHints::default()).is_err());
}

/// Opens and reads a scan that may be damaged; gives the number of points, if any.
fn try_read(folder: &TempDir) -> Option<(usize, Trailer)> {
    read(folder.path(), 30).ok().map(|(block, trailer)| (block.xyz.len(), trailer))
}

#[test]
fn whatever_is_cut_off_the_rest_is_read() {
    for encoding in ["DEFAULT", "BROTLI"] {
        for name in ["metadata.json", "hierarchy.bin", "octree.bin"] {
            let folder = octree(encoding, &nodes());
            let path = folder.path().join(name);
            let whole = std::fs::read(&path).unwrap();
            let mut before = 0;
            for sixteenth in 0..16 {
                std::fs::write(&path, &whole[..whole.len() * sixteenth / 16]).unwrap();
                let found = try_read(&folder);
                let num_points = found.as_ref().map_or(0, |(num_points, _)| *num_points);
                assert!((before..91).contains(&num_points), "{encoding} {name} {sixteenth}: {num_points}");
                assert!(found.is_none_or(|(_, trailer)| !trailer.losses.is_empty()));
                before = num_points;
            }
            let least = if name == "metadata.json" { 0 } else { 40 };
            assert!(before >= least, "{encoding} {name}: {before}");
            std::fs::remove_file(&path).unwrap();
            assert!(try_read(&folder).is_none());
        }
    }
}

/// Numbers that look like chance, the same in each run.
fn chance(seed: &mut u64) -> usize {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 33) as usize
}

/// Flips bits of a file of a scan a few hundred times, and reads what is left each time.
fn flip(folder: &TempDir, name: &str, num_points: usize) {
    let path = folder.path().join(name);
    let whole = std::fs::read(&path).unwrap();
    let mut seed = 7;
    let mut num_read = 0;
    for _ in 0..300 {
        let mut bytes = whole.clone();
        for _ in 0..1 + chance(&mut seed) % 3 {
            let at = chance(&mut seed) % bytes.len();
            bytes[at] ^= 1 << (chance(&mut seed) % 8);
        }
        std::fs::write(&path, bytes).unwrap();
        if let Some((num, _)) = try_read(folder) {
            assert!(num <= 3 * num_points, "{name}: {num}");
            num_read += 1;
        }
    }
    assert!(num_read > 0, "{name}: nothing was ever read");
    std::fs::write(&path, whole).unwrap();
}

#[test]
fn flipped_bits_never_panic_and_make_no_points() {
    for encoding in ["DEFAULT", "BROTLI"] {
        let folder = octree(encoding, &nodes());
        ["metadata.json", "hierarchy.bin", "octree.bin"].iter().for_each(|name| flip(&folder, name, 91));
    }
    let folder = files(&binary_cloud(5), "bin", true);
    ["cloud.js", "data/r/r.hrc", "data/r/r.bin"].iter().for_each(|name| flip(&folder, name, 60));
}

#[test]
fn claims_are_not_believed() {
    let entry = |num_points: u32, offset: u64, num_bytes: u64| {
        let numbers =
            num_points.to_le_bytes().into_iter().chain(offset.to_le_bytes()).chain(num_bytes.to_le_bytes());
        [0, 0].into_iter().chain(numbers).collect::<Vec<u8>>()
    };
    for encoding in ["DEFAULT", "BROTLI"] {
        let folder = octree(encoding, &nodes()[..1]);
        let len = std::fs::metadata(folder.path().join("octree.bin")).unwrap().len();
        let claims = [
            (u32::MAX, 0, len),
            (u32::MAX, 0, u64::MAX),
            (40, u64::MAX, u64::MAX),
            (40, u64::MAX - 10, len),
            (41, 0, len),
        ];
        for (num_points, offset, num_bytes) in claims {
            std::fs::write(folder.path().join("hierarchy.bin"), entry(num_points, offset, num_bytes))
                .unwrap();
            let said = match read(folder.path(), 30) {
                Ok((block, trailer)) => {
                    assert_eq!((encoding, block.xyz.len()), ("DEFAULT", 40));
                    trailer.losses.concat()
                }
                Err(error) => error.to_string(),
            };
            assert!(said.contains("cut off") || said.contains("none of them"), "{said}");
        }
        // All nodes claim the same bytes: no more is read than could be there.
        let mut shared = entry(40, 0, len);
        shared[1] = 255;
        shared.extend((0..8).flat_map(|_| entry(40, 0, len)));
        std::fs::write(folder.path().join("hierarchy.bin"), shared).unwrap();
        std::fs::write(
            folder.path().join("metadata.json"),
            std::fs::read_to_string(folder.path().join("metadata.json")).unwrap().replace(":22,", ":198,"),
        )
        .unwrap();
        let (block, trailer) = read(folder.path(), 30).unwrap();
        assert_eq!(block.xyz.len(), 80);
        assert!(
            trailer.losses[0].contains("7 nodes whose points lie in those of others"),
            "{:?}",
            trailer.losses
        );
    }
}

#[test]
fn pointers_and_empty_files_are_told() {
    let folder = octree("DEFAULT", &nodes());
    let said = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        let whole = std::fs::read(&path).unwrap();
        std::fs::write(&path, bytes).unwrap();
        let error = read(folder.path(), 30).map(|_| ()).unwrap_err().to_string();
        std::fs::write(path, whole).unwrap();
        error
    };
    let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 7\n";
    assert!(said("octree.bin", pointer).contains("octree.bin is a Git LFS pointer"));
    assert!(said("hierarchy.bin", pointer).contains("hierarchy.bin is a Git LFS pointer"));
    assert!(said("octree.bin", b"").contains("lists 91 points, but octree.bin is empty"));
    assert!(said("hierarchy.bin", b"").contains("announces 91 points, but no node"));
}

/// What `cloud.js` says of nodes of records.
fn binary_cloud(step: usize) -> Value {
    json!({
        "version": "1.7", "octreeDir": "data", "spacing": 1.0, "scale": 0.001, "hierarchyStepSize": step,
        "boundingBox": {"lx": 10.0, "ly": 20.0, "lz": -5.0, "ux": 18.0, "uy": 28.0, "uz": 3.0},
        "pointAttributes": ["POSITION_CARTESIAN", "COLOR_PACKED", "INTENSITY"],
    })
}

/// Names and masks of the nodes of a scan of Potree 1.
const FILES: [(&str, u8); 6] =
    [("r", 0b1000_0001), ("r0", 0b100), ("r7", 0), ("r02", 0b10), ("r021", 0b1), ("r0210", 0)];
/// Points of each of them.
const EACH: u32 = 10;

/// Writes a scan of Potree 1, whose leaves have a count of 0 in the hierarchy, as converters write it.
fn files(cloud: &Value, ending: &str, is_nested: bool) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let step = cloud["hierarchyStepSize"].as_u64().unwrap_or(0) as usize;
    let place = |name: &str, ending: &str| {
        let mut path = folder.path().join("data");
        if is_nested {
            path.push("r");
            path.extend(
                name.as_bytes()[1..].chunks_exact(step).map(|part| std::str::from_utf8(part).unwrap()),
            );
        }
        std::fs::create_dir_all(&path).unwrap();
        path.join(format!("{name}.{ending}"))
    };
    for (at, (name, mask)) in FILES.iter().enumerate() {
        let point = |number: u32| {
            let xyz = [number, 2 * number, at as u32];
            let rgb = [number as u8, at as u8, 255, 255];
            xyz.iter()
                .flat_map(|c| c.to_le_bytes())
                .chain(rgb)
                .chain(500u16.to_le_bytes())
                .collect::<Vec<u8>>()
        };
        std::fs::write(place(name, ending), (0..EACH).flat_map(point).collect::<Vec<u8>>()).unwrap();
        if step > 0 && (name.len() - 1).is_multiple_of(step) && (*mask != 0 || at == 0) {
            let is_in =
                |(other, _): &&(&str, u8)| other.starts_with(name) && other.len() <= name.len() + step;
            let entry = |(_, mask): &(&str, u8)| {
                let num_points = if *mask == 0 { 0 } else { EACH };
                [*mask].into_iter().chain(num_points.to_le_bytes()).collect::<Vec<u8>>()
            };
            std::fs::write(
                place(name, "hrc"),
                FILES.iter().filter(is_in).flat_map(entry).collect::<Vec<u8>>(),
            )
            .unwrap();
        }
    }
    std::fs::write(folder.path().join("cloud.js"), cloud.to_string()).unwrap();
    folder
}

/// Smallest corners of [`FILES`], in the box of [`binary_cloud`].
const CORNERS: [[f64; 3]; 6] = [
    [10.0, 20.0, -5.0],
    [10.0, 20.0, -5.0],
    [14.0, 24.0, -1.0],
    [10.0, 22.0, -5.0],
    [10.0, 22.0, -4.0],
    [10.0, 22.0, -4.0],
];

#[test]
fn nodes_of_records_are_put_together_however_folders_are_cut() {
    let inline = {
        let mut cloud = binary_cloud(0);
        cloud["hierarchy"] = json!(FILES.map(|(name, _)| json!([name, 10])));
        cloud["version"] = json!("1.4");
        cloud
    };
    let scans = [
        (binary_cloud(5), true),
        (binary_cloud(2), true),
        (binary_cloud(1), true),
        (binary_cloud(3), false),
        (inline, false),
    ];
    for (cloud, is_nested) in scans {
        let folder = files(&cloud, "bin", is_nested);
        for name in ["", "cloud.js"] {
            let path = folder.path().join(name);
            assert_eq!(formats::open(&path, &OpenHints::default()).unwrap().header().num_points, 60);
            let (block, trailer) = read(&path, 25).unwrap();
            assert_eq!(
                (trailer.losses, trailer.warnings, trailer.white),
                (vec![], vec![], Some(255)),
                "{cloud}"
            );
            assert_eq!(block.xyz.len(), 60);
            for (number, &xyz) in block.xyz.iter().enumerate() {
                let (node, point) = (number / 10, (number % 10) as f64);
                let expected =
                    DVec3::from_array(CORNERS[node]) + 0.001 * DVec3::new(point, 2.0 * point, node as f64);
                assert!((block.grid.p_in_world(xyz) - expected).abs().max_element() < 1e-12);
            }
            let Some(Column::U16x3(rgb)) = block.column(&Attribute::Color) else { panic!("no colors") };
            assert_eq!(rgb[37], [7, 3, 255]);
            assert_eq!(block.column(&Attribute::Intensity), Some(&Column::U16(vec![500; 60])));
        }
    }
}

#[test]
fn missing_nodes_and_parts_of_the_hierarchy_are_counted() {
    let folder = files(&binary_cloud(2), "bin", true);
    let data = folder.path().join("data/r");
    std::fs::remove_file(data.join("r7.bin")).unwrap();
    std::fs::write(data.join("02/r021.bin"), [0; 27]).unwrap();
    let (block, trailer) = read(folder.path(), 25).unwrap();
    assert_eq!(block.xyz.len(), 41);
    assert_eq!(
        trailer.losses,
        [
            "has 1 node whose file is missing: r7; it is left out",
            "has 1 node that is cut off: r021; what is missing is left out",
        ]
    );
    std::fs::remove_file(data.join("02/r02.hrc")).unwrap();
    let (block, trailer) = read(folder.path(), 25).unwrap();
    assert_eq!(block.xyz.len(), 30);
    assert!(trailer.losses[0].contains("has 1 part of its hierarchy (.hrc) that is missing"));
    std::fs::remove_file(data.join("r.hrc")).unwrap();
    assert!(read(folder.path(), 25).unwrap_err().to_string().contains("its hierarchy, "));
    std::fs::remove_dir_all(folder.path().join("data")).unwrap();
    assert!(read(folder.path(), 25).unwrap_err().to_string().contains("is not there"));
}

//! Potree's scans: nodes that are LAS files on grids of their own, and real scans as other readers found them.
//!
//! The expected numbers are from a reader of Potree in Python, written for this test (numpy, brotli), and from laspy.

use base::task::Progress;
use kit::las_files::las_bytes;
use kit::real_scans::folder;
use las::{Builder, Point, Transform, Vector};
use points::{Attribute, Block, Column, Grid, Projection, Trailer};
use std::collections::BTreeMap;
use std::path::Path;

/// A scan's grid, its grid coordinates, its other values by the names of their attributes, and what came at its end.
type ReadScan = (Grid, Vec<[i32; 3]>, BTreeMap<String, Vec<f64>>, Trailer);

/// All points of a scan, with these attributes.
fn read(path: &Path, want: Option<Projection>) -> ReadScan {
    let dataset = points::open(path, &points::OpenHints::default()).unwrap_or_else(|error| panic!("{error}"));
    let want = want.unwrap_or_else(|| dataset.header().schema.projection()).in_blocks_of(100_000);
    let (mut grid, mut xyz, mut columns) = (Grid::default(), Vec::new(), BTreeMap::<String, Vec<f64>>::new());
    let mut take = |block: Block| {
        grid = block.grid;
        let num_points = block.xyz.len();
        for (attribute, column) in &block.columns {
            columns.entry(attribute.name().into_owned()).or_default().extend(numbers(column, num_points));
        }
        xyz.extend(block.xyz);
        Ok(())
    };
    let trailer = dataset.read(&want, &mut take, &Progress::hidden()).unwrap();
    (grid, xyz, columns, trailer)
}

/// The numbers of a column: all channels of a color, and 1 for each mark.
fn numbers(column: &Column, num_points: usize) -> Vec<f64> {
    match column {
        Column::Bool(marks) => (0..num_points).map(|at| f64::from(u8::from(marks.get(at)))).collect(),
        Column::U8(values) => values.iter().map(|&value| value.into()).collect(),
        Column::I8(values) => values.iter().map(|&value| value.into()).collect(),
        Column::U16(values) => values.iter().map(|&value| value.into()).collect(),
        Column::I16(values) => values.iter().map(|&value| value.into()).collect(),
        Column::U32(values) => values.iter().map(|&value| value.into()).collect(),
        Column::F64(values) => values.clone(),
        Column::U16x3(values) => values.iter().flatten().map(|&value| value.into()).collect(),
        Column::F32x3(values) => values.iter().flatten().map(|&value| value.into()).collect(),
        other => panic!("no such column is expected: {:?}", other.kind()),
    }
}

/// Name, points, smallest and largest corner of a scan.
type BoxRow = (&'static str, usize, [f64; 3], [f64; 3]);
/// Least and largest value of an attribute, and the sum of all.
type SumRow = (&'static str, [f64; 3]);

#[rustfmt::skip]
const SCANS: &[(BoxRow, &[SumRow])] = &[
    (("potree2/ign-default", 697721, [484649.36, 6632629.73, 99.65], [484999.99, 6632999.98, 120.41]), &[
        ("rgb", [255.0, 65024.0, 55737270200.0]), ("intensity", [311.0, 3004.0, 1108349761.0]),
        ("classification", [1.0, 65.0, 1424885.0]), ("noise", [0.0, 0.0, 0.0]),
    ]),
    (("potree2/ign-brotli", 697721, [484649.37, 6632629.74, 99.66], [485000.0, 6632999.99, 120.42]), &[
        ("intensity", [311.0, 3004.0, 1108349761.0]), ("return_number", [1.0, 6.0, 708981.0]),
        ("number_of_returns", [1.0, 6.0, 720217.0]), ("synthetic", [0.0; 3]), ("key_point", [0.0; 3]),
        ("withheld", [0.0; 3]), ("overlap", [0.0; 3]), ("classification", [1.0, 65.0, 1424885.0]), ("noise", [0.0; 3]),
        ("user_data", [0.0; 3]), ("scan_angle", [-3112.0, -1210.0, -1374381310.0]),
        ("point_source_id", [47.0, 47.0, 32792887.0]),
        ("gps_time", [390583952.3495862, 390583958.41052896, 272518628458558.38]),
        ("rgb", [255.0, 65024.0, 55737270200.0]), ("extra:Deviation", [256.0, 4352.0, 2776957440.0]),
        ("extra:ExtraBytes", [1.0, 65.0, 1436533.0]),
    ]),
    (("potree2/autzen-default", 110000, [636001.76, 848935.2, 406.26], [637179.21, 849497.89, 520.51]), &[
        ("intensity", [0.0, 254.0, 11220547.0]), ("return_number", [1.0, 4.0, 122564.0]),
        ("number_of_returns", [1.0, 4.0, 135174.0]), ("classification", [1.0, 2.0, 136107.0]), ("noise", [0.0; 3]),
        ("scan_angle", [-18.0, -1.0, -911726.0]), ("user_data", [117.0, 135.0, 13763736.0]),
        ("point_source_id", [7326.0, 7326.0, 805860000.0]),
        ("gps_time", [245379.39843682514, 245385.91112104454, 26992173910.63077]),
        ("rgb", [40.0, 236.0, 36362480.0]),
    ]),
    (("potree2/lion-brotli", 341989, [-4.975, 1.049, -3.435], [-0.785, 6.729, 1.125]), &[
        ("intensity", [5397.0, 65535.0, 11553659104.0]), ("rgb", [0.0, 65280.0, 34343611392.0]),
        ("extra:OriginId", [0.0, 199.0, 35340816.0]),
    ]),
    (("potree20-default-ahora", 26845, [-844161.69, -1014989.25, 636.83], [-843731.53, -1014653.73, 719.96]), &[
        ("intensity", [8.0, 107.0, 859472.0]), ("return_number", [1.0, 3.0, 28300.0]),
        ("classification", [8.0, 8.0, 214760.0]), ("point_source_id", [1561.0, 1564.0, 41945674.0]),
        ("gps_time", [-14900372.491119385, -14898755.686767578, -399978558251.20825]),
        ("rgb", [43520.0, 65280.0, 4673177600.0]),
    ]),
    (("potree14-laz-lion", 341989, [-4.985, 1.039, -3.445], [-0.789, 6.724, 1.124]), &[
        ("intensity", [5397.0, 65535.0, 11553659104.0]), ("rgb", [0.0, 65280.0, 34343611392.0]),
    ]),
    (("potree17-bin-lion", 272768, [-0.748213, -2.780406, 2.550821], [2.449718, 1.488497, 7.194766]), &[
        ("rgb", [19.0, 255.0, 109097555.0]), ("extra:alpha", [255.0, 255.0, 69555840.0]),
    ]),
    (("potree18-bin-street-incomplete", 27690, [406047.001, 7405438.787, 517.898], [406185.003, 7405572.421, 568.623]), &[
        ("rgb", [0.0, 255.0, 9304030.0]), ("gps_time", [147471.35251899998, 147474.501875, 4083516216.02422]),
        ("intensity", [1.0, 172.0, 604003.0]), ("number_of_returns", [1.0, 1.0, 27690.0]),
        ("return_number", [1.0, 1.0, 27690.0]), ("point_source_id", [0.0, 31.0, 295943.0]),
    ]),
];

/// Sums of all places along each axis, in the files' own coordinates, of the scans that count in their own grid.
const PLACES: [(&str, [i64; 3]); 4] = [
    ("potree2/ign-default", [15123632370, 15805378016, 548384758]),
    ("potree2/ign-brotli", [15124330091, 15806075737, 549082479]),
    ("potree2/autzen-default", [5991046431, 2316350315, 264843350]),
    ("potree14-laz-lion", [-890724580, 1367316656, -516821443]),
];

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn points_and_attributes_are_those_of_other_readers() {
    for ((name, num_points, min, max), sums) in SCANS {
        let (grid, xyz, columns, trailer) = read(&folder().join(name), None);
        assert_eq!(xyz.len(), *num_points, "{name}");
        let places = || xyz.iter().map(|&xyz| grid.p_in_world(xyz).to_array());
        for axis in 0..3 {
            let low = places().fold(f64::MAX, |low, p| low.min(p[axis]));
            let high = places().fold(f64::MIN, |high, p| high.max(p[axis]));
            assert!(
                (low - min[axis]).abs() < 1e-6 && (high - max[axis]).abs() < 1e-6,
                "{name}: {low} {high}"
            );
        }
        if let Some((_, expected)) = PLACES.iter().find(|(of, _)| of == name) {
            let sum = |axis: usize| xyz.iter().map(|xyz| i64::from(xyz[axis])).sum::<i64>();
            assert_eq!([0, 1, 2].map(sum), *expected, "{name}");
        }
        for (attribute, expected) in *sums {
            let values = &columns[*attribute];
            let low = values.iter().copied().fold(f64::MAX, f64::min);
            let high = values.iter().copied().fold(f64::MIN, f64::max);
            let sum: f64 = values.iter().sum();
            // Sums of whole numbers are exact; those of times depend on the order in the last digits.
            let is_near = (sum - expected[2]).abs() <= 1e-9 * expected[2].abs();
            assert!([low, high] == expected[..2] && is_near, "{name}: {attribute} {low} {high} {sum}");
        }
        let is_whole = !name.contains("incomplete");
        assert_eq!(trailer.losses.is_empty(), is_whole, "{name}: {:?}", trailer.losses);
        assert_eq!(trailer.warnings, [""; 0], "{name}");
    }
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn normals_are_of_unit_length_or_none() {
    let (_, xyz, columns, _) = read(&folder().join("potree17-bin-lion"), None);
    let normals = &columns["normals"];
    let (lengths, nones): (Vec<f64>, Vec<f64>) =
        normals.chunks(3).map(|n| n.iter().map(|c| c * c).sum::<f64>()).partition(|length| !length.is_nan());
    assert_eq!((lengths.len() + nones.len(), nones.len()), (xyz.len(), 36));
    assert!(lengths.iter().all(|length| (length - 1.0).abs() < 1e-5));
    let sum: f64 = normals.iter().filter(|c| !c.is_nan()).sum();
    assert!((sum - 133_783.09).abs() < 0.1, "{sum}");
}

/// The places of a scan in order, without their points' order.
fn sorted(mut xyz: Vec<[i32; 3]>) -> Vec<[i32; 3]> {
    xyz.sort_unstable();
    xyz
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn encodings_of_one_scan_are_one_unit_apart() {
    let none = || Some(Projection::of([]));
    let places = |name: &str| read(&folder().join(name), none());
    let (grid, plain, ..) = places("potree2/ign-default");
    let (other, folded, ..) = places("potree2/ign-brotli");
    assert_eq!(grid, other);
    // The converter adds a unit along all axes. It is not taken off: neither encoding has the source's own places.
    assert!(sorted(plain.clone()) == sorted(folded.iter().map(|xyz| xyz.map(|c| c - 1)).collect()));
    let (own, source, ..) = places("laz-aerial-rgbnir-ign/las_with_several_extra_byte_bloc.laz");
    let steps =
        |xyz: [i32; 3]| ((own.p_in_world(xyz) - grid.offset) / grid.scale).round().as_ivec3().to_array();
    let source: std::collections::HashSet<[i32; 3]> = source.into_iter().map(steps).collect();
    let part =
        |xyz: &[[i32; 3]]| xyz.iter().filter(|xyz| source.contains(*xyz)).count() as f64 / xyz.len() as f64;
    assert!(part(&plain) < 0.5 && part(&folded) < 0.5, "{} {}", part(&plain), part(&folded));
    // Each place of the folded scan is the source's, or one unit above it along some axes.
    let is_next = |xyz: &[i32; 3]| {
        (0..8).any(|mask| source.contains(&std::array::from_fn(|axis| xyz[axis] - (mask >> axis & 1))))
    };
    assert!(folded.iter().all(is_next));
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn scans_without_points_say_why() {
    for (name, said) in [
        ("potree2-truncated-source", "announces 909091 points, but no node in hierarchy.bin has any"),
        ("potree20-lfs-pointers", "hierarchy.bin is a Git LFS pointer"),
        ("potree20-octree-missing-pump", "octree.bin, which belongs to it, is not there"),
    ] {
        let path = folder().join("malformed").join(name);
        for path in [path.clone(), path.join("metadata.json")] {
            let error = points::open(&path, &points::OpenHints::default()).err().unwrap().to_string();
            assert!(error.contains(said) && error.contains(name), "{error}");
        }
    }
}

/// The points of a node, in meters about the root's corner.
const PLACES_OF_NODE: [[f64; 3]; 3] = [[0.25, 1.5, 0.125], [1.75, 0.5, 2.0], [3.0, 3.5, 1.0]];

/// A node's file, on the grid with this scale and offset.
fn node(scale: f64, offset: f64, shift: f64) -> Vec<u8> {
    let transform = Transform { scale, offset };
    let mut builder = Builder::from((1, 2));
    builder.transforms = Vector { x: transform, y: transform, z: transform };
    let point = |[x, y, z]: [f64; 3]| Point {
        x: x + shift,
        y: y + shift,
        z: z + shift,
        intensity: (100.0 * x) as u16,
        ..Point::default()
    };
    las_bytes(builder, PLACES_OF_NODE.map(point))
}

#[test]
fn nodes_on_other_grids_come_together() {
    // The grids are the same, whole steps apart, part of a step apart, and of other steps.
    for (scale, offset) in [(0.001, 0.0), (0.001, -2.125), (0.001, 0.0005), (0.0005, 7.0)] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("data")).unwrap();
        std::fs::write(folder.path().join("data/r.las"), node(0.001, 0.0, 0.0)).unwrap();
        std::fs::write(folder.path().join("data/r5.las"), node(scale, offset, offset.fract() + 1.0)).unwrap();
        let cloud = r#"{"version": "1.4", "octreeDir": "data", "pointAttributes": "LAS", "scale": 0.001,
            "boundingBox": {"lx": 0, "ly": 0, "lz": 0, "ux": 8, "uy": 8, "uz": 8}, "hierarchy": [["r", 3], ["r5", 3]]}"#;
        std::fs::write(folder.path().join("cloud.js"), cloud).unwrap();
        let want = Projection::of([Attribute::Intensity]);
        let (grid, xyz, columns, trailer) = read(folder.path(), Some(want));
        assert_eq!((xyz.len(), trailer.losses, trailer.warnings), (6, vec![], vec![]));
        assert_eq!(columns["intensity"], [25.0, 175.0, 300.0, 25.0, 175.0, 300.0]);
        for (number, &xyz) in xyz.iter().enumerate() {
            let shift = if number < 3 { 0.0 } else { offset.fract() + 1.0 };
            let p = grid.p_in_world(xyz).to_array();
            for axis in 0..3 {
                let error = (p[axis] - PLACES_OF_NODE[number % 3][axis] - shift).abs();
                assert!(error <= 1e-8, "{scale} {offset}: {error}");
            }
        }
    }
}

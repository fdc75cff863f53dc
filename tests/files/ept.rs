//! Real EPT scans, COPC files and archives, where `SCANWALK_TEST_DATA` names a folder of them. Numbers are those of other
//! readers: laspy with lazrs for LAZ, one in Python with numpy and zstandard for records. All points, in any order, were
//! equal there, with intensities, colors, classes, sources and times.

use base::task::Progress;
use kit::reading;
use kit::real_scans::{folder, read_in};
use points::{Attribute, Block, Column, OpenHints, Projection, Scan, open};
use std::collections::HashMap;
use std::path::Path;

/// Path, points, smallest and largest corner rounded to thousandths, smallest and largest intensity, the largest red,
/// green and blue.
type EptRow = (&'static str, usize, [f64; 3], [f64; 3], [u16; 2], [u16; 3]);

#[rustfmt::skip]
const TABLE: &[EptRow] = &[
    ("ept-binary-small/rgb", 134, [497753.69, 7050887.61, 0.98], [497754.4, 7050888.39, 1.25], [0, 0], [181, 217, 223]),
    ("ept-binary-small/rgb16", 311, [7.3, 2.7, -5.8], [7.6, 2.99, -5.77], [27392, 28928], [64768, 65024, 64512]),
    ("ept-binary-small/sunshine-coast", 253, [498062.0, 7050992.84, 74.34], [498067.39, 7050997.04, 80.02], [199, 2086], [0; 3]),
    ("ept-laszip-lone-star", 518862, [515368.602, 4918340.364, 2322.896], [515401.043, 4918381.124, 2338.575], [17, 2744], [0; 3]),
    ("ept-zstd-lion/ept.json", 341989, [-4.985, 1.039, -3.445], [-0.789, 6.724, 1.124], [5397, 65535], [65280; 3]),
    ("malformed/ept-bad-pointcount-laszip", 1065, [635619.85, 848899.7, 406.59], [638982.55, 853535.43, 586.38], [0, 254], [249, 239, 249]),
    ("malformed/ept-bcbf", 5, [1.0, 1.0, 999.0], [1.0, 1.0, 999.0], [0, 0], [0; 3]),
    ("copc/lone-star.copc.laz", 518862, [515368.602, 4918340.364, 2322.896], [515401.043, 4918381.124, 2338.575], [17, 2744], [0; 3]),
    ("copc/simple_with_page.copc.laz", 1065, [635619.85, 848899.7, 406.59], [638982.55, 853535.43, 586.38], [0, 254], [249, 239, 249]),
];

/// All blocks of a scan, with color and intensity.
fn blocks(path: &Path) -> Vec<Block> {
    let want = Projection::of([Attribute::Color, Attribute::Intensity]).in_blocks_of(100_000);
    let mut blocks = Vec::new();
    let mut take = |block: Block| {
        blocks.push(block);
        Ok(())
    };
    open(path, &OpenHints::default()).unwrap().read(&want, &mut take, &Progress::hidden()).unwrap();
    blocks
}

/// What differs from the row, if anything does.
fn difference(folder: &Path, row: &EptRow) -> Option<String> {
    let (name, num_points, min, max, intensity, rgb) = row;
    let (mut num, mut low, mut high) = (0, [f64::MAX; 3], [f64::MIN; 3]);
    let (mut found_intensity, mut found_rgb) = ([u16::MAX, 0], [0; 3]);
    for block in blocks(&folder.join(name)) {
        num += block.xyz.len();
        for xyz in &block.xyz {
            let p = block.grid.p_in_world(*xyz).to_array();
            low = std::array::from_fn(|axis| low[axis].min(p[axis]));
            high = std::array::from_fn(|axis| high[axis].max(p[axis]));
        }
        if let Some(Column::U16(values)) = block.column(&Attribute::Intensity) {
            values
                .iter()
                .for_each(|v| found_intensity = [found_intensity[0].min(*v), found_intensity[1].max(*v)]);
        } else {
            found_intensity = [0, 0];
        }
        if let Some(Column::U16x3(values)) = block.column(&Attribute::Color) {
            values.iter().for_each(|v| found_rgb = std::array::from_fn(|c| v[c].max(found_rgb[c])));
        }
    }
    let near = |a: [f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 0.00051);
    let same = (num, &found_intensity, &found_rgb) == (*num_points, intensity, rgb);
    (!same || !near(low, min) || !near(high, max))
        .then(|| format!("{name}: {num} points, {low:?} to {high:?}, {found_intensity:?}, {found_rgb:?}"))
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn points_and_values_are_those_of_other_readers() {
    let folder = folder();
    for row in TABLE {
        assert_eq!(difference(&folder, row), None);
    }
    let mut wrong = TABLE[0];
    wrong.1 = 133;
    assert!(difference(&folder, &wrong).is_some());
}

/// How many points have a place, in quarters of a millimeter, and an intensity.
fn counted(scan: &Scan) -> HashMap<([i64; 3], u16), usize> {
    let mut counts = HashMap::new();
    for file in &scan.files {
        for (xyz, intensity) in file.points.xyz.iter().zip(&file.points.intensity) {
            let p = file.in_file.grid.p_in_world(*xyz).to_array();
            *counts.entry((p.map(|c| (c * 4000.0).round() as i64), *intensity)).or_default() += 1;
        }
    }
    counts
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn one_scan_is_the_same_in_three_formats() {
    let folder = folder();
    let tiles: Vec<_> =
        (1..=4).map(|tile| folder.join(format!("laz-tiles-lone-star/split-{tile}.laz"))).collect();
    let tiles = counted(&reading::files(&tiles).unwrap());
    for name in ["ept-laszip-lone-star", "copc/lone-star.copc.laz"] {
        let scan = read_in(&folder, name).unwrap();
        // The file itself names a system on the earth, where its points are not.
        assert_eq!(scan.warnings.is_empty(), name.starts_with("ept"), "{:?}", scan.warnings);
        assert!(counted(&scan) == tiles, "{name} differs from the tiles");
    }
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn what_is_odd_is_said() {
    let folder = folder();
    let said = |name: &str| match read_in(&folder, name) {
        Ok(scan) => scan.warnings.join("\n"),
        Err(error) => error,
    };
    assert!(said("ept-binary-small/rgb16").contains("announces 318 points, but holds 311; all were read"));
    assert!(said("malformed/ept-bad-pointcount-laszip").contains("1 node with another number of points"));
    let error = said("malformed/ept-schema-mismatch-norgb");
    assert!(error.contains("880 bytes for 22 points, which are not the 34 each"), "{error}");
}

/// Copies a folder without one of its files.
fn copy(from: &Path, to: &Path, without: &str) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().map(|entry| entry.unwrap()) {
        let (path, name) = (entry.path(), entry.file_name());
        if path.is_dir() {
            copy(&path, &to.join(name), without);
        } else if name != without {
            // The copies may be changed, unlike what they are copied from.
            std::fs::write(to.join(name), std::fs::read(&path).unwrap()).unwrap();
        }
    }
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn nodes_that_are_missing_or_overwritten_lose_only_themselves() {
    let (folder, made) = (folder(), tempfile::tempdir().unwrap());
    let from = folder.join("ept-laszip-lone-star");
    // The root is missing, so that another node says what points have.
    copy(&from, made.path(), "0-0-0-0.laz");
    let overwritten = folder.join("malformed/las/ept-invalid-tile-2-2-2-2.laz");
    std::fs::write(made.path().join("ept-data/2-2-2-2.laz"), std::fs::read(overwritten).unwrap()).unwrap();
    std::fs::remove_file(made.path().join("ept-hierarchy/2-2-2-1.json")).unwrap();
    let scan = reading::file(made.path()).unwrap();
    let said = scan.warnings.join("\n");
    assert!(said.contains("has 1 node whose file is missing (0-0-0-0)"), "{said}");
    assert!(said.contains("node 2-2-2-2 cannot be read") && said.contains("it is left out"), "{said}");
    assert!(said.contains("1 piece of its hierarchy that is lost"), "{said}");
    assert!((300_000..480_000).contains(&scan.num_points()), "{}", scan.num_points());
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn real_copc_files_lose_their_order_with_their_hierarchy_and_no_point() {
    let (folder, made) = (folder(), tempfile::tempdir().unwrap());
    let path = made.path().join("a.copc.laz");
    for (name, num_points) in [("lone-star", 518_862), ("simple_with_page", 1065)] {
        let mut bytes = std::fs::read(folder.join(format!("copc/{name}.copc.laz"))).unwrap();
        // The first record is the info record, behind a header of 375 bytes; its sixth number is the root page's place.
        let at = 375 + 54 + 40;
        bytes[at..at + 8].copy_from_slice(&7u64.to_le_bytes());
        std::fs::write(&path, &bytes).unwrap();
        let scan = reading::file(&path).unwrap();
        assert_eq!(scan.num_points(), num_points);
        assert!(scan.warnings[0].contains("is COPC, but its hierarchy"), "{:?}", scan.warnings);
    }
}

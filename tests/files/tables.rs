//! Real PCD and text files, where `SCANWALK_TEST_DATA` names a folder of them: points, boxes and sums as other readers found
//! them (PCD: pypcd4 1.5.1, and Python's `float` where the data are text; text: Python's `float` on the words of each line that
//! has three numbers and more).

use base::task::Progress;
use kit::real_scans::folder;
use points::{Attribute, Block, Column, OpenHints, open};

/// Path, format for people, points, sums of the coordinates, sum of all channels of all colors.
type TableRow = (&'static str, &'static str, usize, [f64; 3], u64);

const UTM17: [f64; 3] = [2_898_163.22, 43_209_796.05, 1706.79];

#[rustfmt::skip]
const TABLE: &[TableRow] = &[
    ("pcd/autzen-utm.pcd", "PCD 0.7, binary", 1065, [526_636_816.64, 5_195_213_595.26, 140_913.34], 382_913),
    ("pcd/milk.pcd", "PCD 0.7, binary compressed", 12575, [3_138.982_72, -1_214.454_17, -8_762.243_23], 3_206_625),
    ("pcd/min_cut_segmentation_tutorial.pcd", "PCD 0.7, ascii", 9311, [643_781.606, -180_419.427, 6232.32], 0),
    ("pcd/room_scan1.pcd", "PCD 0.7, binary compressed", 112_586, [26_047.641_8, 15_075.899_81, 46_427.954_74], 0),
    ("pcd/table_scene_mug_stereo_textured.pcd", "PCD 0.7, binary compressed", 209_280, [19_930.185_86, -9_814.717_66, 264_682.154_89], 95_259_783),
    ("pcd/utm17_space.pcd", "PCD 0.7, ascii", 10, UTM17, 0),
    ("malformed/pcd/utm17_comma.pcd", "PCD 0.7, ascii", 10, UTM17, 0),
    ("malformed/pcd/missingheader.pcd", "text, columns x y z", 10, UTM17, 0),
    ("text/autzen.pts", "PTS, columns x y z intensity r g b", 10, [6_361_203.110_017, 8_490_797.470_032, 4_448.180_021], 3099),
    ("text/test.pts", "PTS, columns x y z intensity r g b", 19, [-352.692_185, -412.482_65, -22.633_043], 1009),
    ("text/crlf_test.txt", "text, columns x y z intensity, separated by commas", 10, UTM17, 0),
    ("text/data.xyz", "text, columns x y z", 400, [176_528_000.0, 1_500_288_000.0, 50_706.0], 0),
    ("text/largescan.txt", "text, columns x y z OffsetTime ScanAngleRank, separated by commas", 6, [2_590_159.73, 4_661_056.49, 240.181], 0),
    ("text/lion-r.csv", "text, columns x y z r g b, separated by commas", 31_414, [54_995.567_129, 60_635.344_879, 67_764.080_659], 12_350_651),
    ("text/quoted.txt", "text, columns x y z, separated by commas", 9, [134.0, 121.0, 18.0], 0),
    ("text/utm17_1.txt", "text, columns x y z, separated by commas", 10, UTM17, 0),
    ("text/utm17_2.txt", "text, columns x y z", 10, UTM17, 0),
    ("malformed/text/badheader.txt", "text, columns x y z, separated by commas", 8, [20.5, 4.5, 25.0], 0),
    ("malformed/text/missingheader.txt", "text, columns x y z intensity", 5, [15.0, 15.0, 15.0], 0),
];

/// What a file holds: its format, points, sums of coordinates, and the sum of its channels.
fn sums(name: &str) -> (String, usize, [f64; 3], u64) {
    let dataset = open(&folder().join(name), &OpenHints::default()).unwrap();
    let (mut num, mut places, mut channels) = (0, [0.0; 3], 0);
    let mut take = |block: Block| {
        num += block.xyz.len();
        for xyz in &block.xyz {
            let p = block.grid.p_in_world(*xyz).to_array();
            places = std::array::from_fn(|axis| places[axis] + p[axis]);
        }
        if let Some(Column::U16x3(rgb)) = block.column(&Attribute::Color) {
            channels += rgb.iter().flatten().map(|channel| u64::from(*channel)).sum::<u64>();
        }
        Ok(())
    };
    let want = dataset.header().schema.projection().in_blocks_of(10_000);
    let trailer = dataset.read(&want, &mut take, &Progress::hidden()).unwrap();
    assert_eq!(trailer.losses, [""; 0], "{name}");
    (dataset.header().format.clone(), num, places, channels)
}

#[test]
#[cfg_attr(not(feature = "with-scans"), ignore = "needs real scans, in the folder SCANWALK_TEST_DATA")]
fn sums_are_those_of_other_readers() {
    for (name, format, num, places, channels) in TABLE {
        let found = sums(name);
        assert_eq!((&found.0[..], found.1, found.3), (*format, *num, *channels), "{name}");
        for axis in 0..3 {
            // A point moves by half a step at most, which is far less.
            let most = 1e-6 * (1.0 + places[axis].abs() / *num as f64) * *num as f64 + 0.01;
            assert!((found.2[axis] - places[axis]).abs() <= most, "{name}: {:?}, not {places:?}", found.2);
        }
    }
}

//! Tests of finding points without a color, and of what is done about them.

use super::*;
use crate::color::choose;
use crate::stats::Stats;
use crate::{Grid, ScanBuilder};
use glam::DVec3;

fn filled(color: ColorSource, intensity: Vec<u16>) -> Vec<[u16; 3]> {
    let xyz = (0..5).map(|z| [0, 0, z]).collect();
    let rgb = vec![[0; 3], [0; 3], [9, 0, 0], [0; 3], [0; 3]];
    let grid = Grid { scale: DVec3::splat(-0.5), offset: DVec3::ZERO };
    let mut file = ScanBuilder::new(grid, xyz).rgb(rgb).intensity(intensity).color(color).file();
    file.coloring.blank =
        Some(Blank { color: [0; 3], near: 0, white: 255, num_others: 1, by_intensity: false });
    find_grays(&mut file);
    (0..5).map(|at| file.rgb(at, color.white().unwrap_or(255))).collect()
}

#[test]
fn black_points_are_gray_by_intensity_or_height_and_colored_ones_stay() {
    let by_intensity = filled(ColorSource::Rgb8, vec![100, 300, 0, 500, 900]);
    assert_eq!(by_intensity, [[78; 3], [106; 3], [9, 0, 0], [135; 3], [191; 3]]);
    // Heights fall along this file, and the sixteen bits are filled.
    let by_height = filled(ColorSource::Rgb16, vec![7; 5]);
    assert_eq!(by_height, [[49151; 3], [40959; 3], [9, 0, 0], [24576; 3], [16384; 3]]);
    assert_eq!(filled(ColorSource::Rgb12, vec![])[0], [3071; 3]);
    assert_eq!(filled(ColorSource::default(), vec![]), [[0; 3], [0; 3], [9, 0, 0], [0; 3], [0; 3]]);
}

fn blank(rgb: &[[u16; 3]]) -> Option<Blank> {
    let colors = Distribution::of(rgb);
    Blank::of(&colors, White::known_or_of(None, &colors), rgb, false)
}

#[test]
fn a_color_that_all_points_have_or_all_but_a_few_is_none() {
    for color in
        [[0; 3], [1; 3], [255; 3], [1023; 3], [65535; 3], [128; 3], [200, 10, 10], [65535, 65535, 65534]]
    {
        for (num, most) in [(2, 0), (99, 0), (100, 1), (500, 3), (6000, 12), (100_000, 200)] {
            for num_others in [0, 1, most, most + 1, 2 * most + 1] {
                // The others are the last points of the file, or one now and then.
                let step = num / num_others.max(1);
                let spread = |at: usize| at % step == step / 2 && at / step < num_others;
                let last = |at: usize| at >= num - num_others;
                for is_other in [&spread as &dyn Fn(usize) -> bool, &last] {
                    let other = color.map(|c: u16| if c > 100 { c / 2 } else { 99 });
                    let rgb: Vec<[u16; 3]> =
                        (0..num).map(|at| if is_other(at) { other } else { color }).collect();
                    let found = blank(&rgb).map(|blank| (blank.color, blank.num_others));
                    // Black is no color either where many points have another.
                    let is_none = num_others <= most || color == [0; 3] && 2 * num_others < num;
                    let expected = is_none.then_some((color, num_others));
                    assert_eq!(found, expected, "{color:?}: {num_others} of {num}");
                }
            }
        }
    }
}

#[test]
fn what_is_alike_without_being_the_same_has_colors() {
    // Snow is overexposed except at some points.
    for share in [3, 30, 300] {
        let snow = |at: usize| if at % share == 1 { [250, (at % 200) as u16, 90] } else { [255; 3] };
        assert_eq!(blank(&(0..6000).map(snow).collect::<Vec<_>>()), None, "one in {share}");
    }
    let two: Vec<[u16; 3]> = (0..6000).map(|at| if at < 3500 { [65535; 3] } else { [9, 8, 7] }).collect();
    assert_eq!(blank(&two), None);
    // A single point tells nothing by being like all others.
    assert_eq!(blank(&[[9, 8, 7]]), None);
    assert_eq!(blank(&[]), None);
    assert!(blank(&[[0; 3]]).is_some());
}

/// A file with these colors, and what was decided about them.
fn colored(made: ScanBuilder, rgb: Vec<[u16; 3]>, stats: &Stats) -> ScanFile {
    let mut file = made.rgb(rgb).file();
    file.coloring = choose(stats, &file.points.rgb, None).coloring;
    file
}

/// Settles files of one color each, except at `num_others` points. Returns which files keep their colors, and the
/// number of warnings.
fn settled(colors: &[[u16; 3]], num_others: usize) -> (Vec<bool>, usize) {
    let tile = |rgb| {
        let (mut rgb, xyz) = (vec![rgb; 2000], vec![[0; 3]; 2000]);
        rgb[..num_others].fill([7, 6, 5]);
        let intensity: Vec<u16> = (0..2000).collect();
        let stats = Stats::of(&xyz, &intensity);
        colored(ScanBuilder::new(Grid::default(), xyz).intensity(intensity), rgb, &stats)
    };
    let mut scan = Scan::of(colors.iter().map(|&rgb| tile(rgb)).collect());
    settle(&mut scan);
    for file in &scan.files {
        let is_drawn = num_others > 0 || file.coloring.blank.is_none();
        assert_eq!(
            (file.coloring.source.white().is_some(), !file.points.rgb.is_empty()),
            (is_drawn, is_drawn)
        );
    }
    (scan.files.iter().map(|file| file.coloring.blank.is_none()).collect(), scan.warnings.len())
}

#[test]
fn single_colors_stay_where_they_tell_files_apart() {
    let (red, blue, white, black) = ([255, 0, 0], [0, 0, 65535], [65535; 3], [0; 3]);
    for num_others in [0, 1] {
        for color in [red, white, [1; 3]] {
            assert_eq!(settled(&[color], num_others), (vec![false], 1), "{color:?}");
            assert_eq!(settled(&[color, color], num_others), (vec![false; 2], 2), "{color:?}");
        }
        assert_eq!(settled(&[black], num_others), (vec![false], num_others));
        assert_eq!(settled(&[red, blue], num_others), (vec![true; 2], 0));
        let all = settled(&[red, blue, white, black], num_others);
        assert_eq!(all, (vec![true, true, false, false], 1 + num_others));
    }
}

/// A red mark beside a scan in color stays red; a white one is as good as none.
#[test]
fn a_single_color_stays_beside_files_in_color() {
    let in_color: Vec<[u16; 3]> = (0..2000).map(|i| [i % 256, i / 8, 90]).collect();
    for (color, stays) in [([255, 0, 0], true), ([255; 3], false)] {
        let file = |rgb| colored(ScanBuilder::new(Grid::default(), vec![[0; 3]; 2000]), rgb, &Stats::EMPTY);
        let mut scan = Scan::of(vec![file(in_color.clone()), file(vec![color; 2000])]);
        settle(&mut scan);
        let is_drawn =
            scan.files[1].coloring.blank.is_none() && scan.files[1].points.rgb == vec![color; 2000];
        assert_eq!((is_drawn, scan.files[0].coloring.blank), (stays, None), "{color:?}");
    }
}

#[test]
fn the_bits_of_a_few_colors_are_their_own() {
    let source = |blank: [u16; 3], other: [u16; 3]| {
        let mut rgb = vec![blank; 6000];
        rgb[4000] = other;
        choose(&Stats::EMPTY, &rgb, None).coloring.source
    };
    assert_eq!(source([65535; 3], [200, 10, 10]), ColorSource::Rgb8);
    assert_eq!(source([1; 3], [60_000, 200, 9]), ColorSource::Rgb16);
    assert_eq!(source([255; 3], [255, 255, 99]), ColorSource::Rgb8);
    assert_eq!(source([0; 3], [60_000, 200, 9]), ColorSource::Rgb16);
}

/// Points of which some are black, and the others have brightnesses of 255 that `bright` makes of numbers from 0 to 1.
fn partly_black(share: f64, bright: impl Fn(f64) -> f64, white: f64) -> Vec<[u16; 3]> {
    let part = |at: usize| {
        let hash = (at as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (hash >> 40) as f64 / (1u64 << 24) as f64
    };
    let color = |at: usize| {
        let gray = bright(part(at + 70_000));
        let channel = |c: usize| ((gray + 6.0 * part(3 * at + c) - 3.0) / 255.0).clamp(0.0, 1.0);
        [0, 1, 2].map(|c| (channel(c) * white).round() as u16)
    };
    (0..20_000).map(|at| if part(at) < share { [0; 3] } else { color(at) }).collect()
}

#[test]
fn black_beside_colors_is_the_lack_of_one_where_next_to_none_are_nearly_black() {
    for white in [255.0, 1023.0, 4095.0, 65535.0] {
        for share in [0.12, 0.3, 0.5, 0.7, 0.97] {
            for (name, bright) in [
                ("even", &(|u| 4.0 + 251.0 * u) as &dyn Fn(f64) -> f64),
                ("dark ones are frequent", &|u| 8.0 + 247.0 * u * u),
                ("bright", &|u| 120.0 + 135.0 * u),
            ] {
                let rgb = partly_black(share, bright, white);
                let found = blank(&rgb).unwrap_or_else(|| panic!("{white} {share} {name}"));
                let num_others = rgb.iter().filter(|rgb| **rgb != [0; 3]).count();
                assert_eq!((found.color, found.near, found.num_others), ([0; 3], 0, num_others));
            }
        }
    }
}

#[test]
fn the_black_of_a_dark_scene_is_a_color() {
    for white in [255.0, 1023.0, 4095.0, 65535.0] {
        for (name, bright) in [
            ("night", &(|u: f64| -12.0 * u.max(1e-9).ln()) as &dyn Fn(f64) -> f64),
            ("night with crushed blacks", &|u: f64| (-25.0 * u.max(1e-9).ln() - 9.0).max(0.0)),
            ("asphalt", &|u: f64| 14.0 + 22.0 * u),
            ("asphalt, black in its cracks", &|u: f64| (30.0 * u - 8.0).max(0.0)),
            ("high contrast", &|u: f64| (300.0 * u - 50.0).max(0.0)),
        ] {
            let rgb = partly_black(0.0, bright, white);
            assert_eq!(blank(&rgb), None, "{name}, {white}");
        }
        // A few black points among bright ones, such as those of a mask's edge, keep their color.
        assert_eq!(blank(&partly_black(0.05, |u| 60.0 + 195.0 * u, white)), None);
    }
}

#[test]
fn colors_that_nobody_can_tell_apart_are_none() {
    for (low, high) in [
        ([0; 3], [1; 3]),
        ([0; 3], [2, 1, 0]),
        ([254; 3], [255; 3]),
        ([100, 50, 3], [102, 51, 2]),
        ([65280; 3], [65535; 3]),
        ([65021; 3], [65535; 3]),
        ([4070; 3], [4095; 3]),
        ([30_000, 20_000, 0], [30_500, 19_500, 400]),
    ] {
        for num_low in [1, 30, 1000, 1999] {
            for num_wild in [0, 3] {
                let mut rgb: Vec<[u16; 3]> =
                    (0..2000).map(|at| if at * 7 % 2000 < num_low { low } else { high }).collect();
                rgb[..num_wild].fill([40_000, 7, 50_000]);
                let found = blank(&rgb).unwrap_or_else(|| panic!("{low:?} {high:?} {num_low} {num_wild}"));
                assert_eq!(found.num_others, num_wild, "{low:?} {high:?} {num_low}");
            }
        }
    }
    // Colors that can barely be told apart are colors.
    for (low, high) in [([0; 3], [0, 0, 6]), ([65535; 3], [65535, 65535, 64000]), ([10; 3], [16, 10, 10])] {
        let rgb: Vec<[u16; 3]> = (0..2000).map(|at| if at % 2 == 0 { low } else { high }).collect();
        assert!(blank(&rgb).is_none_or(|blank| blank.near == 0), "{low:?} {high:?}");
    }
    // Files whose single colors cannot be told apart are not told apart by them.
    assert_eq!(settled(&[[200, 10, 10], [201, 11, 10]], 0), (vec![false; 2], 2));
    assert_eq!(settled(&[[200, 10, 10], [190, 11, 10]], 0), (vec![true; 2], 0));
}

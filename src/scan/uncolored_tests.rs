//! Tests of which points have no color, and what is done about them.

use super::*;
use crate::scan::color::source;
use crate::scan::{Lattice, Points};
use glam::DVec3;

fn filled(color: ColorSource, intensity: Vec<u16>) -> Vec<[u16; 3]> {
    let xyz = (0..5).map(|z| [0, 0, z]).collect();
    let rgb = vec![[0; 3], [0; 3], [9, 0, 0], [0; 3], [0; 3]];
    let points = Points { xyz, rgb, intensity, ..Points::default() };
    let lattice = Lattice { scale: DVec3::splat(-0.5), offset: DVec3::ZERO };
    let blank = Some(Blank { color: [0; 3], num_others: 1, by_intensity: false });
    let mut file = ScanFile { lattice, points, color, blank, ..ScanFile::default() };
    fill_with_grey(&mut file);
    file.points.rgb
}

#[test]
fn black_points_are_grey_by_intensity_or_height_and_colored_ones_stay() {
    let by_intensity = filled(ColorSource::Rgb8, vec![100, 300, 0, 500, 900]);
    assert_eq!(by_intensity, [[78; 3], [106; 3], [9, 0, 0], [135; 3], [191; 3]]);
    // Heights fall along this file, and the sixteen bits are filled.
    let by_height = filled(ColorSource::Rgb16, vec![7; 5]);
    assert_eq!(by_height, [[49151; 3], [40959; 3], [9, 0, 0], [24576; 3], [16384; 3]]);
    assert_eq!(filled(ColorSource::Rgb12, vec![])[0], [3071; 3]);
    assert_eq!(filled(ColorSource::default(), vec![]), [[0; 3], [0; 3], [9, 0, 0], [0; 3], [0; 3]]);
}

fn blank(rgb: &[[u16; 3]]) -> Option<Blank> {
    Blank::of(&Stats::of(&[], rgb, &[]), rgb)
}

#[test]
fn a_color_that_all_points_have_or_all_but_a_few_is_none() {
    for color in
        [[0; 3], [1; 3], [255; 3], [1023; 3], [65535; 3], [128; 3], [200, 10, 10], [65535, 65535, 65534]]
    {
        for (num, most) in [(2, 0), (99, 0), (100, 1), (500, 3), (6000, 12), (100_000, 200)] {
            for num_others in [0, 1, most, most + 1, 2 * most + 1] {
                // The last of the file, and one now and then.
                let step = num / num_others.max(1);
                let spread = |at: usize| at % step == step / 2 && at / step < num_others;
                let last = |at: usize| at >= num - num_others;
                for is_other in [&spread as &dyn Fn(usize) -> bool, &last] {
                    let other = color.map(|c: u16| c ^ 1);
                    let rgb: Vec<[u16; 3]> =
                        (0..num).map(|at| if is_other(at) { other } else { color }).collect();
                    let found = blank(&rgb).map(|blank| (blank.color, blank.num_others));
                    // Black is none, too, where many points are something else.
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
    // Snow: overexposed but for some points.
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

/// Files of one color each, but for `num_others` points: which of them keep their colors, and how many warnings there are.
fn settled(colors: &[[u16; 3]], num_others: usize) -> (Vec<bool>, usize) {
    let tile = |rgb| {
        let (mut rgb, xyz) = (vec![rgb; 2000], vec![[0; 3]; 2000]);
        rgb[..num_others].fill([7, 6, 5]);
        let intensity: Vec<u16> = (0..2000).collect();
        let stats = Stats::of(&xyz, &rgb, &intensity);
        let blank = Blank::of(&stats, &rgb);
        let color = source(&stats, &mut rgb, blank).0;
        ScanFile {
            blank,
            color,
            points: Points { xyz, rgb, intensity, ..Points::default() },
            ..ScanFile::default()
        }
    };
    let mut scan = Scan { files: colors.iter().map(|&rgb| tile(rgb)).collect(), ..Scan::default() };
    settle(&mut scan);
    for file in &scan.files {
        let is_drawn = num_others > 0 || file.blank.is_none();
        assert_eq!((file.color.white().is_some(), !file.points.rgb.is_empty()), (is_drawn, is_drawn));
    }
    (scan.files.iter().map(|file| file.blank.is_none()).collect(), scan.warnings.len())
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

#[test]
fn the_bits_of_a_few_colors_are_their_own() {
    let source = |blank: [u16; 3], other: [u16; 3]| {
        let mut rgb = vec![blank; 6000];
        rgb[4000] = other;
        let stats = Stats::of(&[], &rgb, &[]);
        let blank = Blank::of(&stats, &rgb);
        source(&stats, &mut rgb, blank).0
    };
    assert_eq!(source([65535; 3], [200, 10, 10]), ColorSource::Rgb8);
    assert_eq!(source([65535; 3], [65535, 65535, 65534]), ColorSource::Rgb16);
    assert_eq!(source([1; 3], [60_000, 200, 9]), ColorSource::Rgb16);
    assert_eq!(source([255; 3], [255, 255, 254]), ColorSource::Rgb8);
    assert_eq!(source([0; 3], [60_000, 200, 9]), ColorSource::Rgb16);
}

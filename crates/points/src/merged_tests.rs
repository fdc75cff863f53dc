//! Tests of finding merged files, and of the colors that are made of them.

use super::*;
use crate::coloring::{Raise, Raised};

/// A number from 0 to 1 that looks irregular: a multiplicative hash.
fn part(at: usize) -> f64 {
    let hash = (at as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (hash >> 40) as f64 / (1u64 << 24) as f64
}

/// Colors of a scene, from 0 to 1; dark ones are frequent, and the brightest are cut off.
fn scene(num_points: usize, darkness: f64) -> Vec<[f64; 3]> {
    let channel = |at: usize| (part(at).powi(2) * 1.1).min(1.0) * darkness;
    (0..num_points).map(|at| [3 * at, 3 * at + 1, 3 * at + 2].map(channel)).collect()
}

fn written(scene: &[[f64; 3]], white: u16) -> Vec<[u16; 3]> {
    scene.iter().map(|rgb| rgb.map(|c| (c * f64::from(white)).round() as u16)).collect()
}

fn runs(rgb: &[[u16; 3]], white: u16) -> Runs {
    let mut runs = Runs::NONE;
    let peaks: Vec<u16> = rgb.iter().map(peak_of).collect();
    peaks.as_chunks().0.iter().for_each(|run| runs.add(run, white));
    runs
}

/// The colors that are drawn if those whose white is `low` are made as bright as the others.
fn raise(rgb: &mut [[u16; 3]], low: u16, high: u16, told_by: ToldBy) {
    let points = of_lesser_white(rgb.len(), |at| rgb[at], low, told_by);
    let mut raised = Raised::default();
    points.into_iter().for_each(|points| raised.add(Raise { low, high, points }));
    rgb.iter_mut().enumerate().for_each(|(at, rgb)| *rgb = raised.color(at, *rgb));
}

const WHITES: [u16; 4] = [255, 1023, 4095, 65535];

#[test]
fn tiles_of_fewer_bits_are_told_from_those_of_more_and_made_as_bright() {
    for (low, high) in WHITES.into_iter().flat_map(|low| WHITES.map(|high| (low, high))) {
        if low >= high {
            continue;
        }
        for darkness in [1.0, 0.9] {
            let all = scene(20_000, darkness);
            let right = written(&all, high);
            for (from, to) in
                [(0, 2000), (0, 10_000), (3000, 5000), (10_000, 20_000), (2000, 20_000), (18_111, 20_000)]
            {
                for black in [usize::MAX, 3, 2] {
                    let what = format!("{from} to {to} of {low}, others of {high}, {darkness}, {black}");
                    let mut rgb = right.clone();
                    rgb[from..to].copy_from_slice(&written(&all[from..to], low));
                    // The file has one wrong value, and points without a color.
                    rgb[from + 500] = [low + 45, 7, 7];
                    rgb.iter_mut().step_by(black).for_each(|rgb| *rgb = [0; 3]);
                    assert!(runs(&rgb, low).are_merged(), "{what}: {:?}", runs(&rgb, low));
                    raise(&mut rgb, low, high, ToldBy::Tiles);
                    let is_off = |(a, b): &(&[u16; 3], &[u16; 3])| {
                        let step = f64::from(high) / f64::from(low);
                        **a != [0; 3] && (0..3).any(|c| f64::from(a[c].abs_diff(b[c])) > 0.6 * step)
                    };
                    let num_off = rgb.iter().zip(&right).filter(is_off).count();
                    // A few dark points at a tile's end may be taken for those of the other tile.
                    assert!(num_off <= 1 + 40, "{what}: {num_off} are wrong");
                }
            }
        }
    }
}

#[test]
fn points_that_exceed_the_lesser_white_keep_their_own() {
    let mut rgb = [[255, 7, 0], [256, 7, 0], [65535; 3]];
    raise(&mut rgb, 255, 65535, ToldBy::Points);
    assert_eq!(rgb, [[65535, 7 * 257, 0], [256, 7, 0], [65535; 3]]);
    let unknown = rgb;
    raise(&mut rgb, 4095, 65535, ToldBy::Unknown);
    assert_eq!(rgb, unknown);
}

#[test]
fn what_has_one_white_is_not_merged() {
    for white in WHITES {
        let is_merged =
            |rgb: &[[u16; 3]]| WHITES[..3].iter().any(|&low| low < white && runs(rgb, low).are_merged());
        for darkness in [1.0, 0.5, 0.2, 0.06] {
            assert!(!is_merged(&written(&scene(20_000, darkness), white)), "{white} {darkness}");
        }
        // Parts of a scene are dark, and light changes slowly or at once; from white to a 256th of it.
        for length in [64, 256, 1000, 5000] {
            for sharp in [false, true] {
                let stops = |at: usize| 8.0 * part(at / length + 7);
                let light = |at: usize| {
                    let next = if sharp { 0.0 } else { (at % length) as f64 / length as f64 };
                    (-(stops(at) * (1.0 - next) + stops(at + length) * next)).exp2()
                };
                let lit: Vec<[f64; 3]> = scene(100_000, 1.0)
                    .iter()
                    .enumerate()
                    .map(|(at, rgb)| rgb.map(|c| c * light(at)))
                    .collect();
                assert!(!is_merged(&written(&lit, white)), "{white} {length} {sharp}");
            }
        }
        // A dark room comes before a light one; its colors thin out.
        for stops in 0..40 {
            let light = (-0.25 * f64::from(stops)).exp2();
            let mut rgb = written(&scene(20_000, 1.0), white);
            for (at, rgb) in rgb.iter_mut().enumerate().take(9000) {
                let bright = |at: usize| -0.4 * part(at).max(1e-6).ln();
                *rgb = [0, 1, 2].map(|c| ((bright(3 * at + c) * light).min(1.0) * f64::from(white)) as u16);
            }
            assert!(!is_merged(&rgb), "{white}, {light}");
        }
        // The scene has a dark material of one shade.
        for shade in [190, 220, 800, 3000, 3700] {
            let asphalt = |at: usize| {
                [at, at + 1, at + 2].map(|i| shade + (f64::from(shade) * 0.2 * part(3 * i)) as u16)
            };
            let mut rgb = written(&scene(20_000, 1.0), white);
            (5000..9000).for_each(|at| rgb[at] = asphalt(at));
            assert!(!is_merged(&rgb), "{white} {shade}");
            // A darker material follows it.
            (9000..14_000).for_each(|at| rgb[at] = asphalt(at).map(|c| c / 7));
            assert!(!is_merged(&rgb), "{white} {shade}, and a darker one");
        }
    }
}

//! Tests of how bright white is.

use super::*;

/// Colors of a scene: what 16-bit channels would be, `darkness` of full brightness at most, some of it cut off.
fn scene(num_points: usize, darkness: f64) -> Vec<[f64; 3]> {
    let channel = |at: usize| {
        // Anything that is not regular: a multiplicative hash.
        let hash = (at as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let u = (hash >> 40) as f64 / (1u64 << 24) as f64;
        // Dark values are frequent, and the brightest twentieth is cut off.
        (u * u * 1.1).min(1.0) * darkness
    };
    (0..num_points).map(|at| [3 * at, 3 * at + 1, 3 * at + 2].map(channel)).collect()
}

/// How a program writes a channel of 0 to 1.
type Writer = (&'static str, fn(f64) -> u16, u16);

const WRITERS: [Writer; 6] = [
    ("8 bits", |c| (c * 255.0).round() as u16, 255),
    ("10 bits", |c| (c * 1023.0).round() as u16, 1023),
    ("12 bits", |c| (c * 4095.0).round() as u16, 4095),
    ("16 bits", |c| (c * 65535.0).round() as u16, 65535),
    ("8 bits in the high byte", |c| (c * 255.0).round() as u16 * 256, 65535),
    ("8 bits repeated", |c| (c * 255.0).round() as u16 * 257, 65535),
];

fn written(scene: &[[f64; 3]], write: fn(f64) -> u16) -> Vec<[u16; 3]> {
    scene.iter().map(|rgb| rgb.map(write)).collect()
}

/// Counted in blocks, as the readers do.
fn counts(rgb: &[[u16; 3]]) -> ColorCounts {
    rgb.chunks(1000).map(ColorCounts::of).fold(ColorCounts::NONE, ColorCounts::union)
}

/// Every `step`-th point gets `color`.
fn spoilt(mut rgb: Vec<[u16; 3]>, step: usize, color: impl Fn(usize) -> [u16; 3]) -> Vec<[u16; 3]> {
    (step / 2..rgb.len()).step_by(step).for_each(|at| rgb[at] = color(at));
    rgb
}

#[test]
fn the_white_is_that_of_the_writer_whatever_the_outliers_the_darkness_and_the_share_of_black() {
    let num_points = 20_000;
    for (name, write, white) in WRITERS {
        // Down to what the next smaller white could be, too.
        let darkest = if white == 65535 { 0.1 } else { 0.5 };
        for darkness in [1.0, 0.7, darkest] {
            for black in [0, 2, 10, 50] {
                for outliers in [usize::MAX / 2, num_points, 1000] {
                    let mut rgb = written(&scene(num_points, darkness), write);
                    // All but every `black`-th point.
                    rgb.iter_mut()
                        .enumerate()
                        .filter(|(at, _)| black > 0 && at % black > 0)
                        .for_each(|(_, p)| *p = [0; 3]);
                    let rgb =
                        spoilt(rgb, outliers, |at| [0, 1, 2].map(|c| (at * 40_503 + c * 17_321) as u16));
                    let found = counts(&rgb).white();
                    let case = format!("{name}, darkness {darkness}, black {black}, outliers {outliers}");
                    assert_eq!(found, White::One(white), "{case}");
                }
            }
        }
    }
}

#[test]
fn one_256_among_8_bits_is_wrong_and_many_are_not() {
    let rgb = written(&scene(6000, 1.0), WRITERS[0].1);
    assert_eq!(counts(&spoilt(rgb.clone(), 6000, |_| [256; 3])).white(), White::One(255));
    assert_eq!(counts(&spoilt(rgb, 10, |_| [40_000; 3])).white(), White::Two);
}

#[test]
fn a_dark_scan_of_16_bits_with_highlights_is_not_12_bits() {
    // An exponential tail: one value in 500 is above 4095.
    let dark = |at: usize| {
        let hash = (at as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (-659.0 * ((hash >> 40) as f64 / (1u64 << 24) as f64).max(1e-9).ln()) as u16
    };
    let rgb: Vec<[u16; 3]> = (0..20_000).map(|at| [3 * at, 3 * at + 1, 3 * at + 2].map(dark)).collect();
    assert_eq!(counts(&rgb).white(), White::One(65535));
    // Dark to the last byte: what is made of bytes is of 16 bits.
    let dim = written(&scene(20_000, 0.01), WRITERS[5].1);
    assert!(dim.iter().flatten().all(|&c| c < 1023));
    assert_eq!(counts(&dim).white(), White::One(65535));
}

#[test]
fn merged_files_have_two_whites() {
    for darkness in [1.0, 0.5, 0.2] {
        for (eight, sixteen) in [(6000, 14_000), (10_000, 10_000), (19_000, 1000)] {
            for writer in [3, 4, 5] {
                let mut rgb = written(&scene(eight, darkness), WRITERS[0].1);
                rgb.extend(written(&scene(sixteen, darkness), WRITERS[writer].1));
                assert_eq!(
                    counts(&rgb).white(),
                    White::Two,
                    "{eight}, {sixteen}, {darkness}, {}",
                    WRITERS[writer].0
                );
            }
        }
    }
}

#[test]
fn a_small_part_of_the_other_bits_is_seen() {
    let all = 20_000;
    for darkness in [1.0, 0.9] {
        for share in [0.01, 0.02, 0.05, 0.1] {
            let few = (share * f64::from(all)) as usize;
            for writer in [3, 4, 5] {
                for (eight, sixteen) in [(few, all as usize - few), (all as usize - few, few)] {
                    let mut rgb = written(&scene(eight, darkness), WRITERS[0].1);
                    rgb.extend(written(&scene(sixteen, darkness), WRITERS[writer].1));
                    // As one tile behind the other, and all among each other.
                    let case = format!("{eight}, {sixteen}, {darkness}, {}", WRITERS[writer].0);
                    assert_eq!(counts(&rgb).white(), White::Two, "{case}");
                    let mixed: Vec<[u16; 3]> = (0..rgb.len()).map(|at| rgb[at * 7919 % rgb.len()]).collect();
                    assert_eq!(counts(&mixed).white(), White::Two, "{case}, mixed");
                }
            }
        }
    }
}

#[test]
fn the_noise_of_black_is_no_second_distribution() {
    // splitmix64.
    let part = |at: usize| {
        let z = (at as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((z ^ z >> 31) >> 40) as f64 / (1u64 << 24) as f64).max(1e-9)
    };
    for share in [2, 4, 8] {
        for width in [20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 150.0, 200.0, 300.0] {
            // The brightest of three channels of noise, thinning out as a bell does or as an exponential.
            let bell = |at: usize| {
                width
                    * (-2.0 * part(at).ln()).sqrt()
                    * (std::f64::consts::TAU * part(at + 99_991)).cos().abs()
            };
            let exponential = |at: usize| -width * part(at).ln();
            for (name, noise) in [("bell", &bell as &dyn Fn(usize) -> f64), ("exponential", &exponential)] {
                let mut rgb = written(&scene(20_000, 1.0), WRITERS[3].1);
                rgb.iter_mut().for_each(|rgb| *rgb = rgb.map(|c| c.max(3000)));
                let rgb = spoilt(rgb, 100 / share, |at| [0, 1, 2].map(|c| noise(3 * at + c) as u16));
                assert_eq!(counts(&rgb).white(), White::One(65535), "{name} of {width}, {share} %");
            }
        }
    }
}

#[test]
fn whites_that_were_rounded_up_are_8_bits() {
    for step in [2000, 200, 50, 20] {
        let rgb = written(&scene(20_000, 1.0), WRITERS[0].1);
        let rgb = spoilt(rgb, step, |at| [256, 250, 256 + at as u16 % 3]);
        assert_eq!(counts(&rgb).white(), White::One(255), "every {step}th");
    }
}

#[test]
fn a_handful_of_points_is_believed() {
    for (rgb, white) in [
        (vec![[1, 2, 255]], 255),
        (vec![[65535, 7, 0]], 65535),
        (vec![[257, 514, 65535]], 65535),
        (vec![[10, 20, 30], [60_000, 1, 2]], 65535),
    ] {
        assert_eq!(counts(&rgb).white(), White::One(white), "{rgb:?}");
    }
}

#[test]
fn blocks_count_as_the_whole() {
    let rgb = written(&scene(9_999, 1.0), WRITERS[3].1);
    // Runs end where their block does.
    let without_runs = |counts| ColorCounts { runs: Runs::NONE, ..counts };
    assert_eq!(without_runs(counts(&rgb)), without_runs(ColorCounts::of(&rgb)));
    assert_ne!(counts(&rgb), ColorCounts::of(&rgb[1..]));
}

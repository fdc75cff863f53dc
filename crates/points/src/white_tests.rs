//! Tests of how bright white is.

use super::*;

/// Colors of a scene, from 0 to `darkness`, of which some are cut off.
fn scene(num_points: usize, darkness: f64) -> Vec<[f64; 3]> {
    let channel = |at: usize| {
        // `u` looks irregular: a multiplicative hash.
        let hash = (at as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let u = (hash >> 40) as f64 / (1u64 << 24) as f64;
        // Dark values are frequent, and the brightest twentieth is cut off.
        (u * u * 1.1).min(1.0) * darkness
    };
    (0..num_points).map(|at| [3 * at, 3 * at + 1, 3 * at + 2].map(channel)).collect()
}

/// How a program writes a channel of 0 to 1.
type ChannelWriter = (&'static str, fn(f64) -> u16, u16);

const WRITERS: [ChannelWriter; 6] = [
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

fn white(rgb: &[[u16; 3]]) -> White {
    White::of(&Distribution::of(rgb))
}

/// True if points of these two whites were found.
fn are_two(rgb: &[[u16; 3]], low: u16, high: u16) -> bool {
    matches!(white(rgb), White::Two { low: l, high: h, .. } if (l, h) == (low, high))
}

/// Every `step`-th point gets `color`.
fn spoilt(mut rgb: Vec<[u16; 3]>, step: usize, color: impl Fn(usize) -> [u16; 3]) -> Vec<[u16; 3]> {
    (step / 2..rgb.len()).step_by(step).for_each(|at| rgb[at] = color(at));
    rgb
}

#[test]
fn the_white_is_that_of_the_writer_whatever_the_outliers_the_darkness_and_the_share_of_black() {
    let num_points = 20_000;
    for (name, write, right) in WRITERS {
        // The darkest scene could be of the next smaller white, too.
        let darkest = if right == 65535 { 0.1 } else { 0.5 };
        for darkness in [1.0, 0.7, darkest] {
            for black in [0, 2, 10, 50] {
                for outliers in [usize::MAX / 2, num_points, 1000] {
                    let mut rgb = written(&scene(num_points, darkness), write);
                    // All points become black except every `black`-th.
                    rgb.iter_mut()
                        .enumerate()
                        .filter(|(at, _)| black > 0 && at % black > 0)
                        .for_each(|(_, p)| *p = [0; 3]);
                    let rgb =
                        spoilt(rgb, outliers, |at| [0, 1, 2].map(|c| (at * 40_503 + c * 17_321) as u16));
                    let found = white(&rgb);
                    let case = format!("{name}, darkness {darkness}, black {black}, outliers {outliers}");
                    assert_eq!(found, White::One(right), "{case}");
                }
            }
        }
    }
}

#[test]
fn one_256_among_8_bits_is_wrong_and_many_are_not() {
    let rgb = written(&scene(6000, 1.0), WRITERS[0].1);
    assert_eq!(white(&spoilt(rgb.clone(), 6000, |_| [256; 3])), White::One(255));
    assert!(are_two(&spoilt(rgb, 10, |_| [40_000; 3]), 255, 65535));
}

#[test]
fn a_dark_scan_of_16_bits_with_highlights_is_not_12_bits() {
    // An exponential tail: one value in 500 is above 4095.
    let dark = |at: usize| {
        let hash = (at as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (-659.0 * ((hash >> 40) as f64 / (1u64 << 24) as f64).max(1e-9).ln()) as u16
    };
    let rgb: Vec<[u16; 3]> = (0..20_000).map(|at| [3 * at, 3 * at + 1, 3 * at + 2].map(dark)).collect();
    assert_eq!(white(&rgb), White::One(65535));
    // Colors made of bytes are of 16 bits, however dark.
    let dim = written(&scene(20_000, 0.01), WRITERS[5].1);
    assert!(dim.iter().flatten().all(|&c| c < 1023));
    assert_eq!(white(&dim), White::One(65535));
}

#[test]
fn merged_files_have_two_whites() {
    for darkness in [1.0, 0.5, 0.2] {
        for (eight, sixteen) in [(6000, 14_000), (10_000, 10_000), (19_000, 1000)] {
            for writer in [3, 4, 5] {
                let mut rgb = written(&scene(eight, darkness), WRITERS[0].1);
                rgb.extend(written(&scene(sixteen, darkness), WRITERS[writer].1));
                let case = format!("{eight}, {sixteen}, {darkness}, {}", WRITERS[writer].0);
                assert!(are_two(&rgb, 255, 65535), "{case}: {:?}", white(&rgb));
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
                    // Points come as one tile behind the other, then mixed.
                    let case = format!("{eight}, {sixteen}, {darkness}, {}", WRITERS[writer].0);
                    assert!(are_two(&rgb, 255, 65535), "{case}: {:?}", white(&rgb));
                    let mixed: Vec<[u16; 3]> = (0..rgb.len()).map(|at| rgb[at * 7919 % rgb.len()]).collect();
                    assert!(are_two(&mixed, 255, 65535), "{case}, mixed: {:?}", white(&mixed));
                }
            }
        }
    }
}

#[test]
fn the_noise_of_black_is_no_second_distribution() {
    // The hash is splitmix64.
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
                assert_eq!(white(&rgb), White::One(65535), "{name} of {width}, {share} %");
            }
        }
    }
}

#[test]
fn whites_that_were_rounded_up_are_8_bits() {
    for step in [2000, 200, 50, 20] {
        let rgb = written(&scene(20_000, 1.0), WRITERS[0].1);
        let rgb = spoilt(rgb, step, |at| [256, 250, 256 + at as u16 % 3]);
        assert_eq!(white(&rgb), White::One(255), "every {step}th");
    }
}

#[test]
fn a_handful_of_points_is_believed() {
    for (rgb, right) in [
        (vec![[1, 2, 255]], 255),
        (vec![[65535, 7, 0]], 65535),
        (vec![[257, 514, 65535]], 65535),
        (vec![[10, 20, 30], [60_000, 1, 2]], 65535),
    ] {
        assert_eq!(white(&rgb), White::One(right), "{rgb:?}");
    }
}

/// The points in an order that has nothing to do with them.
fn shuffled(rgb: &[[u16; 3]]) -> Vec<[u16; 3]> {
    (0..rgb.len()).map(|at| rgb[at * 7919 % rgb.len()]).collect()
}

/// A white, and how a program writes a channel of 0 to 1 with it.
type Bits = (u16, fn(f64) -> u16);

const BITS: [Bits; 4] =
    [(255, WRITERS[0].1), (1023, WRITERS[1].1), (4095, WRITERS[2].1), (65535, WRITERS[3].1)];

#[test]
fn two_whites_are_found_whichever_they_are_and_however_they_are_merged() {
    for (at, (low, write_low)) in BITS.into_iter().enumerate() {
        for (high, write_high) in BITS.into_iter().skip(at + 1) {
            for (num_low, num_high) in [(10_000, 10_000), (14_000, 6000), (6000, 14_000), (18_000, 2000)] {
                let all = scene(num_low + num_high, 1.0);
                let mut rgb = written(&all[..num_low], write_low);
                rgb.extend(written(&all[num_low..], write_high));
                let case = format!("{num_low} of {low}, {num_high} of {high}");
                let tiles = White::Two { low, high, told_by: ToldBy::Tiles };
                assert!(
                    white(&rgb) == tiles || low == 255 && high == 65535 && are_two(&rgb, low, high),
                    "{case}: {:?}",
                    white(&rgb)
                );
                let rgb = shuffled(&rgb);
                assert!(are_two(&rgb, low, high), "{case}, shuffled: {:?}", white(&rgb));
            }
        }
    }
}

#[test]
fn single_points_do_not_tell_their_white_where_dark_ones_may_be_of_either() {
    let told_by = |low: fn(f64) -> u16, high: fn(f64) -> u16, gray: bool| {
        let tone = |rgb: [f64; 3]| if gray { [rgb[0].sqrt(); 3] } else { rgb };
        let all: Vec<[f64; 3]> = scene(20_000, 1.0).into_iter().map(tone).collect();
        let mut rgb = written(&all[..10_000], low);
        rgb.extend(written(&all[10_000..], high));
        match white(&shuffled(&rgb)) {
            White::Two { told_by, .. } => told_by,
            White::One(white) => panic!("{white}"),
        }
    };
    // Few points are dark in all channels, if these have nothing to do with each other.
    assert_eq!(told_by(BITS[0].1, BITS[2].1, false), ToldBy::Points);
    assert_eq!(told_by(BITS[0].1, BITS[3].1, true), ToldBy::Points);
    assert_eq!(told_by(BITS[0].1, BITS[1].1, true), ToldBy::Unknown);
    assert_eq!(told_by(BITS[0].1, BITS[2].1, true), ToldBy::Unknown);
}

#[test]
fn wild_values_far_above_leave_the_others_as_bright_as_they_are() {
    for (at, (low, write)) in BITS.into_iter().take(3).enumerate() {
        for darkness in [1.0, 0.95, 0.8] {
            for step in [25, 50, 100, 300] {
                let rgb = written(&scene(20_000, darkness), write);
                let wild = |at: usize| [0, 1, 2].map(|c| ((at + 1) * 40_503 + c * 17_321) as u16);
                let rgb = spoilt(rgb, step, wild);
                let right = White::Two { low, high: 65535, told_by: ToldBy::Points };
                assert_eq!(white(&rgb), right, "{low} ({at}), darkness {darkness}, every {step}th");
            }
        }
    }
}

#[test]
fn a_scene_of_one_white_stays_of_one() {
    // The hash is splitmix64.
    let part = |at: usize| {
        let z = (at as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((z ^ z >> 31) >> 40) as f64 / (1u64 << 24) as f64).max(1e-9)
    };
    let bell = |at: usize| (-2.0 * part(at).ln()).sqrt() * (std::f64::consts::TAU * part(at + 99_991)).cos();
    // A dark material has a shade near the lesser whites and a spread of its own; the scene around it is bright or dim.
    for (bits, shades) in [
        (1, &[150.0, 190.0, 230.0, 250.0][..]),
        (2, &[150.0, 190.0, 230.0, 250.0, 700.0, 900.0, 1000.0]),
        (3, &[700.0, 900.0, 1000.0, 2800.0, 3300.0, 3700.0, 4000.0]),
    ] {
        let (right, write) = BITS[bits];
        for share in [20, 50, 80] {
            for shade in shades {
                for spread in [0.05, 0.1, 0.2, 0.5] {
                    for darkness in [1.0, 0.6] {
                        let mut rgb = written(&scene(20_000, darkness), write);
                        (0..rgb.len()).filter(|at| at * 37 % 100 < share).for_each(|at| {
                            let gray = shade * (1.0 + spread * bell(at));
                            rgb[at] =
                                [0, 1, 2].map(|c| (gray * (1.0 + 0.02 * bell(3 * at + c + 50_000))) as u16);
                        });
                        let case = format!("{share} % of {shade} ± {spread} of {right}, darkness {darkness}");
                        assert_eq!(white(&rgb), White::One(right), "{case}");
                    }
                }
            }
        }
    }
    // The scene is a night with lamps in it.
    for scale in [250.0, 400.0, 659.0, 1200.0, 3000.0] {
        for step in [20, 50, 100, 1000] {
            let night = |at: usize| [0, 1, 2].map(|c| (-scale * part(3 * at + c).ln()).min(65535.0) as u16);
            let rgb: Vec<[u16; 3]> = (0..20_000).map(night).collect();
            let lamp = |at: usize| [0, 1, 2].map(|c| (20_000.0 + 45_535.0 * part(3 * at + c + 7)) as u16);
            let found = white(&spoilt(rgb, step, lamp));
            assert!(matches!(found, White::One(_)), "{scale}, a lamp in {step}: {found:?}");
        }
    }
}

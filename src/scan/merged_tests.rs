//! Tests of which files were merged, and of what is made of them.

use super::*;

/// Anything from 0 to 1 that is not regular: a multiplicative hash.
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

fn runs(rgb: &[[u16; 3]]) -> Runs {
    // In blocks, as the readers do.
    let block = |rgb: &[[u16; 3]]| {
        let mut runs = Runs::NONE;
        runs.add(&rgb.iter().map(|rgb| rgb[0].max(rgb[1]).max(rgb[2])).collect::<Vec<_>>());
        runs
    };
    rgb.chunks(2730).map(block).fold(Runs::NONE, Runs::union)
}

#[test]
fn tiles_of_8_bits_are_told_from_those_of_more_and_made_as_bright() {
    for white in [1023, 4095, 65535] {
        for darkness in [1.0, 0.8] {
            let all = scene(20_000, darkness);
            let right = written(&all, white);
            for (from, to) in
                [(0, 2000), (0, 10_000), (3000, 5000), (10_000, 20_000), (2000, 20_000), (18_111, 20_000)]
            {
                let what = format!("{from} to {to} of 8 bits, others of {white}, {darkness}");
                let mut rgb = right.clone();
                rgb[from..to].copy_from_slice(&written(&all[from..to], 255));
                // One wrong value.
                rgb[from + 500] = [300, 7, 7];
                assert!(runs(&rgb).are_merged(), "{what}: {:?}", runs(&rgb));
                raise(&mut rgb, white);
                let is_off = |(a, b): &(&[u16; 3], &[u16; 3])| {
                    let step = f64::from(white) / 255.0;
                    (0..3).any(|c| f64::from(a[c].abs_diff(b[c])) > 0.6 * step)
                };
                let num_off = rgb.iter().zip(&right).filter(is_off).count();
                // Where a tile ends, a few dark points may be taken for those of the other.
                assert!(num_off <= 1 + 40, "{what}: {num_off} are wrong");
            }
        }
    }
}

#[test]
fn what_has_one_white_is_not_merged() {
    for white in [255, 1023, 4095, 65535] {
        for darkness in [1.0, 0.5, 0.2, 0.06] {
            assert!(!runs(&written(&scene(20_000, darkness), white)).are_merged(), "{white} {darkness}");
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
                let runs = runs(&written(&lit, white));
                assert!(!runs.are_merged(), "{white} {length} {sharp}: {runs:?}");
            }
        }
        // A dark material of one shade.
        let asphalt = |at: usize| [at, at + 1, at + 2].map(|i| 190 + (40.0 * part(3 * i)) as u16);
        let mut rgb = written(&scene(20_000, 1.0), white);
        (5000..9000).for_each(|at| rgb[at] = asphalt(at));
        assert!(!runs(&rgb).are_merged(), "{white}");
    }
}

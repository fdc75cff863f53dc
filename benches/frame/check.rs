//! Whether the comparison is fair: all contestants draw the same picture. Checked at full precision, since
//! renderers for one eye may need fewer bits than one for both, and hardware points have them all.

use crate::contestant::{Compute, Contestant, Hardware};
use anyhow::{Result, ensure};
use scanwalk::space::View;
use scanwalk::twin::resolve::depth_of;

/// Share of the pixels on which hardware and compute must agree. They cannot on all: hardware snaps points to
/// 1/256 of a pixel, so that about one in 130 falls into the pixel beside.
const MIN_AGREEMENT: f64 = 0.99;
/// Depths that differ by less than this share are the same.
const TOLERANCE: f32 = 1e-3;

/// Draws one frame with each and compares; gives the share of pixels that `hardware` agrees on.
pub fn pictures(
    stereo: &mut Compute,
    singles: &mut Compute,
    hardware: &mut Hardware,
    view: &View,
) -> Result<f64> {
    for compute in [&mut *stereo, &mut *singles] {
        compute.set_full_precision(true)?;
        compute.draw(view)?;
        compute.set_full_precision(false)?;
    }
    hardware.draw(view)?;

    let [left, right] = stereo.pixels()?;
    ensure!(singles.pixels()? == [left.clone(), right.clone()], "two single eyes differ from a stereo frame");
    // The comparison can fail: the eyes see different pictures.
    ensure!(left != right, "both eyes see the same");

    let depth = |key: u64| depth_of([(key >> 32) as u32, 0]);
    let depths = [left, right].map(|keys| keys.into_iter().map(depth).collect::<Vec<f32>>());
    let other = [hardware.depths(0, view.near)?, hardware.depths(1, view.near)?];
    let share = agreement(&depths[0], &other[0]).min(agreement(&depths[1], &other[1]));
    ensure!(
        share > MIN_AGREEMENT,
        "hardware points agree on {:.2} % of the pixels' depths only",
        100.0 * share
    );
    let crossed = agreement(&depths[0], &other[1]);
    ensure!(crossed < MIN_AGREEMENT, "even the wrong eye agrees on {:.2} %", 100.0 * crossed);
    Ok(share)
}

/// Share of pixels with the same depth, or empty in both.
fn agreement(a: &[f32], b: &[f32]) -> f64 {
    let same = |(a, b): &(&f32, &f32)| a == b || (*a - *b).abs() < TOLERANCE * a.min(**b);
    a.iter().zip(b).filter(same).count() as f64 / a.len() as f64
}

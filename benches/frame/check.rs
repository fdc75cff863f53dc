//! Checks that the comparison is fair: contestants that claim to draw the same picture do.

use crate::contestant::StereoContestant;
use anyhow::{Result, ensure};
use base::space::View;
use render::layout::{Pixel, depth_of};

/// Share of the pixels on which hardware and compute must agree. They cannot agree on all: hardware snaps points to
/// 1/256 of a pixel, so that about one in 130 falls into the next pixel.
const MIN_AGREEMENT: f64 = 0.99;
/// Depths that differ by less than this share are the same.
const TOLERANCE: f32 = 1e-3;

/// Ensures that both draw the same, bit for bit.
pub fn same(a: &mut dyn StereoContestant, b: &mut dyn StereoContestant, view: &View) -> Result<()> {
    let [left, right] = a.pixels(view)?;
    // The comparison can fail, since the eyes see different pictures.
    ensure!(left != right, "both eyes see the same");
    ensure!(b.pixels(view)? == [left, right], "the pictures differ");
    Ok(())
}

/// Ensures that depths agree on nearly all pixels; returns the share.
pub fn alike(
    hardware: &mut dyn StereoContestant,
    compute: &mut dyn StereoContestant,
    view: &View,
) -> Result<f64> {
    let ([left, right], other) = (hardware.pixels(view)?, compute.pixels(view)?);
    let share = agreement(&left, &other[0]).min(agreement(&right, &other[1]));
    ensure!(share > MIN_AGREEMENT, "depths agree on {:.2} % of the pixels only", 100.0 * share);
    let crossed = agreement(&left, &other[1]);
    ensure!(crossed < MIN_AGREEMENT, "even the wrong eye agrees on {:.2} %", 100.0 * crossed);
    Ok(share)
}

/// Share of pixels with the same depth, or empty in both.
fn agreement(a: &[Pixel], b: &[Pixel]) -> f64 {
    let same = |&(&a, &b): &(&Pixel, &Pixel)| {
        let [a, b] = [depth_of(a), depth_of(b)];
        a == b || (a - b).abs() < TOLERANCE * a.min(b)
    };
    a.iter().zip(b).filter(same).count() as f64 / a.len() as f64
}

//! Files that were merged from some of 8 bits and some of 10 or 12: there, dark points of the one look like those of the
//! other. But files are merged one behind the other, so runs of points tell what single points do not.
//!
//! A run in which next to no channel exceeds 255, from dark to bright below, is of 8 bits; of 12 bits, it would be a part of
//! the scene that is nearly black, and between it and the rest there would be runs that are half dark.

use super::white::count;

/// Points of a run.
const RUN: usize = 128;
/// Part of a run's points that may have a channel above 255 where it is of 8 bits, and that have where it is of more.
const LOW: f64 = 0.02;
const HIGH: f64 = 0.5;
/// Fewer runs than this are no second distribution.
const FEWEST: u64 = 4;
/// Runs that are neither: at the ends of tiles, and a share of those of 8 bits.
const MOST_ENDS: f64 = 2.0;
const MOST_BETWEEN: f64 = 0.1;
/// Part of the points of 8 bits that are in the brighter and in the darker half of what there is.
const LEAST_BRIGHT: f64 = 0.15;
const LEAST_DARK: f64 = 0.04;

/// Runs of points, by whether their brightest channels exceed 255.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Runs {
    low: u64,
    between: u64,
    high: u64,
    /// Points of the low ones, those of them above 191, and those up to 127.
    points: u64,
    bright: u64,
    dark: u64,
}

impl Runs {
    /// Of no points.
    pub const NONE: Self = Self { low: 0, between: 0, high: 0, points: 0, bright: 0, dark: 0 };

    /// Counts the runs of points of which these are the brightest channels.
    pub fn add(&mut self, peaks: &[u16]) {
        for run in peaks.chunks_exact(RUN) {
            let above = count(run, |c| c > 255) as f64 / RUN as f64;
            if above > LOW {
                *(if above < HIGH { &mut self.between } else { &mut self.high }) += 1;
                continue;
            }
            self.low += 1;
            self.points += RUN as u64;
            self.bright += count(run, |c| c > 191);
            self.dark += count(run, |c| c <= 127);
        }
    }

    /// Of both together.
    pub fn union(self, other: Self) -> Self {
        Self {
            low: self.low + other.low,
            between: self.between + other.between,
            high: self.high + other.high,
            points: self.points + other.points,
            bright: self.bright + other.bright,
            dark: self.dark + other.dark,
        }
    }

    /// True if some runs are of 8 bits and others of more.
    pub fn are_merged(&self) -> bool {
        let part = |num: u64, least: f64| num as f64 >= least * self.points as f64;
        self.low >= FEWEST
            && self.high >= FEWEST
            && self.between as f64 <= MOST_ENDS + MOST_BETWEEN * self.low as f64
            && part(self.bright, LEAST_BRIGHT)
            && part(self.dark, LEAST_DARK)
    }
}

/// Makes the colors of 8 bits in a merged file as bright as the others, whose white is `white`.
pub(super) fn raise(rgb: &mut [[u16; 3]], white: u16) {
    let is_low = |rgb: &[u16; 3]| rgb.iter().all(|&c| c <= 255);
    let mut is_eight = vec![false; rgb.len()];
    for (run, is_eight) in rgb.chunks(RUN).zip(is_eight.chunks_mut(RUN)) {
        let above = run.iter().filter(|rgb| !is_low(rgb)).count() as f64;
        is_eight.fill(above <= LOW * run.len() as f64);
    }
    // A tile ends within a run: as far as all is low.
    for at in 1..rgb.len() {
        is_eight[at] |= is_eight[at - 1] && is_low(&rgb[at]);
    }
    for at in (1..rgb.len()).rev() {
        is_eight[at - 1] |= is_eight[at] && is_low(&rgb[at - 1]);
    }
    let raised = |c: u16| if c > 255 { c } else { ((u32::from(c) * u32::from(white) + 127) / 255) as u16 };
    for (rgb, _) in rgb.iter_mut().zip(is_eight).filter(|(_, is_eight)| *is_eight) {
        *rgb = rgb.map(raised);
    }
}

#[cfg(test)]
#[path = "merged_tests.rs"]
mod tests;

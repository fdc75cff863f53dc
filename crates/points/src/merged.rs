//! Tells apart the points of a file that was merged from files of fewer and of more bits. Dark points of one file look
//! like those of the other. But files are merged one behind the other, so runs of points tell what single points do
//! not.
//!
//! A run is of fewer bits if next to no channel exceeds the lesser white, and its colors are dark to bright below it.
//! If it were of more bits, it would be a part of the scene that is nearly black, and there would be runs that are half
//! dark between it and the rest.

use super::Marks;
use super::coloring::RaisedPoints;
use super::distribution::peak_of;

/// Points of a run.
pub(super) const RUN: usize = 128;
/// Fewest points of a run that are not black, so that the run tells anything.
const FEWEST_COLORED: usize = RUN / 4;
/// A run is of fewer bits if at most this part of its points has a channel above the lesser white.
const LOW: f64 = 0.02;
/// A run is of more bits if at least this part of its points has a channel above the lesser white.
const HIGH: f64 = 0.5;
/// Fewer runs than this are no second distribution.
const FEWEST: u64 = 4;
/// Most runs at the ends of tiles, which are neither of fewer nor of more bits.
const MOST_ENDS: f64 = 2.0;
/// Most other runs that are neither of fewer nor of more bits, as a part of those of fewer bits.
const MOST_BETWEEN: f64 = 0.1;
/// Least part of the points of fewer bits in their brightest quarter: a scene has colors of all brightnesses, a few
/// dark materials do not.
pub(super) const LEAST_BRIGHT: f64 = 0.15;
/// Least part of the points of fewer bits in the quarter below the brightest.
pub(super) const LEAST_MIDDLE: f64 = 0.05;
/// Least part of the points of fewer bits in their darker half.
const LEAST_DARK: f64 = 0.04;
/// Points in the brightest quarter of fewer bits are at least this many times as many as in the next, equally wide
/// range above the white: points that are only dark thin out instead.
const CUT_OFF: u64 = 50;

/// How the points of a file with two whites are told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ToldBy {
    /// Points without a channel above the lesser white have it.
    Points,
    /// Runs of points in which next to no channel exceeds the lesser white have it.
    Tiles,
    /// Nobody knows which points have which white.
    Unknown,
}

/// The value above which the brightest quarter of a white starts.
pub(super) fn bright(white: u16) -> u16 {
    white - (white + 1) / 4
}

/// Part of a run's points that exceed a white, black points aside. `None` if nearly all are black, which is the same
/// with any white.
fn part_above(peaks: impl Iterator<Item = u16> + Clone, white: u16) -> Option<f64> {
    let num_colored = peaks.clone().filter(|&c| c > 0).count();
    let num_above = peaks.filter(|&c| c > white).count();
    (num_colored >= FEWEST_COLORED).then(|| num_above as f64 / num_colored as f64)
}

/// Numbers of runs of points, by whether their brightest channels exceed a white.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Runs {
    low: u64,
    between: u64,
    high: u64,
    /// Points of the low runs that are not black.
    points: u64,
    /// Points of the low runs in the brightest quarter.
    bright: u64,
    /// Points of the low runs in the quarter below the brightest.
    middle: u64,
    /// Points of the low runs in the darker half, except black ones.
    dark: u64,
    /// Points of the low runs that are brighter than the white, by at most a quarter.
    over: u64,
}

impl Runs {
    /// No runs.
    pub const NONE: Self =
        Self { low: 0, between: 0, high: 0, points: 0, bright: 0, middle: 0, dark: 0, over: 0 };

    /// Counts a run of points with these brightest channels.
    pub fn add(&mut self, run: &[u16; RUN], white: u16) {
        let Some(above) = part_above(run.iter().copied(), white) else { return };
        if above > LOW {
            *(if above < HIGH { &mut self.between } else { &mut self.high }) += 1;
            return;
        }
        let count = |is: &dyn Fn(u16) -> bool| run.iter().filter(|&&c| is(c)).count() as u64;
        self.low += 1;
        self.points += count(&|c| c > 0);
        self.bright += count(&|c| c > bright(white) && c <= white);
        self.over += count(&|c| c > white && c - white <= white - bright(white));
        self.middle += count(&|c| c > white / 2 && c <= bright(white));
        self.dark += count(&|c| c > 0 && c <= white / 2);
    }

    /// True if some runs have this white and others a greater one.
    pub fn are_merged(&self) -> bool {
        let part = |num: u64, least: f64| num as f64 >= least * self.points as f64;
        self.low >= FEWEST
            && self.high >= FEWEST
            && self.between as f64 <= MOST_ENDS + MOST_BETWEEN * self.low as f64
            && part(self.bright, LEAST_BRIGHT)
            && part(self.middle, LEAST_MIDDLE)
            && part(self.dark, LEAST_DARK)
            && CUT_OFF * self.over <= self.bright
    }
}

/// Which points have the lesser white, `low`; `None` if nobody knows.
pub(super) fn of_lesser_white(
    num_points: usize,
    color: impl Fn(usize) -> [u16; 3],
    low: u16,
    told_by: ToldBy,
) -> Option<RaisedPoints> {
    match told_by {
        ToldBy::Unknown => None,
        ToldBy::Points => Some(RaisedPoints::Dark),
        ToldBy::Tiles => Some(RaisedPoints::Marked(tiles(num_points, color, low))),
    }
}

/// Which points lie in tiles of the lesser white.
fn tiles(num_points: usize, color: impl Fn(usize) -> [u16; 3], low: u16) -> Marks {
    let peak = |at: usize| peak_of(&color(at));
    let mut is_of_low = vec![false; num_points];
    for (number, is_of_low) in is_of_low.chunks_mut(RUN).enumerate() {
        let run = number * RUN..number * RUN + is_of_low.len();
        let above = part_above(run.map(peak), low);
        is_of_low.fill(above.is_some_and(|above| above <= LOW));
    }
    // A tile ends within a run, and goes on over runs that tell nothing, as far as no channel exceeds the lesser white.
    for at in 1..num_points {
        is_of_low[at] |= is_of_low[at - 1] && peak(at) <= low;
    }
    for at in (1..num_points).rev() {
        is_of_low[at - 1] |= is_of_low[at] && peak(at - 1) <= low;
    }
    let mut marks = Marks::default();
    (0..num_points).filter(|&at| is_of_low[at]).for_each(|at| marks.set(at));
    marks
}

#[cfg(test)]
#[path = "merged_tests.rs"]
mod tests;

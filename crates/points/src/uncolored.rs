//! Finds points without a color. Exporters that have no colors write black, white or any other color at all points.
//! Such a file may have colors besides at a few points: marked points, wrong points, or those of a merged scan that had
//! photographs, among several that had none.

use super::coloring::Grays;
use super::distribution::Distribution;
use super::ramp::byte;
use super::white::White;
use super::{ColorSource, Scan, ScanFile};
use base::words::grouped;
use rayon::prelude::*;

/// Part of each channel's values that are near their median where it is worth counting points.
const NEARLY_ALL: f64 = 0.9;
/// Levels of 255 by which colors may differ without anybody seeing it.
const UNSEEN: u16 = 2;
/// Part of the points that may have another color than nearly all.
const FEW: f64 = 0.002;
/// Number of points that may have another color than nearly all, if [`FEW`] are fewer.
const FEW_NUM: f64 = 3.0;
/// Part of a small file's points that may have another color than nearly all, if [`FEW_NUM`] are more.
const FEW_OF_SMALL: f64 = 0.01;
/// Least part of the points that are black, where black may be the lack of a color.
const LEAST_BLACK: f64 = 0.1;
/// Fewest black points that can tell.
const FEWEST_BLACK: u64 = 20;
/// Black points are at least this many times as many as nearly black ones, where black is the lack of a color: in a
/// dark scene the one goes over into the other.
const BLACK_ALONE: u64 = 8;
/// A point is nearly black up to white divided by this: 3 of 255.
const NEARLY_BLACK: u16 = 64;
/// Most values that are looked at, evenly over the file, to find the ends of the grays.
const MOST_VALUES: usize = 1 << 18;
/// Part of the values that may lie beyond each end of the grays.
const TAIL: f64 = 0.01;

/// The color that stands for none in a file, as it is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blank {
    /// Black, if many points are black and few are nearly black; or the color that all points have, or all except a
    /// few, as nearly as can be seen.
    pub color: [u16; 3],
    /// Largest distance of such points' channels from the color.
    pub near: u16,
    /// The stored value of full brightness, told by all colors of the file.
    pub white: u16,
    /// Number of points that have another color.
    pub num_others: usize,
    /// True if points without a color are drawn by intensity, false if by height: in grays where others have colors.
    pub by_intensity: bool,
}

impl Blank {
    /// The blank of a file with these colors, if it has one.
    pub(super) fn of(
        colors: &Distribution,
        white: White,
        rgb: &[[u16; 3]],
        by_intensity: bool,
    ) -> Option<Self> {
        let black = || {
            let num_others = rgb.par_iter().filter(|rgb| **rgb != [0; 3]).count();
            Self { color: [0; 3], near: 0, white: white.full(), num_others, by_intensity }
        };
        let of_nearly_all = Self::of_nearly_all(colors, white.full(), rgb);
        of_nearly_all
            .map(|blank| Self { by_intensity, ..blank })
            .or_else(|| lacks_where_black(colors, white).then(black))
    }

    /// The color that all points have except a few, as nearly as can be seen.
    fn of_nearly_all(colors: &Distribution, white: u16, rgb: &[[u16; 3]]) -> Option<Self> {
        let unseen = (u32::from(UNSEEN) * u32::from(white) / 255) as u16;
        // A single point tells nothing by being like all others.
        if rgb.len() < 2 || !colors.is_close(unseen, NEARLY_ALL) {
            return None;
        }
        let color = colors.middle();
        let count = |(num_others, near): (usize, u16), rgb: &[u16; 3]| match distance(*rgb, color) {
            far if far > unseen => (num_others + 1, near),
            distance => (num_others, near.max(distance)),
        };
        let both = |a: (usize, u16), b: (usize, u16)| (a.0 + b.0, a.1.max(b.1));
        let (num_others, near) = rgb.par_iter().fold(|| (0, 0), count).reduce(|| (0, 0), both);
        let num_all = rgb.len() as f64;
        let few = (FEW * num_all).max(FEW_NUM).min(FEW_OF_SMALL * num_all);
        (num_others as f64 <= few).then_some(Self { color, near, white, num_others, by_intensity: false })
    }

    /// True if no point of the file has another color.
    pub(super) fn is_all(&self) -> bool {
        self.num_others == 0
    }

    /// True if a point with this color has none.
    pub(super) fn is(&self, rgb: [u16; 3]) -> bool {
        distance(rgb, self.color) <= self.near
    }

    /// True if the blank is black, which is the same with any white.
    pub(super) fn is_black(&self) -> bool {
        self.color == [0; 3] && self.near == 0
    }

    /// The color that is none, in words.
    pub(super) fn words(&self) -> String {
        let nearly = if self.near > 0 { "nearly " } else { "" };
        match self.color {
            [0, 0, 0] => format!("{nearly}black"),
            [r, g, b] => format!("{nearly}{r}, {g}, {b}"),
        }
    }

    /// The color as it would be drawn.
    fn shown(&self) -> [u8; 3] {
        self.color.map(|c| byte(c, self.white))
    }

    /// A sentence about the blank, whose subject is the file.
    fn sentence(&self, num_all: usize) -> Option<String> {
        let Self { color, near, num_others, .. } = *self;
        let same = if near > 0 { "nearly the same" } else { "the same" };
        if self.is_all() {
            let what = format!("has {same} color at all points, {color:?}, which is taken for none");
            return (!self.is_black()).then_some(what);
        }
        let (num, all) = (grouped(num_others), grouped(num_all));
        let only = if 2 * num_others < num_all { "only " } else { "" };
        let others = if self.is_black() {
            "black".into()
        } else {
            let nearly = if near > 0 { "nearly all" } else { "all" };
            format!("{nearly} {color:?}, which is taken for none")
        };
        Some(format!(
            "has a color at {only}{num} of {all} points; the others are {others}: they are drawn in grays"
        ))
    }
}

/// Part of points with these colors that have none.
pub(super) fn part_without(rgb: &[[u16; 3]], known: Option<u16>) -> f64 {
    let colors = Distribution::of(rgb);
    let white = White::known_or_of(known, &colors);
    let blank = Blank::of(&colors, white, rgb, false);
    blank.map_or(0.0, |blank| 1.0 - blank.num_others as f64 / rgb.len() as f64)
}

/// Largest difference between the channels of two colors.
fn distance(a: [u16; 3], b: [u16; 3]) -> u16 {
    a.iter().zip(b).fold(0, |far, (a, b)| far.max(a.abs_diff(b)))
}

/// True if black is the lack of a color: if most points are black, or if many are and next to none is nearly black.
fn lacks_where_black(colors: &Distribution, white: White) -> bool {
    let (num_all, num_black) = (colors.num_points(), colors.num_black());
    let num_nearly = colors.peaks.between(0, white.least() / NEARLY_BLACK);
    2 * num_black > num_all
        || num_black as f64 >= LEAST_BLACK * num_all as f64
            && num_black >= FEWEST_BLACK
            && num_black >= BLACK_ALONE * num_nearly
}

/// True if nobody sees the difference between two colors as they are drawn.
fn are_alike(a: [u8; 3], b: [u8; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| u16::from(a.abs_diff(b)) <= UNSEEN)
}

/// Decides about files that have a single color each, or nearly. Single colors tell the files apart and stay where they
/// differ, or where other files have colors of many kinds; otherwise they tell nothing. Grays tell nothing either,
/// because exporters fill them in.
pub(super) fn settle(scan: &mut Scan) {
    let is_gray = |[r, g, b]: [u8; 3]| are_alike([r, g, b], [g, b, r]);
    let colors = scan.files.iter().filter_map(|file| file.coloring.blank.map(|blank| blank.shown()));
    let single: Vec<[u8; 3]> = colors.filter(|&color| !is_gray(color)).collect();
    let is_colored =
        |file: &ScanFile| file.coloring.blank.is_none() && file.coloring.source.white().is_some();
    let do_differ =
        single.iter().any(|&color| !are_alike(color, single[0])) || scan.files.iter().any(is_colored);
    for file in &mut scan.files {
        let Some(blank) = file.coloring.blank else { continue };
        if do_differ && !is_gray(blank.shown()) {
            file.coloring.blank = None;
            file.coloring.source = ColorSource::with_white(blank.white);
            continue;
        }
        if blank.is_all() {
            // A column that tells nothing would only cost memory.
            file.points.rgb = Vec::new();
        }
        let sentence = blank.sentence(file.points.xyz.len());
        scan.warnings.extend(sentence.map(|sentence| format!("{}: {sentence}", file.path.display())));
    }
}

/// Finds the grays that the points without a color are drawn in, if others of the file have colors: by intensity, or by
/// height where the intensity is the same everywhere.
pub(super) fn find_grays(file: &mut ScanFile) {
    let (Some(mut blank), Some(_)) = (file.coloring.blank, file.coloring.source.white()) else { return };
    let num_points = file.points.xyz.len();
    let by_intensity = ends(|at| file.intensity(at), num_points);
    blank.by_intensity = by_intensity[0] < by_intensity[1];
    let ends = if blank.by_intensity { by_intensity } else { ends(|at| file.height(at), num_points) };
    file.coloring.grays = Some(Grays { by_intensity: blank.by_intensity, ends });
    file.coloring.blank = Some(blank);
}

/// The values between which all lie except the tails.
fn ends(value: impl Fn(usize) -> f64, num_points: usize) -> [f64; 2] {
    let step = num_points.div_ceil(MOST_VALUES).max(1);
    let mut values: Vec<f64> = (0..num_points).step_by(step).map(value).collect();
    let Some(last) = values.len().checked_sub(1) else { return [0.0; 2] };
    let tail = (values.len() as f64 * TAIL) as usize;
    [tail, last - tail].map(|at| *values.select_nth_unstable_by(at, f64::total_cmp).1)
}

#[cfg(test)]
#[path = "uncolored_tests.rs"]
mod tests;

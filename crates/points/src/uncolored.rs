//! Points without a color: where exporters have none, they write black, white or any other color at all of them. A file
//! may have colors besides at a few points: marked ones, wrong ones, or a scan that was merged from several of which few
//! had photographs.

use super::coloring::Greys;
use super::distribution::Distribution;
use super::ramp::byte;
use super::white::White;
use super::{ColorSource, Scan, ScanFile};
use base::words::grouped;
use rayon::prelude::*;

/// Part of the channels that are near to their middle where it is worth counting points.
const NEARLY_ALL: f64 = 0.9;
/// Levels of 255 that colors may differ by for nobody to see it.
const UNSEEN: u16 = 2;
/// Points that may have another color than nearly all: a share of all, and a number; in small files not so many.
const FEW: f64 = 0.002;
const FEW_NUM: f64 = 3.0;
const FEW_OF_SMALL: f64 = 0.01;
/// Part of the points that are black where black may be the lack of a color, and how many times as many they are as those
/// that are nearly black: in a dark scene the one goes over into the other. Of fewer, nobody knows.
const LEAST_BLACK: f64 = 0.1;
const FEWEST_BLACK: u64 = 20;
const BLACK_ALONE: u64 = 8;
/// Up to this part of white a point is nearly black: 3 of 255.
const NEARLY_BLACK: u16 = 64;
/// Values looked at, evenly over the file, to find the ends of the greys.
const MOST_VALUES: usize = 1 << 18;
/// Part of the values that may lie beyond each end.
const TAIL: f64 = 0.01;

/// The color that stands for none in a file, as it is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blank {
    /// Black, if many points are and few nearly; or what all points have, or all but a few, as nearly as can be seen.
    pub color: [u16; 3],
    /// How far the channels of such points are from it at most.
    pub near: u16,
    /// The stored value of full brightness, as all colors of the file tell it.
    pub white: u16,
    /// Points that have another one.
    pub num_others: usize,
    /// True if these are drawn by intensity, in greys where others have colors, and not by height.
    pub by_intensity: bool,
}

impl Blank {
    /// Of a file with these colors, if it has one.
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

    /// The color that all points have but a few, as nearly as can be seen.
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

    /// True if it is black, which is the same with any white.
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

    /// What is to be said of it, with the file as the subject.
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
            "has a color at {only}{num} of {all} points; the others are {others}: they are drawn in greys"
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

/// How far the channels of two colors are apart at most.
fn distance(a: [u16; 3], b: [u16; 3]) -> u16 {
    a.iter().zip(b).fold(0, |far, (a, b)| far.max(a.abs_diff(b)))
}

/// True if black is the lack of a color: where most points are, or where many are and next to none nearly.
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

/// Decides about files of which each has a single color, or nearly. Where these differ, or other files have colors of many
/// kinds, they tell the files apart and stay; otherwise they tell nothing. Greys are what exporters fill in.
pub(super) fn settle(scan: &mut Scan) {
    let is_grey = |[r, g, b]: [u8; 3]| are_alike([r, g, b], [g, b, r]);
    let colors = scan.files.iter().filter_map(|file| file.coloring.blank.map(|blank| blank.shown()));
    let single: Vec<[u8; 3]> = colors.filter(|&color| !is_grey(color)).collect();
    let is_colored =
        |file: &ScanFile| file.coloring.blank.is_none() && file.coloring.source.white().is_some();
    let do_differ =
        single.iter().any(|&color| !are_alike(color, single[0])) || scan.files.iter().any(is_colored);
    for file in &mut scan.files {
        let Some(blank) = file.coloring.blank else { continue };
        if do_differ && !is_grey(blank.shown()) {
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

/// Finds the greys that the points without a color are drawn in, if others of the file have colors: by intensity, or by
/// height where that is the same everywhere.
pub(super) fn find_greys(file: &mut ScanFile) {
    let (Some(mut blank), Some(_)) = (file.coloring.blank, file.coloring.source.white()) else { return };
    let num_points = file.points.xyz.len();
    let by_intensity = ends(|at| file.intensity(at), num_points);
    blank.by_intensity = by_intensity[0] < by_intensity[1];
    let ends = if blank.by_intensity { by_intensity } else { ends(|at| file.height(at), num_points) };
    file.coloring.greys = Some(Greys { by_intensity: blank.by_intensity, ends });
    file.coloring.blank = Some(blank);
}

/// The values between which all but the tails lie.
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

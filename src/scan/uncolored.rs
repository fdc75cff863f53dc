//! Points without a color: where exporters have none, they write black, white or any other color at all of them. A file
//! may have colors besides at a few points: marked ones, wrong ones, or a scan that was merged from several of which few
//! had photographs.

use super::majority::Majority;
use super::stats::Stats;
use super::white::ColorCounts;
use super::{ColorSource, Scan, ScanFile};
use crate::words::grouped;
use rayon::prelude::*;

/// By which part of all points a color has to outnumber the others to be worth counting.
const NEARLY_ALL: f64 = 0.9;
/// Points that may have another color than nearly all: a share of all, and a number; in small files not so many.
const FEW: f64 = 0.002;
const FEW_NUM: f64 = 3.0;
const FEW_OF_SMALL: f64 = 0.01;
/// Greys that points without a color get, as parts of white: seen before black and before white.
const GREYS: [f64; 2] = [0.25, 0.75];
/// Values looked at, evenly over the file, to find the ends of the greys.
const MOST_VALUES: usize = 1 << 18;
/// Part of the values that may lie beyond each end.
const TAIL: f64 = 0.01;

/// The color that stands for none in a file, as it is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Blank {
    /// Black, if most points are; or what all points have, or all but a few.
    pub color: [u16; 3],
    /// Points that have another one.
    pub num_others: usize,
    /// True if these are drawn by intensity, in greys where others have colors, and not by height.
    pub by_intensity: bool,
}

impl Blank {
    /// Of a file with these colors, if it has one.
    pub(super) fn of(stats: &Stats, rgb: &[[u16; 3]]) -> Option<Self> {
        let by_intensity = stats.intensity_min < stats.intensity_max;
        let (colors, num_all) = (&stats.colors, rgb.len());
        let of = |color| {
            let num_others = rgb.par_iter().filter(|rgb| **rgb != color).count();
            Self { color, num_others, by_intensity }
        };
        if 2 * colors.num_black > colors.num_points {
            return Some(of([0; 3]));
        }
        let Majority { color, more } = colors.majority;
        // A single point tells nothing by being like all others.
        if num_all < 2 || (more as f64) < NEARLY_ALL * num_all as f64 {
            return None;
        }
        let few = (FEW * num_all as f64).max(FEW_NUM).min(FEW_OF_SMALL * num_all as f64);
        Some(of(color)).filter(|blank| blank.num_others as f64 <= few)
    }

    /// True if no point of the file has another color.
    pub(super) fn is_all(&self) -> bool {
        self.num_others == 0
    }

    /// The colors that tell how bright the file's white is.
    pub(super) fn telling(blank: Option<Self>, colors: &ColorCounts, rgb: &[[u16; 3]]) -> ColorCounts {
        match blank {
            // Black is the same with any white.
            Some(Self { color, .. }) if color != [0; 3] => {
                let others: Vec<[u16; 3]> = rgb.par_iter().copied().filter(|rgb| *rgb != color).collect();
                let mut counts = ColorCounts::of(&others);
                counts.known = colors.known;
                counts
            }
            _ => *colors,
        }
    }

    /// What is to be said of it, with the file as the subject.
    fn sentence(&self, num_all: usize) -> Option<String> {
        let Self { color, num_others, .. } = *self;
        let is_black = color == [0; 3];
        if self.is_all() {
            let what = format!("has the same color at all points, {color:?}, which is taken for none");
            return (!is_black).then_some(what);
        }
        let (num, all) = (grouped(num_others), grouped(num_all));
        let others =
            if is_black { "black".into() } else { format!("all {color:?}, which is taken for none") };
        Some(format!(
            "has a color at only {num} of {all} points; the others are {others}: they are drawn in greys"
        ))
    }
}

/// Decides about files of which each has a single color, or nearly. Where these differ, they tell the files apart and
/// stay; otherwise they tell nothing. Greys are what exporters fill in.
pub(super) fn settle(scan: &mut Scan) {
    let is_grey = |[r, g, b]: [u16; 3]| r == g && g == b;
    let blanks = scan.files.iter().filter_map(|file| file.blank);
    let mut single: Vec<[u16; 3]> =
        blanks.map(|blank| blank.color).filter(|&color| !is_grey(color)).collect();
    single.sort_unstable();
    single.dedup();
    for file in &mut scan.files {
        let Some(blank) = file.blank else { continue };
        if single.len() > 1 && !is_grey(blank.color) {
            file.blank = None;
            file.color =
                if blank.color.iter().all(|&c| c <= 255) { ColorSource::Rgb8 } else { ColorSource::Rgb16 };
            continue;
        }
        if blank.is_all() {
            // The column would only cost memory.
            file.points.rgb = Vec::new();
        }
        let sentence = blank.sentence(file.points.xyz.len());
        scan.warnings.extend(sentence.map(|sentence| format!("{}: {sentence}", file.path.display())));
    }
}

/// Gives the points without a color greys, if others of the file have colors: by intensity, or by height where that is
/// the same everywhere.
pub(super) fn fill_with_grey(file: &mut ScanFile) {
    let (Some(blank), Some(white)) = (&mut file.blank, file.color.white().map(f64::from)) else { return };
    let (lattice, xyz) = (file.lattice, &file.points.xyz);
    let intensity = |at: usize| file.points.intensity.get(at).map_or(0.0, |&value| f64::from(value));
    let height = |at: usize| lattice.p_in_world(xyz[at]).z;
    let by_intensity = ends(&intensity, xyz.len());
    blank.by_intensity = by_intensity[0] < by_intensity[1];
    let (value, [low, high]): (&(dyn Fn(usize) -> f64 + Sync), _) =
        if blank.by_intensity { (&intensity, by_intensity) } else { (&height, ends(&height, xyz.len())) };
    let color = blank.color;
    file.points.rgb.par_iter_mut().enumerate().filter(|(_, rgb)| **rgb == color).for_each(|(at, rgb)| {
        let t = if high > low { ((value(at) - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 };
        *rgb = [(white * (GREYS[0] + (GREYS[1] - GREYS[0]) * t)).round() as u16; 3];
    });
}

/// The values between which all but the tails lie.
fn ends(value: &dyn Fn(usize) -> f64, num_points: usize) -> [f64; 2] {
    let step = num_points.div_ceil(MOST_VALUES).max(1);
    let mut values: Vec<f64> = (0..num_points).step_by(step).map(value).collect();
    let Some(last) = values.len().checked_sub(1) else { return [0.0; 2] };
    let tail = (values.len() as f64 * TAIL) as usize;
    [tail, last - tail].map(|at| *values.select_nth_unstable_by(at, f64::total_cmp).1)
}

#[cfg(test)]
#[path = "uncolored_tests.rs"]
mod tests;

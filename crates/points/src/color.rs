//! Which column a file is colored by, and how: decided by what the columns hold.

use super::coloring::{Raise, Raised};
use super::distribution::{Distribution, LESSER_WHITES, peak_of};
use super::intensity;
use super::merged::{self, ToldBy};
use super::stats::Stats;
use super::white::White;
use super::{Blank, ColorSource, Coloring, ScanFile};
use base::space::Bounds;
use base::words::grouped;
use rayon::prelude::*;

/// Colors up to white divided by this are nearly black: nobody sees them before black.
const NEARLY_BLACK: u16 = 64;
/// A file is said to be nearly black if at least this part of its points is.
const DARK_PART: f64 = 0.9;
/// Part of the heights that may lie beyond each end of their ramp: single outliers must not flatten the rest.
const TAIL: f64 = 0.01;
/// Heights looked at, evenly over the scan, to find the ends of the ramp.
const MOST_HEIGHTS: usize = 1 << 20;

/// What a file is colored by, and what is to be said of it.
#[derive(Clone, Debug, Default)]
pub(super) struct ColorChoice {
    /// The coloring. [`share_ranges`] sets the ranges of its ramps, [`super::uncolored`] its grays.
    pub coloring: Coloring,
    /// Sentences whose subject is the file, where its colors are of several kinds.
    pub sentences: Vec<String>,
}

/// Chooses how a file with these columns is colored. `known` is its white, where the format knows it.
pub(super) fn choose(stats: &Stats, rgb: &[[u16; 3]], known: Option<u16>) -> ColorChoice {
    if rgb.is_empty() {
        return ColorChoice { coloring: Coloring::by(without_rgb(stats)), ..ColorChoice::default() };
    }
    let colors = Distribution::of(rgb);
    let white = White::known_or_of(known, &colors);
    let blank = Blank::of(&colors, white, rgb, stats.intensity_min < stats.intensity_max);
    let (source, raised, mut sentences) = match blank {
        Some(blank) if blank.is_all() => (without_rgb(stats), Raised::default(), Vec::new()),
        Some(blank) if !blank.is_black() => {
            // The few points that have a color tell their white themselves.
            let numbers: Vec<usize> = (0..rgb.len()).filter(|&number| !blank.is(rgb[number])).collect();
            let few: Vec<[u16; 3]> = numbers.iter().map(|&number| rgb[number]).collect();
            let white = White::known_or_of(known, &Distribution::of(&few));
            let (source, raised, sentences) = make_one(&few, known, white);
            (source, raised.beside(blank, &numbers), sentences)
        }
        _ => make_one(rgb, known, white),
    };
    sentences.extend(source.white().and_then(|white| nearly_black(rgb, &raised, blank, white)));
    ColorChoice { coloring: Coloring { source, blank, grays: None, raised }, sentences }
}

/// Returns a sentence if nearly all colors are so dark that nobody sees them.
fn nearly_black(rgb: &[[u16; 3]], raised: &Raised, blank: Option<Blank>, white: u16) -> Option<String> {
    let darkest = white / NEARLY_BLACK;
    let is_dark = |rgb: [u16; 3]| peak_of(&rgb) <= darkest && !blank.is_some_and(|blank| blank.is(rgb));
    let num_dark = if raised.is_none() {
        rgb.par_iter().filter(|rgb| is_dark(**rgb)).count()
    } else {
        rgb.par_iter().enumerate().filter(|(number, rgb)| is_dark(raised.color(*number, **rgb))).count()
    };
    let (num, all) = (grouped(num_dark), grouped(rgb.len()));
    // A single point is no scene.
    (num_dark > 1 && num_dark as f64 >= DARK_PART * rgb.len() as f64).then(|| {
        format!(
            "has colors that are nearly black, up to {darkest} of {white}, at {num} of {all} points: hardly seen before \
             black; --set 'frame.background=[128,128,128]' sets them off"
        )
    })
}

/// Raises colors of lesser whites to the greatest white, one white after the other, starting with `white`. Returns the
/// column, the raises, and sentences about them.
fn make_one(rgb: &[[u16; 3]], known: Option<u16>, mut white: White) -> (ColorSource, Raised, Vec<String>) {
    let (mut raised, mut sentences, mut full) = (Raised::default(), Vec::new(), 0);
    for _ in 0..=LESSER_WHITES.len() {
        full = white.full().max(full);
        let White::Two { low, high, told_by } = white else { break };
        let color = |number: usize| raised.color(number, rgb[number]);
        let points = merged::of_lesser_white(rgb.len(), color, low, told_by);
        sentences.push(two_whites(low, high, told_by));
        let Some(points) = points else { break };
        raised.add(Raise { low, high, points });
        let color = |number: usize| raised.color(number, rgb[number]);
        white = White::known_or_of(known, &Distribution::of_colors(rgb.len(), color));
    }
    (ColorSource::with_white(full), raised, sentences)
}

/// Returns a sentence about two whites.
fn two_whites(low: u16, high: u16, told_by: ToldBy) -> String {
    let [low, high] = [low, high].map(|white| white.ilog2() + 1);
    let drawn = match told_by {
        ToldBy::Points => "each point is drawn by its own".into(),
        ToldBy::Tiles => "each tile is drawn by its own".into(),
        ToldBy::Unknown => format!(
            "which is which cannot be told, so all are drawn as of {high} and some are too dark; show the files that were \
             merged, each of which is drawn by its own"
        ),
    };
    format!(
        "has colors of {low} bits at some points and of {high} at others, as if files had been merged; {drawn}"
    )
}

fn without_rgb(stats: &Stats) -> ColorSource {
    if stats.intensity_min < stats.intensity_max {
        ColorSource::Intensity { low: 0.0, high: 0.0 }
    } else {
        ColorSource::Height { low: 0.0, high: 0.0 }
    }
}

/// Gives all files of a scan the same ends of their ramps, those of its scene, so that neighboring tiles match. Returns
/// a sentence if some files need other ends.
pub(super) fn share_ranges(files: &mut [ScanFile], scene: &Bounds) -> Option<String> {
    let height = height_range(files, scene);
    for file in files.iter_mut() {
        if let ColorSource::Height { low, high } = &mut file.coloring.source {
            (*low, *high) = height;
        }
    }
    intensity::share_range(files, scene)
}

fn height_range(files: &[ScanFile], scene: &Bounds) -> (f64, f64) {
    let by_height = || files.iter().filter(|file| matches!(file.coloring.source, ColorSource::Height { .. }));
    let num_points: usize = by_height().map(|file| file.points.xyz.len()).sum();
    let step = num_points.div_ceil(MOST_HEIGHTS).max(1);
    let mut heights: Vec<f64> = by_height()
        .flat_map(|file| {
            let grid = file.grid;
            file.points.xyz.iter().step_by(step).map(move |xyz| grid.p_in_world(*xyz))
        })
        .filter(|p| scene.contains(*p))
        .map(|p| p.z)
        .collect();
    if heights.is_empty() {
        return (0.0, 0.0);
    }
    let last = heights.len() - 1;
    let tail = (heights.len() as f64 * TAIL) as usize;
    let mut at = |index| *heights.select_nth_unstable_by(index, f64::total_cmp).1;
    let robust = (at(tail), at(last - tail));
    if robust.0 < robust.1 { robust } else { (at(0), at(last)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ramp::RAMP;
    use crate::{Grid, ScanBuilder};
    use glam::DVec3;

    const EVERYWHERE: Bounds = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };

    /// A file with these colors and intensities, whose points lie above each other.
    fn file(rgb: Vec<[u16; 3]>, intensity: Vec<u16>) -> ScanFile {
        let grid = Grid { scale: DVec3::splat(0.5), offset: DVec3::ZERO };
        let xyz = (0..rgb.len()).map(|at| [0, 0, 8 * at as i32]).collect();
        let mut file = ScanBuilder::new(grid, xyz).rgb(rgb).intensity(intensity).file();
        let stats = Stats::of(&file.points.xyz, &file.points.intensity);
        file.coloring = choose(&stats, &file.points.rgb, None).coloring;
        file
    }

    #[test]
    fn sixteen_bits_round_and_eight_bits_stay() {
        for c in 0..=u16::MAX {
            let bright = [u16::MAX, c, 0];
            let file = file(vec![bright], vec![0]);
            let expected = (f64::from(c) / 257.0).round() as u32;
            assert_eq!(file.color(0), 255 | expected << 8 | 255 << 24);
        }
        let file = file(vec![[255, 1, 2]], vec![0]);
        assert_eq!(file.coloring.source, ColorSource::Rgb8);
        assert_eq!(file.color(0), 255 | 1 << 8 | 2 << 16 | 255 << 24);
    }

    #[test]
    fn ten_and_twelve_bits_round() {
        let shown = |color, rgb| {
            let made = ScanBuilder::new(Grid::default(), vec![[0; 3]]).rgb(vec![rgb]).color(color);
            made.file().color(0).to_le_bytes()
        };
        for (color, white) in [(ColorSource::Rgb10, 1023), (ColorSource::Rgb12, 4095)] {
            for c in 0..=white {
                let expected = (f64::from(c) * 255.0 / f64::from(white)).round() as u8;
                assert_eq!(shown(color, [c, white, 0]), [expected, 255, 0, 255]);
            }
            assert_eq!(shown(color, [60_000, 0, 0])[0], 255, "beyond the white is white");
        }
    }

    #[test]
    fn black_falls_back_to_intensity_and_constant_intensity_to_height() {
        let black = vec![[0; 3]; 2];
        let mut files = [file(black.clone(), vec![3, 9]), file(black, vec![7, 7])];
        share_ranges(&mut files, &EVERYWHERE);
        assert_eq!(files[0].coloring.source, ColorSource::Intensity { low: 3.0, high: 9.0 });
        assert_eq!(files[1].coloring.source, ColorSource::Height { low: 0.0, high: 4.0 });
        assert_eq!([files[0].color(0), files[0].color(1)], [RAMP[0], RAMP[255]]);
        assert_eq!([files[1].color(0), files[1].color(1)], [RAMP[0], RAMP[255]]);
    }
}

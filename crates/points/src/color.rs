//! From columns to colours: which column a file is coloured by, and the ramp for those without colour.

use super::distribution::{Distribution, LESSER_WHITES, peak_of};
use super::intensity;
use super::merged::{self, Parts};
use super::stats::Stats;
use super::white::White;
use super::{Blank, ColorSource, ScanFile};
use base::space::Bounds;
use base::words::grouped;
use rayon::prelude::*;
use std::sync::LazyLock;

/// Up to this part of white nobody sees a color before black, and the part of the points that have such colors where that
/// is said.
const NEARLY_BLACK: u16 = 64;
const DARK_PART: f64 = 0.9;
/// Part of the heights that may lie beyond each end of their ramp: single outliers must not flatten the rest.
const TAIL: f64 = 0.01;
/// Heights looked at, evenly over the scan, to find the ends of the ramp.
const MOST_HEIGHTS: usize = 1 << 20;

impl ScanFile {
    /// Colour of a point: r | g≪8 | b≪16 | 255≪24, sRGB.
    ///
    /// # Panics
    /// If there is no point `index`.
    #[must_use]
    pub fn color(&self, index: usize) -> u32 {
        match self.color {
            ColorSource::Rgb8 => pack(self.points.rgb[index].map(|c| byte(c, 255))),
            ColorSource::Rgb10 => pack(self.points.rgb[index].map(|c| byte(c, 1023))),
            ColorSource::Rgb12 => pack(self.points.rgb[index].map(|c| byte(c, 4095))),
            ColorSource::Rgb16 => pack(self.points.rgb[index].map(|c| byte(c, u16::MAX))),
            ColorSource::Intensity { low, high } => ramp(f64::from(self.points.intensity[index]), low, high),
            ColorSource::Height { low, high } => {
                let z = self.lattice.offset.z + self.lattice.scale.z * f64::from(self.points.xyz[index][2]);
                ramp(z, low, high)
            }
        }
    }
}

/// What a file is coloured by, and what is to be said of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Choice {
    /// Ranges of ramps follow in [`share_ranges`].
    pub color: ColorSource,
    pub blank: Option<Blank>,
    /// Sentences whose subject is the file, where its colors are of several kinds.
    pub sentences: Vec<String>,
}

/// Chooses for a file with these columns, of which the reader may know the white. Colors of several kinds are made one.
pub(super) fn choose(stats: &Stats, rgb: &mut [[u16; 3]], known: Option<u16>) -> Choice {
    if rgb.is_empty() {
        return Choice { color: without_rgb(stats), ..Choice::default() };
    }
    let colors = Distribution::of(rgb);
    let white = White::known_or_of(known, &colors);
    let blank = Blank::of(&colors, white, rgb, stats.intensity_min < stats.intensity_max);
    let (color, mut sentences) = match blank {
        Some(blank) if blank.is_all() => (without_rgb(stats), Vec::new()),
        Some(blank) if !blank.is_black() => {
            // The few that have a color tell their white themselves.
            let mut few: Vec<[u16; 3]> = rgb.iter().copied().filter(|&rgb| !blank.is(rgb)).collect();
            let made = make_one(&mut few, known);
            rgb.iter_mut().filter(|rgb| !blank.is(**rgb)).zip(few).for_each(|(rgb, few)| *rgb = few);
            made
        }
        _ => make_one(rgb, known),
    };
    sentences.extend(color.white().and_then(|white| nearly_black(rgb, blank, white)));
    Choice { color, blank, sentences }
}

/// What is to be said of colors of which nearly all are so dark that nobody sees them.
fn nearly_black(rgb: &[[u16; 3]], blank: Option<Blank>, white: u16) -> Option<String> {
    let darkest = white / NEARLY_BLACK;
    let is_dark = |rgb: &&[u16; 3]| peak_of(rgb) <= darkest && !blank.is_some_and(|blank| blank.is(**rgb));
    let num_dark = rgb.par_iter().filter(is_dark).count();
    let (num, all) = (grouped(num_dark), grouped(rgb.len()));
    // A single point is no scene.
    (num_dark > 1 && num_dark as f64 >= DARK_PART * rgb.len() as f64).then(|| {
        format!(
            "has colors that are nearly black, up to {darkest} of {white}, at {num} of {all} points: hardly seen before \
             black; --set 'frame.background=[128,128,128]' sets them off"
        )
    })
}

/// Makes colors of several whites those of the greatest, one after the other, and says so.
fn make_one(rgb: &mut [[u16; 3]], known: Option<u16>) -> (ColorSource, Vec<String>) {
    let (mut sentences, mut full) = (Vec::new(), 0);
    for _ in 0..=LESSER_WHITES.len() {
        let white = White::known_or_of(known, &Distribution::of(rgb));
        full = white.full().max(full);
        let White::Two { low, high, parts } = white else { break };
        merged::raise(rgb, low, high, parts);
        sentences.push(two_whites(low, high, parts));
        if parts == Parts::Unknown {
            break;
        }
    }
    (ColorSource::with_white(full), sentences)
}

/// What is to be said of two whites.
fn two_whites(low: u16, high: u16, parts: Parts) -> String {
    let [low, high] = [low, high].map(|white| white.ilog2() + 1);
    let drawn = match parts {
        Parts::Points => "each point is drawn by its own".into(),
        Parts::Tiles => "each tile is drawn by its own".into(),
        Parts::Unknown => format!(
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

impl ColorSource {
    /// Stored colors of which this is full brightness.
    pub(super) fn with_white(white: u16) -> Self {
        match white {
            255 => Self::Rgb8,
            1023 => Self::Rgb10,
            4095 => Self::Rgb12,
            _ => Self::Rgb16,
        }
    }

    /// The stored value of full brightness. `None` if no stored colors are drawn.
    pub(super) fn white(self) -> Option<u16> {
        match self {
            Self::Rgb8 => Some(255),
            Self::Rgb10 => Some(1023),
            Self::Rgb12 => Some(4095),
            Self::Rgb16 => Some(u16::MAX),
            Self::Intensity { .. } | Self::Height { .. } => None,
        }
    }
}

/// Gives all files of a scan the same ends of their ramps, those of its scene, so that neighbouring tiles match. A
/// sentence where some need others.
pub(super) fn share_ranges(files: &mut [ScanFile], scene: &Bounds) -> Option<String> {
    let height = height_range(files, scene);
    for file in files.iter_mut() {
        if let ColorSource::Height { low, high } = &mut file.color {
            (*low, *high) = height;
        }
    }
    intensity::share_range(files, scene)
}

fn height_range(files: &[ScanFile], scene: &Bounds) -> (f64, f64) {
    let by_height = || files.iter().filter(|file| matches!(file.color, ColorSource::Height { .. }));
    let num_points: usize = by_height().map(|file| file.points.xyz.len()).sum();
    let step = num_points.div_ceil(MOST_HEIGHTS).max(1);
    let mut heights: Vec<f64> = by_height()
        .flat_map(|file| {
            let lattice = file.lattice;
            file.points.xyz.iter().step_by(step).map(move |xyz| lattice.p_in_world(*xyz))
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

/// round(c · 255 / white), in integers: no white here is even, so no tie exists. Above the white is white.
pub(super) fn byte(c: u16, white: u16) -> u8 {
    let (c, white) = (u32::from(c.min(white)), u32::from(white));
    ((2 * 255 * c + white) / (2 * white)) as u8
}

fn pack([r, g, b]: [u8; 3]) -> u32 {
    u32::from_le_bytes([r, g, b, 255])
}

/// The ramp's colour of a value; the middle if the ends coincide.
fn ramp(value: f64, low: f64, high: f64) -> u32 {
    let t = if high > low { (value - low) / (high - low) } else { 0.5 };
    // `as` saturates: below 0 becomes 0.
    RAMP[((t * 255.0 + 0.5) as usize).min(255)]
}

/// Violet to yellow by way of green: lightness rises evenly in Oklab, so equal steps look equal, also to
/// those who do not see all hues, and also printed in grey.
static RAMP: LazyLock<[u32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|index| {
        let t = index as f64 / 255.0;
        let lightness = 0.28 + 0.64 * t;
        let hue = (300.0 - 195.0 * t).to_radians();
        let chroma = 0.09 + 0.05 * t;
        pack(srgb_of_oklab(lightness, chroma * hue.cos(), chroma * hue.sin()))
    })
});

/// Oklab to 8-bit sRGB, clamped to what can be shown.
fn srgb_of_oklab(lightness: f64, a: f64, b: f64) -> [u8; 3] {
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    let linear = [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ];
    linear.map(|c| {
        let c = c.clamp(0.0, 1.0);
        let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Lattice, Points};
    use glam::DVec3;

    const EVERYWHERE: Bounds = Bounds { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };

    fn file(mut points: Points) -> ScanFile {
        let stats = Stats::of(&points.xyz, &points.intensity);
        ScanFile {
            path: "a.las".into(),
            format: String::new(),
            lattice: Lattice { scale: DVec3::splat(0.5), offset: DVec3::ZERO },
            color: choose(&stats, &mut points.rgb, None).color,
            points,
            bounds: Bounds::EMPTY,
            ..ScanFile::default()
        }
    }

    #[test]
    fn sixteen_bits_round_and_eight_bits_stay() {
        for c in 0..=u16::MAX {
            let bright = [u16::MAX, c, 0];
            let file = file(Points {
                xyz: vec![[0; 3]],
                rgb: vec![bright],
                intensity: vec![0],
                ..Points::default()
            });
            let expected = (f64::from(c) / 257.0).round() as u32;
            assert_eq!(file.color(0), 255 | expected << 8 | 255 << 24);
        }
        let file = file(Points {
            xyz: vec![[0; 3]],
            rgb: vec![[255, 1, 2]],
            intensity: vec![0],
            ..Points::default()
        });
        assert_eq!(file.color, ColorSource::Rgb8);
        assert_eq!(file.color(0), 255 | 1 << 8 | 2 << 16 | 255 << 24);
    }

    #[test]
    fn ten_and_twelve_bits_round() {
        let shown = |color, rgb| {
            let points = Points { xyz: vec![[0; 3]], rgb: vec![rgb], ..Points::default() };
            let file = ScanFile { points, color, ..ScanFile::default() };
            file.color(0).to_le_bytes()
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
        let xyz = vec![[0; 3], [0, 0, 8]];
        let mut files = [
            file(Points { xyz: xyz.clone(), rgb: black.clone(), intensity: vec![3, 9], ..Points::default() }),
            file(Points { xyz, rgb: black, intensity: vec![7, 7], ..Points::default() }),
        ];
        share_ranges(&mut files, &EVERYWHERE);
        assert_eq!(files[0].color, ColorSource::Intensity { low: 3.0, high: 9.0 });
        assert_eq!(files[1].color, ColorSource::Height { low: 0.0, high: 4.0 });
        assert_eq!([files[0].color(0), files[0].color(1)], [RAMP[0], RAMP[255]]);
        assert_eq!([files[1].color(0), files[1].color(1)], [RAMP[0], RAMP[255]]);
    }

    #[test]
    fn the_ramp_grows_lighter_everywhere() {
        let luminance = |color: u32| {
            let channel = |shift: u32| (f64::from(color >> shift & 255) / 255.0).powf(2.2);
            0.2126 * channel(0) + 0.7152 * channel(8) + 0.0722 * channel(16)
        };
        assert!(RAMP.windows(2).all(|pair| luminance(pair[0]) <= luminance(pair[1]) + 1e-3));
        assert!(luminance(RAMP[0]) < 0.05 && luminance(RAMP[255]) > 0.6);
        assert_eq!(ramp(f64::NAN, 0.0, 1.0), RAMP[0]);
        assert_eq!(ramp(-5.0, 0.0, 1.0), RAMP[0]);
        assert_eq!(ramp(5.0, 0.0, 1.0), RAMP[255]);
        assert_eq!(ramp(1.0, 1.0, 1.0), RAMP[128]);
    }
}

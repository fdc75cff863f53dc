//! What the values of a point's row mean: its place, its color, and whether it can be seen.

use super::reader::{Color, Kept, NUM_SLOTS, Opacity, RowValues, SLOT_OPACITY, SLOT_PLACE, SLOT_RGB};

/// Splats less opaque than this are left out: nine tenths of the light pass them, and as points they would be fog.
const FAINT: f64 = 0.1;
/// The constant spherical harmonic, 1 / (2 √π): a splat's color is 0.5 + this · its constant term.
const HARMONIC_0: f64 = 0.282_094_791_773_878_14;
/// Points of a chunk of a compressed splat.
const CHUNK_POINTS: u64 = 256;

/// Smallest and largest place and color of a chunk's points, in the order of [`super::names::CHUNK`]; NaN where not
/// given.
pub(super) type SplatBox = [f32; NUM_SLOTS];

/// How to understand the points of a file.
#[derive(Debug)]
pub(super) struct Meaning {
    pub has: Kept,
    pub chunks: Vec<SplatBox>,
    /// False where no point is opaque enough, so that all are shown.
    pub leaves_faint_out: bool,
}

impl Meaning {
    /// Coordinates of a point; not finite where they are unknown.
    #[inline]
    pub fn place(&self, number: u64, row: &RowValues) -> [f64; 3] {
        if !self.has.chunked {
            return row.three(SLOT_PLACE);
        }
        let Some(chunk) = self.chunk(number) else { return [f64::NAN; 3] };
        let packed = row.values[SLOT_PLACE.start] as u32;
        // The axes take 11, 10 and 11 bits.
        let parts = [part(packed >> 21, 2047), part(packed >> 11, 1023), part(packed, 2047)];
        std::array::from_fn(|axis| between(chunk[axis], chunk[axis + 3], parts[axis]))
    }

    fn chunk(&self, number: u64) -> Option<&SplatBox> {
        self.chunks.get(usize::try_from(number / CHUNK_POINTS).ok()?)
    }

    /// True for a point that is nearly transparent.
    #[inline]
    pub fn is_faint(&self, row: &RowValues) -> bool {
        self.leaves_faint_out && self.opacity(row).is_some_and(|opacity| opacity < FAINT)
    }

    /// The part of the light that a point keeps; `None` where that is unknown.
    #[inline]
    pub fn opacity(&self, row: &RowValues) -> Option<f64> {
        match self.has.opacity {
            Opacity::Absent | Opacity::Unclear => None,
            Opacity::Logit => Some(1.0 / (1.0 + (-row.values[SLOT_OPACITY]).exp())),
            Opacity::PartOf(most) => Some(row.values[SLOT_OPACITY] / f64::from(most)),
            Opacity::Chunked => Some(part(row.values[SLOT_RGB.start] as u32, 255)),
        }
    }

    /// Color of a point, of 8 or 16 bits: see [`white`](Self::white). Floats are multiplied by `factor`.
    #[inline]
    pub fn rgb(&self, number: u64, row: &RowValues, factor: f64) -> [u16; 3] {
        match self.has.color {
            Color::Chunked => {
                let packed = row.values[SLOT_RGB.start] as u32;
                let range = |channel: usize| {
                    let range = self.chunk(number).map(|chunk| (chunk[6 + channel], chunk[9 + channel]));
                    range.filter(|(low, high)| low.is_finite() && high.is_finite()).unwrap_or((0.0, 1.0))
                };
                std::array::from_fn(|channel| {
                    let (low, high) = range(channel);
                    of_unit(between(low, high, part(packed >> (24 - 8 * channel), 255)))
                })
            }
            color => rgb(color, row, factor),
        }
    }

    /// The largest value of a color, where the file's format says so.
    pub fn white(&self) -> Option<u16> {
        match self.has.color {
            Color::Packed => Some(255),
            Color::Harmonics | Color::Chunked => Some(u16::MAX),
            Color::Absent | Color::Integers(_) | Color::Floats => None,
        }
    }
}

/// Color of a row that needs no chunk.
#[inline]
pub(super) fn rgb(color: Color, row: &RowValues, factor: f64) -> [u16; 3] {
    let rgb = row.three(SLOT_RGB);
    match color {
        Color::Absent | Color::Chunked => [0; 3],
        Color::Integers(largest) => std::array::from_fn(|channel| unsigned(rgb[channel], largest[channel])),
        // `as` saturates, and makes 0 of NaN.
        Color::Floats => rgb.map(|c| (c * factor).round() as u16),
        Color::Packed => [16, 8, 0].map(|shift| (rgb[0] as u32 >> shift & 0xff) as u16),
        Color::Harmonics => rgb.map(|c| of_unit(0.5 + HARMONIC_0 * c)),
    }
}

/// The lowest bits of a packed number, as a part of `most`, in which all of them are set.
fn part(packed: u32, most: u32) -> f64 {
    f64::from(packed & most) / f64::from(most)
}

fn between(low: f32, high: f32, part: f64) -> f64 {
    f64::from(low) * (1.0 - part) + f64::from(high) * part
}

/// Turns 0 to 1 into 16 bits.
fn of_unit(c: f64) -> u16 {
    (c.clamp(0.0, 1.0) * 65535.0).round() as u16
}

/// An integer of 8 or 16 bits, whether it was stored with a sign or not.
#[inline]
fn unsigned(value: f64, largest: u16) -> u16 {
    let value = if value < 0.0 { value + f64::from(largest) + 1.0 } else { value };
    (value as u16).min(largest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::ply::reader::Intensity;

    fn row(values: &[(usize, f64)]) -> RowValues {
        let mut row = RowValues::default();
        values.iter().for_each(|&(slot, value)| row.values[slot] = value);
        row
    }

    fn meaning(color: Color, opacity: Opacity, chunks: Vec<SplatBox>) -> Meaning {
        let chunked = !chunks.is_empty();
        let has =
            Kept { is_splat: true, chunked, color, intensity: Intensity::Absent, normal: false, opacity };
        Meaning { has, chunks, leaves_faint_out: true }
    }

    #[test]
    fn signed_bytes_are_their_bits() {
        assert_eq!([-1.0, -128.0, 64.0, 300.0, f64::NAN].map(|v| unsigned(v, 255)), [255, 128, 64, 255, 0]);
        assert_eq!([-1.0, 70_000.0].map(|v| unsigned(v, u16::MAX)), [u16::MAX; 2]);
    }

    #[test]
    fn packed_colors_are_red_green_blue_from_the_top() {
        let row = row(&[(SLOT_RGB.start, f64::from(0xfe01_80ffu32))]);
        assert_eq!(rgb(Color::Packed, &row, 1.0), [1, 128, 255]);
    }

    #[test]
    fn harmonics_are_colors_about_gray() {
        let color = |c: f64| rgb(Color::Harmonics, &row(&[(3, c), (4, 0.0), (5, -9.0)]), 1.0);
        assert_eq!(color(0.0), [32768, 32768, 0]);
        assert_eq!(color(1.0)[0], (0.782_094_8f64 * 65535.0).round() as u16);
        assert_eq!((color(5.0)[0], color(f64::NAN)[0]), (65535, 0));
    }

    #[test]
    fn faint_splats_are_told_by_their_logit() {
        let splat = meaning(Color::Harmonics, Opacity::Logit, vec![]);
        // ln(0.1 / 0.9) = −2.197.
        assert_eq!(
            [-2.3, -2.1, 0.0].map(|o| splat.is_faint(&row(&[(SLOT_OPACITY, o)]))),
            [true, false, false]
        );
        let all = Meaning { leaves_faint_out: false, ..splat };
        assert!(!all.is_faint(&row(&[(SLOT_OPACITY, -9.0)])));
    }

    #[test]
    fn a_chunk_spreads_its_points_over_its_box() {
        let old = [
            0.0,
            10.0,
            -4.0,
            2047.0,
            1033.0,
            4.0,
            f32::NAN,
            f32::NAN,
            f32::NAN,
            f32::NAN,
            f32::NAN,
            f32::NAN,
        ];
        let new = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.5, 0.0, -1.0, 1.0, 0.5, 3.0];
        let splat = meaning(Color::Chunked, Opacity::Chunked, vec![old, new]);
        let packed = |x: u32, y: u32, z: u32| row(&[(0, f64::from(x << 21 | y << 11 | z))]);
        assert_eq!(splat.place(255, &packed(7, 1023, 2047)), [7.0, 1033.0, 4.0]);
        assert_eq!(splat.place(256, &packed(0, 1023, 0)), [0.0, 1.0, 0.0]);
        assert!(splat.place(512, &packed(0, 0, 0))[0].is_nan(), "no chunk");
        let color = |number, bits: u32| splat.rgb(number, &row(&[(3, f64::from(bits))]), 1.0);
        assert_eq!(color(0, 0xff00_80ff), [65535, 0, 32896]);
        // The ranges are 0.5 to 1, 0 to 0.5, and −1 to 3, which is cut off at black and white.
        assert_eq!(color(300, 0x00ff_ffff), [32768, 32768, 65535]);
        let faint = |alpha: u32| splat.is_faint(&row(&[(3, f64::from(0xffff_ff00 | alpha))]));
        assert_eq!([25, 26].map(faint), [true, false]);
    }
}

//! The first pass over a PLY file, which finds what must be known of all points before any is put into columns.

use super::body::RowSink;
use super::point::{Meaning, SplatBox};
use super::reader::{Color, Intensity, Opacity, RowValues, SLOT_INTENSITY, SLOT_OPACITY, SLOT_RGB};
use crate::formats::measured::{both, count_channels};
use crate::grid;
use base::space::Bounds;
use glam::DVec3;

/// Places that are kept as a sample, evenly over the file; somewhat more may be kept.
const SAMPLE: u64 = 1 << 16;

/// What was found so far.
#[derive(Clone, Debug)]
pub(super) struct Found {
    /// Points with a place that are not faint.
    pub num_kept: u64,
    /// Points with a place that are faint.
    pub num_faint: u64,
    /// Box of the points that are kept.
    pub bounds: Bounds,
    /// Places of a sample of the kept points.
    pub sample: Vec<DVec3>,
    /// Numbers of the kept points' float channels between 0 and 1, above 1, and above 255.
    pub channels: [u64; 3],
    /// The smallest and largest finite intensity.
    pub intensity: (f64, f64),
    /// Finite intensities of the sample.
    pub intensities: Vec<f64>,
    /// The smallest and largest finite opacity.
    pub opacity: (f64, f64),
    /// Colors of the sample, where they are asked for; floats of 0 to 1 become 8 bits.
    pub colors: Vec<[u16; 3]>,
}

/// The pass that surveys a file.
#[derive(Debug)]
pub(super) struct Survey<'a> {
    meaning: &'a Meaning,
    with_colors: bool,
    /// Points from one of the sample to the next.
    stride: u64,
    /// Points until the next one of the sample.
    until_next: u64,
    first_point: u64,
    num_points: u64,
    pub found: Found,
}

impl<'a> Survey<'a> {
    /// A survey of a file that holds about this many points.
    pub fn new(meaning: &'a Meaning, num_points: u64, with_colors: bool) -> Self {
        let found = Found {
            num_kept: 0,
            num_faint: 0,
            bounds: Bounds::EMPTY,
            sample: Vec::new(),
            channels: [0; 3],
            intensity: (f64::MAX, f64::MIN),
            intensities: Vec::new(),
            opacity: (f64::MAX, f64::MIN),
            colors: Vec::new(),
        };
        let stride = num_points.div_ceil(SAMPLE).max(1);
        Self { meaning, with_colors, stride, until_next: 0, first_point: 0, num_points: 0, found }
    }
}

impl RowSink for Survey<'_> {
    fn part(&self, first_point: u64, _: usize) -> Self {
        Self { stride: self.stride, first_point, ..Self::new(self.meaning, 0, self.with_colors) }
    }

    fn append(&mut self, later: Self) {
        let Found { num_kept, num_faint, bounds, sample, channels, .. } = later.found;
        let Found { intensity, intensities, opacity, colors, .. } = later.found;
        self.num_points += later.num_points;
        self.found.num_kept += num_kept;
        self.found.num_faint += num_faint;
        self.found.bounds = self.found.bounds.union(bounds);
        self.found.sample.extend(sample);
        self.found.channels = std::array::from_fn(|range| self.found.channels[range] + channels[range]);
        self.found.intensities.extend(intensities);
        self.found.colors.extend(colors);
        self.found.intensity = both(self.found.intensity, intensity);
        self.found.opacity = both(self.found.opacity, opacity);
    }

    #[inline]
    fn point(&mut self, row: &RowValues) {
        let number = self.first_point + self.num_points;
        self.num_points += 1;
        let is_of_sample = self.until_next == 0;
        self.until_next = if is_of_sample { self.stride } else { self.until_next } - 1;
        let place = self.meaning.place(number, row);
        if !grid::is_place(&place) {
            return;
        }
        let found = &mut self.found;
        if self.meaning.is_faint(row) {
            found.num_faint += 1;
            return;
        }
        found.num_kept += 1;
        let place = DVec3::from_array(place);
        found.bounds = found.bounds.with(place);
        if is_of_sample {
            found.sample.push(place);
            if self.with_colors {
                found.colors.push(self.meaning.rgb(number, row, 255.0));
            }
        }
        if self.meaning.has.opacity == Opacity::Unclear && row.values[SLOT_OPACITY].is_finite() {
            found.opacity = both(found.opacity, (row.values[SLOT_OPACITY], row.values[SLOT_OPACITY]));
        }
        if self.meaning.has.color == Color::Floats {
            count_channels(&mut found.channels, row.three(SLOT_RGB));
        }
        if self.meaning.has.intensity != Intensity::Absent && row.values[SLOT_INTENSITY].is_finite() {
            let value = row.values[SLOT_INTENSITY];
            found.intensity = both(found.intensity, (value, value));
            if is_of_sample {
                found.intensities.push(value);
            }
        }
    }

    fn bad_point(&mut self) {
        self.num_points += 1;
    }

    fn num_points(&self) -> u64 {
        self.num_points
    }

    fn progress(num_points: u64) -> u64 {
        num_points / 2
    }
}

/// The pass before the survey of compressed splats, which collects the boxes of their chunks.
#[derive(Debug, Default)]
pub(super) struct SplatBoxes(pub Vec<SplatBox>);

impl RowSink for SplatBoxes {
    fn part(&self, _: u64, _: usize) -> Self {
        Self::default()
    }

    fn append(&mut self, later: Self) {
        self.0.extend(later.0);
    }

    fn chunk(&mut self, row: &RowValues) {
        self.0.push(row.values.map(|value| value as f32));
    }

    fn point(&mut self, _: &RowValues) {}

    fn bad_point(&mut self) {}

    fn num_points(&self) -> u64 {
        0
    }

    fn progress(_: u64) -> u64 {
        0
    }
}

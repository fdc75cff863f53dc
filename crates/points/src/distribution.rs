//! How the colors of a file are distributed, which tells how bright its white is, and which points have no color.

use super::merged::{RUN, Runs};

/// Largest number of points that are counted, evenly over the file; all points of a small file are counted.
const MOST_POINTS: usize = 1 << 17;

/// Whites of 8, 10 and 12 bits, which are below that of 16 bits.
pub(super) const LESSER_WHITES: [u16; 3] = [255, 1023, 4095];

/// The colors of a file, or of a sample of it, counted.
#[derive(Debug)]
pub(super) struct Distribution {
    /// Red, green and blue of each point.
    channels: [Histogram; 3],
    /// The brightest channel of each point.
    pub peaks: Histogram,
    /// Runs of points, by whether they exceed each of [`LESSER_WHITES`].
    pub runs: [Runs; LESSER_WHITES.len()],
}

impl Distribution {
    /// The distribution of these colors.
    pub fn of(rgb: &[[u16; 3]]) -> Self {
        Self::of_colors(rgb.len(), |number| rgb[number])
    }

    /// The distribution of the colors of this many points.
    pub fn of_colors(num_points: usize, color: impl Fn(usize) -> [u16; 3]) -> Self {
        let runs = (0..num_points).step_by(RUN).map(|first| first..num_points.min(first + RUN));
        // The step is odd, so that it is no multiple of an even period of the file.
        let step = runs.len().div_ceil(MOST_POINTS / RUN).max(1) | 1;
        let counted = runs.clone().step_by(step).flatten();
        let largest = counted.fold(0, |largest, number| largest.max(peak_of(&color(number))));
        let mut counts = [(); 4].map(|()| vec![0u32; usize::from(largest) + 1]);
        let mut merged = [Runs::NONE; LESSER_WHITES.len()];
        for run in runs.step_by(step) {
            let mut peaks = [0; RUN];
            for (peak, number) in peaks.iter_mut().zip(run.clone()) {
                let rgb = color(number);
                for (counts, c) in counts.iter_mut().zip(rgb) {
                    counts[usize::from(c)] += 1;
                }
                *peak = peak_of(&rgb);
                counts[3][usize::from(*peak)] += 1;
            }
            if run.len() == RUN {
                merged.iter_mut().zip(LESSER_WHITES).for_each(|(runs, white)| runs.add(&peaks, white));
            }
        }
        let [red, green, blue, peaks] = counts.map(Histogram::of);
        Self { channels: [red, green, blue], peaks, runs: merged }
    }

    /// Number of points counted.
    pub fn num_points(&self) -> u64 {
        self.peaks.num()
    }

    /// Number of points whose channels are all 0.
    pub fn num_black(&self) -> u64 {
        self.peaks.up_to(0)
    }

    /// Number of channels counted.
    pub fn num_channels(&self) -> u64 {
        3 * self.num_points()
    }

    /// Number of channels above a value.
    pub fn above(&self, value: u16) -> u64 {
        self.channels.iter().map(|channel| channel.above(value)).sum()
    }

    /// Number of channels above `low`, up to `high`.
    pub fn between(&self, low: u16, high: u16) -> u64 {
        self.above(low) - self.above(high)
    }

    /// The median of each channel's values.
    pub fn middle(&self) -> [u16; 3] {
        self.channels.each_ref().map(Histogram::median)
    }

    /// True if at least this part of each channel's values is no further than `near` from their median.
    pub fn is_close(&self, near: u16, part: f64) -> bool {
        self.channels.iter().all(|channel| {
            let middle = channel.median();
            let below = middle.checked_sub(near + 1).map_or(0, |value| channel.up_to(value));
            let num = channel.up_to(middle.saturating_add(near)) - below;
            num as f64 >= part * channel.num() as f64
        })
    }

    /// Number of channels above 255 whose low byte is 0 or their high byte: 8 bits made 16, by shifting or by
    /// repeating.
    pub fn num_bytes(&self) -> u64 {
        let at = |value: u16| self.between(value - 1, value);
        (1..=255).map(|byte| at(byte << 8) + at(byte << 8 | byte)).sum()
    }
}

/// The brightest channel of a color.
pub(super) fn peak_of(rgb: &[u16; 3]) -> u16 {
    rgb[0].max(rgb[1]).max(rgb[2])
}

/// Number of values up to each value, until all are counted.
#[derive(Debug)]
pub(super) struct Histogram(Vec<u32>);

impl Histogram {
    /// The histogram of values that occur this many times each.
    fn of(mut counts: Vec<u32>) -> Self {
        let mut sum = 0;
        for count in &mut counts {
            sum += *count;
            *count = sum;
        }
        Self(counts)
    }

    /// Number of all values.
    fn num(&self) -> u64 {
        self.0.last().map_or(0, |&all| u64::from(all))
    }

    fn up_to(&self, value: u16) -> u64 {
        self.0.get(usize::from(value)).map_or(self.num(), |&up_to| u64::from(up_to))
    }

    /// Number of values above this.
    pub fn above(&self, value: u16) -> u64 {
        self.num() - self.up_to(value)
    }

    /// Number of values above `low`, up to `high`.
    pub fn between(&self, low: u16, high: u16) -> u64 {
        self.up_to(high) - self.up_to(low)
    }

    /// The smallest value that at least half of all values do not exceed.
    fn median(&self) -> u16 {
        let at = self.0.partition_point(|&up_to| 2 * u64::from(up_to) < self.num());
        u16::try_from(at).unwrap_or(u16::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_and_peaks_are_counted() {
        let found = Distribution::of(&[[0, 0, 0], [5, 256, 7], [0x1212, 9, 0], [65535, 65535, 8]]);
        assert_eq!((found.num_points(), found.num_black(), found.num_channels()), (4, 1, 12));
        assert_eq!([0, 255, 256, 65534, 65535].map(|value| found.above(value)), [8, 4, 3, 2, 0]);
        assert_eq!([0, 255, 256, 65534, 65535].map(|value| found.peaks.above(value)), [3, 3, 2, 1, 0]);
        assert_eq!((found.between(5, 256), found.peaks.between(255, 256)), (4, 1));
        assert_eq!(found.num_bytes(), 4);
        assert_eq!(Distribution::of(&[]).num_points(), 0);
    }

    #[test]
    fn the_middle_has_most_values_near_it() {
        let mut rgb: Vec<[u16; 3]> = (0..1000).map(|at| [100 + at % 3, 7, 0]).collect();
        let is_close = |rgb: &[[u16; 3]], near| Distribution::of(rgb).is_close(near, 0.9);
        assert_eq!(Distribution::of(&rgb).middle(), [101, 7, 0]);
        assert!(is_close(&rgb, 1) && !is_close(&rgb, 0));
        rgb[..99].fill([0, 0, 60_000]);
        assert!(is_close(&rgb, 2));
        rgb[..101].fill([0, 0, 60_000]);
        assert!(!is_close(&rgb, 2));
        assert!(is_close(&[[65535; 3], [65534; 3]], 514));
    }

    #[test]
    fn of_many_points_some_are_counted_from_all_over_the_file() {
        let rgb: Vec<[u16; 3]> = (0..3_000_000).map(|at| [(at / 100_000) as u16 + 1; 3]).collect();
        let found = Distribution::of(&rgb);
        assert!((MOST_POINTS / 2..=MOST_POINTS).contains(&(found.num_points() as usize)));
        assert!((1..=30).all(|value| found.peaks.between(value - 1, value) > found.num_points() / 40));
    }
}

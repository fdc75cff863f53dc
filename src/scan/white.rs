//! How bright a file's white is, told by the distribution of its colors.
//!
//! LAS has 16 bits for a channel and says how many are used nowhere: cameras and exporters write 8, 10, 12 or 16 of
//! them. The largest value would tell, but single values are wrong in many files, and merged files have two whites.

use super::majority::Majority;
use super::merged::Runs;

/// Values that channels are counted above. Powers of two less one: the whites of 8, 10 and 12 bits, and octaves
/// beside them.
const LIMITS: [u16; 8] = [0, 15, 255, 511, 1023, 2047, 4095, 8191];
/// Part of all channels that may lie above the white: such values are wrong.
const MOST_WRONG: f64 = 0.002;
/// The same as a part of the channels that are not zero: in a mostly black file, few values are many.
const MOST_WRONG_OF_NONZERO: f64 = 0.1;
/// Part of the channels above 255 that repeat a byte, above which all were made of bytes.
const MADE_OF_BYTES: f64 = 0.99;
/// Fewer channels than this are no second distribution.
const FEWEST_OF_TWO: u64 = 60;
/// Part of all channels that a second distribution of 8 bits has for its channels alone to tell.
const LARGE_PART: f64 = 0.1;
/// Values that the brightest channel of points is counted above, to tell points of 8 bits from those of 16.
const PEAK_LIMITS: [u16; 6] = [15, 191, 255, 319, 1023, 4095];
/// Fewer points than this, or a lesser part of all, are no second distribution.
const FEWEST_POINTS_OF_TWO: u64 = 20;
const LEAST_OF_TWO: f64 = 0.003;
/// Part of the points of 8 bits that are in its brightest quarter, and how many times what follows up to 319 they are: what
/// thins out towards 255 and beyond is the noise of black of 16 bits.
const LEAST_BRIGHT: f64 = 0.15;
const CUT_OFF: u64 = 8;
/// So many times as many channels from 16 to 255 as from 256 to 511, and few above: those are whites that were rounded up.
const ROUNDED_UP: u64 = 20;
/// Points of a pass: their channels stay in the first cache for all that is counted, and counts fit 16 bits.
const PASS: usize = (1 << 13) / 3;
/// Of a run of more passes, one in so many is counted: a distribution needs no more, and reading waits for it.
const MOST_FULL_PASSES: usize = 4;

/// The colors of a run of points, counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ColorCounts {
    /// Points that have a color, black or not.
    pub num_points: u64,
    /// Points of which all channels are 0.
    pub num_black: u64,
    /// The color that most points have.
    pub majority: Majority,
    /// The white, where the reader knows it.
    pub known: Option<u16>,
    /// Channels that were counted.
    num_channels: u64,
    /// Those of them above each of [`LIMITS`].
    above: [u64; LIMITS.len()],
    /// Points that were counted.
    num_counted: u64,
    /// Those of them whose brightest channel is above each of [`PEAK_LIMITS`].
    peaks: [u64; PEAK_LIMITS.len()],
    /// Runs of the points that were counted.
    runs: Runs,
    /// Channels above 255 whose low byte is 0 or their high byte: 8 bits made 16, by shifting or by repeating.
    bytes: u64,
}

/// The stored value that stands for full brightness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum White {
    /// The same in the whole file: 255, 1023, 4095 or 65535.
    One(u16),
    /// 255 for points that have no channel above it, 65535 for the others.
    Two,
    /// 255 for some tiles, this for the others.
    Tiles(u16),
}

impl ColorCounts {
    /// Of no points; the neutral element of [`ColorCounts::union`].
    pub const NONE: Self = Self {
        num_points: 0,
        num_black: 0,
        majority: Majority::NONE,
        known: None,
        num_channels: 0,
        above: [0; LIMITS.len()],
        num_counted: 0,
        peaks: [0; PEAK_LIMITS.len()],
        runs: Runs::NONE,
        bytes: 0,
    };

    /// Of these points.
    pub fn of(rgb: &[[u16; 3]]) -> Self {
        let mut counts = Self {
            num_points: rgb.len() as u64,
            num_black: rgb.iter().map(|rgb| u64::from(rgb[0] | rgb[1] | rgb[2] == 0)).sum(),
            majority: Majority::of(rgb),
            ..Self::NONE
        };
        let passes = rgb.chunks(PASS);
        let step = if passes.len() > MOST_FULL_PASSES { MOST_FULL_PASSES } else { 1 };
        passes.step_by(step).for_each(|pass| counts.add(pass));
        counts
    }

    fn add(&mut self, rgb: &[[u16; 3]]) {
        let channels = rgb.as_flattened();
        let count = |is: &dyn Fn(u16) -> bool| count(channels, is);
        self.num_channels += channels.len() as u64;
        let largest = channels.iter().fold(0, |largest, &c| largest.max(c));
        for (above, limit) in self.above.iter_mut().zip(LIMITS) {
            // Most files have 8 bits: nothing to count for most limits.
            if largest > limit {
                *above += count(&|c| c > limit);
            }
        }
        if largest > 255 {
            self.bytes += count(&|c| c > 255 && (c & 255 == 0 || c & 255 == c >> 8));
        }
        self.num_counted += rgb.len() as u64;
        let mut peaks = [0; PASS];
        for (peak, [r, g, b]) in peaks.iter_mut().zip(rgb) {
            *peak = *r.max(g).max(b);
        }
        let peaks = &peaks[..rgb.len().min(PASS)];
        for (above, limit) in self.peaks.iter_mut().zip(PEAK_LIMITS) {
            if largest > limit {
                *above += self::count(peaks, |c| c > limit);
            }
        }
        self.runs.add(peaks);
    }

    /// Of both runs together.
    pub fn union(self, other: Self) -> Self {
        Self {
            num_points: self.num_points + other.num_points,
            num_black: self.num_black + other.num_black,
            majority: self.majority.union(other.majority),
            known: self.known.or(other.known),
            num_channels: self.num_channels + other.num_channels,
            above: std::array::from_fn(|at| self.above[at] + other.above[at]),
            num_counted: self.num_counted + other.num_counted,
            peaks: std::array::from_fn(|at| self.peaks[at] + other.peaks[at]),
            runs: self.runs.union(other.runs),
            bytes: self.bytes + other.bytes,
        }
    }

    /// The file's white.
    pub fn white(&self) -> White {
        if let Some(white) = self.known {
            return White::One(white);
        }
        if self.is_wrong(self.above(255)) || self.is_rounded_up() {
            return White::One(255);
        }
        if self.has_two() {
            return White::Two;
        }
        // Colors made of bytes are of 16 bits, however dark.
        if self.is_made_of_bytes() {
            return White::One(u16::MAX);
        }
        let ends = |white: u16| {
            let top = self.above(white / 2) - self.above(white);
            let next = self.above(white) - self.above(2 * white + 1);
            // Where full brightness is cut off, next to nothing follows; the highlights of a dark scan thin out.
            self.is_wrong(self.above(white)) && next <= 3 + top / 50
        };
        match [1023, 4095].into_iter().find(|&white| ends(white)) {
            Some(white) if self.runs.are_merged() => White::Tiles(white),
            None if self.runs.are_merged() => White::Two,
            white => White::One(white.unwrap_or(u16::MAX)),
        }
    }

    /// Channels above one of [`LIMITS`].
    fn above(&self, limit: u16) -> u64 {
        LIMITS.iter().position(|&l| l == limit).map_or(0, |at| self.above[at])
    }

    /// True if so few channels are no proof. A single point is none beside ten.
    fn is_wrong(&self, num_channels: u64) -> bool {
        let (all, nonzero) = (self.num_channels as f64, self.above(0) as f64);
        let few = num_channels as f64 <= (MOST_WRONG * all).max(3.0);
        num_channels == 0 || few && num_channels as f64 <= MOST_WRONG_OF_NONZERO * nonzero
    }

    /// True if all are 8 bits, but some of the brightest came out as 256 or a little more.
    fn is_rounded_up(&self) -> bool {
        let (low, next) = (self.above(15) - self.above(255), self.above(255) - self.above(511));
        self.is_wrong(self.above(511)) && low > ROUNDED_UP * next
    }

    /// True if points of 8 and of 16 bits are mixed: then there is a valley between what is dark to bright of 8 bits
    /// and what is bright of 16, at what is almost black of 16. A single scene has its values side by side.
    fn has_two(&self) -> bool {
        let low = self.above(15) - self.above(255);
        let valley = self.above(255) - self.above(1023);
        let high = self.above(4095);
        let are_many = low >= FEWEST_OF_TWO && !self.is_wrong(low) && !self.is_wrong(high);
        // Bytes made 16 bits have nothing below 256 of their own.
        let is_large = low as f64 >= LARGE_PART * self.num_channels as f64;
        let is_valley = is_large && low > 2 * valley && high > valley || self.is_made_of_bytes();
        are_many && is_valley || self.has_few_of_two()
    }

    /// The same where one kind is a small part. Its channels drown among the dark channels of bright points; its points
    /// do not, since few points are dark in all channels.
    fn has_few_of_two(&self) -> bool {
        let [dark, bright, eight, next, valley_end, high] = self.peaks;
        let (low, bright) = (dark - eight, bright - eight);
        let valley = eight - valley_end;
        let many =
            |num: u64| num >= FEWEST_POINTS_OF_TWO && num as f64 >= LEAST_OF_TWO * self.num_counted as f64;
        many(low)
            && many(high)
            && low > 2 * valley
            && high > valley
            && bright as f64 >= LEAST_BRIGHT * low as f64
            && bright > CUT_OFF * (eight - next)
    }

    fn is_made_of_bytes(&self) -> bool {
        self.bytes as f64 >= MADE_OF_BYTES * self.above(255) as f64
    }
}

/// At most 65 535 values that are so.
pub(super) fn count(values: &[u16], is: impl Fn(u16) -> bool) -> u64 {
    u64::from(values.iter().map(|&value| u16::from(is(value))).sum::<u16>())
}

#[cfg(test)]
#[path = "white_tests.rs"]
mod tests;

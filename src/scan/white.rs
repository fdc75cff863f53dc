//! How bright a file's white is, told by the distribution of its colors.
//!
//! LAS has 16 bits for a channel and says how many are used nowhere: cameras and exporters write 8, 10, 12 or 16 of
//! them. The largest value would tell, but single values are wrong in many files, and merged files have two whites.

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
/// Channels of a pass: they stay in the first cache for all passes, and their counts fit 16 bits.
const PASS: usize = 1 << 13;
/// Of a run of more passes, one in so many is counted: a distribution needs no more, and reading waits for it.
const MOST_FULL_PASSES: usize = 4;

/// The colors of a run of points, counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ColorCounts {
    /// Points that have a color, black or not.
    pub num_points: u64,
    /// Points of which all channels are 0.
    pub num_black: u64,
    /// The color of the first point, and true if all others have it.
    pub one: Option<([u16; 3], bool)>,
    /// The white, where the reader knows it.
    pub known: Option<u16>,
    /// Channels that were counted.
    num_channels: u64,
    /// Those of them above each of [`LIMITS`].
    above: [u64; LIMITS.len()],
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
}

impl ColorCounts {
    /// Of no points; the neutral element of [`ColorCounts::union`].
    pub const NONE: Self = Self {
        num_points: 0,
        num_black: 0,
        one: None,
        known: None,
        num_channels: 0,
        above: [0; LIMITS.len()],
        bytes: 0,
    };

    /// Of these points.
    pub fn of(rgb: &[[u16; 3]]) -> Self {
        let Some(&first) = rgb.first() else { return Self::NONE };
        let mut counts = Self {
            num_points: rgb.len() as u64,
            num_black: rgb.iter().map(|rgb| u64::from(rgb[0] | rgb[1] | rgb[2] == 0)).sum(),
            one: Some((first, rgb.iter().all(|rgb| *rgb == first))),
            ..Self::NONE
        };
        let passes = rgb.as_flattened().chunks(PASS);
        let step = if passes.len() > MOST_FULL_PASSES { MOST_FULL_PASSES } else { 1 };
        passes.step_by(step).for_each(|pass| counts.add(pass));
        counts
    }

    fn add(&mut self, channels: &[u16]) {
        let count =
            |is: &dyn Fn(u16) -> bool| u64::from(channels.iter().map(|&c| u16::from(is(c))).sum::<u16>());
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
    }

    /// Of both runs together.
    pub fn union(self, other: Self) -> Self {
        let one = match (self.one, other.one) {
            (Some((a, a_all)), Some((b, b_all))) => Some((a, a_all && b_all && a == b)),
            (one, None) | (None, one) => one,
        };
        Self {
            num_points: self.num_points + other.num_points,
            num_black: self.num_black + other.num_black,
            one,
            known: self.known.or(other.known),
            num_channels: self.num_channels + other.num_channels,
            above: std::array::from_fn(|at| self.above[at] + other.above[at]),
            bytes: self.bytes + other.bytes,
        }
    }

    /// The color that all points have, if there are several: it tells nothing of any of them. Black tells nothing of
    /// a single point either.
    pub fn constant(&self) -> Option<[u16; 3]> {
        let (color, all) = self.one?;
        (all && (self.num_points > 1 || color == [0; 3])).then_some(color)
    }

    /// The file's white.
    pub fn white(&self) -> White {
        if let Some(white) = self.known {
            return White::One(white);
        }
        if self.is_wrong(self.above(255)) {
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
        White::One([1023, 4095].into_iter().find(|&white| ends(white)).unwrap_or(u16::MAX))
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

    /// True if points of 8 and of 16 bits are mixed: then there is a valley between what is dark to bright of 8 bits
    /// and what is bright of 16, at what is almost black of 16. A single scene has its values side by side.
    fn has_two(&self) -> bool {
        let low = self.above(15) - self.above(255);
        let valley = self.above(255) - self.above(1023);
        let high = self.above(4095);
        let are_many = low >= FEWEST_OF_TWO && !self.is_wrong(low) && !self.is_wrong(high);
        // Bytes made 16 bits have nothing below 256 of their own.
        are_many && (low > 2 * valley && high > valley || self.is_made_of_bytes())
    }

    fn is_made_of_bytes(&self) -> bool {
        self.bytes as f64 >= MADE_OF_BYTES * self.above(255) as f64
    }
}

#[cfg(test)]
#[path = "white_tests.rs"]
mod tests;

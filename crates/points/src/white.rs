//! Tells how bright a file's white is by the distribution of its colors.
//!
//! LAS has 16 bits for a channel and nowhere says how many are used: cameras and exporters write 8, 10, 12 or 16 of
//! them. The largest value would tell, but single values are wrong in many files, and merged files have two whites.

use super::distribution::{Distribution, LESSER_WHITES};
use super::merged::{LEAST_BRIGHT, LEAST_MIDDLE, ToldBy, bright};

/// Part of all channels that may lie above the white: such values are wrong.
const MOST_WRONG: f64 = 0.002;
/// Part of the channels that are not zero that may lie above the white: in a mostly black file, a few values are many.
const MOST_WRONG_OF_NONZERO: f64 = 0.1;
/// All colors were made of bytes if at least this part of the channels above 255 are bytes, shifted or repeated.
const MADE_OF_BYTES: f64 = 0.99;
/// Fewer channels than this are no second distribution.
const FEWEST_OF_TWO: u64 = 60;
/// Least part of all channels that a second distribution of 8 bits has, where its channels alone tell it.
const LARGE_PART: f64 = 0.1;
/// Fewer points than this are no second distribution.
const FEWEST_POINTS_OF_TWO: u64 = 20;
/// A lesser part of all points than this is no second distribution.
const LEAST_OF_TWO: f64 = 0.003;
/// Points in the brightest quarter of 8 bits are more than this many times as many as points above, up to 319: points
/// that thin out toward 255 and beyond are the noise of black of 16 bits.
const CUT_OFF: u64 = 8;
/// Channels from 256 to 511 are whites that were rounded up if channels from 16 to 255 are more than this many times as
/// many, and few lie above.
const ROUNDED_UP: u64 = 20;
/// An octave has at least this many times as many channels as the next where full brightness is cut off.
const CUT_OFF_OCTAVE: u64 = 50;
/// Largest part of all channels that may be wild values above a white.
const MOST_WILD: f64 = 0.05;
/// Wild values are at least this many times as many as the channels in the octave above the white.
const WILD_NEXT: u64 = 4;
/// Least part that the octave below a white has of the channels that are not zero.
const LEAST_TOP: f64 = 0.1;
/// A sharp edge at a white, which leaves no doubt.
const SHARP: Edge = Edge { part: 64, least: 0.005, times: 4 };
/// A blunt edge at a white, which a shade of a single scene may look like.
const BLUNT: Edge = Edge { part: 16, least: 0.03, times: 8 };
/// Largest part of the points up to the lesser white that may be dark points of the greater, where single points tell
/// their white.
const MOST_DOUBTFUL: f64 = 0.05;

/// The stored value that stands for full brightness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum White {
    /// One white in the whole file: 255, 1023, 4095 or 65535.
    One(u16),
    /// The white `low` in some parts of the file, `high` in others.
    Two { low: u16, high: u16, told_by: ToldBy },
}

impl White {
    /// The greatest white of the file.
    pub fn full(self) -> u16 {
        match self {
            Self::One(white) | Self::Two { high: white, .. } => white,
        }
    }

    /// The least white of the file.
    pub fn least(self) -> u16 {
        match self {
            Self::One(white) | Self::Two { low: white, .. } => white,
        }
    }

    /// The white that the reader knows, or else that of colors with this distribution.
    pub fn known_or_of(known: Option<u16>, colors: &Distribution) -> Self {
        known.map_or_else(|| Self::of(colors), Self::One)
    }

    fn of(colors: &Distribution) -> Self {
        if is_wrong(colors, colors.above(255)) || is_rounded_up(colors) {
            return Self::One(255);
        }
        let is_two = has_two(colors);
        // Colors made of bytes are of 16 bits, however dark.
        let high = match [1023, 4095].into_iter().find(|&white| ends(colors, white)) {
            Some(white) if !is_two && !is_made_of_bytes(colors) => white,
            _ => u16::MAX,
        };
        let lesser = || LESSER_WHITES.into_iter().filter(|&low| low < high);
        let two = |low, told_by| Self::Two { low, high, told_by };
        let merged =
            LESSER_WHITES.into_iter().zip(colors.runs).find(|(low, runs)| *low < high && runs.are_merged());
        if is_two {
            let tiles = merged.is_some_and(|(low, _)| low == 255);
            return two(255, if tiles { ToldBy::Tiles } else { ToldBy::Points });
        }
        if is_made_of_bytes(colors) {
            return Self::One(high);
        }
        if let Some((low, _)) = merged {
            return two(low, ToldBy::Tiles);
        }
        if let Some(low) = lesser().find(|&low| has_wild(colors, low)) {
            return two(low, ToldBy::Points);
        }
        let edge = lesser().find_map(|low| Some((low, told_at_edge(colors, low)?)));
        edge.map_or(Self::One(high), |(low, told_by)| two(low, told_by))
    }
}

/// True if this few channels are no proof. A single point is no proof beside ten.
fn is_wrong(colors: &Distribution, num_channels: u64) -> bool {
    let (all, nonzero) = (colors.num_channels() as f64, colors.above(0) as f64);
    let few = num_channels as f64 <= (MOST_WRONG * all).max(3.0);
    num_channels == 0 || few && num_channels as f64 <= MOST_WRONG_OF_NONZERO * nonzero
}

/// True if all channels have 8 bits, but some of the brightest came out as 256 or a little more.
fn is_rounded_up(colors: &Distribution) -> bool {
    is_wrong(colors, colors.above(511)) && colors.between(15, 255) > ROUNDED_UP * colors.between(255, 511)
}

/// True if full brightness is cut off at this white, so that next to nothing follows. The highlights of a dark scan
/// thin out instead.
fn ends(colors: &Distribution, white: u16) -> bool {
    is_wrong(colors, colors.above(white)) && is_cut_off(colors, white)
}

fn is_cut_off(colors: &Distribution, white: u16) -> bool {
    let [top, next] = octaves(colors, white);
    next <= 3 + top / CUT_OFF_OCTAVE
}

/// Number of channels in the octave below a white, and in the octave above.
fn octaves(colors: &Distribution, white: u16) -> [u64; 2] {
    [colors.between(white / 2, white), colors.between(white, 2 * white + 1)]
}

/// True if full brightness is cut off at this white, except for some wild values far above.
fn has_wild(colors: &Distribution, white: u16) -> bool {
    let [top, next] = octaves(colors, white);
    let beyond = colors.above(2 * white + 1);
    is_cut_off(colors, white)
        && WILD_NEXT * next <= beyond
        && beyond as f64 <= MOST_WILD * colors.num_channels() as f64
        && top as f64 >= LEAST_TOP * colors.above(0) as f64
}

/// True if points of 8 and of 16 bits are mixed. There is then a valley between the values of 8 bits, from dark to
/// bright, and the bright values of 16, where values of 16 bits are almost black. A single scene has its values side by
/// side.
fn has_two(colors: &Distribution) -> bool {
    let (low, valley, high) = (colors.between(15, 255), colors.between(255, 1023), colors.above(4095));
    let are_many = low >= FEWEST_OF_TWO && !is_wrong(colors, low) && !is_wrong(colors, high);
    // Bytes that were made 16 bits have no values of their own below 256.
    let is_large = low as f64 >= LARGE_PART * colors.num_channels() as f64;
    let is_valley = is_large && low > 2 * valley && high > valley || is_made_of_bytes(colors);
    are_many && is_valley || has_few_of_two(colors)
}

/// True if points of 8 and of 16 bits are mixed and one kind is a small part. Its channels drown among the dark
/// channels of bright points, but its points do not, since few points are dark in all channels.
fn has_few_of_two(colors: &Distribution) -> bool {
    let peaks = &colors.peaks;
    let (low, bright, next) =
        (peaks.between(15, 255), peaks.between(bright(255), 255), peaks.between(255, 319));
    let (valley, high) = (peaks.between(255, 1023), peaks.above(4095));
    are_many(colors, low)
        && are_many(colors, high)
        && low > 2 * valley
        && high > valley
        && bright as f64 >= LEAST_BRIGHT * low as f64
        && bright > CUT_OFF * next
}

fn are_many(colors: &Distribution, num_points: u64) -> bool {
    num_points >= FEWEST_POINTS_OF_TWO && num_points as f64 >= LEAST_OF_TWO * colors.num_points() as f64
}

fn is_made_of_bytes(colors: &Distribution) -> bool {
    colors.num_bytes() as f64 >= MADE_OF_BYTES * colors.above(255) as f64
}

/// An edge at a white in the distribution of points. Points below, within the white divided by `part`, are at least
/// `least` of all points up to the white, and more than `times` as many as the points above.
struct Edge {
    part: u16,
    least: f64,
    times: u64,
}

impl Edge {
    /// Number of points this near to a white, below and above.
    fn beside(&self, colors: &Distribution, white: u16) -> [u64; 2] {
        let width = (white + 1) / self.part;
        [colors.peaks.between(white - width, white), colors.peaks.between(white, white + width)]
    }

    /// True if many of the `num_low` points up to a white are near to it, and few are above.
    fn is_at(&self, colors: &Distribution, white: u16, num_low: u64) -> bool {
        let [below, above] = self.beside(colors, white);
        below >= FEWEST_POINTS_OF_TWO
            && below as f64 >= self.least * num_low as f64
            && below > self.times * above
    }
}

/// How points are told apart if some of them, from dark to bright, end at this white as if cut off, although others go
/// on. `None` if none do.
fn told_at_edge(colors: &Distribution, white: u16) -> Option<ToldBy> {
    let peaks = &colors.peaks;
    let low = peaks.between(white / 16, white);
    let part = |num: u64, least: f64| num as f64 >= least * low as f64;
    let is_spread = part(peaks.between(bright(white), white), LEAST_BRIGHT)
        && part(peaks.between(white / 2, bright(white)), LEAST_MIDDLE);
    if !is_spread || !are_many(colors, low) || !are_many(colors, peaks.above(white)) {
        return None;
    }
    let is_sharp = SHARP.is_at(colors, white, low);
    // Points of the greater white may be as many at each value as there are just above the edge.
    let num_doubtful = u64::from(BLUNT.part) * BLUNT.beside(colors, white)[1];
    let is_clear = num_doubtful as f64 <= MOST_DOUBTFUL * peaks.between(0, white) as f64;
    (is_sharp || BLUNT.is_at(colors, white, low)).then_some(if is_sharp && is_clear {
        ToldBy::Points
    } else {
        ToldBy::Unknown
    })
}

#[cfg(test)]
#[path = "white_tests.rs"]
mod tests;

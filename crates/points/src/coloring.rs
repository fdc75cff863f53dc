//! How a file's points are colored: decided once when the file, or the scan, is read, and applied where colors are
//! needed. The columns stay as they are stored.

use super::distribution::peak_of;
use super::ramp::{byte, pack, ramp};
use super::{Blank, Marks, ScanFile};

/// Which column a file is colored by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColorSource {
    /// `rgb` holds 8-bit values.
    Rgb8,
    /// `rgb` holds 10-bit values; 8-bit color = round(c · 255 / 1023).
    Rgb10,
    /// `rgb` holds 12-bit values; 8-bit color = round(c · 255 / 4095).
    Rgb12,
    /// `rgb` holds 16-bit values; 8-bit color = round(c / 257).
    Rgb16,
    /// No color: intensity through the ramp, from `low` to `high` of the scan.
    Intensity {
        /// Value at the dark end.
        low: f64,
        /// Value at the bright end.
        high: f64,
    },
    /// Neither color nor intensity: height (world z) through the ramp, from `low` to `high` of the scan.
    Height {
        /// Height at the dark end.
        low: f64,
        /// Height at the bright end.
        high: f64,
    },
}

impl Default for ColorSource {
    /// Height, without a range yet.
    fn default() -> Self {
        Self::Height { low: 0.0, high: 0.0 }
    }
}

impl ColorSource {
    /// The source for stored colors whose full brightness is `white`.
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

/// How the points of a file get their colors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coloring {
    /// The column that the file is colored by.
    pub source: ColorSource,
    /// The color that stands for none.
    pub blank: Option<Blank>,
    /// Grays of points without a color, where others have one.
    pub(super) grays: Option<Grays>,
    /// Raises that make colors of fewer bits as bright as the others.
    pub(super) raised: Raised,
}

impl Coloring {
    /// Colors all points by one column, without blanks, grays or raises.
    #[must_use]
    pub fn by(source: ColorSource) -> Self {
        Self { source, ..Self::default() }
    }
}

/// Grays for points without a color.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grays {
    /// True if the gray follows intensity, false if it follows height.
    pub by_intensity: bool,
    /// Values at the dark end and at the bright end.
    pub ends: [f64; 2],
}

/// Darkest and brightest gray of points without a color, as parts of white: both are seen before black and before
/// white.
const GRAYS: [f64; 2] = [0.25, 0.75];

impl Grays {
    /// The gray that stands for a value, beside colors of this white.
    fn of(self, value: f64, white: u16) -> u16 {
        let [low, high] = self.ends;
        let t = if high > low { ((value - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 };
        (f64::from(white) * (GRAYS[0] + (GRAYS[1] - GRAYS[0]) * t)).round() as u16
    }
}

/// Raises that make some colors of a file as bright as the others, in the order in which they apply.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Raised {
    raises: Vec<Raise>,
    /// Points that have this color are left alone.
    spared: Option<Blank>,
}

/// Some points whose white is less than that of the others.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Raise {
    pub low: u16,
    pub high: u16,
    pub points: RaisedPoints,
}

/// The points that a raise brightens.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum RaisedPoints {
    /// Points without a channel above the lesser white.
    Dark,
    /// Points with these marks.
    Marked(Marks),
}

impl Raise {
    /// The raised color of a point.
    fn apply(&self, number: usize, rgb: [u16; 3]) -> [u16; 3] {
        let is_low = match &self.points {
            RaisedPoints::Dark => peak_of(&rgb) <= self.low,
            RaisedPoints::Marked(marks) => marks.get(number),
        };
        let (low, high) = (u64::from(self.low), u64::from(self.high));
        // The result is at most `high`, which is a u16, because `c` is at most `low`.
        let raised = |c: u16| if c > self.low { c } else { ((u64::from(c) * high + low / 2) / low) as u16 };
        if is_low { rgb.map(raised) } else { rgb }
    }
}

impl Raised {
    /// Adds a raise, which applies to colors as the earlier raises leave them.
    pub fn add(&mut self, raise: Raise) {
        self.raises.push(raise);
    }

    /// True if all colors stay as stored.
    pub fn is_none(&self) -> bool {
        self.raises.is_empty()
    }

    /// The color of a point whose stored color is `stored`.
    #[inline]
    pub fn color(&self, number: usize, stored: [u16; 3]) -> [u16; 3] {
        if self.is_none() || self.spared.is_some_and(|blank| blank.is(stored)) {
            return stored;
        }
        self.raises.iter().fold(stored, |rgb, raise| raise.apply(number, rgb))
    }

    /// Turns raises of the points that are not `spared` into raises of the whole file, in which these points have the
    /// given numbers.
    pub fn beside(self, spared: Blank, numbers: &[usize]) -> Self {
        let renumbered = |mut raise: Raise| {
            if let RaisedPoints::Marked(marks) = &mut raise.points {
                let mut in_file = Marks::default();
                let marked = numbers.iter().enumerate().filter(|(number, _)| marks.get(*number));
                marked.for_each(|(_, &number)| in_file.set(number));
                *marks = in_file;
            }
            raise
        };
        Self { raises: self.raises.into_iter().map(renumbered).collect(), spared: Some(spared) }
    }
}

impl ScanFile {
    /// Color of a point: r | g≪8 | b≪16 | 255≪24, sRGB.
    ///
    /// # Panics
    /// If there is no point `index`.
    #[must_use]
    pub fn color(&self, index: usize) -> u32 {
        match self.coloring.source {
            ColorSource::Rgb8 => self.packed(index, 255),
            ColorSource::Rgb10 => self.packed(index, 1023),
            ColorSource::Rgb12 => self.packed(index, 4095),
            ColorSource::Rgb16 => self.packed(index, u16::MAX),
            ColorSource::Intensity { low, high } => ramp(f64::from(self.points.intensity[index]), low, high),
            ColorSource::Height { low, high } => ramp(self.height(index), low, high),
        }
    }

    #[inline]
    fn packed(&self, index: usize, white: u16) -> u32 {
        pack(self.rgb(index, white).map(|c| byte(c, white)))
    }

    /// Red, green and blue of a point, as parts of `white`.
    #[inline]
    pub(super) fn rgb(&self, index: usize, white: u16) -> [u16; 3] {
        let Coloring { blank, grays, raised, .. } = &self.coloring;
        let rgb = raised.color(index, self.points.rgb[index]);
        match (grays, blank) {
            (Some(grays), Some(blank)) if blank.is(rgb) => {
                [grays.of(self.gray_value(index, *grays), white); 3]
            }
            _ => rgb,
        }
    }

    fn gray_value(&self, index: usize, grays: Grays) -> f64 {
        if grays.by_intensity { self.intensity(index) } else { self.height(index) }
    }

    /// Intensity of a point; 0 where there is none.
    pub(super) fn intensity(&self, index: usize) -> f64 {
        self.points.intensity.get(index).map_or(0.0, |&value| f64::from(value))
    }

    /// World z of a point.
    pub(super) fn height(&self, index: usize) -> f64 {
        self.grid.offset.z + self.grid.scale.z * f64::from(self.points.xyz[index][2])
    }
}

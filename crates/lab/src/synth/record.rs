//! A point as LAS stores it: the fields, and their bytes in the two point formats that we write.

use glam::DVec3;
use points::Grid;

/// How a file's points are stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrittenLayout {
    /// Point format.
    pub format: WrittenFormat,
    /// Grid of the coordinates.
    pub grid: Grid,
}

/// The LAS point formats that we write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WrittenFormat {
    /// LAS 1.2, point format 2: color, no time.
    Rgb2,
    /// LAS 1.4, point format 7: color and time.
    Rgb7,
}

impl WrittenFormat {
    /// Number of the format in the header.
    pub fn id(self) -> u8 {
        match self {
            Self::Rgb2 => 2,
            Self::Rgb7 => 7,
        }
    }

    /// Bytes per point.
    pub fn record_bytes(self) -> u16 {
        match self {
            Self::Rgb2 => 26,
            Self::Rgb7 => 36,
        }
    }
}

/// Record of one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrittenRecord {
    /// Grid coordinates.
    pub xyz: [i32; 3],
    /// Strength of the return.
    pub intensity: u16,
    /// Number of the return within its pulse, from 1.
    pub return_number: u8,
    /// Number of returns of the pulse.
    pub num_returns: u8,
    /// ASPRS class.
    pub class: u8,
    /// True if the mirror moves in the positive direction.
    pub forward: bool,
    /// Angle off nadir in degrees, positive to the right of the flight direction.
    pub scan_angle_deg: f32,
    /// Number of the station or strip.
    pub source: u16,
    /// GPS time, seconds.
    pub gps_time: f64,
    /// Red, green, blue.
    pub rgb: [u16; 3],
}

impl WrittenRecord {
    /// The grid point nearest to `p_in_world`.
    pub fn snap(grid: &Grid, p_in_world: DVec3) -> [i32; 3] {
        ((p_in_world - grid.offset) / grid.scale).round().to_array().map(|c| c as i32)
    }

    /// Appends the bytes, little endian.
    pub fn encode(&self, format: WrittenFormat, out: &mut Vec<u8>) {
        for c in self.xyz {
            out.extend(c.to_le_bytes());
        }
        out.extend(self.intensity.to_le_bytes());
        let direction = u8::from(self.forward) << 6;
        match format {
            WrittenFormat::Rgb2 => {
                out.push((self.return_number & 7) | (self.num_returns & 7) << 3 | direction);
                out.extend([self.class, (self.scan_angle_deg.round() as i8) as u8, 0]);
                out.extend(self.source.to_le_bytes());
            }
            WrittenFormat::Rgb7 => {
                out.push((self.return_number & 15) | self.num_returns << 4);
                out.extend([direction, self.class, 0]);
                out.extend(((self.scan_angle_deg / 0.006).round() as i16).to_le_bytes());
                out.extend(self.source.to_le_bytes());
                out.extend(self.gps_time.to_le_bytes());
            }
        }
        for c in self.rgb {
            out.extend(c.to_le_bytes());
        }
    }
}

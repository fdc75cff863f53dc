//! A point record: where its columns lie, and how records become columns.

use crate::scan::Points;

/// Bytes of a standard record, by point format 0–10.
const RECORD_BYTES: [u16; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];
/// First byte of red, green, blue, by point format; 0: no colour.
const RGB_OFFSET: [usize; 11] = [0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30];
/// First byte of the intensity, in every format.
const INTENSITY_OFFSET: usize = 12;

/// Where the columns lie in a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// Bytes from one record to the next; at least what the columns need.
    pub record_bytes: usize,
    /// First byte of x, y, z; the intensity follows them.
    pub core_offset: usize,
    /// First byte of red, green, blue.
    pub rgb_offset: Option<usize>,
}

/// Bytes of a standard record; `None` for a format that does not exist.
pub(super) fn standard_bytes(point_format: u8) -> Option<u16> {
    RECORD_BYTES.get(usize::from(point_format)).copied()
}

impl Layout {
    /// Records of a LAS file; `None` if the format does not exist or the records are too short for it.
    pub fn of_format(point_format: u8, record_bytes: u16) -> Option<Self> {
        if record_bytes < standard_bytes(point_format)? {
            return None;
        }
        let rgb_offset = RGB_OFFSET[usize::from(point_format)];
        let rgb_offset = (rgb_offset > 0).then_some(rgb_offset);
        Some(Self { record_bytes: usize::from(record_bytes), core_offset: 0, rgb_offset })
    }

    /// Parses whole records into columns of the same number of points; columns that are empty are left out.
    ///
    /// One pass a column: a block of records stays in the cache, and each pass is a plain strided copy.
    pub fn parse(&self, records: &[u8], xyz: &mut [[i32; 3]], rgb: &mut [[u16; 3]], intensity: &mut [u16]) {
        let core = self.core_offset;
        for (p, record) in xyz.iter_mut().zip(records.chunks_exact(self.record_bytes)) {
            *p = le_xyz(&record[core..]);
        }
        for (value, record) in intensity.iter_mut().zip(records.chunks_exact(self.record_bytes)) {
            *value = le_u16(&record[core + INTENSITY_OFFSET..]);
        }
        if let Some(offset) = self.rgb_offset {
            for (color, record) in rgb.iter_mut().zip(records.chunks_exact(self.record_bytes)) {
                *color = le_rgb(&record[offset..]);
            }
        }
    }

    /// Appends one record.
    pub fn push(&self, record: &[u8], points: &mut Points) {
        let core = &record[self.core_offset..];
        points.xyz.push(le_xyz(core));
        points.intensity.push(le_u16(&core[INTENSITY_OFFSET..]));
        if let Some(offset) = self.rgb_offset {
            points.rgb.push(le_rgb(&record[offset..]));
        }
    }
}

fn le_xyz(bytes: &[u8]) -> [i32; 3] {
    let bytes: &[u8; 12] = bytes.first_chunk().unwrap_or(&[0; 12]);
    std::array::from_fn(|axis| {
        let at = 4 * axis;
        i32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
    })
}

fn le_rgb(bytes: &[u8]) -> [u16; 3] {
    let bytes: &[u8; 6] = bytes.first_chunk().unwrap_or(&[0; 6]);
    std::array::from_fn(|channel| u16::from_le_bytes([bytes[2 * channel], bytes[2 * channel + 1]]))
}

fn le_u16(bytes: &[u8]) -> u16 {
    bytes.first_chunk().map_or(0, |bytes| u16::from_le_bytes(*bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_equal_pushed_records() {
        let layout = Layout::of_format(3, 36).unwrap();
        let records: Vec<u8> = (0..36 * 5).map(|byte| (byte * 37 % 251) as u8).collect();
        let mut pushed = Points::default();
        records.chunks(36).for_each(|record| layout.push(record, &mut pushed));
        let (mut xyz, mut rgb, mut intensity) = (vec![[0; 3]; 5], vec![[0; 3]; 5], vec![0; 5]);
        layout.parse(&records, &mut xyz, &mut rgb, &mut intensity);
        assert_eq!(pushed, Points { xyz, rgb, intensity, ..Points::default() });
        // The comparison can fail: one byte further is another point.
        let shifted = Layout { core_offset: 1, ..layout };
        let mut other = Points::default();
        records.chunks(36).for_each(|record| shifted.push(record, &mut other));
        assert_ne!(pushed, other);
    }

    #[test]
    fn short_records_and_unknown_formats_have_no_layout() {
        assert_eq!(Layout::of_format(3, 33), None);
        assert_eq!(Layout::of_format(11, 200), None);
        assert_eq!(Layout::of_format(0, 20).unwrap().rgb_offset, None);
        for format in 0..=10 {
            assert!(Layout::of_format(format, standard_bytes(format).unwrap()).is_some());
        }
    }
}

//! A point record: where its columns lie, and how records become columns.

use crate::{Marks, Points};

/// Bytes of a standard record, by point format 0–10.
const RECORD_BYTES: [u16; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];
/// First byte of red, green, blue, by point format; 0: no colour.
const RGB_OFFSET: [usize; 11] = [0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30];
/// First byte of the intensity, in every format.
const INTENSITY_OFFSET: usize = 12;

/// Classes whose points are noise, in all formats: low and high.
const NOISE_CLASSES: [u8; 2] = [7, 18];
/// What a record says of its point, as bits: that it is deleted, that it is noise.
const WITHHELD: u8 = 1;
const NOISE: u8 = 2;

/// Where a record has its point's class, and the flag that says that it is withheld [LAS 1.4 R15, tables 8 and 16].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Flags {
    /// Byte of the class.
    class: usize,
    class_bits: u8,
    /// Byte of the flag.
    withheld: usize,
    withheld_bit: u8,
}

impl Flags {
    /// Of point formats 0–5: class and flags share a byte.
    pub const LEGACY: Self = Self { class: 15, class_bits: 0x1f, withheld: 15, withheld_bit: 0x80 };
    /// Of LAS 1.0, which knew no flags.
    pub const FIRST: Self = Self { withheld_bit: 0, ..Self::LEGACY };
    /// Of point formats 6–10.
    pub const EXTENDED: Self = Self { class: 16, class_bits: 0xff, withheld: 15, withheld_bit: 0x04 };

    /// What a record says, from its first byte on.
    fn of(self, core: &[u8]) -> u8 {
        let byte = |at: usize| core.get(at).copied().unwrap_or(0);
        let withheld = if byte(self.withheld) & self.withheld_bit == 0 { 0 } else { WITHHELD };
        let is_noise = NOISE_CLASSES.contains(&(byte(self.class) & self.class_bits));
        if is_noise { withheld | NOISE } else { withheld }
    }
}

/// Where the columns lie in a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// Bytes from one record to the next; at least what the columns need.
    pub record_bytes: usize,
    /// First byte of x, y, z; the intensity follows them.
    pub core_offset: usize,
    /// First byte of red, green, blue.
    pub rgb_offset: Option<usize>,
    /// Where it says what its point is.
    pub flags: Flags,
}

/// The columns of a block of records.
pub(super) struct Block<'a> {
    pub xyz: &'a mut [[i32; 3]],
    /// Empty without color.
    pub rgb: &'a mut [[u16; 3]],
    pub intensity: &'a mut [u16],
}

/// What became of a block of records.
#[derive(Debug, Default)]
pub(super) struct Kept {
    /// Points in the columns.
    pub num_points: usize,
    /// Points flagged as withheld, in the columns or not.
    pub num_withheld: u64,
    /// Points that are noise or withheld, by their place in the columns.
    pub noise: Marks,
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
        let flags = if point_format < 6 { Flags::LEGACY } else { Flags::EXTENDED };
        Some(Self { record_bytes: usize::from(record_bytes), core_offset: 0, rgb_offset, flags })
    }

    /// Leaves out of a block that holds the points of these records those that are withheld, unless they are to be
    /// shown, and marks those that are noise.
    pub fn sift(&self, records: &[u8], show_withheld: bool, block: &mut Block) -> Kept {
        let flags = || records.chunks_exact(self.record_bytes).map(|r| self.flags.of(&r[self.core_offset..]));
        let num_points = records.len() / self.record_bytes;
        let mut kept = Kept { num_points, ..Kept::default() };
        // Nearly always there is nothing to do.
        if flags().fold(0, |all, flags| all | flags) == 0 {
            return kept;
        }
        kept.num_points = 0;
        for (from, flags) in flags().enumerate() {
            kept.num_withheld += u64::from(flags & WITHHELD);
            if flags & WITHHELD != 0 && !show_withheld {
                continue;
            }
            let to = kept.num_points;
            if flags != 0 {
                kept.noise.set(to);
            }
            block.xyz[to] = block.xyz[from];
            block.intensity[to] = block.intensity[from];
            if !block.rgb.is_empty() {
                block.rgb[to] = block.rgb[from];
            }
            kept.num_points += 1;
        }
        kept
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

    /// Appends one record, if it is not withheld or that is to be shown.
    pub fn push(&self, record: &[u8], show_withheld: bool, points: &mut Points) {
        let core = &record[self.core_offset..];
        let flags = self.flags.of(core);
        if flags != 0 {
            points.num_withheld += u64::from(flags & WITHHELD);
            if flags & WITHHELD != 0 && !show_withheld {
                return;
            }
            points.noise.set(points.xyz.len());
        }
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
        records.chunks(36).for_each(|record| layout.push(record, true, &mut pushed));
        let (mut xyz, mut rgb, mut intensity) = (vec![[0; 3]; 5], vec![[0; 3]; 5], vec![0; 5]);
        layout.parse(&records, &mut xyz, &mut rgb, &mut intensity);
        let mut block = Block { xyz: &mut xyz, rgb: &mut rgb, intensity: &mut intensity };
        let Kept { num_points, num_withheld, noise } = layout.sift(&records, true, &mut block);
        assert_eq!(num_points, 5);
        assert_eq!(pushed, Points { xyz, rgb, intensity, noise, num_withheld, ..Points::default() });
        // The comparison can fail: one byte further is another point.
        let shifted = Layout { core_offset: 1, ..layout };
        let mut other = Points::default();
        records.chunks(36).for_each(|record| shifted.push(record, true, &mut other));
        assert_ne!(pushed, other);
    }

    /// Records whose x is their number.
    fn records(layout: &Layout, flags: &[[u8; 2]]) -> Vec<u8> {
        let record = |(x, flags): (usize, &[u8; 2])| {
            let mut record = vec![0; layout.record_bytes];
            record[0] = x as u8;
            record[15..17].copy_from_slice(flags);
            record
        };
        flags.iter().enumerate().flat_map(record).collect()
    }

    #[test]
    fn the_withheld_are_left_out_and_noise_is_marked() {
        let legacy = |format| Layout::of_format(format, standard_bytes(format).unwrap()).unwrap();
        let first = Layout { flags: Flags::FIRST, ..legacy(1) };
        // A class, noise, withheld, noise that is withheld, high noise, and other flags.
        let old = [[2, 9], [7, 0], [0x82, 0], [0x87, 0], [18, 0], [0x62, 7]];
        let new = [[0, 2], [0, 7], [4, 2], [6, 7], [0xf1, 18], [0xfb, 0x87]];
        let mut cases = vec![(first, old, vec![0, 1, 2, 3, 4, 5], vec![1, 3, 4], 0)];
        cases.extend((0..=5).map(|format| (legacy(format), old, vec![0, 1, 4, 5], vec![1, 4], 2)));
        cases.extend((6..=10).map(|format| (legacy(format), new, vec![0, 1, 4, 5], vec![1, 4], 2)));
        for (layout, flags, left, noise, num_withheld) in cases {
            let bytes = records(&layout, &flags);
            for show_withheld in [false, true] {
                let mut pushed = Points::default();
                bytes.chunks(layout.record_bytes).for_each(|r| layout.push(r, show_withheld, &mut pushed));
                let xs: Vec<i32> = pushed.xyz.iter().map(|p| p[0]).collect();
                let marked: Vec<i32> = xs
                    .iter()
                    .copied()
                    .enumerate()
                    .filter(|(i, _)| pushed.noise.get(*i))
                    .map(|(_, x)| x)
                    .collect();
                assert_eq!(pushed.num_withheld, num_withheld, "{layout:?}");
                if show_withheld {
                    assert_eq!(
                        (xs.len(), marked.len()),
                        (6, if num_withheld > 0 { 4 } else { 3 }),
                        "{layout:?}"
                    );
                } else {
                    assert_eq!((xs, marked), (left.clone(), noise.clone()), "{layout:?}");
                }
                let (mut xyz, mut rgb, mut intensity) = (vec![[0; 3]; 6], vec![[0; 3]; 6], vec![0; 6]);
                layout.parse(&bytes, &mut xyz, &mut rgb, &mut intensity);
                let mut block = Block { xyz: &mut xyz, rgb: &mut rgb, intensity: &mut intensity };
                let kept = layout.sift(&bytes, show_withheld, &mut block);
                assert_eq!(xyz[..kept.num_points], pushed.xyz);
                assert_eq!((kept.num_withheld, kept.noise), (pushed.num_withheld, pushed.noise));
            }
        }
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

//! A point record: which attributes it has and where, and how records become columns [LAS, tables 7 to 17].

use super::extra::Extra;
use crate::block::Block;
use crate::column::{Column, ColumnPart, Type};
use crate::{Attribute, Field, Grid, Marks, Projection, Schema, Waveform};
use laz::LazItem;
use laz::laszip::LazItemType;
use std::collections::TryReserveError;
use std::ops::Range;

/// Bytes of a standard record, by point format 0–10.
const RECORD_BYTES: [u16; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];
/// First byte of the GPS time, by point format; 0 where a format has none.
const GPS_TIME: [usize; 11] = [0, 20, 0, 20, 20, 20, 22, 22, 22, 22, 22];
/// First byte of the color, by point format; 0 where a format has none.
const RGB: [usize; 11] = [0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30];
/// First byte of the near infrared, by point format; 0 where a format has none.
const NIR: [usize; 11] = [0, 0, 0, 0, 0, 0, 0, 0, 36, 0, 36];
/// First byte of the waveform, by point format; 0 where a format has none.
const WAVEFORM: [usize; 11] = [0, 0, 0, 0, 28, 34, 0, 0, 0, 30, 38];
/// Classes whose points are noise, in all formats: low and high.
const NOISE_CLASSES: [u8; 2] = [7, 18];
/// Degrees of a step of the scan angle in point formats 6–10.
const ANGLE_STEP: f64 = 0.006;

/// Kinds of the first bytes of a record, before the bytes in which point formats differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Core {
    /// LAS 1.0: as point formats 0–5, without flags.
    First,
    /// Point formats 0–5: class and flags share a byte.
    Legacy,
    /// Point formats 6–10: class and flags have bytes of their own.
    Extended,
}

/// Where a record has an attribute, counted from the record's first byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FieldPlace {
    /// One number or three, starting at this byte.
    At(usize),
    /// Bits of a byte, shifted down, then masked. An attribute of yes or no is true if any of them is set.
    Bits { at: usize, shift: u32, mask: u8 },
    /// Bits of a byte that hold a class, which is noise or not.
    Noise { at: usize, mask: u8 },
}

/// First bytes of the parts that not all records have.
#[derive(Clone, Debug, Default)]
struct Offsets {
    gps_time: Option<usize>,
    rgb: Option<usize>,
    nir: Option<usize>,
    waveform: Option<usize>,
    extra: Range<usize>,
}

/// How the records of a file are made up.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    /// Bytes from one record to the next, at least as many as its parts need.
    pub record_bytes: usize,
    fields: Vec<(Field, FieldPlace)>,
    /// Names of extra bytes that no column can hold.
    unread: Vec<String>,
}

/// Bytes of a standard record; `None` for a format that does not exist.
pub(super) fn standard_bytes(point_format: u8) -> Option<u16> {
    RECORD_BYTES.get(usize::from(point_format)).copied()
}

/// Bytes of a part of a decompressed record. The size that the item itself states is not believed.
pub(super) fn item_bytes(item: LazItemType) -> usize {
    match item {
        LazItemType::Point10 => 20,
        LazItemType::GpsTime | LazItemType::RGBNIR14 => 8,
        LazItemType::RGB12 | LazItemType::RGB14 => 6,
        LazItemType::WavePacket13 | LazItemType::WavePacket14 => 29,
        LazItemType::Point14 => 30,
        LazItemType::Byte(count) | LazItemType::Byte14(count) => usize::from(count),
    }
}

impl Core {
    /// The core of a point format in a file of LAS 1.`minor`.
    pub fn of(point_format: u8, minor: u8) -> Self {
        match (point_format, minor) {
            (6.., _) => Self::Extended,
            (_, 0) => Self::First,
            _ => Self::Legacy,
        }
    }

    /// Attributes of the core, in the order in which lists have them.
    fn fields(self) -> Vec<(Field, FieldPlace)> {
        use Attribute as A;
        let bits = |attribute, at, shift, mask| {
            (Field::plain(attribute, Type::U8), FieldPlace::Bits { at, shift, mask })
        };
        let flag = |attribute, at, mask| {
            (Field::plain(attribute, Type::Bool), FieldPlace::Bits { at, shift: 0, mask })
        };
        let noise = |at, mask| (Field::plain(A::Noise, Type::Bool), FieldPlace::Noise { at, mask });
        let byte = |attribute, at| bits(attribute, at, 0, 0xff);
        let short = |attribute, at| (Field::plain(attribute, Type::U16), FieldPlace::At(at));
        let angle =
            |kind, scale, at| (Field { scale, ..Field::plain(A::ScanAngle, kind) }, FieldPlace::At(at));
        let mut fields = vec![short(A::Intensity, 12)];
        match self {
            Self::First | Self::Legacy => {
                fields.extend([
                    bits(A::ReturnNumber, 14, 0, 0x07),
                    bits(A::NumReturns, 14, 3, 0x07),
                    flag(A::ScanDirection, 14, 0x40),
                    flag(A::EdgeOfFlightLine, 14, 0x80),
                    bits(A::Classification, 15, 0, 0x1f),
                    noise(15, 0x1f),
                ]);
                if self == Self::Legacy {
                    fields.extend([
                        flag(A::Synthetic, 15, 0x20),
                        flag(A::KeyPoint, 15, 0x40),
                        flag(A::Withheld, 15, 0x80),
                    ]);
                }
                fields.extend([angle(Type::I8, 1.0, 16), byte(A::UserData, 17), short(A::SourceId, 18)]);
            }
            Self::Extended => fields.extend([
                bits(A::ReturnNumber, 14, 0, 0x0f),
                bits(A::NumReturns, 14, 4, 0x0f),
                flag(A::Synthetic, 15, 0x01),
                flag(A::KeyPoint, 15, 0x02),
                flag(A::Withheld, 15, 0x04),
                flag(A::Overlap, 15, 0x08),
                bits(A::ScannerChannel, 15, 4, 0x03),
                flag(A::ScanDirection, 15, 0x40),
                flag(A::EdgeOfFlightLine, 15, 0x80),
                byte(A::Classification, 16),
                noise(16, 0xff),
                angle(Type::I16, ANGLE_STEP, 18),
                byte(A::UserData, 17),
                short(A::SourceId, 20),
            ]),
        }
        fields
    }
}

impl Layout {
    /// The layout of a LAS file's records; `None` if the format does not exist or the records are too short for it.
    pub fn of_format(point_format: u8, minor: u8, record_bytes: u16, extra: &[Extra]) -> Option<Self> {
        let standard = standard_bytes(point_format)?;
        if record_bytes < standard {
            return None;
        }
        let offset = |places: [usize; 11]| Some(places[usize::from(point_format)]).filter(|&at| at > 0);
        let offsets = Offsets {
            gps_time: offset(GPS_TIME),
            rgb: offset(RGB),
            nir: offset(NIR),
            waveform: offset(WAVEFORM),
            extra: usize::from(standard)..usize::from(record_bytes),
        };
        Some(Self::new(Core::of(point_format, minor), &offsets, record_bytes.into(), extra))
    }

    /// The layout of records that are compressed as these items. The items count, not the point format: some writers
    /// leave out parts that they do not compress (waveforms), and the rest is still readable.
    pub fn of_items(items: &[LazItem], minor: u8, extra: &[Extra]) -> Self {
        let (mut offsets, mut at) = (Offsets::default(), 0);
        let mut core = Core::Extended;
        for item in items {
            match item.item_type() {
                LazItemType::Point10 => core = Core::of(0, minor),
                LazItemType::Point14 => offsets.gps_time = Some(at + GPS_TIME[6]),
                LazItemType::GpsTime => offsets.gps_time = Some(at),
                LazItemType::RGB12 | LazItemType::RGB14 => offsets.rgb = Some(at),
                LazItemType::RGBNIR14 => (offsets.rgb, offsets.nir) = (Some(at), Some(at + 6)),
                LazItemType::WavePacket13 | LazItemType::WavePacket14 => offsets.waveform = Some(at),
                LazItemType::Byte(count) | LazItemType::Byte14(count) => {
                    offsets.extra = at..at + usize::from(count);
                }
            }
            at += item_bytes(item.item_type());
        }
        Self::new(core, &offsets, at, extra)
    }

    fn new(core: Core, offsets: &Offsets, record_bytes: usize, extra: &[Extra]) -> Self {
        use Waveform as W;
        let mut fields = core.fields();
        let mut add = |attribute, kind, at| fields.push((Field::plain(attribute, kind), FieldPlace::At(at)));
        offsets.gps_time.into_iter().for_each(|at| add(Attribute::GpsTime, Type::F64, at));
        offsets.rgb.into_iter().for_each(|at| add(Attribute::Color, Type::U16x3, at));
        offsets.nir.into_iter().for_each(|at| add(Attribute::NearInfrared, Type::U16, at));
        if let Some(at) = offsets.waveform {
            fields.push((
                Field::plain(Attribute::Waveform(W::Description), Type::U8),
                FieldPlace::Bits { at, shift: 0, mask: 0xff },
            ));
            let numbers = [(W::Offset, Type::U64, 1), (W::Size, Type::U32, 9), (W::Location, Type::F32, 13)];
            let numbers = numbers.into_iter().chain([(W::Direction, Type::F32x3, 17)]);
            fields.extend(numbers.map(|(part, kind, behind)| {
                (Field::plain(Attribute::Waveform(part), kind), FieldPlace::At(at + behind))
            }));
        }
        let (mut at, mut unread) = (offsets.extra.start, Vec::new());
        for extra in extra {
            let num_before = fields.len();
            for (field, num_bytes) in &extra.fields {
                if let Some(field) = field.clone().filter(|_| at + num_bytes <= offsets.extra.end) {
                    let place = if field.kind == Type::U8 {
                        FieldPlace::Bits { at, shift: 0, mask: 0xff }
                    } else {
                        FieldPlace::At(at)
                    };
                    fields.push((field, place));
                }
                at += num_bytes;
            }
            if fields.len() < num_before + extra.fields.len() && !extra.name.is_empty() {
                unread.push(extra.name.clone());
            }
        }
        Self { record_bytes, fields, unread }
    }

    /// Attributes of the records.
    pub fn schema(&self) -> Schema {
        let fields = self.fields.iter().map(|(field, _)| field.clone()).collect();
        Schema { fields, unread: self.unread.clone() }
    }

    /// The first attribute whose place cannot be read into a column of its type: a fault of this file. Reading trusts
    /// that there is none.
    pub fn misfit(&self) -> Option<(Attribute, Type)> {
        let fits = |(field, place): &(Field, FieldPlace)| {
            let mut column = Column::new(field.kind);
            let no_records = RecordBytes { bytes: &[], record_bytes: self.record_bytes.max(1) };
            column.grow(0).is_ok_and(|mut part| place.read(&no_records, &mut part))
        };
        let misfit = self.fields.iter().find(|field| !fits(field));
        misfit.map(|(field, _)| (field.attribute.clone(), field.kind))
    }

    /// How the wanted attributes are taken out of the records.
    pub fn extractor(&self, want: &Projection) -> Extractor {
        let wanted = self.fields.iter().filter(|(field, _)| want.wants(&field.attribute));
        Extractor { record_bytes: self.record_bytes, fields: wanted.cloned().collect() }
    }
}

/// How records become columns of wanted attributes.
#[derive(Clone, Debug)]
pub(super) struct Extractor {
    record_bytes: usize,
    fields: Vec<(Field, FieldPlace)>,
}

impl Extractor {
    /// A block without points.
    pub fn block(&self, grid: Grid) -> Block {
        Block::new(grid, self.columns())
    }

    /// Attributes and types of a block's columns.
    pub fn columns(&self) -> impl Iterator<Item = (Attribute, Type)> + '_ {
        self.fields.iter().map(|(field, _)| (field.attribute.clone(), field.kind))
    }

    /// Parses whole records into a part of a block that has as many points.
    ///
    /// Each column takes one pass: a few records stay in the cache, and each pass is a plain strided copy.
    pub fn parse(&self, records: &[u8], xyz: &mut [[i32; 3]], columns: &mut [ColumnPart]) {
        let records = RecordBytes { bytes: records, record_bytes: self.record_bytes };
        records.copy(xyz, 0, le_i32x3);
        for (column, (_, place)) in columns.iter_mut().zip(&self.fields) {
            place.read(&records, column);
        }
    }

    /// Appends whole records to a block.
    ///
    /// # Errors
    /// There is no memory.
    pub fn append(&self, records: &[u8], block: &mut Block) -> Result<(), TryReserveError> {
        let (first, num_points) = (block.xyz.len(), records.len() / self.record_bytes);
        block.reserve(num_points)?;
        block.xyz.resize(first + num_points, [0; 3]);
        let records = RecordBytes { bytes: records, record_bytes: self.record_bytes };
        records.copy(&mut block.xyz[first..], 0, le_i32x3);
        for ((_, column), (_, place)) in block.columns.iter_mut().zip(&self.fields) {
            let mut part = column.grow(num_points)?;
            place.read(&records, &mut part);
            if let ColumnPart::Bool(marks) = part {
                column.mark(&marks, first);
            }
        }
        Ok(())
    }
}

impl FieldPlace {
    /// Takes an attribute out of records; returns false, and does nothing, if the place does not hold values of the
    /// column's type.
    fn read(self, records: &RecordBytes, column: &mut ColumnPart) -> bool {
        match (self, column) {
            (Self::Bits { at, shift, mask }, ColumnPart::U8(values)) => {
                records.copy(values, at, |[byte]: [u8; 1]| byte >> shift & mask);
            }
            (Self::Bits { at, mask, .. }, ColumnPart::Bool(marks)) => {
                records.mark(marks, at, |byte| byte & mask != 0);
            }
            (Self::Noise { at, mask }, ColumnPart::Bool(marks)) => {
                records.mark(marks, at, |byte| NOISE_CLASSES.contains(&(byte & mask)));
            }
            (Self::At(at), ColumnPart::I8(values)) => records.copy(values, at, i8::from_le_bytes),
            (Self::At(at), ColumnPart::U16(values)) => records.copy(values, at, u16::from_le_bytes),
            (Self::At(at), ColumnPart::I16(values)) => records.copy(values, at, i16::from_le_bytes),
            (Self::At(at), ColumnPart::U32(values)) => records.copy(values, at, u32::from_le_bytes),
            (Self::At(at), ColumnPart::I32(values)) => records.copy(values, at, i32::from_le_bytes),
            (Self::At(at), ColumnPart::U64(values)) => records.copy(values, at, u64::from_le_bytes),
            (Self::At(at), ColumnPart::I64(values)) => records.copy(values, at, i64::from_le_bytes),
            (Self::At(at), ColumnPart::F32(values)) => records.copy(values, at, f32::from_le_bytes),
            (Self::At(at), ColumnPart::F64(values)) => records.copy(values, at, f64::from_le_bytes),
            (Self::At(at), ColumnPart::U16x3(values)) => records.copy(values, at, le_u16x3),
            (Self::At(at), ColumnPart::F32x3(values)) => {
                records.copy(values, at, |bytes| le_i32x3(bytes).map(|bits| f32::from_bits(bits as u32)));
            }
            _ => return false,
        }
        true
    }
}

/// Whole records that follow each other.
struct RecordBytes<'a> {
    bytes: &'a [u8],
    record_bytes: usize,
}

impl RecordBytes<'_> {
    /// Makes a value of the bytes from `at` on of each record.
    #[inline]
    fn copy<const N: usize, T>(&self, values: &mut [T], at: usize, value: impl Fn([u8; N]) -> T) {
        for (to, record) in values.iter_mut().zip(self.bytes.chunks_exact(self.record_bytes)) {
            // The layout keeps every place within the record.
            *to = value(record[at..].first_chunk().copied().unwrap_or([0; N]));
        }
    }

    /// Marks records by one of their bytes.
    #[inline]
    fn mark(&self, marks: &mut Marks, at: usize, is_true: impl Fn(u8) -> bool) {
        let bytes = self.bytes.get(at..).unwrap_or_default().iter().step_by(self.record_bytes);
        for (number, byte) in bytes.enumerate() {
            if is_true(*byte) {
                marks.set(number);
            }
        }
    }
}

fn le_i32x3(bytes: [u8; 12]) -> [i32; 3] {
    std::array::from_fn(|axis| {
        let at = 4 * axis;
        i32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
    })
}

fn le_u16x3(bytes: [u8; 6]) -> [u16; 3] {
    std::array::from_fn(|channel| u16::from_le_bytes([bytes[2 * channel], bytes[2 * channel + 1]]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_format(point_format: u8) -> Layout {
        Layout::of_format(point_format, 4, standard_bytes(point_format).unwrap(), &[]).unwrap()
    }

    fn marked(block: &Block, attribute: &Attribute) -> Vec<usize> {
        let Some(Column::Bool(marks)) = block.column(attribute) else { return Vec::new() };
        (0..block.xyz.len()).filter(|&number| marks.get(number)).collect()
    }

    #[test]
    fn noise_and_the_withheld_are_told_by_each_core() {
        let first = Layout::of_format(1, 0, 28, &[]).unwrap();
        // The points are of a class, noise, withheld, withheld noise, high noise, and with other flags.
        let old = [[2, 9], [7, 0], [0x82, 0], [0x87, 0], [18, 0], [0x62, 7]];
        let new = [[0, 2], [0, 7], [4, 2], [6, 7], [0xf1, 18], [0xfb, 0x87]];
        let mut cases = vec![(first, old, vec![])];
        cases.extend((0..=5).map(|format| (of_format(format), old, vec![2, 3])));
        cases.extend((6..=10).map(|format| (of_format(format), new, vec![2, 3])));
        let want = Projection::of([Attribute::Withheld, Attribute::Noise]);
        for (layout, flags, withheld) in cases {
            let record = |flags: &[u8; 2]| {
                let mut record = vec![0; layout.record_bytes];
                record[15..17].copy_from_slice(flags);
                record
            };
            let records: Vec<u8> = flags.iter().flat_map(record).collect();
            let extractor = layout.extractor(&want);
            let mut block = extractor.block(Grid::default());
            // The records come in two parts, so that the second part's numbers have to go on.
            let (some, others) = records.split_at(3 * layout.record_bytes);
            extractor.append(some, &mut block).unwrap();
            extractor.append(others, &mut block).unwrap();
            assert_eq!(block.xyz.len(), 6);
            assert_eq!(marked(&block, &Attribute::Withheld), withheld, "{layout:?}");
            assert_eq!(marked(&block, &Attribute::Noise), [1, 3, 4], "{layout:?}");
        }
    }

    #[test]
    fn short_records_and_unknown_formats_have_no_layout() {
        assert_eq!(Layout::of_format(3, 2, 33, &[]), None);
        assert_eq!(Layout::of_format(11, 4, 200, &[]), None);
        assert_eq!(of_format(0).schema().field(&Attribute::Color), None);
        for format in 0..=10 {
            let layout = of_format(format);
            let ends = layout.fields.iter().map(|(_, place)| match place {
                FieldPlace::At(at) | FieldPlace::Bits { at, .. } | FieldPlace::Noise { at, .. } => at + 1,
            });
            assert!(ends.max().unwrap() <= layout.record_bytes, "{format}");
        }
    }

    #[test]
    fn a_place_that_does_not_hold_a_columns_type_is_found() {
        for format in 0..=10 {
            assert_eq!(of_format(format).misfit(), None, "{format}");
        }
        let mut layout = of_format(7);
        layout.fields[0].0.kind = Type::Bool;
        assert_eq!(layout.misfit(), Some((Attribute::Intensity, Type::Bool)));
    }

    #[test]
    fn what_is_not_wanted_has_no_column() {
        let extractor = of_format(7).extractor(&Projection::of([Attribute::Color, Attribute::Normal]));
        assert_eq!(extractor.columns().collect::<Vec<_>>(), [(Attribute::Color, Type::U16x3)]);
    }
}

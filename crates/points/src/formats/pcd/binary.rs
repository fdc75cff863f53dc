//! Rows of bytes: of a file whose points follow each other, and of one that was compressed, whose fields do.

use super::header::{FieldValue, PcdHeader};
use crate::column::{Column, Type};
use crate::formats::measured::{
    JudgedValues, Measured, Part, PartColors, PartIntensities, Places, RowsSeen, unit,
};
use crate::formats::plan::{PlannedColor, RowPlan};
use crate::formats::rows::of_bits;
use crate::source::Source;
use crate::{Attribute, Marks, Projection, ScanError};
use base::words::counted;
use std::path::Path;

/// Most rows of a part.
const PART_ROWS: u64 = 1 << 16;
/// Most bytes of a part, unless a single row has more.
const PART_BYTES: u64 = 1 << 22;

/// Where the bytes of points are.
#[derive(Debug)]
pub(super) enum PcdBody {
    /// In the file, point by point.
    InFile,
    /// In memory, field by field, and the number of points that the fields are as long as.
    InMemory(Vec<u8>, u64),
}

/// The points of an opened file.
#[derive(Debug)]
pub(super) struct BinaryRows<'a> {
    pub source: &'a Source,
    pub header: &'a PcdHeader,
    pub plan: &'a RowPlan,
    /// Values of the plan's columns.
    pub values: &'a [FieldValue],
    pub body: PcdBody,
    /// What could not be decompressed, as a sentence whose subject is the file.
    pub loss: Option<String>,
}

impl BinaryRows<'_> {
    /// Points that have a whole row, or whose place is there.
    pub fn num_rows(&self) -> u64 {
        match &self.body {
            PcdBody::InFile => {
                let num_bytes = self.source.len().saturating_sub(self.header.body_offset);
                self.header.num_points.min(num_bytes / self.header.row_bytes)
            }
            PcdBody::InMemory(bytes, num) => {
                let whole = self.plan.place.iter().map(|&at| {
                    let FieldValue { field, value } = self.values[at];
                    let field = &self.header.fields[field];
                    let there = (bytes.len() as u64).saturating_sub(field.offset.saturating_mul(*num));
                    let row = field.size * field.count;
                    // The last point needs its value alone.
                    there
                        .saturating_sub((value + 1) * field.size)
                        .checked_div(row)
                        .map_or(0, |more| if there < (value + 1) * field.size { 0 } else { more + 1 })
                });
                whole.min().unwrap_or(0).min(*num)
            }
        }
    }

    fn part_rows(&self) -> u64 {
        (PART_BYTES / self.header.row_bytes).clamp(1, PART_ROWS)
    }

    /// The bytes of a value of `num` points from point `first` on, given the bytes of their rows if these are in the file.
    fn view<'b>(&'b self, rows: &'b [u8], at: usize, first: u64, num: usize) -> ValueBytes<'b> {
        let FieldValue { field, value } = self.values[at];
        let field = &self.header.fields[field];
        // All of these are less than the bytes in memory, or than those of a row.
        match &self.body {
            PcdBody::InFile => {
                let start = (field.offset + value * field.size) as usize;
                ValueBytes { bytes: rows, start, stride: self.header.row_bytes as usize, num }
            }
            PcdBody::InMemory(bytes, num_points) => {
                let stride = field.size * field.count;
                let start = field.offset * num_points + first * stride + value * field.size;
                ValueBytes { bytes, start: start as usize, stride: stride as usize, num }
            }
        }
    }

    fn kind(&self, at: usize) -> Type {
        self.plan.columns[at].kind
    }
}

/// The bytes of one value of each of some points.
#[derive(Clone, Copy)]
struct ValueBytes<'a> {
    bytes: &'a [u8],
    start: usize,
    stride: usize,
    num: usize,
}

impl ValueBytes<'_> {
    /// The values; zeros where the bytes are not there.
    fn values<const N: usize, T>(self, of: impl Fn([u8; N]) -> T) -> impl Iterator<Item = T> {
        let bytes = self.bytes.get(self.start..).unwrap_or_default();
        (0..self.num).map(move |number| {
            let value = bytes.get(number * self.stride..).and_then(<[u8]>::first_chunk);
            of(*value.unwrap_or(&[0; N]))
        })
    }

    /// A column of the values, which are stored as `kind`; marks of those that are not 0, if marks are wanted.
    fn column(self, kind: Type, wanted: Type) -> Column {
        match kind {
            Type::U8 if wanted == Type::Bool => {
                let mut marks = Marks::default();
                let set = self.values(u8::from_le_bytes).enumerate().filter(|(_, value)| *value != 0);
                set.for_each(|(number, _)| marks.set(number));
                Column::Bool(marks)
            }
            Type::U8 => Column::U8(self.values(u8::from_le_bytes).collect()),
            Type::I8 => Column::I8(self.values(i8::from_le_bytes).collect()),
            Type::U16 => Column::U16(self.values(u16::from_le_bytes).collect()),
            Type::I16 => Column::I16(self.values(i16::from_le_bytes).collect()),
            Type::U32 => Column::U32(self.values(u32::from_le_bytes).collect()),
            Type::I32 => Column::I32(self.values(i32::from_le_bytes).collect()),
            Type::U64 => Column::U64(self.values(u64::from_le_bytes).collect()),
            Type::I64 => Column::I64(self.values(i64::from_le_bytes).collect()),
            Type::F32 => Column::F32(self.values(f32::from_le_bytes).collect()),
            // No field of another type gets a column.
            _ => Column::F64(self.values(f64::from_le_bytes).collect()),
        }
    }

    /// Hands over each value, which is stored as `kind`, with its number.
    #[inline]
    fn each(self, kind: Type, mut take: impl FnMut(usize, f64)) {
        let mut next = 0;
        let mut take = |value: f64| {
            take(next, value);
            next += 1;
        };
        match kind {
            Type::U8 => self.values(u8::from_le_bytes).for_each(|v| take(v.into())),
            Type::I8 => self.values(i8::from_le_bytes).for_each(|v| take(v.into())),
            Type::U16 => self.values(u16::from_le_bytes).for_each(|v| take(v.into())),
            Type::I16 => self.values(i16::from_le_bytes).for_each(|v| take(v.into())),
            Type::U32 => self.values(u32::from_le_bytes).for_each(|v| take(v.into())),
            Type::I32 => self.values(i32::from_le_bytes).for_each(|v| take(v.into())),
            Type::U64 => self.values(u64::from_le_bytes).for_each(|v| take(v as f64)),
            Type::I64 => self.values(i64::from_le_bytes).for_each(|v| take(v as f64)),
            Type::F32 => self.values(f32::from_le_bytes).for_each(|v| take(v.into())),
            _ => self.values(f64::from_le_bytes).for_each(take),
        }
    }

    /// The 32 bits of each value, which is stored as `kind`.
    fn bits(self, kind: Type) -> Vec<u32> {
        match kind {
            // The bits are taken as they stand: as a float they may be a NaN, whose bits a conversion may change.
            Type::F32 | Type::U32 | Type::I32 => self.values(u32::from_le_bytes).collect(),
            _ => {
                let mut bits = Vec::with_capacity(self.num);
                let is_float = kind == Type::F64;
                self.each(kind, |_, value| bits.push(crate::formats::number::packed_bits(value, is_float)));
                bits
            }
        }
    }
}

impl Measured for BinaryRows<'_> {
    fn path(&self) -> &Path {
        self.source.path()
    }

    fn num_points(&self) -> u64 {
        self.num_rows()
    }

    fn num_parts(&self) -> usize {
        usize::try_from(self.num_rows().div_ceil(self.part_rows())).unwrap_or(usize::MAX)
    }

    fn decode(&self, part: usize, want: &Projection) -> Result<Part, ScanError> {
        let first = part as u64 * self.part_rows();
        let wanted = self.part_rows().min(self.num_rows() - first);
        let row_bytes = self.header.row_bytes;
        let rows = match &self.body {
            PcdBody::InFile => {
                self.source.bytes(self.header.body_offset + first * row_bytes, wanted * row_bytes)?
            }
            PcdBody::InMemory(..) => Vec::new(),
        };
        // Fewer if the file shrank since it was opened.
        let num = match &self.body {
            PcdBody::InFile => rows.len() / row_bytes as usize,
            PcdBody::InMemory(..) => wanted as usize,
        };
        let plan = self.plan.projected(want);
        let view = |at: usize| self.view(&rows, at, first, num);
        let mut places = vec![[0.0; 3]; num];
        for (axis, &at) in plan.place.iter().enumerate() {
            view(at).each(self.kind(at), |number, value| places[number][axis] = value);
        }
        let colors = match plan.color {
            PlannedColor::Absent => PartColors::Absent,
            PlannedColor::Packed(at) => {
                PartColors::Stored(view(at).bits(self.kind(at)).into_iter().map(of_bits).collect())
            }
            PlannedColor::Whole(at) => {
                let mut rgb = vec![[0u16; 3]; num];
                for (channel, &at) in at.iter().enumerate() {
                    // `as` saturates.
                    view(at).each(self.kind(at), |number, value| rgb[number][channel] = value as u16);
                }
                PartColors::Stored(rgb)
            }
            PlannedColor::Floats(at) => {
                let mut rgb = vec![[0f32; 3]; num];
                for (channel, &at) in at.iter().enumerate() {
                    view(at).each(self.kind(at), |number, value| rgb[number][channel] = value as f32);
                }
                PartColors::Floats(rgb)
            }
        };
        let intensities = match plan.intensity {
            None => PartIntensities::Absent,
            Some(at) if plan.keeps_intensity() => {
                let mut all = Vec::with_capacity(num);
                view(at).each(self.kind(at), |_, value| all.push(value as u16));
                PartIntensities::Stored(all)
            }
            Some(at) => {
                let mut all = Vec::with_capacity(num);
                view(at).each(self.kind(at), |_, value| all.push(value));
                PartIntensities::Numbers(all)
            }
        };
        let mut columns = Vec::new();
        if let Some(normal) = plan.normal {
            let mut normals = vec![[0.0; 3]; num];
            for (axis, &at) in normal.iter().enumerate() {
                view(at).each(self.kind(at), |number, value| normals[number][axis] = value);
            }
            columns.push((Attribute::Normal, Column::F32x3(normals.into_iter().map(unit).collect())));
        }
        for (at, field) in &plan.others {
            columns.push((field.attribute.clone(), view(*at).column(self.kind(*at), field.kind)));
        }
        Ok(Part { colors, intensities, columns, ..Part::at(Places::Anywhere(places)) })
    }

    fn judged(&self) -> JudgedValues {
        self.plan.judged()
    }

    fn white(&self) -> Option<u16> {
        self.plan.white()
    }

    fn losses(&self, read: &RowsSeen) -> Vec<String> {
        let (announced, num, end) = (self.header.num_points, read.num_read, self.source.len());
        let cut_off = (num < announced && announced < u64::MAX).then(|| {
            let announced = counted(announced, "point");
            format!("announces {announced}, but only {num} could be read (the file has {end} bytes)")
        });
        self.loss.clone().into_iter().chain(cut_off).collect()
    }

    fn no_points(&self, read: &RowsSeen) -> ScanError {
        let (announced, start, end) = (self.header.num_points, self.header.body_offset, self.source.len());
        let reason = match &self.loss {
            _ if announced == 0 => "its header announces none; choose another file".into(),
            _ if read.num_read > 0 => "none has a place within 1e15 of zero; export it again".into(),
            Some(loss) => format!("it {loss}; get it again"),
            None => {
                format!("points should follow byte {start}, but the file ends at byte {end}; get it again")
            }
        };
        ScanError::NoPoints { path: self.source.path().to_owned(), reason }
    }
}

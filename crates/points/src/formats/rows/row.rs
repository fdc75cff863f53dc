//! Puts the cells of lines into the columns of a part, as a plan says.

use super::cells::Dialect;
use crate::column::{Column, Number, Type};
use crate::formats::measured::{Part, PartColors, PartIntensities, Places, unit};
use crate::formats::number::packed_bits;
use crate::formats::plan::{PlannedColor, RowPlan};

/// Slots of a row's values: place, color, intensity, normal.
const NUM_SLOTS: usize = 10;
const SLOT_RGB: usize = 3;
const SLOT_INTENSITY: usize = 6;
const SLOT_NORMAL: usize = 7;

/// What becomes of a cell.
#[derive(Clone, Copy, Debug, Default)]
struct CellUse {
    /// Slot of the row's values.
    slot: Option<u8>,
    /// Column of the part.
    extra: Option<u16>,
    /// True if the column holds whole numbers of 64 bits, of which a float has not all digits.
    is_long: bool,
}

/// Takes in rows.
#[derive(Debug)]
pub(super) struct RowTaker<'a> {
    plan: &'a RowPlan,
    dialect: Dialect,
    /// Uses of cells, up to the last that is wanted.
    uses: Vec<CellUse>,
    places: Vec<[f64; 3]>,
    colors: PartColors,
    intensities: PartIntensities,
    normals: Vec<[f32; 3]>,
    extras: Vec<Column>,
    /// Values for the extra columns of one row.
    row: Vec<Number>,
}

impl<'a> RowTaker<'a> {
    /// A part without rows, of which about `num_rows` are expected.
    pub fn new(plan: &'a RowPlan, dialect: Dialect, num_rows: usize) -> Self {
        let mut uses = vec![CellUse::default(); plan.columns.len()];
        let mut put = |at: usize, slot: usize| uses[at].slot = Some(slot as u8);
        (0..3).for_each(|axis| put(plan.place[axis], axis));
        let colors = match plan.color {
            PlannedColor::Absent => PartColors::Absent,
            PlannedColor::Whole(at) => {
                (0..3).for_each(|channel| put(at[channel], SLOT_RGB + channel));
                PartColors::Stored(Vec::with_capacity(num_rows))
            }
            PlannedColor::Floats(at) => {
                (0..3).for_each(|channel| put(at[channel], SLOT_RGB + channel));
                PartColors::Floats(Vec::with_capacity(num_rows))
            }
            PlannedColor::Packed(at) => {
                put(at, SLOT_RGB);
                PartColors::Stored(Vec::with_capacity(num_rows))
            }
        };
        let intensities = match plan.intensity {
            None => PartIntensities::Absent,
            Some(at) => {
                put(at, SLOT_INTENSITY);
                let stored = PartIntensities::Stored(Vec::with_capacity(num_rows));
                let numbers = PartIntensities::Numbers(Vec::new());
                if plan.keeps_intensity() { stored } else { numbers }
            }
        };
        if let Some(at) = plan.normal {
            (0..3).for_each(|axis| put(at[axis], SLOT_NORMAL + axis));
        }
        for (number, (at, field)) in plan.others.iter().enumerate() {
            uses[*at].extra = u16::try_from(number).ok();
            uses[*at].is_long = matches!(field.kind, Type::I64 | Type::U64);
        }
        let is_used = |of: &CellUse| of.slot.is_some() || of.extra.is_some();
        let num_used = uses.iter().rposition(is_used).map_or(0, |last| last + 1);
        uses.truncate(num_used);
        Self {
            plan,
            dialect,
            uses,
            places: Vec::with_capacity(num_rows),
            colors,
            intensities,
            normals: Vec::new(),
            extras: plan.others.iter().map(|(_, field)| Column::new(field.kind)).collect(),
            row: vec![Number::Float(f64::NAN); plan.others.len()],
        }
    }

    /// Takes in a line; returns false if it is no row.
    #[inline]
    pub fn take(&mut self, line: &[u8]) -> bool {
        let mut values = [f64::NAN; NUM_SLOTS];
        let mut cells = self.dialect.cells(line);
        for of in &self.uses {
            let value = match *of {
                CellUse { slot: None, extra: None, .. } => {
                    if cells.cell().is_none() {
                        return false;
                    }
                    continue;
                }
                CellUse { is_long: true, .. } => {
                    let Some(word) = cells.cell() else { return false };
                    let whole = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
                    match whole.map(Number::Whole).or_else(|| self.dialect.number(word).map(Number::Float)) {
                        Some(value) => value,
                        None => return false,
                    }
                }
                _ => match cells.value() {
                    Some(value) => Number::Float(value),
                    None => return false,
                },
            };
            if let Some(slot) = of.slot {
                values[usize::from(slot)] = value.as_f64();
            }
            if let Some(extra) = of.extra {
                self.row[usize::from(extra)] = value;
            }
        }
        // Columns behind the last that is wanted must be there too; twice as many are two rows on one line.
        for _ in self.uses.len()..self.plan.columns.len() {
            if cells.cell().is_none() {
                return false;
            }
        }
        if !cells.is_empty() {
            let more = std::iter::from_fn(|| cells.word()).count();
            if more >= self.plan.columns.len() {
                return false;
            }
        }
        self.push(&values);
        true
    }

    fn push(&mut self, values: &[f64; NUM_SLOTS]) {
        let three = |slot: usize| [values[slot], values[slot + 1], values[slot + 2]];
        self.places.push(three(0));
        match &mut self.colors {
            PartColors::Absent => {}
            PartColors::Stored(rgb) => rgb.push(match self.plan.color {
                PlannedColor::Packed(at) => {
                    of_bits(packed_bits(values[SLOT_RGB], !self.plan.columns[at].is_whole))
                }
                // `as` saturates, and makes 0 of NaN.
                _ => three(SLOT_RGB).map(|channel| channel.round() as u16),
            }),
            PartColors::Floats(rgb) => rgb.push(three(SLOT_RGB).map(|channel| channel as f32)),
        }
        match &mut self.intensities {
            PartIntensities::Absent => {}
            PartIntensities::Stored(all) => all.push(values[SLOT_INTENSITY].round() as u16),
            PartIntensities::Numbers(all) => all.push(values[SLOT_INTENSITY]),
        }
        if self.plan.normal.is_some() {
            self.normals.push(unit(three(SLOT_NORMAL)));
        }
        let number = self.places.len() - 1;
        for (column, value) in self.extras.iter_mut().zip(&self.row) {
            column.push(*value, number);
        }
    }

    /// The rows taken in.
    pub fn part(self) -> Part {
        let mut columns = Vec::new();
        if self.plan.normal.is_some() {
            columns.push((crate::Attribute::Normal, Column::F32x3(self.normals)));
        }
        let others = self.plan.others.iter().map(|(_, field)| field.attribute.clone());
        columns.extend(others.zip(self.extras));
        Part {
            colors: self.colors,
            intensities: self.intensities,
            columns,
            ..Part::at(Places::Anywhere(self.places))
        }
    }
}

/// Red, green and blue of 0xAARRGGBB.
#[inline]
pub(in crate::formats) fn of_bits(bits: u32) -> [u16; 3] {
    [16, 8, 0].map(|shift| (bits >> shift & 0xff) as u16)
}

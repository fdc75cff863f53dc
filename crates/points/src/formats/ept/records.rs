//! Records become columns: places go onto the scan's grid, values to the columns of the wanted attributes.

use super::dims::{DimCell, DimUse, Dims, PlaceDim};
use super::ranges::Ranges;
use crate::block::Block;
use crate::column::{Column, Number, Type, Value};
use crate::grid::{FittedGrid, is_place};
use crate::{Attribute, Field, Grid, Marks, Projection};
use glam::DVec3;
use std::collections::TryReserveError;

/// Classes whose points are noise: low and high.
const NOISE_CLASSES: [i128; 2] = [7, 18];

/// How places go onto the grid.
#[derive(Clone, Copy, Debug)]
pub(super) enum Placing {
    /// Stored steps stay, less a number of steps for each axis.
    Steps { grid: Grid, origin: [i128; 3] },
    /// Places of any numbers.
    Fitted(FittedGrid),
}

/// How records become columns of wanted attributes.
#[derive(Clone, Debug)]
pub(super) struct RecordReader<'a> {
    dims: &'a Dims,
    placing: Placing,
    /// What is subtracted from intensities, and the factor that they are then multiplied by.
    ramp: (f64, f64),
    fields: Vec<(Field, DimUse)>,
}

impl Placing {
    /// The grid that the schema states, moved by the origin.
    fn steps(places: &[PlaceDim; 3], origin: [i128; 3]) -> Self {
        let offset = |axis: usize| places[axis].offset + places[axis].scale * origin[axis] as f64;
        let grid = Grid {
            scale: DVec3::from_array([0, 1, 2].map(|axis| places[axis].scale)),
            offset: DVec3::from_array([0, 1, 2].map(offset)),
        };
        Self::Steps { grid, origin }
    }

    /// How places are put on a grid. `ranges` are those of all points, if the places need them.
    fn of(dims: &Dims, ranges: Option<&Ranges>) -> Self {
        let Some(ranges) = ranges.filter(|_| dims.needs_ranges_of_places()) else {
            return Self::steps(&dims.places, [0; 3]);
        };
        match ranges.origin() {
            Some(origin) => Self::steps(&dims.places, origin),
            None => Self::Fitted(FittedGrid::over(ranges.sample.clone(), ranges.bounds)),
        }
    }

    fn grid(&self) -> Grid {
        match self {
            Self::Steps { grid, .. } => *grid,
            Self::Fitted(fitted) => fitted.grid,
        }
    }

    /// The grid point of a record; `None` if it has no place, or one too far away.
    #[inline]
    fn place(&self, places: &[PlaceDim; 3], record: &[u8]) -> Option<[i32; 3]> {
        match self {
            Self::Steps { origin, .. } => {
                let mut xyz = [0; 3];
                for axis in 0..3 {
                    let Number::Whole(step) = places[axis].cell.number(record) else { return None };
                    xyz[axis] = i32::try_from(step - origin[axis]).ok()?;
                }
                Some(xyz)
            }
            Self::Fitted(fitted) => {
                let p = [0, 1, 2].map(|axis| places[axis].value(record));
                (is_place(&p) && fitted.holds(&p)).then(|| fitted.snap(&p))
            }
        }
    }
}

impl<'a> RecordReader<'a> {
    /// A reader of the wanted attributes. `ranges` are those of all points, if they are needed.
    pub fn new(dims: &'a Dims, want: &Projection, ranges: Option<&Ranges>) -> Self {
        let wanted = dims.fields.iter().filter(|(field, _)| want.wants(&field.attribute));
        Self {
            dims,
            placing: Placing::of(dims, ranges),
            ramp: ranges.map_or((0.0, 1.0), |ranges| ranges.intensity_ramp()),
            fields: wanted.cloned().collect(),
        }
    }

    /// The scan's grid.
    pub fn grid(&self) -> Grid {
        self.placing.grid()
    }

    /// Reads whole records. Returns also how many have no place, which are left out.
    ///
    /// # Errors
    /// There is no memory.
    pub fn block(&self, records: &[u8]) -> Result<(Block, u64), TryReserveError> {
        let columns = self.fields.iter().map(|(field, _)| (field.attribute.clone(), field.kind));
        let mut block = Block::new(self.grid(), columns);
        let num = records.len() / self.dims.record_bytes;
        block.reserve(num)?;
        let mut without_place = Marks::default();
        for (number, record) in records.chunks_exact(self.dims.record_bytes).enumerate() {
            let place = self.placing.place(&self.dims.places, record);
            if place.is_none() {
                without_place.set(number);
            }
            block.xyz.push(place.unwrap_or_default());
        }
        for ((_, column), (_, from)) in block.columns.iter_mut().zip(&self.fields) {
            self.fill(column, *from, records);
        }
        let num_without_place = without_place.count() as u64;
        if num_without_place > 0 {
            block.leave_out(&without_place);
        }
        Ok((block.with_stats(), num_without_place))
    }

    /// Fills a column, which has room for all records' values.
    fn fill(&self, column: &mut Column, from: DimUse, records: &[u8]) {
        let records = records.chunks_exact(self.dims.record_bytes);
        match (from, column) {
            (DimUse::Number(cell), column) => fill_numbers(column, cell, records),
            (DimUse::Flag(cell, mask), Column::Bool(marks)) => {
                mark(marks, records, |record| record.get(cell.at).is_some_and(|byte| byte & mask != 0));
            }
            (DimUse::Noise(cell), Column::Bool(marks)) => mark(
                marks,
                records,
                |record| matches!(cell.number(record), Number::Whole(class) if NOISE_CLASSES.contains(&class)),
            ),
            (DimUse::Intensity(cell), Column::U16(values)) => {
                let (start, factor) = self.ramp;
                let spread = |record| ((cell.number(record).as_f64() - start) * factor).round() as u16;
                values.extend(records.map(spread));
            }
            (DimUse::Color(cells), Column::U16x3(values)) => {
                values.extend(records.map(|record| cells.map(|cell| u16::of(cell.number(record)))));
            }
            (DimUse::Normal(cells), Column::F32x3(values)) => {
                values.extend(records.map(|record| cells.map(|cell| f32::of(cell.number(record)))));
            }
            // The column is too short then, which is an error where its block is handed over.
            _ => {}
        }
    }
}

fn mark<'a>(marks: &mut Marks, records: impl Iterator<Item = &'a [u8]>, is_true: impl Fn(&[u8]) -> bool) {
    records.enumerate().filter(|(_, record)| is_true(record)).for_each(|(number, _)| marks.set(number));
}

/// Copies the numbers of a dimension into a column of its type.
fn fill_numbers<'a>(column: &mut Column, cell: DimCell, records: impl Iterator<Item = &'a [u8]>) {
    macro_rules! copy {
        ($values:expr, $value:ty) => {
            $values.extend(records.map(|record| {
                <$value>::from_le_bytes(record[cell.at..].first_chunk().copied().unwrap_or_default())
            }))
        };
    }
    match (column, cell.kind) {
        (Column::U8(values), Type::U8) => copy!(values, u8),
        (Column::I8(values), Type::I8) => copy!(values, i8),
        (Column::U16(values), Type::U16) => copy!(values, u16),
        (Column::I16(values), Type::I16) => copy!(values, i16),
        (Column::U32(values), Type::U32) => copy!(values, u32),
        (Column::I32(values), Type::I32) => copy!(values, i32),
        (Column::U64(values), Type::U64) => copy!(values, u64),
        (Column::I64(values), Type::I64) => copy!(values, i64),
        (Column::F32(values), Type::F32) => copy!(values, f32),
        (Column::F64(values), Type::F64) => copy!(values, f64),
        // The column is too short then, which is an error where its block is handed over.
        _ => {}
    }
}

impl Dims {
    /// True if the places of all points must be seen before any can be put on a grid: they are floats, or steps that
    /// could be too many.
    pub fn needs_ranges_of_places(&self) -> bool {
        let fits = |kind| matches!(kind, Type::I8 | Type::U8 | Type::I16 | Type::U16 | Type::I32);
        !self.places.iter().all(|place| fits(place.cell.kind))
    }

    /// The dimension of intensities, if all must be seen before any can be spread over 16 bits, and they are wanted.
    pub fn intensity_to_spread(&self, want: &Projection) -> Option<DimCell> {
        self.fields.iter().find_map(|(field, from)| match from {
            DimUse::Intensity(cell) if cell.kind != Type::U8 && want.wants(&field.attribute) => Some(*cell),
            _ => None,
        })
    }
}

/// True if a block has these attributes in columns of these types, in this order.
pub(super) fn has_columns(block: &Block, columns: &[(Attribute, Type)]) -> bool {
    block.columns.len() == columns.len()
        && block.columns.iter().zip(columns).all(|((a, column), (b, kind))| a == b && column.kind() == *kind)
}

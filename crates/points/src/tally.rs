//! Tallies all attributes of files, block by block: the smallest and the largest value, how many points have one, and how
//! many points each class has.

use super::column::{Column, Number, Type};
use super::read::{self, FilesRead};
use super::{Attribute, Block, Field, Header, ReadOptions, ScanError, open};
use base::task::{Progress, Task};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Points that are asked for at once.
const BLOCK_POINTS: usize = 1 << 18;

/// What all values of an attribute come to that have one type.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tally {
    pub attribute: Attribute,
    pub kind: Type,
    /// Points that have a value, which is neither NaN nor no-data; of a flag, points that are marked.
    pub num_points: u64,
    /// Smallest and largest value of each part: a number has one part, a color three. `None` if no point has a value.
    pub ranges: Vec<Option<[Number; 2]>>,
    /// Points of each class, if this is the attribute for it.
    pub classes: Vec<u64>,
}

/// All attributes of some files.
#[derive(Debug, Default)]
pub(super) struct Tallied {
    pub headers: Vec<Header>,
    pub num_points: u64,
    /// Attributes in the order of their first appearance.
    pub tallies: Vec<Tally>,
    /// Sentences about what was odd, each naming its file.
    pub warnings: Vec<String>,
}

/// Tallies all attributes of all points of the files, the withheld ones too. One block of one file is in memory at a
/// time, and those in work; only colors that are those of faces need a file as a whole.
///
/// # Errors
/// See [`read::read`].
pub(super) fn of_files(paths: &[PathBuf], options: &ReadOptions, task: &Task) -> Result<Tallied, ScanError> {
    let mut tallied = Tallied::default();
    let tally = |path: &Path, progress: &Progress| of_file(path, options, progress);
    let FilesRead { files, remarks, failures } = read::each(paths, options, task, tally)?;
    tallied.warnings.extend(remarks);
    for file in files {
        tallied.headers.extend(file.headers);
        tallied.num_points += file.num_points;
        tallied.warnings.extend(file.warnings);
        for tally in file.tallies {
            let same = |other: &&mut Tally| (&other.attribute, other.kind) == (&tally.attribute, tally.kind);
            match tallied.tallies.iter_mut().find(same) {
                Some(all) => all.join(&tally),
                None => tallied.tallies.push(tally),
            }
        }
    }
    tallied.warnings.extend(failures);
    Ok(tallied)
}

fn of_file(path: &Path, options: &ReadOptions, progress: &Progress) -> Result<Tallied, ScanError> {
    let dataset = open(path, &options.hints())?;
    let header = dataset.header();
    let want = header.schema.projection().in_blocks_of(BLOCK_POINTS).without_triangles();
    // The first of several fields of one attribute counts.
    let mut fields: Vec<&Field> = Vec::new();
    for field in &header.schema.fields {
        if !fields.iter().any(|other| other.attribute == field.attribute) {
            fields.push(field);
        }
    }
    let mut tallies: Vec<Tally> = fields.iter().map(|field| Tally::new(field)).collect();
    let mut num_points = 0;
    let mut take = |block: Block| {
        num_points += block.xyz.len() as u64;
        tallies.par_iter_mut().zip(&fields).for_each(|(tally, field)| {
            if let Some(column) = block.column(&field.attribute) {
                tally.add(field, column, block.xyz.len());
            }
        });
        Ok(())
    };
    let trailer = dataset.read(&want, &mut take, progress)?;
    let warnings = read::sentences(header, &trailer, options.strict)?;
    Ok(Tallied { headers: vec![header.clone()], num_points, tallies, warnings })
}

impl Tally {
    fn new(field: &Field) -> Self {
        let (attribute, kind) = (field.attribute.clone(), field.kind);
        let ranges = vec![None; kind.num_parts()];
        Self { attribute, kind, num_points: 0, ranges, classes: Vec::new() }
    }

    /// Takes in the values of a block of `len` points.
    fn add(&mut self, field: &Field, column: &Column, len: usize) {
        for (part, range) in self.ranges.iter_mut().enumerate() {
            let (mut num_values, mut stored) = (0, None);
            column.each(part, len, |number| {
                let value = number.as_f64();
                if !value.is_nan() && field.no_data != Some(value) {
                    num_values += 1;
                    widen(&mut stored, number);
                }
            });
            for number in stored.into_iter().flatten() {
                widen(range, field.value(number));
            }
            // A point has all parts of a value or none.
            if part == 0 {
                self.num_points += match column {
                    Column::Bool(marks) => marks.count() as u64,
                    _ => num_values,
                };
            }
        }
        if let (Attribute::Classification, Column::U8(classes)) = (&field.attribute, column) {
            self.classes.resize(usize::from(u8::MAX) + 1, 0);
            classes.iter().for_each(|&class| self.classes[usize::from(class)] += 1);
        }
    }

    /// Takes in another tally of the same attribute.
    fn join(&mut self, other: &Self) {
        self.num_points += other.num_points;
        for (range, other) in self.ranges.iter_mut().zip(&other.ranges) {
            other.iter().flatten().for_each(|&number| widen(range, number));
        }
        self.classes.resize(self.classes.len().max(other.classes.len()), 0);
        self.classes.iter_mut().zip(&other.classes).for_each(|(all, more)| *all += more);
    }
}

impl Field {
    /// What a stored number stands for.
    fn value(&self, stored: Number) -> Number {
        if self.scale == 1.0 && self.offset == 0.0 {
            stored
        } else {
            Number::Float(self.offset + self.scale * stored.as_f64())
        }
    }
}

/// Makes a range hold a number.
fn widen(range: &mut Option<[Number; 2]>, number: Number) {
    let [low, high] = range.get_or_insert([number; 2]);
    if number.is_less(*low) {
        *low = number;
    }
    if high.is_less(number) {
        *high = number;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Marks;

    fn tally(field: &Field, columns: &[Column]) -> Tally {
        let mut tally = Tally::new(field);
        columns.iter().for_each(|column| tally.add(field, column, column.num_values().unwrap_or(3)));
        tally
    }

    #[test]
    fn values_are_scaled_and_none_is_no_value() {
        let plain = Field::plain(Attribute::Named("a".into()), Type::I16);
        let field = Field { scale: -0.5, offset: 1.0, no_data: Some(-9.0), ..plain };
        let got = tally(&field, &[Column::I16(vec![4, -9]), Column::I16(vec![-9, 10, 2])]);
        assert_eq!(got.num_points, 3);
        assert_eq!(got.ranges, [Some([Number::Float(-4.0), Number::Float(0.0)])]);
        let none = tally(&field, &[Column::I16(vec![-9])]);
        assert_eq!((none.num_points, &none.ranges[..]), (0, &[None][..]));
    }

    #[test]
    fn all_bits_of_whole_numbers_count() {
        let field = Field::plain(Attribute::GpsTime, Type::U64);
        let got = tally(&field, &[Column::U64(vec![u64::MAX - 1, u64::MAX, 1 << 60, (1 << 60) - 1])]);
        assert_eq!(got.ranges, [Some([(1 << 60) - 1, i128::from(u64::MAX)].map(Number::Whole))]);
    }

    #[test]
    fn parts_flags_and_classes_are_told_apart() {
        let field = Field::plain(Attribute::Normal, Type::F32x3);
        let got = tally(&field, &[Column::F32x3(vec![[0.0, 1.0, 2.0], [f32::NAN; 3], [3.0, -1.0, 2.0]])]);
        let range = |low, high| Some([Number::Float(low), Number::Float(high)]);
        assert_eq!(
            (got.num_points, got.ranges),
            (2, vec![range(0.0, 3.0), range(-1.0, 1.0), range(2.0, 2.0)])
        );
        let mut marks = Marks::default();
        marks.set(1);
        let got = tally(&Field::plain(Attribute::Overlap, Type::Bool), &[Column::Bool(marks)]);
        assert_eq!((got.num_points, got.ranges), (1, vec![Some([Number::Whole(0), Number::Whole(1)])]));
        let field = Field::plain(Attribute::Classification, Type::U8);
        let mut all = tally(&field, &[Column::U8(vec![2, 2, 255])]);
        all.join(&tally(&field, &[Column::U8(vec![2, 0])]));
        let counts: Vec<(usize, u64)> =
            all.classes.iter().copied().enumerate().filter(|(_, num)| *num > 0).collect();
        assert_eq!((all.num_points, counts), (5, vec![(0, 1), (2, 3), (255, 1)]));
    }
}

//! Tests of what all formats of measured coordinates share, with parts that are made up.

use super::*;
use crate::{Block, Type};
use std::path::PathBuf;

/// A file of points on a line, of which each 10th has no place, in parts of `part_points`.
struct Line {
    num_points: usize,
    part_points: usize,
    /// True if it has a grid of its own.
    has_grid: bool,
    /// A point that is far from all others.
    far: Option<usize>,
    /// The part that cannot be read.
    broken: Option<usize>,
    judged: JudgedValues,
}

const LINE: Line = Line {
    num_points: 1000,
    part_points: 64,
    has_grid: false,
    far: None,
    broken: None,
    judged: JudgedValues { colors: true, intensities: true, whole_intensities: false },
};
/// The grid of a line that has its own.
const LINE_GRID: Grid = Grid { scale: glam::DVec3::splat(0.25), offset: glam::DVec3::ZERO };

impl Measured for Line {
    fn path(&self) -> &Path {
        Path::new("line")
    }

    fn num_points(&self) -> u64 {
        self.num_points as u64
    }

    fn num_parts(&self) -> usize {
        self.num_points.div_ceil(self.part_points)
    }

    fn decode(&self, part: usize, want: &Projection) -> Result<Part, ScanError> {
        if self.broken == Some(part) {
            return Err(ScanError::io(self.path(), Some(7), std::io::ErrorKind::InvalidData.into()));
        }
        let numbers = part * self.part_points..self.num_points.min((part + 1) * self.part_points);
        let mut none = Marks::default();
        numbers.clone().enumerate().filter(|(_, n)| n % 10 == 3).for_each(|(at, _)| none.set(at));
        let place = |n: usize| match n {
            n if n % 10 == 3 => [f64::NAN; 3],
            n if Some(n) == self.far => [1e30, 0.0, 0.0],
            n => [0.25 * n as f64, (n % 7) as f64, (n % 5) as f64],
        };
        let places = if self.has_grid {
            Places::OnGrid(
                numbers.clone().map(|n| [n as i32, 4 * (n % 7) as i32, 4 * (n % 5) as i32]).collect(),
                none,
            )
        } else {
            Places::Anywhere(numbers.clone().map(place).collect())
        };
        let mut part = Part { num_bad: 1, first_bad: Some(part as u64), ..Part::at(places) };
        if want.wants(&Attribute::Color) {
            part.colors = PartColors::Floats(numbers.clone().map(|n| [(n % 3) as f32 / 2.0; 3]).collect());
        }
        if want.wants(&Attribute::Intensity) {
            part.intensities = PartIntensities::Numbers(numbers.clone().map(|n| n as f64 - 500.0).collect());
        }
        if want.wants(&Attribute::UserData) {
            part.columns
                .push((Attribute::UserData, Column::U32(numbers.clone().map(|n| n as u32).collect())));
        }
        if want.wants(&Attribute::Overlap) {
            let mut marks = Marks::default();
            numbers.enumerate().filter(|(_, n)| n % 10 == 4).for_each(|(at, _)| marks.set(at));
            part.columns.push((Attribute::Overlap, Column::Bool(marks)));
        }
        Ok(part)
    }

    fn grid(&self) -> Option<Grid> {
        self.has_grid.then_some(LINE_GRID)
    }

    fn judged(&self) -> JudgedValues {
        self.judged
    }

    fn losses(&self, read: &RowsSeen) -> Vec<String> {
        vec![format!("has {} bad rows, first {:?}", read.num_bad, read.first_bad)]
    }

    fn no_points(&self, read: &RowsSeen) -> ScanError {
        ScanError::NoPoints { path: PathBuf::from("line"), reason: format!("{read:?}") }
    }
}

fn all() -> Projection {
    Projection::of([Attribute::Color, Attribute::Intensity, Attribute::UserData, Attribute::Overlap])
}

fn blocks(line: &Line, want: &Projection) -> Result<(Vec<Block>, Trailer), ScanError> {
    let mut blocks = Vec::new();
    let mut take = |block| {
        blocks.push(block);
        Ok(())
    };
    let trailer = read(line, want, &mut take, &Progress::hidden())?;
    Ok((blocks, trailer))
}

#[test]
fn points_come_in_order_without_those_that_have_no_place() {
    for block_points in [usize::MAX, 100, 1] {
        let (blocks, trailer) = blocks(&LINE, &all().in_blocks_of(block_points)).unwrap();
        assert_eq!(
            blocks.len(),
            match block_points {
                100 => 8,
                1 => 16,
                _ => 1,
            }
        );
        let mut numbers = (0..1000).filter(|n| n % 10 != 3);
        for block in &blocks {
            assert_eq!(block.stats, block.clone().with_stats().stats);
            let column = |attribute| block.column(&attribute).unwrap();
            let (Column::U16x3(rgb), Column::U16(intensity)) =
                (column(Attribute::Color), column(Attribute::Intensity))
            else {
                panic!("{block:?}")
            };
            let (Column::U32(user), Column::Bool(marks)) =
                (column(Attribute::UserData), column(Attribute::Overlap))
            else {
                panic!("{block:?}")
            };
            for (at, xyz) in block.xyz.iter().enumerate() {
                let n = numbers.next().unwrap();
                let p = block.grid.p_in_world(*xyz);
                assert_eq!(p.to_array(), [0.25 * n as f64, (n % 7) as f64, (n % 5) as f64]);
                assert_eq!(user[at] as usize, n);
                assert_eq!(marks.get(at), n % 10 == 4);
                assert_eq!(rgb[at][0], [0, 32768, 65535][n % 3]);
                assert_eq!(intensity[at], (n as f64 * 65535.0 / 999.0).round() as u16);
            }
        }
        assert_eq!(numbers.next(), None);
        assert_eq!(trailer.white, Some(u16::MAX));
        assert_eq!(trailer.losses, ["has 16 bad rows, first Some(0)"]);
        assert_eq!(trailer.warnings, ["has 100 points without a finite place; they were left out"]);
    }
}

#[test]
fn a_grid_of_the_file_is_kept_with_and_without_a_survey() {
    for judged in [JudgedValues::default(), LINE.judged] {
        let want = if judged.colors { all() } else { Projection::of([Attribute::UserData]) };
        let (blocks, trailer) = blocks(&Line { has_grid: true, judged, ..LINE }, &want).unwrap();
        assert_eq!((blocks.len(), blocks[0].grid, blocks[0].xyz.len()), (1, LINE_GRID, 900));
        assert_eq!(blocks[0].xyz[3], [4, 16, 16]);
        assert_eq!(trailer.warnings.len(), 1);
        assert_eq!(blocks[0].column(&Attribute::UserData).unwrap().kind(), Type::U32);
    }
}

#[test]
fn what_is_far_is_left_out_and_said() {
    let (blocks, trailer) = blocks(&Line { far: Some(500), ..LINE }, &all()).unwrap();
    assert_eq!(blocks[0].xyz.len(), 899);
    assert!(trailer.warnings[1].contains("has 1 point farther away"), "{:?}", trailer.warnings);
}

#[test]
fn a_broken_part_ends_the_file_and_is_an_error_only_where_nothing_is_before() {
    let (blocks_read, trailer) = blocks(&Line { broken: Some(9), ..LINE }, &all()).unwrap();
    assert_eq!(blocks_read[0].xyz.len(), (0..9 * 64).filter(|n| n % 10 != 3).count());
    assert!(trailer.losses[1].starts_with("could not be read to its end, from byte 7 on"), "{trailer:?}");
    assert!(matches!(blocks(&Line { broken: Some(0), ..LINE }, &all()), Err(ScanError::Io { .. })));
    assert!(matches!(blocks(&Line { num_points: 0, ..LINE }, &all()), Err(ScanError::NoPoints { .. })));
    let nowhere = Line { num_points: 3, part_points: 3, far: Some(0), ..LINE };
    assert_eq!(blocks(&nowhere, &all()).unwrap().0[0].xyz.len(), 2);
}

#[test]
fn the_user_can_stop_it() {
    let cancel = base::task::CancelToken::default();
    cancel.cancel();
    let stopped = read(&LINE, &all(), &mut |_| Ok(()), &Progress::silent(&cancel));
    assert!(matches!(stopped, Err(ScanError::Cancelled(_))));
}

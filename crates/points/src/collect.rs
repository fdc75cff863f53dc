//! Collects a file's blocks into columns in memory: the attributes that the walk wants, without deleted points.

use crate::block::Block;
use crate::column::{Column, Type, leave_out};
use crate::stats::Stats;
use crate::{Attribute, Grid, Marks, Points, Projection};
use std::collections::TryReserveError;

/// Attributes that the walk wants of each point beside its place.
pub(super) fn wanted() -> Projection {
    Projection::of([
        Attribute::Color,
        Attribute::Intensity,
        Attribute::Normal,
        Attribute::Noise,
        Attribute::Withheld,
    ])
}

/// Why a block cannot be collected.
#[derive(Debug)]
pub(super) enum CannotCollect {
    /// There is no memory for its points.
    Memory,
    /// It has a column that nobody takes: of an attribute that was not asked for, or of another type than all files have
    /// that attribute in.
    Column(Attribute, Type),
}

impl From<TryReserveError> for CannotCollect {
    fn from(_: TryReserveError) -> Self {
        Self::Memory
    }
}

/// The points of a file so far.
#[derive(Debug)]
pub(super) struct Collected {
    /// Grid of the points' coordinates.
    pub grid: Grid,
    pub points: Points,
    pub stats: Stats,
}

impl Collected {
    /// No points yet.
    pub fn new() -> Self {
        Self { grid: Grid::default(), points: Points::default(), stats: Stats::EMPTY }
    }

    /// Appends a block, without its withheld points unless they are to be shown. The first block is taken over as it
    /// is, and pages of its spare capacity are never touched.
    ///
    /// # Errors
    /// There is no memory, or the block has a column that nobody takes.
    pub fn add(&mut self, block: Block, show_withheld: bool) -> Result<(), CannotCollect> {
        let Block { grid, xyz, columns, mut stats } = block;
        let (mut points, mut withheld) = (Points { xyz, ..Points::default() }, Marks::default());
        for (attribute, column) in columns {
            match (attribute, column) {
                (Attribute::Color, Column::U16x3(rgb)) => points.rgb = rgb,
                (Attribute::Intensity, Column::U16(intensity)) => points.intensity = intensity,
                (Attribute::Normal, Column::F32x3(normals)) => points.normals = normals,
                (Attribute::Noise, Column::Bool(noise)) => points.noise = noise,
                (Attribute::Withheld, Column::Bool(marks)) => withheld = marks,
                (attribute, column) => return Err(CannotCollect::Column(attribute, column.kind())),
            }
        }
        points.num_withheld = withheld.count() as u64;
        if show_withheld {
            points.noise.append(&withheld, 0);
        } else if points.num_withheld > 0 {
            points.leave_out(&withheld);
            stats = Stats::of_all(&points.xyz, &points.intensity);
        }
        let num_points = self.points.xyz.len();
        join(&mut self.points.xyz, points.xyz)?;
        join(&mut self.points.rgb, points.rgb)?;
        join(&mut self.points.intensity, points.intensity)?;
        join(&mut self.points.normals, points.normals)?;
        self.points.noise.append(&points.noise, num_points);
        self.points.num_withheld += points.num_withheld;
        self.stats = self.stats.union(stats);
        self.grid = grid;
        Ok(())
    }

    /// Gives back the memory that was taken in case more points came.
    pub fn shrink(&mut self) {
        self.points.xyz.shrink_to_fit();
        self.points.rgb.shrink_to_fit();
        self.points.intensity.shrink_to_fit();
        self.points.normals.shrink_to_fit();
    }
}

fn join<T>(all: &mut Vec<T>, mut more: Vec<T>) -> Result<(), TryReserveError> {
    if all.is_empty() {
        *all = more;
    } else {
        all.try_reserve(more.len())?;
        all.append(&mut more);
    }
    Ok(())
}

impl Points {
    /// Leaves the points out that are marked.
    pub(super) fn leave_out(&mut self, gone: &Marks) {
        let mut noise = Marks::default();
        let left = (0..self.xyz.len()).filter(|&number| !gone.get(number));
        for (next, _) in left.enumerate().filter(|(_, number)| self.noise.get(*number)) {
            noise.set(next);
        }
        self.noise = noise;
        leave_out(&mut self.xyz, gone);
        leave_out(&mut self.rgb, gone);
        leave_out(&mut self.intensity, gone);
        leave_out(&mut self.normals, gone);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(first: i32, withheld: &[usize], noise: &[usize]) -> Block {
        let marks = |numbers: &[usize]| {
            let mut marks = Marks::default();
            numbers.iter().for_each(|&number| marks.set(number));
            Column::Bool(marks)
        };
        let xyz: Vec<[i32; 3]> = (first..first + 4).map(|x| [x, 0, 0]).collect();
        let intensity = Column::U16(xyz.iter().map(|p| 10 * p[0] as u16).collect());
        let columns = vec![
            (Attribute::Intensity, intensity),
            (Attribute::Noise, marks(noise)),
            (Attribute::Withheld, marks(withheld)),
        ];
        Block { grid: Grid::default(), xyz, columns, stats: Stats::EMPTY }.with_stats()
    }

    fn collected(show_withheld: bool) -> (Vec<i32>, Vec<i32>, u64, [i32; 2], [u16; 2]) {
        let mut collected = Collected::new();
        for block in [block(0, &[0, 2], &[1]), block(4, &[], &[]), block(8, &[3], &[0, 3])] {
            collected.add(block, show_withheld).unwrap();
        }
        let Collected { points, stats, .. } = collected;
        let xs: Vec<i32> = points.xyz.iter().map(|p| p[0]).collect();
        assert!(xs.iter().zip(&points.intensity).all(|(x, i)| 10 * *x == i32::from(*i)));
        let noise = (0..xs.len()).filter(|&at| points.noise.get(at)).map(|at| xs[at]).collect();
        let range = [stats.intensity_min, stats.intensity_max];
        (xs, noise, points.num_withheld, [stats.xyz_min[0], stats.xyz_max[0]], range)
    }

    #[test]
    fn columns_that_nobody_takes_are_refused() {
        let refused = |attribute: Attribute, column: Column| {
            let block = Block { columns: vec![(attribute.clone(), column)], ..block(0, &[], &[]) };
            let error = Collected::new().add(block, false).unwrap_err();
            matches!(error, CannotCollect::Column(of, _) if of == attribute)
        };
        assert!(refused(Attribute::Intensity, Column::F32(vec![0.5; 4])));
        assert!(refused(Attribute::GpsTime, Column::F64(vec![0.5; 4])));
    }

    #[test]
    fn the_withheld_are_left_out_or_count_as_noise() {
        let left = vec![1, 3, 4, 5, 6, 7, 8, 9, 10];
        assert_eq!(collected(false), (left, vec![1, 8], 3, [1, 10], [10, 100]));
        assert_eq!(collected(true), ((0..12).collect(), vec![0, 1, 2, 8, 11], 3, [0, 11], [0, 110]));
    }
}

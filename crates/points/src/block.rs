//! Blocks: points that follow each other in a file, as formats hand them over, and what comes at the file's end.

use crate::column::{self, Column, Type};
use crate::stats::Stats;
use crate::{Attribute, Grid, Marks};
use std::collections::TryReserveError;

/// Points that follow each other in a file.
#[derive(Clone, Debug)]
pub struct Block {
    /// Grid of their coordinates: the same for all blocks of a file.
    pub grid: Grid,
    /// Grid coordinates.
    pub xyz: Vec<[i32; 3]>,
    /// The wanted attributes that the file has, with values as it stores them. Each column is as long as `xyz`; all
    /// blocks of a file have the same columns.
    pub columns: Vec<(Attribute, Column)>,
    /// Extremes, found while the points were in the cache.
    pub stats: Stats,
}

impl Block {
    /// A block without points.
    pub(crate) fn new(grid: Grid, columns: impl IntoIterator<Item = (Attribute, Type)>) -> Self {
        let columns = columns.into_iter().map(|(attribute, kind)| (attribute, Column::new(kind)));
        Self { grid, xyz: Vec::new(), columns: columns.collect(), stats: Stats::EMPTY }
    }

    /// Makes room for more points.
    pub(crate) fn reserve(&mut self, more: usize) -> Result<(), TryReserveError> {
        self.xyz.try_reserve(more)?;
        self.columns.iter_mut().try_for_each(|(_, column)| column.reserve(more))
    }

    /// Appends a block of the same grid, with the same columns.
    pub(crate) fn append(&mut self, later: Self) -> Result<(), TryReserveError> {
        let (len, mut xyz) = (self.xyz.len(), later.xyz);
        self.reserve(xyz.len())?;
        self.xyz.append(&mut xyz);
        for ((_, column), (_, later)) in self.columns.iter_mut().zip(later.columns) {
            column.append(later, len);
        }
        self.stats = self.stats.union(later.stats);
        Ok(())
    }

    /// Leaves out the marked points. Extremes have to be found again.
    pub(crate) fn leave_out(&mut self, gone: &Marks) {
        let is_kept: Vec<bool> = (0..self.xyz.len()).map(|number| !gone.get(number)).collect();
        column::leave_out(&mut self.xyz, gone);
        self.columns.iter_mut().for_each(|(_, column)| column.keep(&is_kept));
    }

    /// Keeps the first points. Their extremes have to be found again.
    pub(crate) fn truncate(&mut self, len: usize) {
        self.xyz.truncate(len);
        self.columns.iter_mut().for_each(|(_, column)| column.truncate(len));
    }

    /// The column of an attribute, if it was wanted and the file has it.
    #[must_use]
    pub fn column(&self, attribute: &Attribute) -> Option<&Column> {
        self.columns.iter().find(|(other, _)| other == attribute).map(|(_, column)| column)
    }

    /// Finds the extremes.
    pub(crate) fn with_stats(mut self) -> Self {
        let intensity = match self.column(&Attribute::Intensity) {
            Some(Column::U16(intensity)) => &intensity[..],
            _ => &[],
        };
        self.stats = Stats::of(&self.xyz, intensity);
        self
    }
}

/// What is known of a file once its last point was handed over.
#[derive(Debug, Default)]
pub struct Trailer {
    /// Triangles of a mesh as numbers of the points that were handed over, counter-clockwise where the surface is seen
    /// from.
    pub triangles: Vec<[u32; 3]>,
    /// The largest that a color can be, where the format knows it.
    pub white: Option<u16>,
    /// What the file has or announces and could not be read, as sentences whose subject is the file.
    pub losses: Vec<String>,
    /// What else was odd, as sentences whose subject is the file.
    pub warnings: Vec<String>,
}

//! The last pass over a file's parts, which puts points on the grid and hands them over in blocks.

use super::{Part, PartColors, PartIntensities, Places, RowsSeen, Take};
use crate::block::Block;
use crate::column::Column;
use crate::grid::{self, FittedGrid, Grid};
use crate::stats::Stats;
use crate::{Attribute, ScanError};
use std::collections::TryReserveError;
use std::path::{Path, PathBuf};

/// PartFinish parts become blocks, once all points were seen.
#[derive(Debug)]
pub(super) struct PartFinish {
    pub grid: Grid,
    /// The grid that was made for the points; `None` if the file has one.
    pub fitted: Option<FittedGrid>,
    /// Factor of float colors.
    pub color_factor: f64,
    /// Number that is subtracted from intensities, and factor that they are then multiplied by.
    pub intensity: (f64, f64),
}

/// A part that is a block, and what was left out of it.
#[derive(Debug)]
pub(super) struct FinishedPart {
    block: Block,
    pub rows: RowsSeen,
    num_without_place: u64,
    num_far: u64,
    losses: Vec<String>,
}

impl PartFinish {
    /// Puts a part on the grid.
    pub fn finish(&self, part: Part) -> FinishedPart {
        let rows = RowsSeen::of(&part);
        let Part { places, colors, intensities, columns, losses, .. } = part;
        let mut num_without_place = 0;
        let (is_kept, mut xyz) = match places {
            Places::Anywhere(places) => self.snap(&places, &mut num_without_place),
            Places::OnGrid(xyz, none) => {
                num_without_place = none.count() as u64;
                let is_kept = (0..xyz.len()).map(|number| !none.get(number)).collect();
                (is_kept, xyz)
            }
        };
        let rgb = match colors {
            PartColors::Absent => None,
            PartColors::Stored(rgb) => Some(rgb),
            // `as` saturates, and makes 0 of NaN.
            PartColors::Floats(rgb) => {
                let whole = |c: f32| (f64::from(c) * self.color_factor).round() as u16;
                Some(rgb.into_iter().map(|rgb| rgb.map(whole)).collect())
            }
        };
        let intensity = match intensities {
            PartIntensities::Absent => None,
            PartIntensities::Stored(intensity) => Some(intensity),
            PartIntensities::Numbers(intensity) => {
                let (start, factor) = self.intensity;
                Some(intensity.into_iter().map(|value| ((value - start) * factor).round() as u16).collect())
            }
        };
        let standard = [
            rgb.map(|rgb| (Attribute::Color, Column::U16x3(rgb))),
            intensity.map(|intensity| (Attribute::Intensity, Column::U16(intensity))),
        ];
        let mut columns: Vec<(Attribute, Column)> = standard.into_iter().flatten().chain(columns).collect();
        let num_kept = is_kept.iter().filter(|is_kept| **is_kept).count();
        if num_kept < xyz.len() {
            let mut kept = is_kept.iter();
            xyz.retain(|_| kept.next().is_some_and(|is_kept| *is_kept));
            columns.iter_mut().for_each(|(_, column)| column.keep(&is_kept));
        }
        let num_far = rows.num_read - num_without_place - num_kept as u64;
        let block = Block { grid: self.grid, xyz, columns, stats: Stats::EMPTY }.with_stats();
        FinishedPart { block, rows, num_without_place, num_far, losses }
    }

    /// Which of the places are kept, and all of them on the grid.
    fn snap(&self, places: &[[f64; 3]], num_without_place: &mut u64) -> (Vec<bool>, Vec<[i32; 3]>) {
        let Some(fitted) = &self.fitted else {
            // A file that has a grid has no other places.
            *num_without_place = places.len() as u64;
            return (vec![false; places.len()], vec![[0; 3]; places.len()]);
        };
        let mut is_kept = Vec::with_capacity(places.len());
        let mut xyz = Vec::with_capacity(places.len());
        for place in places {
            let is_place = grid::is_place(place);
            *num_without_place += u64::from(!is_place);
            is_kept.push(is_place && fitted.holds(place));
            xyz.push(fitted.snap(place));
        }
        (is_kept, xyz)
    }
}

/// The points of the next block, and what was left out so far.
#[derive(Debug)]
pub(super) struct Blocks {
    path: PathBuf,
    block_points: usize,
    /// Points to be expected, if they were counted.
    num_expected: Option<u64>,
    block: Option<Block>,
    pub rows: RowsSeen,
    /// Points that are in blocks.
    pub num_kept: u64,
    pub num_without_place: u64,
    /// Points farther away than the grid reaches.
    pub num_far: u64,
    pub losses: Vec<String>,
}

impl Blocks {
    /// No blocks yet, of about `block_points` points each.
    pub fn new(path: &Path, block_points: usize, num_expected: Option<u64>) -> Self {
        Self {
            path: path.to_owned(),
            block_points,
            num_expected,
            block: None,
            rows: RowsSeen::default(),
            num_kept: 0,
            num_without_place: 0,
            num_far: 0,
            losses: Vec::new(),
        }
    }

    /// Appends parts. Returns false if one could not be read after others: later ones are not read then.
    ///
    /// # Errors
    /// There is no memory, nothing can be read, or `take` fails.
    pub fn append(
        &mut self,
        parts: Vec<Result<FinishedPart, ScanError>>,
        how: &PartFinish,
        take: &mut Take,
    ) -> Result<bool, ScanError> {
        for part in parts {
            let part = match part {
                Ok(part) => part,
                Err(ScanError::Io { offset, error, .. }) if self.num_kept > 0 => {
                    let from = offset.map_or_else(String::new, |byte| format!(", from byte {byte} on"));
                    self.losses.push(format!("could not be read to its end{from}: {error}"));
                    return Ok(false);
                }
                Err(error) => return Err(error),
            };
            let FinishedPart { block, rows, num_without_place, num_far, losses } = part;
            self.rows.add(rows);
            self.num_kept += block.xyz.len() as u64;
            self.num_without_place += num_without_place;
            self.num_far += num_far;
            let is_new = |loss: &String| !self.losses.contains(loss);
            let losses: Vec<String> = losses.into_iter().filter(is_new).collect();
            self.losses.extend(losses);
            self.join(block, how).map_err(|_| self.no_memory())?;
            if self.block.as_ref().is_some_and(|block| block.xyz.len() >= self.block_points) {
                self.hand_over(take)?;
            }
        }
        Ok(true)
    }

    fn join(&mut self, later: Block, how: &PartFinish) -> Result<(), TryReserveError> {
        let num_expected = self.num_expected.unwrap_or(0).min(self.block_points as u64);
        let block = match &mut self.block {
            Some(block) => block,
            none => {
                let kinds =
                    later.columns.iter().map(|(attribute, column)| (attribute.clone(), column.kind()));
                let block = none.insert(Block::new(how.grid, kinds));
                // A number that exceeds usize exceeds memory.
                block.reserve(usize::try_from(num_expected).unwrap_or(usize::MAX))?;
                block
            }
        };
        block.reserve(later.xyz.len())?;
        let num_here = block.xyz.len();
        block.xyz.extend_from_slice(&later.xyz);
        for ((_, column), (_, later)) in block.columns.iter_mut().zip(later.columns) {
            column.append(later, num_here);
        }
        block.stats = block.stats.union(later.stats);
        Ok(())
    }

    fn no_memory(&self) -> ScanError {
        let num_points = self.num_expected.unwrap_or(self.num_kept);
        ScanError::Memory { path: self.path.clone(), num_points }
    }

    /// Hands over the points since the last block.
    ///
    /// # Errors
    /// Those of `take`.
    pub fn hand_over(&mut self, take: &mut Take) -> Result<(), ScanError> {
        match self.block.take() {
            Some(block) if !block.xyz.is_empty() => take(block),
            _ => Ok(()),
        }
    }
}

//! What formats share whose coordinates are numbers of any kind, and whose files have parts that can be decoded each by
//! itself.
//!
//! ```text
//!  Measured: parts ──in parallel──▶ PartSurvey: box, sample, ranges ──▶ FittedGrid ──parts again──▶ blocks in file order
//! ```
//!
//! A file is read twice, because the grid of its coordinates and the ranges of its intensities and colors are known only
//! after the last point. So only the blocks and the parts in work are held. A file whose coordinates are whole steps of a
//! grid, and whose values need no ranges, is read once.

mod blocks;
mod ranges;
mod survey;

pub(in crate::formats) use ranges::{
    both, count_channels, float_factor, intensity_ends, intensity_ramp, unit,
};

use super::Take;
use crate::block::Trailer;
use crate::column::Column;
use crate::far::{self, left_out};
use crate::grid::{FittedGrid, Grid};
use crate::{Attribute, Marks, Projection, ScanError};
use base::task::{Cancelled, Progress};
use blocks::{Blocks, PartFinish};
use rayon::prelude::*;
use std::path::Path;
use survey::PartSurvey;

/// Parts for each core that are decoded before they are appended.
const PARTS_PER_THREAD: usize = 2;
/// Most sentences about parts that could not be read.
const MOST_LOSSES: usize = 8;

/// An opened file, as a number of parts.
pub(in crate::formats) trait Measured: Sync {
    /// Path of the file.
    fn path(&self) -> &Path;

    /// About how many points there are: no more than the file's size bears out.
    fn num_points(&self) -> u64;

    /// Number of its parts: some for each core, of 10 000 to 100 000 points each.
    fn num_parts(&self) -> usize;

    /// Decodes a part: the places of all its points, and the attributes that are wanted and that the file has. All parts
    /// have the same columns in the same order.
    ///
    /// # Errors
    /// The system cannot read the file. (What cannot be decoded is told in [`Part::losses`].)
    fn decode(&self, part: usize, want: &Projection) -> Result<Part, ScanError>;

    /// The grid of its coordinates, if they are whole steps of one; all parts are [`Places::OnGrid`] then.
    fn grid(&self) -> Option<Grid> {
        None
    }

    /// What only all values together tell.
    fn judged(&self) -> JudgedValues {
        JudgedValues::default()
    }

    /// The largest that a color can be, if the format knows it. Of colors that are floats nobody asks.
    fn white(&self) -> Option<u16> {
        None
    }

    /// Why points have no place, as [`left_out`] says it.
    fn without_place(&self) -> &'static str {
        "without a finite place"
    }

    /// Sentences about rows that could not be read, and about points that are announced and not there.
    fn losses(&self, _read: &RowsSeen) -> Vec<String> {
        Vec::new()
    }

    /// Sentences about what else is odd about the rows that were seen.
    fn warnings(&self, _read: &RowsSeen) -> Vec<String> {
        Vec::new()
    }

    /// The error that says why there are no points although these rows were seen.
    fn no_points(&self, read: &RowsSeen) -> ScanError;
}

/// Which values only all points together give a meaning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::formats) struct JudgedValues {
    /// True if colors are [`PartColors::Floats`].
    pub colors: bool,
    /// True if intensities are [`PartIntensities::Numbers`].
    pub intensities: bool,
    /// True if these intensities are whole numbers, which stay if 16 bits hold them.
    pub whole_intensities: bool,
}

/// Where the points of a part are.
#[derive(Debug)]
pub(in crate::formats) enum Places {
    /// Anywhere; not finite where a point has no place.
    Anywhere(Vec<[f64; 3]>),
    /// On the file's own grid, except for the marked points, which have no place.
    OnGrid(Vec<[i32; 3]>, Marks),
}

impl Places {
    fn len(&self) -> usize {
        match self {
            Self::Anywhere(places) => places.len(),
            Self::OnGrid(xyz, _) => xyz.len(),
        }
    }
}

/// Colors of a part, one for each point.
#[derive(Debug, Default)]
pub(in crate::formats) enum PartColors {
    /// Not wanted, or not there.
    #[default]
    Absent,
    /// Whole numbers, as [`Attribute::Color`] has them.
    Stored(Vec<[u16; 3]>),
    /// Floats, which should be 0 to 1.
    Floats(Vec<[f32; 3]>),
}

/// Intensities of a part, one for each point.
#[derive(Debug, Default)]
pub(in crate::formats) enum PartIntensities {
    /// Not wanted, or not there.
    #[default]
    Absent,
    /// Whole numbers of 16 bits at most.
    Stored(Vec<u16>),
    /// Others, which are spread over 16 bits.
    Numbers(Vec<f64>),
}

/// What was decoded of a part. All that has values has one for each place.
#[derive(Debug)]
pub(in crate::formats) struct Part {
    pub places: Places,
    pub colors: PartColors,
    pub intensities: PartIntensities,
    /// Other wanted attributes, as the file stores them.
    pub columns: Vec<(Attribute, Column)>,
    /// Rows that could not be read; their points are not among the places.
    pub num_bad: u64,
    /// Where the first of these is, in whatever unit the format counts.
    pub first_bad: Option<u64>,
    /// What else could not be read, as sentences whose subject is the file.
    pub losses: Vec<String>,
}

impl Part {
    /// A part of points at these places, of which nothing else is known.
    pub fn at(places: Places) -> Self {
        Self {
            places,
            colors: PartColors::Absent,
            intensities: PartIntensities::Absent,
            columns: Vec::new(),
            num_bad: 0,
            first_bad: None,
            losses: Vec::new(),
        }
    }
}

/// Rows of a file that were seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::formats) struct RowsSeen {
    /// Rows that could be read, with and without a place.
    pub num_read: u64,
    /// Rows that could not be read.
    pub num_bad: u64,
    /// Where the first of these is.
    pub first_bad: Option<u64>,
}

impl RowsSeen {
    /// Adds those of a later part.
    fn add(&mut self, later: Self) {
        self.num_read += later.num_read;
        self.num_bad += later.num_bad;
        self.first_bad = self.first_bad.or(later.first_bad);
    }

    fn of(part: &Part) -> Self {
        Self { num_read: part.places.len() as u64, num_bad: part.num_bad, first_bad: part.first_bad }
    }
}

/// Reads a file: hands over blocks of its points in file order, and says what was left out.
///
/// # Errors
/// Nothing can be read, the user stops it, there is no memory, or `take` fails.
pub(in crate::formats) fn read(
    file: &impl Measured,
    want: &Projection,
    take: &mut Take,
    progress: &Progress,
) -> Result<Trailer, ScanError> {
    let of_file = file.judged();
    let judged = JudgedValues {
        colors: of_file.colors && want.wants(&Attribute::Color),
        intensities: of_file.intensities && want.wants(&Attribute::Intensity),
        ..of_file
    };
    let surveyed = match file.grid() {
        Some(_) if !judged.colors && !judged.intensities => None,
        _ => Some(survey(file, judged, progress)?),
    };
    let fitted = surveyed.as_ref().map(|found| FittedGrid::over(found.sample.clone(), found.bounds));
    let (color_factor, white) = match &surveyed {
        Some(found) if judged.colors => {
            let (factor, white) = float_factor(found.channels, found.num_kept);
            (factor, Some(white))
        }
        _ => (1.0, file.white()),
    };
    let intensity = surveyed.as_ref().map_or((0.0, 1.0), |found| {
        intensity_ramp(intensity_ends(found.intensity, &found.intensities), judged.whole_intensities)
    });
    let how = match (file.grid(), fitted) {
        (Some(grid), _) => PartFinish { grid, fitted: None, color_factor, intensity },
        (None, Some(fitted)) => {
            PartFinish { grid: fitted.grid, fitted: Some(fitted), color_factor, intensity }
        }
        // A file without a grid was surveyed.
        (None, None) => return Err(file.no_points(&RowsSeen::default())),
    };
    let num_kept = surveyed.as_ref().map(|found| found.num_kept);
    let mut blocks = Blocks::new(file.path(), want.block_points(), num_kept);
    let group = PARTS_PER_THREAD * rayon::current_num_threads();
    let mut finished = Vec::new();
    for first in (0..file.num_parts()).step_by(group) {
        let before = std::mem::take(&mut finished);
        let numbers = first..file.num_parts().min(first + group);
        let finish = |number: usize| {
            if progress.is_cancelled() {
                return Err(Cancelled.into());
            }
            let part = how.finish(file.decode(number, want)?);
            // The survey counts the other half.
            let num = part.rows.num_read;
            progress.add(if num_kept.is_some() { num - num / 2 } else { num });
            Ok(part)
        };
        // One group is decoded while the group before is appended.
        let (now, appended) = rayon::join(
            || numbers.into_par_iter().map(finish).collect::<Vec<_>>(),
            || blocks.append(before, &how, take),
        );
        progress.check()?;
        if !appended? {
            break;
        }
        finished = now;
    }
    blocks.append(finished, &how, take)?;
    blocks.hand_over(take)?;
    if blocks.num_kept == 0 {
        return Err(file.no_points(&blocks.rows));
    }
    let mut warnings = file.warnings(&blocks.rows);
    if blocks.num_without_place > 0 {
        warnings.push(left_out(blocks.num_without_place, "point", file.without_place()));
    }
    if blocks.num_far > 0 {
        warnings.push(far::sentence(blocks.num_far));
    }
    let num_more = blocks.losses.len().saturating_sub(MOST_LOSSES);
    blocks.losses.truncate(MOST_LOSSES);
    if num_more > 0 {
        blocks.losses.push(format!("has {num_more} more parts that could not be read"));
    }
    let losses = file.losses(&blocks.rows).into_iter().chain(blocks.losses).collect();
    Ok(Trailer { triangles: Vec::new(), white, losses, warnings })
}

/// Finds what must be known of all points first. There is at least one point that has a place.
fn survey(file: &impl Measured, judged: JudgedValues, progress: &Progress) -> Result<PartSurvey, ScanError> {
    let color = judged.colors.then_some(Attribute::Color);
    let intensity = judged.intensities.then_some(Attribute::Intensity);
    let want = Projection::of(color.into_iter().chain(intensity));
    let survey_one = |number: usize| -> Result<PartSurvey, ScanError> {
        progress.check()?;
        let survey = PartSurvey::of(&file.decode(number, &want)?, file.num_points());
        progress.add(survey.rows.num_read / 2);
        Ok(survey)
    };
    let parts: Vec<Result<PartSurvey, ScanError>> =
        (0..file.num_parts()).into_par_iter().map(survey_one).collect();
    progress.check()?;
    let mut all = PartSurvey::default();
    for part in parts {
        match part {
            Ok(part) => all.append(part),
            Err(error) if all.num_kept == 0 => return Err(error),
            // The parts before can be read; the error is met and told when they are.
            Err(_) => break,
        }
    }
    if all.num_kept == 0 { Err(file.no_points(&all.rows)) } else { Ok(all) }
}

#[cfg(test)]
mod tests;

//! The last pass over a PLY file, which puts rows straight into the columns of a scan.

use super::body::RowSink;
use super::faces::Faces;
use super::point::Meaning;
use super::reader::{Color, Intensity, RowValues, SLOT_INTENSITY, SLOT_NORMAL};
use crate::Attribute;
use crate::block::Block;
use crate::column::{Column, Type};
use crate::formats::measured::unit;
use crate::grid::{self, FittedGrid};
use crate::stats::Stats;
use std::collections::TryReserveError;

/// How rows become columns, once all rows were seen.
#[derive(Debug)]
pub(super) struct How<'a> {
    pub meaning: &'a Meaning,
    pub fitted: FittedGrid,
    /// Factor of float colors.
    pub color_factor: f64,
    /// Number that is subtracted from intensities, and factor that they are then multiplied by.
    pub intensity: (f64, f64),
    /// True if opacities are wanted.
    pub has_opacity: bool,
    /// Attributes that are wanted besides, by the file's names.
    pub extras: Vec<(Attribute, Type)>,
    /// True if faces may name points.
    pub has_faces: bool,
    /// Points that the header announces.
    pub num_announced: u64,
}

/// The points of the next block, in columns that are empty or as long as `xyz`, and the faces so far.
#[derive(Debug)]
pub(super) struct Rows<'a> {
    how: &'a How<'a>,
    first_point: u64,
    num_points: u64,
    pub xyz: Vec<[i32; 3]>,
    pub rgb: Vec<[u16; 3]>,
    pub intensity: Vec<u16>,
    /// Normals of unit length, or NaN.
    pub normals: Vec<[f32; 3]>,
    opacity: Vec<f32>,
    extras: Vec<Column>,
    /// Number of points that were handed over.
    num_before: usize,
    pub faces: Faces,
    /// Numbers of points that are left out, if faces may name them.
    pub gone: Vec<u32>,
    pub left_out: LeftOut,
}

/// Numbers of points that are left out, by the reason, and of colors that are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LeftOut {
    /// Points without a finite place.
    pub without_place: u64,
    /// Points that are nearly transparent.
    pub faint: u64,
    /// Points farther away than the grid reaches.
    pub far: u64,
    /// Colors in lists of neither 3 nor 4 values; their points are kept.
    pub colors: u64,
}

impl<'a> Rows<'a> {
    /// No rows yet.
    pub fn new(how: &'a How<'a>) -> Self {
        Self {
            how,
            first_point: 0,
            num_points: 0,
            xyz: Vec::new(),
            rgb: Vec::new(),
            intensity: Vec::new(),
            normals: Vec::new(),
            opacity: Vec::new(),
            extras: how.extras.iter().map(|(_, kind)| Column::new(*kind)).collect(),
            num_before: 0,
            faces: Faces::new(how.num_announced),
            gone: Vec::new(),
            left_out: LeftOut::default(),
        }
    }

    /// Makes room for points.
    pub fn reserve(&mut self, num_points: u64) -> Result<(), TryReserveError> {
        let has = self.how.meaning.has;
        // A number that exceeds usize exceeds memory.
        let more = |needed: bool| if needed { usize::try_from(num_points).unwrap_or(usize::MAX) } else { 0 };
        self.xyz.try_reserve_exact(more(true))?;
        self.rgb.try_reserve_exact(more(has.color != Color::Absent))?;
        self.intensity.try_reserve_exact(more(has.intensity != Intensity::Absent))?;
        self.normals.try_reserve_exact(more(has.normal))?;
        self.opacity.try_reserve_exact(more(self.how.has_opacity))?;
        self.extras.iter_mut().try_for_each(|column| column.reserve(more(true)))
    }

    /// Number of points that are kept so far.
    pub fn num_kept(&self) -> usize {
        self.num_before + self.xyz.len()
    }

    /// Hands over the points since the last block.
    pub fn hand_over(&mut self) -> Block {
        let xyz = std::mem::take(&mut self.xyz);
        self.num_before += xyz.len();
        let (rgb, intensity) = (std::mem::take(&mut self.rgb), std::mem::take(&mut self.intensity));
        let stats = Stats::of_all(&xyz, &intensity);
        let has = self.how.meaning.has;
        let mut columns = Vec::new();
        // Points may have colors of their own, or those of faces.
        if has.color != Color::Absent || !rgb.is_empty() {
            columns.push((Attribute::Color, Column::U16x3(rgb)));
        }
        if has.intensity != Intensity::Absent {
            columns.push((Attribute::Intensity, Column::U16(intensity)));
        }
        if has.normal {
            columns.push((Attribute::Normal, Column::F32x3(std::mem::take(&mut self.normals))));
        }
        if self.how.has_opacity {
            columns.push((Attribute::Opacity, Column::F32(std::mem::take(&mut self.opacity))));
        }
        for ((attribute, kind), column) in self.how.extras.iter().zip(&mut self.extras) {
            columns.push((attribute.clone(), std::mem::replace(column, Column::new(*kind))));
        }
        Block { grid: self.how.fitted.grid, xyz, columns, stats }
    }

    fn leave_out(&mut self, number: u64) {
        // No triangle names a point beyond u32.
        if self.how.has_faces
            && let Ok(number) = u32::try_from(number)
        {
            self.gone.push(number);
        }
    }
}

impl RowSink for Rows<'_> {
    fn part(&self, first_point: u64, num_rows: usize) -> Self {
        let mut part = Self { first_point, ..Self::new(self.how) };
        // A part is small; growing it will fail if there is no memory for it.
        let _ = part.reserve(num_rows as u64);
        part
    }

    fn append(&mut self, mut later: Self) {
        let num_here = self.xyz.len();
        for (column, later) in self.extras.iter_mut().zip(later.extras) {
            column.append(later, num_here);
        }
        self.opacity.append(&mut later.opacity);
        self.xyz.append(&mut later.xyz);
        self.rgb.append(&mut later.rgb);
        self.intensity.append(&mut later.intensity);
        self.normals.append(&mut later.normals);
        self.faces.append(later.faces);
        // A part may have been read before it was known where it starts.
        let shift = (self.first_point + self.num_points).wrapping_sub(later.first_point);
        let shifted = |number| u32::try_from(u64::from(number).wrapping_add(shift)).ok();
        let gone = later.gone.into_iter().filter_map(shifted);
        self.gone.extend(gone);
        self.num_points += later.num_points;
        self.left_out.without_place += later.left_out.without_place;
        self.left_out.faint += later.left_out.faint;
        self.left_out.far += later.left_out.far;
        self.left_out.colors += later.left_out.colors;
    }

    #[inline]
    fn point(&mut self, row: &RowValues) {
        let number = self.first_point + self.num_points;
        self.num_points += 1;
        let How { meaning, fitted, .. } = self.how;
        let place = meaning.place(number, row);
        if !grid::is_place(&place) {
            self.left_out.without_place += 1;
            return self.leave_out(number);
        }
        if meaning.is_faint(row) {
            self.left_out.faint += 1;
            return self.leave_out(number);
        }
        if !fitted.holds(&place) {
            self.left_out.far += 1;
            return self.leave_out(number);
        }
        self.xyz.push(fitted.snap(&place));
        if meaning.has.color != Color::Absent {
            self.left_out.colors += u64::from(row.has_odd_list);
            self.rgb.push(meaning.rgb(number, row, self.how.color_factor));
        }
        if meaning.has.intensity != Intensity::Absent {
            let (start, factor) = self.how.intensity;
            // `as` saturates, and makes 0 of NaN.
            self.intensity.push(((row.values[SLOT_INTENSITY] - start) * factor).round() as u16);
        }
        if meaning.has.normal {
            self.normals.push(unit(row.three(SLOT_NORMAL)));
        }
        if self.how.has_opacity {
            self.opacity.push(meaning.opacity(row).map_or(f32::NAN, |opacity| opacity as f32));
        }
        // The coordinates of this point are in `xyz` already.
        let number = self.xyz.len() - 1;
        for (column, value) in self.extras.iter_mut().zip(&row.extras) {
            column.push(*value, number);
        }
    }

    fn bad_point(&mut self) {
        let number = self.first_point + self.num_points;
        self.num_points += 1;
        self.leave_out(number);
    }

    fn num_points(&self) -> u64 {
        self.num_points
    }

    fn face(&mut self, color: Color, row: &RowValues) {
        self.faces.push_face(color, row);
    }

    fn strips(&mut self, row: &RowValues) {
        self.faces.push_strips(row);
    }

    fn bad_face(&mut self) {
        self.faces.num_faces += 1;
    }

    fn progress(num_points: u64) -> u64 {
        // The survey counts the other half.
        num_points - num_points / 2
    }
}

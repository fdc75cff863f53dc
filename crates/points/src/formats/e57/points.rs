//! Decodes parts of a file's points: some points of one scan, in the file's coordinates, with the wanted attributes.

use super::attributes::{
    self, CARTESIAN, COLOR, E57Attribute, INTENSITY, Origin, PointColor, PointIntensity, SPHERICAL, TIME,
    three,
};
use super::description::E57Scan;
use super::section::{Fetched, PointSection};
use super::stream::{NumberCoding, PackedNumbers};
use super::{E57File, source_id};
use crate::column::{Column, Type};
use crate::formats::measured::{
    JudgedValues, Measured, Part, PartColors, PartIntensities, Places, RowsSeen, unit,
};
use crate::grid::Grid;
use crate::{Marks, Projection, ScanError};
use base::task::Progress;
use base::words::{agreeing, counted};
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::ops::Range;
use std::path::Path;

/// Points of a part.
const PART_POINTS: u64 = 1 << 15;
/// Scans of which a loss is told by itself.
const MOST_TOLD: usize = 5;

/// The points of a file.
pub(super) struct E57Points<'a> {
    file: &'a E57File,
    sections: Vec<PointSection>,
    /// Scan and points of each part.
    parts: Vec<(usize, Range<u64>)>,
}

impl<'a> E57Points<'a> {
    /// Finds where the points are.
    ///
    /// # Errors
    /// The system cannot read the file, or the user stops it.
    pub fn find(file: &'a E57File, progress: &Progress) -> Result<Self, ScanError> {
        let find = |scan: &E57Scan| match coordinates(scan) {
            Some(_) => PointSection::find(&file.pages, scan, progress),
            None => Ok(PointSection::none("no coordinates are stored")),
        };
        let sections: Vec<PointSection> = file.scans.par_iter().map(find).collect::<Result<_, _>>()?;
        let parts = sections.iter().enumerate().flat_map(|(scan, section)| {
            let end = section.num_points;
            (0..end.div_ceil(PART_POINTS))
                .map(move |part| (scan, part * PART_POINTS..end.min((part + 1) * PART_POINTS)))
        });
        let parts = parts.collect();
        Ok(Self { file, sections, parts })
    }

    /// Sentences about scans that announce more points than could be found.
    fn missing(&self) -> Vec<String> {
        let scans = self.file.scans.iter().zip(&self.sections).enumerate();
        let short = scans.filter(|(_, (scan, section))| section.num_points < scan.announced);
        let mut sentences: Vec<String> = short
            .map(|(number, (scan, section))| {
                let (announced, found) = (counted(scan.announced, "point"), section.num_points);
                let of_scan = if self.file.scans.len() > 1 {
                    format!(" in scan {}", number + 1)
                } else {
                    String::new()
                };
                let why = section.end.as_ref().map_or_else(String::new, |end| format!(": {end}"));
                format!("announces {announced}{of_scan}, of which {found} could be found{why}")
            })
            .collect();
        let num_more = sentences.len().saturating_sub(MOST_TOLD);
        if num_more > 0 {
            sentences.truncate(MOST_TOLD);
            let (scans, announce) =
                (counted(num_more, "more scan"), agreeing(num_more, "announces", "announce"));
            sentences.push(format!("has {scans} that {announce} more than could be found"));
        }
        sentences
    }
}

/// How the coordinates of a scan are stored.
#[derive(Clone, Copy, Debug)]
enum Coordinates {
    Cartesian([usize; 3]),
    /// Range, azimuth and elevation.
    Spherical([usize; 3]),
}

fn coordinates(scan: &E57Scan) -> Option<Coordinates> {
    let cartesian = three(scan, CARTESIAN).map(Coordinates::Cartesian);
    cartesian.or_else(|| three(scan, SPHERICAL).map(Coordinates::Spherical))
}

/// The grid of the file's coordinates, if all scans store whole steps of the same.
pub(super) fn grid(scans: &[E57Scan]) -> Option<Grid> {
    let grid_of = |scan: &E57Scan| {
        let Some(Coordinates::Cartesian(numbers)) = coordinates(scan) else { return None };
        let axis = |number: usize| match scan.streams[number].encoding {
            encoding @ NumberCoding::Whole { scale, offset, .. } => {
                let (low, high) = encoding.range()?;
                let fits = low >= i32::MIN.into() && high <= i32::MAX.into();
                (fits && scale != 0.0 && scale.is_finite() && scale.recip().is_finite())
                    .then_some((scale, offset))
            }
            _ => None,
        };
        let [x, y, z] = numbers.map(axis);
        let (x, y, z) = (x?, y?, z?);
        let is_turned = scan.pose.is_some_and(|pose| pose.orientation != glam::DQuat::IDENTITY);
        let shift = scan.pose.map_or(DVec3::ZERO, |pose| pose.position);
        let offset = DVec3::new(x.1, y.1, z.1) + shift;
        (!is_turned && offset.is_finite()).then_some(Grid { scale: DVec3::new(x.0, y.0, z.0), offset })
    };
    let mut grids = scans.iter().filter(|scan| scan.announced > 0).map(grid_of);
    let first = grids.next()??;
    grids.all(|other| other == Some(first)).then_some(first)
}

impl Measured for E57Points<'_> {
    fn path(&self) -> &Path {
        self.file.pages.source.path()
    }

    fn num_points(&self) -> u64 {
        self.sections.iter().map(|section| section.num_points).sum()
    }

    fn num_parts(&self) -> usize {
        self.parts.len()
    }

    fn decode(&self, part: usize, want: &Projection) -> Result<Part, ScanError> {
        let (scan, points) = self.parts[part].clone();
        let mut decoding = Decoding::new(self, scan, points);
        let mut decoded = Part::at(decoding.places()?);
        for attribute in self.file.attributes.iter().filter(|own| want.wants(&own.field.attribute)) {
            match attribute.origin {
                Origin::Colors => decoded.colors = decoding.colors()?,
                Origin::Intensity => decoded.intensities = decoding.intensities()?,
                _ => decoded.columns.push((attribute.field.attribute.clone(), decoding.column(attribute)?)),
            }
        }
        decoding.leave_damaged_out(&mut decoded);
        Ok(decoded)
    }

    fn grid(&self) -> Option<Grid> {
        self.file.grid
    }

    fn judged(&self) -> JudgedValues {
        JudgedValues {
            colors: self.file.colors == PointColor::Floats,
            intensities: matches!(self.file.intensities, PointIntensity::Whole | PointIntensity::Floats),
            whole_intensities: self.file.intensities == PointIntensity::Whole,
        }
    }

    fn white(&self) -> Option<u16> {
        match self.file.colors {
            PointColor::Stored(white) => white,
            _ => None,
        }
    }

    fn without_place(&self) -> &'static str {
        "that are marked as invalid or have no place"
    }

    fn losses(&self, read: &RowsSeen) -> Vec<String> {
        let mut losses = self.missing();
        if let Some(first) = read.first_bad {
            let (points, were) =
                (counted(read.num_bad, "point"), agreeing(read.num_bad, "it was", "they were"));
            losses.push(format!(
                "has {points} in pages whose checksum is wrong, first point {}; {were} left out",
                first + 1
            ));
        }
        losses
    }

    fn no_points(&self, read: &RowsSeen) -> ScanError {
        let num_scans = self.file.scans.len();
        let reason = if num_scans == 0 {
            "it has no scans; choose another file".to_owned()
        } else if self.file.scans.iter().all(|scan| scan.announced == 0) {
            let scans =
                agreeing(num_scans, "its only scan announces none", "none of its scans announces any");
            format!("{scans}; choose another file")
        } else if read.num_read > 0 {
            let points = agreeing(read.num_read, "its only point is", "all its points are");
            format!("{points} marked as invalid, or at the scanner itself; choose another file")
        } else if let Some(loss) = self.losses(read).first() {
            format!("it {loss}; get the file again")
        } else {
            "none could be read; get the file again".to_owned()
        };
        ScanError::NoPoints { path: self.path().to_owned(), reason }
    }
}

/// Some points of a scan that are being decoded.
struct Decoding<'a> {
    file: &'a E57File,
    scan: &'a E57Scan,
    number: usize,
    section: &'a PointSection,
    points: Range<u64>,
    /// Number of the scan's first point in the file.
    first_in_file: u64,
    /// Points, from the first of these, of which something is damaged.
    damaged: Vec<Range<usize>>,
}

impl<'a> Decoding<'a> {
    fn new(all: &'a E57Points<'a>, number: usize, points: Range<u64>) -> Self {
        let first_in_file = all.sections[..number].iter().map(|section| section.num_points).sum();
        let (file, section) = (all.file, &all.sections[number]);
        Self { file, scan: &file.scans[number], number, section, points, first_in_file, damaged: Vec::new() }
    }

    fn len(&self) -> usize {
        (self.points.end - self.points.start) as usize
    }

    fn fetch(&mut self, stream: usize) -> Result<PackedNumbers, ScanError> {
        let Fetched { numbers, damaged } =
            self.section.fetch(&self.file.pages, self.scan, stream, self.points.clone())?;
        self.damaged.extend(damaged);
        Ok(numbers)
    }

    fn fetch_named(&mut self, name: &str) -> Result<Option<PackedNumbers>, ScanError> {
        self.scan.stream(name).map(|(number, _)| number).map(|number| self.fetch(number)).transpose()
    }

    fn fetch_three(&mut self, numbers: [usize; 3]) -> Result<[PackedNumbers; 3], ScanError> {
        let [x, y, z] = numbers;
        Ok([self.fetch(x)?, self.fetch(y)?, self.fetch(z)?])
    }

    /// Numbers of the points that a flag marks.
    fn flagged(&mut self, name: &str) -> Result<Vec<usize>, ScanError> {
        let Some(states) = self.fetch_named(name)? else { return Ok(Vec::new()) };
        let (mut flagged, mut number) = (Vec::new(), 0);
        states.each_value(|state| {
            if state != 0.0 {
                flagged.push(number);
            }
            number += 1;
        });
        Ok(flagged)
    }

    fn places(&mut self) -> Result<Places, ScanError> {
        match coordinates(self.scan) {
            Some(Coordinates::Cartesian(numbers)) => {
                let invalid = self.flagged("cartesianInvalidState")?;
                let packed = self.fetch_three(numbers)?;
                if self.file.grid.is_some() {
                    let [x, y, z] = packed.map(|packed| packed.whole(|v| v as i32));
                    let xyz = x.into_iter().zip(y).zip(z).map(|((x, y), z)| [x, y, z]).collect();
                    let mut none = Marks::default();
                    invalid.into_iter().for_each(|number| none.set(number));
                    return Ok(Places::OnGrid(xyz, none));
                }
                Ok(self.in_file(packed.map(|packed| packed.values()), &invalid, |p| p))
            }
            Some(Coordinates::Spherical(numbers)) => {
                let invalid = self.flagged("sphericalInvalidState")?;
                let packed = self.fetch_three(numbers)?;
                Ok(self.in_file(packed.map(|packed| packed.values()), &invalid, of_sphere))
            }
            // Parts are made of scans with coordinates only.
            None => Ok(Places::Anywhere(vec![[f64::NAN; 3]; self.len()])),
        }
    }

    /// Places in the file's coordinates, given three values for each and what they mean.
    fn in_file(
        &self,
        [a, b, c]: [Vec<f64>; 3],
        invalid: &[usize],
        of: impl Fn([f64; 3]) -> [f64; 3],
    ) -> Places {
        let values = a.into_iter().zip(b).zip(c).map(|((a, b), c)| of([a, b, c]));
        let mut places: Vec<[f64; 3]> = match self.scan.pose {
            None => values.collect(),
            Some(pose) => {
                let axes = DMat3::from_quat(pose.orientation);
                values.map(|p| (axes * DVec3::from_array(p) + pose.position).to_array()).collect()
            }
        };
        invalid.iter().for_each(|&number| places[number] = [f64::NAN; 3]);
        Places::Anywhere(places)
    }

    fn colors(&mut self) -> Result<PartColors, ScanError> {
        let len = self.len();
        let is_stored = self.file.colors != PointColor::Floats;
        let Some(numbers) = three(self.scan, COLOR) else {
            let none = || PartColors::Floats(vec![[0.0; 3]; len]);
            return Ok(if is_stored { PartColors::Stored(vec![[0; 3]; len]) } else { none() });
        };
        let invalid = self.flagged("isColorInvalid")?;
        let packed = self.fetch_three(numbers)?;
        if is_stored {
            let [r, g, b] = packed.map(|packed| packed.whole(|v| v.clamp(0, u16::MAX.into()) as u16));
            let mut rgb: Vec<[u16; 3]> = r.into_iter().zip(g).zip(b).map(|((r, g), b)| [r, g, b]).collect();
            invalid.into_iter().for_each(|number| rgb[number] = [0; 3]);
            return Ok(PartColors::Stored(rgb));
        }
        let mut rgb = vec![[0.0; 3]; len];
        for (channel, (number, packed)) in numbers.into_iter().zip(packed).enumerate() {
            let ends = attributes::color_ends(self.scan, channel, &self.scan.streams[number]);
            let (low, high) = ends.unwrap_or((0.0, 1.0));
            let mut next = rgb.iter_mut();
            packed.each_value(|value| {
                if let Some(rgb) = next.next() {
                    rgb[channel] = ((value - low) / (high - low)) as f32;
                }
            });
        }
        invalid.into_iter().for_each(|number| rgb[number] = [0.0; 3]);
        Ok(PartColors::Floats(rgb))
    }

    fn intensities(&mut self) -> Result<PartIntensities, ScanError> {
        let len = self.len();
        let invalid = self.flagged("isIntensityInvalid")?;
        let packed = self.fetch_named(INTENSITY)?;
        if self.file.intensities == PointIntensity::Stored {
            let mut values = packed.map_or_else(|| vec![0; len], |packed| packed.whole(|v| v as u16));
            invalid.into_iter().for_each(|number| values[number] = 0);
            return Ok(PartIntensities::Stored(values));
        }
        let mut values = packed.map_or_else(|| vec![f64::NAN; len], |packed| packed.values());
        invalid.into_iter().for_each(|number| values[number] = f64::NAN);
        Ok(PartIntensities::Numbers(values))
    }

    /// The column of an attribute that is neither color nor intensity.
    fn column(&mut self, attribute: &E57Attribute) -> Result<Column, ScanError> {
        let (len, kind) = (self.len(), attribute.field.kind);
        Ok(match &attribute.origin {
            Origin::Station => Column::U16(vec![source_id(self.number); len]),
            Origin::Normals => Column::F32x3(self.normals()?),
            Origin::Count { stream, first } => {
                let most = i64::from(u8::MAX);
                let packed = self.fetch_named(stream)?;
                let numbers =
                    packed.map(|packed| packed.whole(|v| v.saturating_add(*first).clamp(0, most) as u8));
                Column::U8(numbers.unwrap_or_else(|| vec![0; len]))
            }
            Origin::Time => {
                let start = self.scan.start_s.unwrap_or(0.0);
                let packed = self.fetch_named(TIME)?;
                let times =
                    packed.map(|packed| packed.values().into_iter().map(|seconds| start + seconds).collect());
                Column::F64(times.unwrap_or_else(|| vec![f64::NAN; len]))
            }
            Origin::Stream(name) => {
                let column = self.fetch_named(name)?.map(|packed| packed.column(kind));
                column.unwrap_or_else(|| none_of(kind, len))
            }
            // These are handed over otherwise.
            Origin::Colors | Origin::Intensity => none_of(kind, len),
        })
    }

    fn normals(&mut self) -> Result<Vec<[f32; 3]>, ScanError> {
        let Some(numbers) = attributes::normals(self.scan) else {
            return Ok(vec![[f32::NAN; 3]; self.len()]);
        };
        let [x, y, z] = self.fetch_three(numbers)?.map(|packed| packed.values());
        let axes = self.scan.pose.map_or(DMat3::IDENTITY, |pose| DMat3::from_quat(pose.orientation));
        let turned = |((x, y), z)| unit((axes * DVec3::new(x, y, z)).to_array());
        Ok(x.into_iter().zip(y).zip(z).map(turned).collect())
    }

    /// Leaves out the points of which something is damaged, and counts them.
    fn leave_damaged_out(&self, part: &mut Part) {
        if self.damaged.is_empty() {
            return;
        }
        let mut is_kept = vec![true; self.len()];
        self.damaged.iter().for_each(|range| is_kept[range.clone()].fill(false));
        let first = is_kept.iter().position(|is_kept| !is_kept);
        part.first_bad = first.map(|at| self.first_in_file + self.points.start + at as u64);
        part.num_bad = is_kept.iter().filter(|is_kept| !**is_kept).count() as u64;
        keep(part, &is_kept);
    }
}

/// Keeps some of the points of a part.
fn keep(part: &mut Part, is_kept: &[bool]) {
    fn of<T>(values: &mut Vec<T>, is_kept: &[bool]) {
        let mut kept = is_kept.iter();
        values.retain(|_| kept.next().is_some_and(|is_kept| *is_kept));
    }
    match &mut part.places {
        Places::Anywhere(places) => of(places, is_kept),
        Places::OnGrid(xyz, none) => {
            of(xyz, is_kept);
            let mut marks = Column::Bool(std::mem::take(none));
            marks.keep(is_kept);
            if let Column::Bool(marks) = marks {
                *none = marks;
            }
        }
    }
    match &mut part.colors {
        PartColors::Absent => {}
        PartColors::Stored(rgb) => of(rgb, is_kept),
        PartColors::Floats(rgb) => of(rgb, is_kept),
    }
    match &mut part.intensities {
        PartIntensities::Absent => {}
        PartIntensities::Stored(values) => of(values, is_kept),
        PartIntensities::Numbers(values) => of(values, is_kept),
    }
    part.columns.iter_mut().for_each(|(_, column)| column.keep(is_kept));
}

/// A place by range, azimuth and elevation. A range of 0 is no measurement: it would be within the scanner.
fn of_sphere([range, azimuth, elevation]: [f64; 3]) -> [f64; 3] {
    if range == 0.0 {
        return [f64::NAN; 3];
    }
    let ((sin_a, cos_a), (sin_e, cos_e)) = (libm::sincos(azimuth), libm::sincos(elevation));
    [range * cos_e * cos_a, range * cos_e * sin_a, range * sin_e]
}

/// A column of points that lack an attribute.
fn none_of(kind: Type, len: usize) -> Column {
    match kind {
        Type::F32 => Column::F32(vec![f32::NAN; len]),
        Type::F64 => Column::F64(vec![f64::NAN; len]),
        kind => Column::zeros(kind, len).unwrap_or_else(|| Column::new(kind)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_and_ranges_are_places() {
        let close = |a: [f64; 3], b: [f64; 3]| (DVec3::from_array(a) - DVec3::from_array(b)).length() < 1e-15;
        let quarter = std::f64::consts::FRAC_PI_2;
        assert!(close(of_sphere([2.0, 0.0, 0.0]), [2.0, 0.0, 0.0]));
        assert!(close(of_sphere([2.0, quarter, 0.0]), [0.0, 2.0, 0.0]));
        assert!(close(of_sphere([2.0, 1.0, -quarter]), [0.0, 0.0, -2.0]));
        assert!(of_sphere([0.0, 1.0, 1.0])[0].is_nan());
    }
}

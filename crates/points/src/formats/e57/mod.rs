//! E57: scans of one or many stations, each with its pose, as terrestrial scanners' programs write them.
//!
//! ```text
//!  header ──▶ pages with checksums ──▶ description (XML) ──▶ scans: streams, poses, sections
//!  section ──▶ packets ──▶ the bytes of a stream for some points ──▶ numbers ──▶ parts of points
//! ```
//!
//! Any part of a scan can be decoded by itself, and only the streams that are wanted are read.

mod attributes;
mod crc;
mod description;
mod header;
mod pages;
mod points;
mod section;
mod stream;
#[cfg(test)]
mod tests;

use super::measured;
use super::{Candidate, Dataset, Format, OpenHints, Take};
use crate::block::Trailer;
use crate::crs;
use crate::grid::Grid;
use crate::source::Source;
use crate::station::{Station, StationKind};
use crate::up::{Evidence, UpAxis};
use crate::{Axes, Header, Projection, ScanError};
use attributes::{E57Attribute, PointColor, PointIntensity};
use base::task::Progress;
use description::{E57Description, E57Scan};
use header::{E57Header, SIGNATURE};
use pages::Pages;
use points::E57Points;
use std::path::Path;

/// The format E57.
pub(super) struct E57;

impl Format for E57 {
    fn names(&self) -> &'static [&'static str] {
        &["E57"]
    }

    fn probe(&self, candidate: &Candidate) -> bool {
        candidate.head.starts_with(SIGNATURE)
    }

    fn open(&self, path: &Path, _: &OpenHints) -> Result<Box<dyn Dataset>, ScanError> {
        let E57Header { pages, version, text, oddities } = E57Header::read(Source::open(path)?)?;
        let described = description::read(&text).map_err(|problem| ScanError::Field {
            path: path.to_owned(),
            offset: 24,
            field: "xmlPhysicalOffset",
            problem: format!("leads to a description (XML) that {problem}; get the file again"),
        })?;
        let attributes = attributes::all(&described.scans);
        let grid = points::grid(&described.scans);
        let header = Header {
            path: path.to_owned(),
            format: format!("E57 {version}"),
            num_points: described.scans.iter().map(|scan| section::most_points(scan, pages.len())).sum(),
            schema: attributes::schema(&attributes),
            is_on_fixed_grid: grid.is_some(),
            warnings: oddities,
            ..describe(&described)
        };
        let colors = attributes::colors(&described.scans);
        let intensities = attributes::intensities(&described.scans);
        Ok(Box::new(E57File { pages, scans: described.scans, attributes, colors, intensities, grid, header }))
    }
}

/// An opened file.
struct E57File {
    pages: Pages,
    scans: Vec<E57Scan>,
    attributes: Vec<E57Attribute>,
    colors: PointColor,
    intensities: PointIntensity,
    /// The grid of its coordinates, if it has one.
    grid: Option<Grid>,
    header: Header,
}

impl Dataset for E57File {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&self, want: &Projection, take: &mut Take, progress: &Progress) -> Result<Trailer, ScanError> {
        measured::read(&E57Points::find(self, progress)?, want, take, progress)
    }
}

/// What a description says for people.
fn describe(described: &E57Description) -> Header {
    let crs = crs::from_wkt(described.crs.as_bytes());
    // The standard has meters; a system of another unit was written by a program that does not follow it.
    let is_angles = matches!(crs.axes, Some(Axes::Geographic(_)));
    let counts = [(described.scans.len(), "scans"), (described.images.len(), "images")];
    let parts = counts.into_iter().filter(|(num, _)| *num > 0).map(|(num, what)| format!("{what}: {num}"));
    Header {
        parts: parts.collect(),
        stations: stations(described),
        crs: crs.name,
        unit_m: crs.unit_m.or((!is_angles).then_some(1.0)),
        vertical_unit_m: crs.vertical_unit_m,
        axes: crs.axes,
        up: Some(Evidence { up: UpAxis::Z, why: "the format's standard says so" }),
        software: described.software.clone(),
        created: described.created_s.and_then(day),
        ..Header::default()
    }
}

/// Where the file was measured and photographed from.
fn stations(described: &E57Description) -> Vec<Station> {
    let name =
        |name: &Option<String>, number: usize| name.clone().unwrap_or_else(|| (number + 1).to_string());
    let scans = described.scans.iter().enumerate().map(|(number, scan)| Station {
        name: name(&scan.name, number),
        kind: StationKind::Scanner,
        file_from_station: scan.pose,
        source_id: Some(source_id(number)),
    });
    let posed = described.images.iter().enumerate().filter(|(_, image)| image.pose.is_some());
    let images = posed.map(|(number, image)| Station {
        name: name(&image.name, number),
        kind: StationKind::Camera,
        file_from_station: image.pose,
        source_id: None,
    });
    scans.chain(images).collect()
}

/// Days from the start of GPS time, 1980-01-06, to 2000-03-01.
const GPS_DAYS_TO_MARCH_2000: i64 = 7360;
/// Days of 400, 100, 4 years and of one; a leap day is the last of a year that begins in March.
const DAYS_OF_YEARS: [(i64, i64); 4] = [(400, 146_097), (100, 36_524), (4, 1461), (1, 365)];

/// The day of a time in seconds since the start of GPS time, "2024-05-09".
fn day(seconds: f64) -> Option<String> {
    const SECONDS_PER_DAY: f64 = 86_400.0;
    let days = (seconds / SECONDS_PER_DAY).floor() as i64 - GPS_DAYS_TO_MARCH_2000;
    let mut left = days.rem_euclid(DAYS_OF_YEARS[0].1);
    let mut year = 2000 + 400 * days.div_euclid(DAYS_OF_YEARS[0].1);
    for (years, num_days) in &DAYS_OF_YEARS[1..] {
        // The last century of four, and the last year of four, has a day more.
        let most = if *years == 4 { 24 } else { 3 };
        let num = (left / num_days).min(most);
        year += num * years;
        left -= num * num_days;
    }
    let mut month = 3;
    for num_days in [31, 30, 31, 30, 31, 31, 30, 31, 30, 31, 31] {
        if left < num_days {
            break;
        }
        left -= num_days;
        month += 1;
    }
    if month > 12 {
        (year, month) = (year + 1, month - 12);
    }
    (1980..10_000).contains(&year).then(|| format!("{year}-{month:02}-{:02}", left + 1))
}

/// The number that the points of a scan have, from 1.
fn source_id(scan: usize) -> u16 {
    u16::try_from(scan + 1).unwrap_or(u16::MAX)
}

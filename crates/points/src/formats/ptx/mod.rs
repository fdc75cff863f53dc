//! PTX: scans of scanners as text, each with the scanner's place, a transform and rows of points.

mod header;
mod rows;
mod scans;
#[cfg(test)]
mod tests;

use super::measured;
use super::{Candidate, Dataset, Format, OpenHints, Take};
use crate::block::Trailer;
use crate::column::Type;
use crate::source::Source;
use crate::station::{Station, StationKind};
use crate::up::{Evidence, UpAxis};
use crate::{Attribute, Field, Header, Projection, ScanError, Schema};
use base::task::Progress;
use rows::{INTENSITY, PtxRows};
use scans::PtxScan;
use std::path::Path;

/// Bytes of each scan's rows that tell what they have.
const SAMPLE_BYTES: u64 = 1 << 12;
/// Scans that are looked at for what their rows have.
const MOST_SAMPLED: usize = 1 << 10;

/// The format PTX.
pub(super) struct Ptx;

impl Format for Ptx {
    fn names(&self) -> &'static [&'static str] {
        &["PTX"]
    }

    fn probe(&self, candidate: &Candidate) -> bool {
        let head = without_mark(candidate.head);
        header::is_ptx(head, line_end(head))
    }

    fn open(&self, path: &Path, _: &OpenHints) -> Result<Box<dyn Dataset>, ScanError> {
        let source = Source::open(path)?;
        let line_end = line_end(&source.bytes(0, SAMPLE_BYTES)?);
        let scans = scans::find(&source, line_end)?;
        if scans.is_empty() {
            let reason = "its first scan ends within the ten lines before its rows, or one of them makes no sense; get \
                          the file again";
            return Err(ScanError::NoPoints { path: path.to_owned(), reason: reason.into() });
        }
        let num_cells = num_cells(&source, &scans, line_end)?;
        let header = Header {
            path: path.to_owned(),
            format: "PTX".into(),
            num_points: scans.iter().map(|scan| scan.num_lines).sum(),
            schema: schema(&num_cells),
            parts: vec![format!("scans: {}", scans.len())],
            stations: scans.iter().enumerate().map(|(number, scan)| station(number, scan)).collect(),
            up: Some(Evidence { up: UpAxis::Z, why: "scanners stand upright" }),
            ..Header::default()
        };
        Ok(Box::new(PtxFile { source, line_end, scans, header }))
    }
}

/// An opened file. It has at least one scan.
struct PtxFile {
    source: Source,
    /// Byte that ends a line.
    line_end: u8,
    scans: Vec<PtxScan>,
    header: Header,
}

impl Dataset for PtxFile {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&self, want: &Projection, take: &mut Take, progress: &Progress) -> Result<Trailer, ScanError> {
        measured::read(&PtxRows::new(self), want, take, progress)
    }
}

/// A text without a byte order mark.
fn without_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text)
}

/// The byte that ends lines.
fn line_end(text: &[u8]) -> u8 {
    if text.contains(&b'\r') && !text.contains(&b'\n') { b'\r' } else { b'\n' }
}

/// Numbers of the first row of each of the first scans.
fn num_cells(source: &Source, scans: &[PtxScan], line_end: u8) -> Result<Vec<usize>, ScanError> {
    let first_row = |scan: &PtxScan| {
        let text = source.bytes(scan.start, SAMPLE_BYTES.min(scan.end - scan.start))?;
        let lines = text.split(|&byte| byte == line_end).map(<[u8]>::trim_ascii);
        let first = lines
            .filter(|line| !line.is_empty())
            .map(|line| line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).count());
        Ok(first.max().unwrap_or(0))
    };
    scans.iter().take(MOST_SAMPLED).map(first_row).collect()
}

/// What is stored for each point: x y z, intensity, and red, green and blue.
fn schema(num_cells: &[usize]) -> Schema {
    let has_intensity = num_cells.iter().any(|num| matches!(num, 4 | 5 | 7..));
    let has_color = num_cells.iter().any(|&num| num >= 6);
    let raw = Field { is_detail: true, ..Field::plain(Attribute::Named(INTENSITY.into()), Type::F64) };
    let fields = [
        has_color.then(|| Field::plain(Attribute::Color, Type::U16x3)),
        has_intensity.then(|| Field::plain(Attribute::Intensity, Type::U16)),
        Some(Field::plain(Attribute::SourceId, Type::U16)),
        has_intensity.then_some(raw),
    ];
    Schema { fields: fields.into_iter().flatten().collect(), unread: Vec::new() }
}

fn station(number: usize, scan: &PtxScan) -> Station {
    Station {
        name: (number + 1).to_string(),
        kind: StationKind::Scanner,
        file_from_station: scan.header.pose,
        source_id: Some(source_id(number)),
    }
}

/// The number that the points of a scan have, from 1.
fn source_id(scan: usize) -> u16 {
    u16::try_from(scan + 1).unwrap_or(u16::MAX)
}

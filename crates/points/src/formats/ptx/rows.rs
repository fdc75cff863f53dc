//! Decodes the rows of PTX scans: places, intensities and colors, in the file's coordinates.

use super::PtxFile;
use super::scans::PtxScan;
use crate::column::Column;
use crate::formats::measured::{JudgedValues, Measured, Part, PartColors, PartIntensities, Places, RowsSeen};
use crate::formats::rows::Dialect;
use crate::{Attribute, Projection, ScanError};
use base::words::{agreeing, counted};
use glam::DVec3;
use std::path::Path;

/// Bytes of a part.
const PART_BYTES: u64 = 1 << 20;
/// Bytes that are read at once behind a part, to find the end of its last line.
const MORE_BYTES: u64 = 1 << 12;
/// Most bytes of a line; longer ones are damage.
const MOST_LINE_BYTES: u64 = 1 << 20;
/// Scans of which a loss is told by itself.
const MOST_TOLD: usize = 5;
/// The scan's own name for its intensities.
pub(super) const INTENSITY: &str = "intensity";

/// The rows of a file, in parts.
pub(super) struct PtxRows<'a> {
    file: &'a PtxFile,
    /// Scan and first byte of each part.
    parts: Vec<(usize, u64)>,
}

impl<'a> PtxRows<'a> {
    /// The rows of a file.
    pub fn new(file: &'a PtxFile) -> Self {
        let parts = file.scans.iter().enumerate().flat_map(|(number, scan)| {
            (scan.start..scan.end).step_by(PART_BYTES as usize).map(move |start| (number, start))
        });
        Self { file, parts: parts.collect() }
    }

    /// The lines that start in a part, and the place of the first.
    fn text(&self, scan: &PtxScan, start: u64) -> Result<(Vec<u8>, u64), ScanError> {
        let PtxFile { source, line_end, .. } = self.file;
        // The byte before tells whether a line starts with the part.
        let from = if start == scan.start { start } else { start - 1 };
        let end = (start + PART_BYTES).min(scan.end);
        let mut text = source.bytes(from, end - from)?;
        while text.last() != Some(line_end) && (text.len() as u64) < PART_BYTES + MOST_LINE_BYTES {
            let next = from + text.len() as u64;
            let more = source.bytes(next, MORE_BYTES.min(scan.end.saturating_sub(next)))?;
            let end = memchr::memchr(*line_end, &more);
            text.extend_from_slice(&more[..end.map_or(more.len(), |end| end + 1)]);
            if more.is_empty() {
                break;
            }
        }
        if from == start {
            return Ok((text, start));
        }
        // A line that started before is another part's.
        let first = memchr::memchr(*line_end, &text).map_or(text.len(), |end| end + 1);
        text.drain(..first);
        Ok((text, from + first as u64))
    }
}

/// True if the rows of a scan have fewer lines than it announces.
fn is_short(scan: &PtxScan) -> bool {
    scan.num_lines < scan.header.announced
}

fn num_words(line: &[u8]) -> usize {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).count()
}

/// What is kept of a row.
struct PtxRow {
    place: DVec3,
    intensity: f64,
    rgb: [u16; 3],
}

/// How far rows are read.
#[derive(Clone, Copy)]
struct PtxWant {
    intensity: bool,
    color: bool,
}

impl PtxRow {
    /// Reads a row; `None` if it has no three numbers.
    #[inline]
    fn read(line: &[u8], want: PtxWant) -> Option<Self> {
        let mut cells = Dialect::BLANKS.cells(line);
        let place = DVec3::new(cells.value()?, cells.value()?, cells.value()?);
        let (mut intensity, mut rgb) = (f64::NAN, [0; 3]);
        if want.intensity || want.color {
            let mut values = [0.0; 4];
            let mut num = 0;
            for value in &mut values {
                let Some(next) = cells.value() else { break };
                *value = next;
                num += 1;
            }
            // Rows of six numbers have no intensity.
            let [a, b, c, d] = values;
            let (own, color) = match num {
                0 => (f64::NAN, None),
                1 | 2 => (a, None),
                3 => (f64::NAN, Some([a, b, c])),
                _ => (a, Some([b, c, d])),
            };
            intensity = own;
            // `as` saturates, and makes 0 of NaN.
            rgb = color.map_or([0; 3], |color| color.map(|value| value.round() as u16));
        }
        Some(Self { place, intensity, rgb })
    }
}

impl Measured for PtxRows<'_> {
    fn path(&self) -> &Path {
        self.file.source.path()
    }

    fn num_points(&self) -> u64 {
        self.file.header.num_points
    }

    fn num_parts(&self) -> usize {
        self.parts.len()
    }

    fn decode(&self, part: usize, want: &Projection) -> Result<Part, ScanError> {
        let (number, start) = self.parts[part];
        let scan = &self.file.scans[number];
        let (mut text, first) = self.text(scan, start)?;
        let mut is_cut = false;
        if first + text.len() as u64 == self.file.source.len() {
            let end = memchr::memrchr(self.file.line_end, &text).map_or(0, |end| end + 1);
            let (lines, last) = text.split_at(end);
            let before = lines.trim_ascii_end();
            let before = &before[memchr::memrchr(self.file.line_end, before).unwrap_or(0)..];
            // The file may have been cut off: its last line may have lost digits, or numbers.
            is_cut = !last.trim_ascii().is_empty() && (is_short(scan) || num_words(last) < num_words(before));
            if is_cut {
                text.truncate(end);
            }
        }
        let schema = &self.file.header.schema;
        let wants = |attribute: &Attribute| want.wants(attribute) && schema.field(attribute).is_some();
        let raw = Attribute::Named(INTENSITY.into());
        let (has_intensity, has_raw, has_color) =
            (wants(&Attribute::Intensity), wants(&raw), wants(&Attribute::Color));
        let of_row = PtxWant { intensity: has_intensity || has_raw, color: has_color };
        let (mut places, mut intensities, mut colors) = (Vec::new(), Vec::new(), Vec::new());
        let mut decoded = Part::at(Places::Anywhere(Vec::new()));
        let mut at = 0;
        while at < text.len() {
            let end = memchr::memchr(self.file.line_end, &text[at..]).map_or(text.len(), |end| at + end + 1);
            let line = &text[at..end];
            if let Some(row) = PtxRow::read(line, of_row) {
                // Rows of zeros are directions from which no light came back.
                let place = if row.place == DVec3::ZERO {
                    DVec3::NAN
                } else {
                    scan.header.axes * row.place + scan.header.origin
                };
                places.push(place.to_array());
                if of_row.intensity {
                    intensities.push(row.intensity);
                }
                if has_color {
                    colors.push(row.rgb);
                }
            } else if !line.trim_ascii().is_empty() {
                decoded.num_bad += 1;
                decoded.first_bad = decoded.first_bad.or(Some(first + at as u64));
            }
            at = end;
        }
        if is_cut {
            decoded.num_bad += 1;
            decoded.first_bad = decoded.first_bad.or(Some(first + text.len() as u64));
        }
        let num_rows = places.len();
        decoded.places = Places::Anywhere(places);
        if has_color {
            decoded.colors = PartColors::Stored(colors);
        }
        if want.wants(&Attribute::SourceId) {
            let ids = vec![super::source_id(number); num_rows];
            decoded.columns.push((Attribute::SourceId, Column::U16(ids)));
        }
        if has_raw {
            decoded.columns.push((raw, Column::F64(intensities.clone())));
        }
        if has_intensity {
            decoded.intensities = PartIntensities::Numbers(intensities);
        }
        Ok(decoded)
    }

    fn judged(&self) -> JudgedValues {
        JudgedValues { intensities: true, ..JudgedValues::default() }
    }

    fn without_place(&self) -> &'static str {
        "without a return (0 0 0)"
    }

    fn losses(&self, read: &RowsSeen) -> Vec<String> {
        let scans = self.file.scans.iter().enumerate().filter(|(_, scan)| is_short(scan));
        let mut losses: Vec<String> = scans
            .map(|(number, scan)| {
                let (rows, found) = (counted(scan.header.announced, "row"), scan.num_lines);
                format!("announces {rows} in scan {}, of which {found} are there", number + 1)
            })
            .collect();
        let num_more = losses.len().saturating_sub(MOST_TOLD);
        if num_more > 0 {
            losses.truncate(MOST_TOLD);
            losses.push(format!("has {} with fewer rows than announced", counted(num_more, "more scan")));
        }
        if let Some(first) = read.first_bad {
            let (rows, were) = (counted(read.num_bad, "row"), agreeing(read.num_bad, "was", "were"));
            losses.push(format!(
                "has {rows} that could not be read and {were} left out, first at byte {first}"
            ));
        }
        losses
    }

    fn warnings(&self, _: &RowsSeen) -> Vec<String> {
        let more = |scan: &&PtxScan| scan.num_lines > scan.header.announced;
        let num_rows: u64 =
            self.file.scans.iter().filter(more).map(|scan| scan.num_lines - scan.header.announced).sum();
        let rows = counted(num_rows, "more row");
        let sentence =
            format!("has {rows} than announced; {} read", agreeing(num_rows, "it was", "they were"));
        (num_rows > 0).then_some(sentence).into_iter().collect()
    }

    fn no_points(&self, read: &RowsSeen) -> ScanError {
        let reason = match (read.num_read, read.num_bad) {
            (0, 0) => "its scans have no rows; get the file again",
            (0, _) => "none of its rows could be read; get the file again",
            _ => "all its rows are without a return (0 0 0); choose another file",
        };
        ScanError::NoPoints { path: self.path().to_owned(), reason: reason.into() }
    }
}

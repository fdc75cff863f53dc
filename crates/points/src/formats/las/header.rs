//! Reads the public header block of LAS 1.0–1.4.
//!
//! Only the fields that decide where the bytes of the points lie are believed, and only as far as the file's size bears
//! them out. Boxes and return counts are not even parsed.

use super::record;
use crate::source::Source;
use crate::{Grid, ScanError};
use glam::DVec3;

/// Bytes of the shortest header (LAS 1.0–1.2).
const SHORTEST: u64 = 227;
/// Bytes of the longest header (LAS 1.4).
const LONGEST: u64 = 375;

/// Extended variable length records: where they start, how many are announced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Evlrs {
    pub offset: u64,
    pub announced: u32,
}

/// What a LAS header says.
#[derive(Clone, Debug)]
pub(super) struct LasHeader {
    /// Minor version: 0–4, or more in files of the future.
    pub minor: u8,
    /// Bytes of the header itself; the variable length records follow.
    pub header_bytes: u64,
    /// First byte of the points.
    pub points_offset: u64,
    /// Variable length records announced.
    pub announced_vlrs: u32,
    /// Point format, 0–10.
    pub point_format: u8,
    /// Bytes of a record when not compressed.
    pub record_bytes: u16,
    /// True if the points are LAZ.
    pub compressed: bool,
    /// Points announced.
    pub announced_points: u64,
    /// Grid of the coordinates.
    pub grid: Grid,
    /// Where the points end at the latest, if something else is announced to follow them.
    pub points_end: Option<u64>,
    /// Extended variable length records, which only LAS 1.4 has.
    pub evlrs: Option<Evlrs>,
    /// True if the coordinate system is given as WKT.
    pub wkt: bool,
    /// Program that wrote the file.
    pub software: String,
    /// Day of creation: year, day of the year.
    pub created: Option<(u16, u16)>,
    /// What was odd, as ends of sentences.
    pub oddities: Vec<String>,
}

impl LasHeader {
    /// Reads and checks the header.
    ///
    /// # Errors
    /// The file is too short, has an unknown version or point format, a grid that is none, or points before the
    /// header's end.
    pub fn read(source: &Source) -> Result<Self, ScanError> {
        let bytes = source.bytes(0, LONGEST)?;
        if (bytes.len() as u64) < SHORTEST {
            let what = "header";
            let (path, len) = (source.path().to_owned(), source.len());
            return Err(ScanError::Truncated { path, len, what, needed: SHORTEST });
        }
        let fields = Fields { source, bytes: &bytes };
        let header = fields.header()?;
        header.check(&fields)?;
        Ok(header)
    }

    /// The error of records that are too short for their point format.
    pub fn short_records(&self, source: &Source) -> ScanError {
        ScanError::Field {
            path: source.path().to_owned(),
            offset: 105,
            field: "Point Data Record Length",
            problem: format!(
                "is {}, too short for point format {}, which needs {}: the header is damaged",
                self.record_bytes,
                self.point_format,
                record::standard_bytes(self.point_format).unwrap_or(0)
            ),
        }
    }

    /// Day of creation as a date, "2024-05-09".
    pub fn created_date(&self) -> Option<String> {
        let (year, mut day) = self.created?;
        let leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
        let months = [31, if leap { 29 } else { 28 }, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
        for (month, &days) in months.iter().enumerate() {
            if day <= days {
                return Some(format!("{year}-{:02}-{day:02}", month + 1));
            }
            day -= days;
        }
        None
    }

    fn check(&self, fields: &Fields) -> Result<(), ScanError> {
        let Self { point_format, points_offset, grid, .. } = self;
        if record::standard_bytes(*point_format).is_none() {
            let problem =
                format!("is {point_format}: only 0 to 10 are known; convert the file to one of them");
            return Err(fields.bad(104, "Point Data Record Format", problem));
        }
        if *points_offset < SHORTEST {
            let problem = format!("is {points_offset}, inside the header: the header is damaged");
            return Err(fields.bad(96, "Offset to Point Data", problem));
        }
        let scale_names = ["X Scale Factor", "Y Scale Factor", "Z Scale Factor"];
        let offset_names = ["X Offset", "Y Offset", "Z Offset"];
        for axis in 0..3 {
            let (scale, offset) = (grid.scale[axis], grid.offset[axis]);
            let fix = "no point has a place: repair the header or export the scan again";
            if !scale.is_finite() || scale == 0.0 {
                return Err(fields.bad(
                    131 + 8 * axis as u64,
                    scale_names[axis],
                    format!("is {scale}: {fix}"),
                ));
            }
            if !offset.is_finite() || !(offset.abs() + scale.abs() * 2f64.powi(31)).is_finite() {
                let problem = format!("is {offset} (scale {scale}): {fix}");
                return Err(fields.bad(155 + 8 * axis as u64, offset_names[axis], problem));
            }
        }
        Ok(())
    }
}

/// Little-endian fields of the header by their first byte. The first [`SHORTEST`] bytes exist; later bytes that are
/// missing read as 0.
struct Fields<'a> {
    source: &'a Source,
    bytes: &'a [u8],
}

impl Fields<'_> {
    fn header(&self) -> Result<LasHeader, ScanError> {
        let (major, minor) = (self.bytes[24], self.bytes[25]);
        if major != 1 {
            let problem = format!(
                "is {major}.{minor}, and only 1.0 to 1.4 are known: the header is damaged, or convert the file to LAS 1.4"
            );
            return Err(self.bad(24, "Version", problem));
        }
        let header_bytes = u64::from(self.u16(94)).max(SHORTEST);
        let mut oddities = Vec::new();
        if minor > 4 {
            oddities.push(format!("is LAS 1.{minor}, newer than this program; it is read as LAS 1.4"));
        }
        let points_offset = u64::from(self.u32(96));
        let format_byte = self.bytes[104];
        let evlrs = (minor >= 4 && header_bytes >= 255)
            .then(|| Evlrs { offset: self.u64(235), announced: self.u32(243) })
            .filter(|evlrs| evlrs.announced > 0 && evlrs.offset > points_offset);
        let waveform = if minor >= 3 && header_bytes >= 235 { self.u64(227) } else { 0 };
        let points_end = [evlrs.map(|e| e.offset), Some(waveform)].into_iter().flatten();
        let points_end = points_end.filter(|&end| end > points_offset).min();
        let announced_points = match u64::from(self.u32(107)) {
            legacy if minor < 4 || header_bytes < 255 => legacy,
            legacy => Some(self.u64(247)).filter(|&count| count > 0).unwrap_or(legacy),
        };
        let created = (self.u16(92), self.u16(90));
        Ok(LasHeader {
            minor,
            header_bytes,
            points_offset,
            announced_vlrs: self.u32(100),
            point_format: format_byte & 0x3f,
            record_bytes: self.u16(105),
            compressed: format_byte & 0x80 != 0,
            announced_points,
            grid: Grid { scale: self.vector(131), offset: self.vector(155) },
            points_end,
            evlrs,
            wkt: minor >= 4 && self.u16(6) & 0x10 != 0,
            software: text(&self.bytes[58..90]),
            // Some writers fill in a date from before there was any LAS.
            created: (created.0 >= 2000 && created.1 > 0).then_some(created),
            oddities,
        })
    }

    fn array<const N: usize>(&self, at: usize) -> [u8; N] {
        self.bytes.get(at..).and_then(|bytes| bytes.first_chunk()).copied().unwrap_or([0; N])
    }

    fn u16(&self, at: usize) -> u16 {
        u16::from_le_bytes(self.array(at))
    }

    fn u32(&self, at: usize) -> u32 {
        u32::from_le_bytes(self.array(at))
    }

    fn u64(&self, at: usize) -> u64 {
        u64::from_le_bytes(self.array(at))
    }

    fn vector(&self, at: usize) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|axis| f64::from_le_bytes(self.array(at + 8 * axis))))
    }

    fn bad(&self, offset: u64, field: &'static str, problem: String) -> ScanError {
        ScanError::Field { path: self.source.path().to_owned(), offset, field, problem }
    }
}

/// Text up to the first zero, for people: no control characters.
pub(super) fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
    let text = String::from_utf8_lossy(&bytes[..end]);
    text.chars().filter(|c| !c.is_control()).collect::<String>().trim().to_owned()
}

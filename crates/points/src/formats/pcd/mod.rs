//! PCD: points as the Point Cloud Library and robots write them, as text, as bytes, or compressed.
//!
//! A file whose data are text is read as rows of text, and any other as rows of bytes; compressed data are decompressed
//! first, all at once, because they are one stream.

mod binary;
mod header;
mod lzf;

use super::measured::{self, Measured};
use super::plan::{RowPlan, SKIPPED, StoredColumn};
use super::rows::{Dialect, RowsAt, Separator, TextRowsFile};
use super::{Candidate, Dataset, Format, OpenHints, Take};
use crate::block::Trailer;
use crate::column::Type;
use crate::source::Source;
use crate::{Header, Projection, ScanError, Station, StationKind};
use base::task::Progress;
use base::words::counted;
use binary::{BinaryRows, PcdBody};
use header::{FieldValue, PcdEncoding, PcdHeader};
use std::path::Path;

/// Bytes behind the header that tell what separates the values of text.
const SAMPLE_BYTES: u64 = 1 << 14;
/// Bytes before the compressed data: their size and that of the decompressed.
const SIZES_BYTES: u64 = 8;

/// The format PCD.
pub(super) struct Pcd;

impl Format for Pcd {
    fn names(&self) -> &'static [&'static str] {
        &["PCD"]
    }

    fn probe(&self, candidate: &Candidate) -> bool {
        let head = candidate.head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(candidate.head);
        let line = head.split(|&byte| byte == b'\n').find(|line| !line.trim_ascii().is_empty());
        let is_pcd = |line: &[u8]| header::is_first_line(&String::from_utf8_lossy(line));
        let ends_so = candidate.path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("pcd"));
        // A comment of another program may come first.
        let has_fields = || {
            let mut lines = head.split(|&byte| byte == b'\n');
            lines.any(|line| line.starts_with(b"FIELDS ") || line.starts_with(b"COLUMNS "))
        };
        line.is_some_and(is_pcd) || ends_so && has_fields()
    }

    fn open(&self, path: &Path, _: &OpenHints) -> Result<Box<dyn Dataset>, ScanError> {
        let source = Source::open(path)?;
        let pcd = PcdHeader::read(&source)?;
        let (values, unread) = pcd.values();
        let stored = |(at, name): &(FieldValue, String)| {
            // Values without a type get no column.
            let kind = pcd.fields[at.field].kind.unwrap_or(Type::F64);
            StoredColumn { name: name.clone(), kind, is_whole: !matches!(kind, Type::F32 | Type::F64) }
        };
        let columns: Vec<StoredColumn> = values.iter().map(stored).collect();
        let plan = RowPlan::of(columns).ok_or_else(|| {
            let names: Vec<&str> = pcd.fields.iter().map(|field| field.name.as_str()).collect();
            ScanError::NoPoints {
                path: path.to_owned(),
                reason: format!("its fields are {}; export it with x, y and z", names.join(", ")),
            }
        })?;
        let values: Vec<FieldValue> = values.into_iter().map(|(at, _)| at).collect();
        let num_bytes = source.len().saturating_sub(pcd.body_offset);
        let rows = match pcd.encoding {
            PcdEncoding::Ascii => Some(text_rows(Source::open(path)?, &pcd, &plan, &values)?),
            _ => None,
        };
        let num_points = match (&rows, pcd.encoding) {
            (Some(rows), _) => rows.num_points(),
            (None, PcdEncoding::Compressed) => {
                let most = num_bytes.saturating_mul(lzf::MOST_TIMES) / pcd.row_bytes;
                pcd.num_points.min(most)
            }
            (None, _) => pcd.num_points.min(num_bytes / pcd.row_bytes),
        };
        let header = describe(path, &pcd, &plan, unread, num_points);
        Ok(Box::new(PcdFile { source, pcd, plan, values, rows, header }))
    }
}

/// What a file says of itself.
fn describe(path: &Path, pcd: &PcdHeader, plan: &RowPlan, unread: Vec<String>, num_points: u64) -> Header {
    let encoding = match pcd.encoding {
        PcdEncoding::Ascii => "ascii",
        PcdEncoding::Binary => "binary",
        PcdEncoding::Compressed => "binary compressed",
    };
    let parts = match (pcd.width, pcd.height) {
        (Some(width), Some(height)) if height > 1 => {
            vec![format!("rows: {height} of {}", counted(width, "point"))]
        }
        _ => Vec::new(),
    };
    let station = |pose| Station {
        name: "1".into(),
        kind: StationKind::Scanner,
        file_from_station: Some(pose),
        source_id: None,
    };
    Header {
        path: path.to_owned(),
        format: format!("PCD {}, {encoding}", pcd.version),
        num_points,
        schema: plan.schema(unread),
        parts,
        stations: pcd.pose().map(station).into_iter().collect(),
        warnings: pcd.oddities.clone(),
        ..Header::default()
    }
}

/// The rows of a file whose data are text.
fn text_rows(
    source: Source,
    pcd: &PcdHeader,
    plan: &RowPlan,
    values: &[FieldValue],
) -> Result<TextRowsFile, ScanError> {
    let sample = source.bytes(pcd.body_offset, SAMPLE_BYTES)?;
    let dialect = match sample.split(|&byte| byte == b'\n').next() {
        Some(line) if line.contains(&b',') => Dialect { separator: Separator::Comma, point: b'.' },
        Some(line) if line.contains(&b';') => Dialect { separator: Separator::Semicolon, point: b'.' },
        _ => Dialect::BLANKS,
    };
    let num_bytes = source.len().saturating_sub(pcd.body_offset);
    // A digit and a blank per value.
    let num_words: u64 = pcd.fields.iter().map(|field| field.count).sum();
    let at = RowsAt {
        start: pcd.body_offset,
        line_end: b'\n',
        dialect,
        num_points: pcd.num_points.min(num_bytes.div_ceil(2 * num_words.max(1))),
        has_counts: false,
        in_header: (pcd.num_points < u64::MAX).then_some(pcd.num_points),
    };
    Ok(TextRowsFile::new(source, at, in_words(pcd, plan, values)))
}

/// The plan for the words of a line, which has all values of all fields, and not only those that get columns.
fn in_words(pcd: &PcdHeader, plan: &RowPlan, values: &[FieldValue]) -> RowPlan {
    let mut words = Vec::new();
    let mut word_of_column = vec![0; values.len()];
    for (number, field) in pcd.fields.iter().enumerate() {
        for value in 0..field.count {
            let column = values.iter().position(|at| *at == FieldValue { field: number, value });
            words.push(match column {
                Some(at) => {
                    word_of_column[at] = words.len();
                    plan.columns[at].clone()
                }
                None => StoredColumn { name: SKIPPED.into(), kind: Type::F64, is_whole: false },
            });
        }
    }
    plan.moved(words, |at| word_of_column[at])
}

/// An opened file.
#[derive(Debug)]
struct PcdFile {
    source: Source,
    pcd: PcdHeader,
    plan: RowPlan,
    values: Vec<FieldValue>,
    /// Its rows, if they are text.
    rows: Option<TextRowsFile>,
    header: Header,
}

impl Dataset for PcdFile {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&self, want: &Projection, take: &mut Take, progress: &Progress) -> Result<Trailer, ScanError> {
        if let Some(rows) = &self.rows {
            return measured::read(rows, want, take, progress);
        }
        let (body, loss) = match self.pcd.encoding {
            PcdEncoding::Compressed => self.decompressed()?,
            _ => (PcdBody::InFile, None),
        };
        let Self { source, pcd, plan, values, .. } = self;
        let rows = BinaryRows { source, header: pcd, plan, values, body, loss };
        measured::read(&rows, want, take, progress)
    }
}

impl PcdFile {
    /// The decompressed points, and a sentence if they are not whole.
    fn decompressed(&self) -> Result<(PcdBody, Option<String>), ScanError> {
        let PcdHeader { row_bytes, num_points, body_offset, .. } = self.pcd;
        let sizes = self.source.bytes(body_offset, SIZES_BYTES)?;
        let size = |from: usize| {
            let bytes = sizes.get(from..).and_then(<[u8]>::first_chunk);
            u64::from(bytes.map_or(0, |bytes| u32::from_le_bytes(*bytes)))
        };
        let (num_compressed, num_bytes) = (size(0), size(4));
        let input = self.source.bytes(body_offset + SIZES_BYTES, num_compressed)?;
        // The fields are as long as what was compressed says; a header may lie.
        let num_stored = if num_bytes.is_multiple_of(row_bytes) { num_bytes / row_bytes } else { num_points };
        let most = usize::try_from(num_bytes).unwrap_or(usize::MAX);
        let memory = |_| ScanError::Memory { path: self.source.path().to_owned(), num_points: num_stored };
        let lzf::Decompressed { bytes, is_whole } = lzf::decompress(&input, most).map_err(memory)?;
        let got = bytes.len() as u64;
        let loss = (!is_whole || got < num_bytes).then(|| {
            format!(
                "has {} of compressed points, of which {got} can be decompressed: fields that come later are not whole",
                counted(num_bytes, "byte")
            )
        });
        Ok((PcdBody::InMemory(bytes, num_stored), loss))
    }
}

#[cfg(test)]
mod tests;

//! Finds the scans of a PTX file: wherever a line of one whole number begins a header, whatever counts say before.

use super::header::PtxHeader;
use crate::ScanError;
use crate::source::Source;
use rayon::prelude::*;

/// Bytes that are looked through at once.
const SPAN_BYTES: u64 = 4 << 20;
/// Most bytes of a header.
const HEADER_BYTES: u64 = 1 << 13;
/// Most digits of a count.
const MOST_DIGITS: usize = 15;

/// A scan of a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PtxScan {
    pub header: PtxHeader,
    /// First byte of its rows.
    pub start: u64,
    /// The byte behind its rows.
    pub end: u64,
    /// Lines of its rows.
    pub num_lines: u64,
}

/// What is in a span of the file.
#[derive(Debug, Default)]
struct LineSpan {
    /// Lines that start in it.
    num_lines: u64,
    /// Lines of one number that start in it: their places, and the number of lines before them in the span.
    counts: Vec<(u64, u64)>,
}

/// Finds all scans.
///
/// # Errors
/// The system cannot read the file.
pub(super) fn find(source: &Source, line_end: u8) -> Result<Vec<PtxScan>, ScanError> {
    let starts: Vec<u64> = (0..source.len()).step_by(SPAN_BYTES as usize).collect();
    let spans: Vec<LineSpan> =
        starts.into_par_iter().map(|start| span(source, start, line_end)).collect::<Result<_, _>>()?;
    let mut scans: Vec<PtxScan> = Vec::new();
    // Lines before a place, and the place behind the last header.
    let (mut before, mut behind) = (0, 0);
    for LineSpan { num_lines, counts } in spans {
        for (at, lines) in counts {
            if at < behind {
                continue;
            }
            let text = source.bytes(at, HEADER_BYTES)?;
            let is_all = at + text.len() as u64 == source.len();
            if let Some((header, num_bytes)) = PtxHeader::read(&text, line_end, is_all) {
                let num_header_lines =
                    text[..num_bytes].iter().filter(|&&byte| byte == line_end).count() as u64;
                if let Some(last) = scans.last_mut() {
                    last.end = at;
                    last.num_lines = (before + lines).saturating_sub(last.num_lines);
                }
                behind = at + num_bytes as u64;
                // Until the scan's end is known, this is the number of lines before it.
                let num_lines = before + lines + num_header_lines;
                scans.push(PtxScan { header, start: behind, end: source.len(), num_lines });
            }
        }
        before += num_lines;
    }
    if let Some(last) = scans.last_mut() {
        last.num_lines = before.saturating_sub(last.num_lines);
    }
    Ok(scans)
}

/// Looks through the lines that start in a span.
fn span(source: &Source, start: u64, line_end: u8) -> Result<LineSpan, ScanError> {
    // A line starts behind the end of another; the first one of the file is the first of the first span.
    let from = start.saturating_sub(1);
    let text = source.bytes(from, SPAN_BYTES + start - from + MOST_DIGITS as u64 + 2)?;
    let mut found = LineSpan::default();
    let mut look = |at: u64, line: &[u8]| {
        if at < source.len() {
            if is_count(line, line_end) {
                found.counts.push((at, found.num_lines));
            }
            found.num_lines += 1;
        }
    };
    if start == 0 {
        look(0, &text);
    }
    for end in memchr::memchr_iter(line_end, &text) {
        let at = from + end as u64 + 1;
        if at >= start + SPAN_BYTES {
            break;
        }
        look(at, &text[end + 1..]);
    }
    Ok(found)
}

/// True if a line, of which only the first bytes may be there, has one whole number.
#[inline]
fn is_count(line: &[u8], line_end: u8) -> bool {
    let is_blank = |byte: &u8| *byte != line_end && matches!(byte, b' ' | b'\t' | b'\r');
    let line = line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line);
    let blanks = line.iter().take(MOST_DIGITS).take_while(|byte| is_blank(byte)).count();
    let digits = line[blanks..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    // A line that goes on beyond what is there may be a count too.
    let behind = line[blanks + digits..].iter().find(|byte| !is_blank(byte));
    digits > 0 && digits <= MOST_DIGITS && behind.is_none_or(|&byte| byte == line_end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_stand_alone() {
        for yes in ["12\n", " 7 \r\n", "5", "\u{feff}3\n"] {
            assert!(is_count(yes.as_bytes(), b'\n'), "{yes}");
        }
        for no in ["", "\n", "1 2\n", "-1\n", "1.5\n", "x\n", "1234567890123456\n"] {
            assert!(!is_count(no.as_bytes(), b'\n'), "{no}");
        }
    }
}

//! The directory of a ZIP archive, also of more than 4 GiB. Nothing else of such an archive is needed: its members are
//! packed as gzip packs a file.

use crate::ScanError;
use crate::source::Source;
use base::words::counted;
use std::path::{Component, Path};

/// Most bytes of the directory: of some million members.
const MOST_DIRECTORY: u64 = 1 << 28;
/// Bytes of the directory's end, of an entry, and of the head of a member, without names and remarks.
const END_BYTES: usize = 22;
const ENTRY_BYTES: usize = 46;
const HEAD_BYTES: usize = 30;
/// Bytes of what leads to a large archive's end of directory, and of that.
const LOCATOR_BYTES: usize = 20;
const LARGE_END_BYTES: u64 = 56;
/// Stand for numbers that are elsewhere, because they are too large.
const ELSEWHERE: u64 = 0xffff_ffff;
const ELSEWHERE_16: u64 = 0xffff;
/// The extra field of numbers that are too large.
const LARGE_NUMBERS: u64 = 1;

/// A file in the archive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ZipMember {
    /// Its name, which leads nowhere out of the archive.
    pub name: String,
    /// How it is packed.
    pub method: u64,
    pub is_encrypted: bool,
    /// Bytes when packed.
    pub packed_bytes: u64,
    /// Checksum of the unpacked bytes.
    pub crc: u32,
    head_offset: u64,
}

impl ZipMember {
    /// First byte of the packed bytes, or why there are none, as the end of a sentence.
    pub fn data_offset(&self, source: &Source) -> Result<Result<u64, String>, ScanError> {
        let head = source.bytes(self.head_offset, HEAD_BYTES as u64)?;
        if head.len() < HEAD_BYTES || !head.starts_with(b"PK\x03\x04") {
            return Ok(Err(format!("is not at byte {} of its archive", self.head_offset)));
        }
        let after_head = HEAD_BYTES as u64 + number(&head, 26, 2) + number(&head, 28, 2);
        let offset = self.head_offset.saturating_add(after_head);
        let is_whole = offset.checked_add(self.packed_bytes).is_some_and(|end| end <= source.len());
        Ok(if is_whole { Ok(offset) } else { Err("reaches beyond the archive's end".into()) })
    }
}

/// The files in an archive, by name, or why they cannot be found, as the end of a sentence.
///
/// # Errors
/// The system cannot read the archive.
pub(super) fn members(source: &Source) -> Result<Result<Vec<ZipMember>, String>, ScanError> {
    let tail_bytes = source.len().min((END_BYTES + LOCATOR_BYTES) as u64 + ELSEWHERE_16);
    let tail_offset = source.len() - tail_bytes;
    let tail = source.bytes(tail_offset, tail_bytes)?;
    // The last that could be the end is taken: a remark may follow.
    let is_end = |at: &usize| {
        tail[*at..].starts_with(b"PK\x05\x06")
            && *at + END_BYTES + number(&tail, at + 20, 2) as usize <= tail.len()
    };
    let Some(end) = (0..=tail.len().saturating_sub(END_BYTES)).rev().find(is_end) else {
        let problem =
            "its directory is missing, which is at its end: it was cut off; copy or download it again";
        return Ok(Err(problem.into()));
    };
    let end_offset = tail_offset + end as u64;
    let [mut size, mut offset] = [12, 16].map(|at| number(&tail, end + at, 4));
    let mut after = end_offset;
    if size == ELSEWHERE || offset == ELSEWHERE || number(&tail, end + 10, 2) == ELSEWHERE_16 {
        let locator = end.checked_sub(LOCATOR_BYTES).map(|at| &tail[at..end]);
        if let Some(locator) = locator.filter(|bytes| bytes.starts_with(b"PK\x06\x07")) {
            let at = number(locator, 8, 8);
            let large = source.bytes(at, LARGE_END_BYTES)?;
            if large.len() as u64 == LARGE_END_BYTES && large.starts_with(b"PK\x06\x06") {
                (size, offset, after) = (number(&large, 40, 8), number(&large, 48, 8), at);
            }
        }
    }
    if size > MOST_DIRECTORY || size > after {
        return Ok(Err(format!("its directory claims {}; get it again", counted(size, "byte"))));
    }
    // The directory ends where its end begins. Something may lie before the archive, which moves all places.
    let start = after - size;
    let moved = start.saturating_sub(offset);
    let directory = source.bytes(start, size)?;
    Ok(Ok(entries(&directory, moved)))
}

/// The entries up to the first that is not whole.
fn entries(directory: &[u8], moved: u64) -> Vec<ZipMember> {
    let mut found = Vec::new();
    let mut rest = directory;
    while rest.len() >= ENTRY_BYTES && rest.starts_with(b"PK\x01\x02") {
        let [name_bytes, extra_bytes, remark_bytes] = [28, 30, 32].map(|at| number(rest, at, 2) as usize);
        let Some(texts) = rest.get(ENTRY_BYTES..ENTRY_BYTES + name_bytes + extra_bytes + remark_bytes) else {
            break;
        };
        let (name, others) = texts.split_at(name_bytes);
        let large = large_numbers(rest, &others[..extra_bytes]);
        let name = String::from_utf8_lossy(name).replace('\\', "/");
        let is_folder = name.ends_with('/');
        let name = plain(&name);
        if !is_folder && !name.is_empty() {
            found.push(ZipMember {
                name,
                method: number(rest, 10, 2),
                is_encrypted: number(rest, 8, 2) & 1 == 1,
                packed_bytes: large[1],
                crc: number(rest, 16, 4) as u32,
                head_offset: large[2].saturating_add(moved),
            });
        }
        rest = &rest[ENTRY_BYTES + texts.len()..];
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    found
}

/// Unpacked bytes, packed bytes and the place of an entry: numbers that are too large are in its extra fields, in this
/// order.
fn large_numbers(entry: &[u8], mut extra: &[u8]) -> [u64; 3] {
    let mut numbers = [24, 20, 42].map(|at| number(entry, at, 4));
    while extra.len() >= 4 {
        let (kind, len) = (number(extra, 0, 2), number(extra, 2, 2) as usize);
        let Some(field) = extra.get(4..4 + len) else { break };
        if kind == LARGE_NUMBERS {
            let mut large = field.chunks_exact(8);
            for value in numbers.iter_mut().filter(|value| **value == ELSEWHERE) {
                *value = large.next().map_or(*value, |bytes| number(bytes, 0, 8));
            }
        }
        extra = &extra[4 + len..];
    }
    numbers
}

/// A name without what would lead out of the archive, and without control characters.
fn plain(name: &str) -> String {
    let parts = Path::new(name).components().filter_map(|part| match part {
        Component::Normal(part) => part.to_str(),
        _ => None,
    });
    let name = parts.collect::<Vec<_>>().join("/");
    name.chars().filter(|c| !c.is_control()).collect()
}

/// A little-endian number of up to 8 bytes; bytes that are missing are 0.
fn number(bytes: &[u8], at: usize, num_bytes: usize) -> u64 {
    let bytes = bytes.get(at..).unwrap_or_default().iter().take(num_bytes);
    bytes.rev().fold(0, |number, byte| number << 8 | u64::from(*byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_nowhere_out_of_the_archive() {
        for (name, expected) in [
            ("a/b.laz", "a/b.laz"),
            ("/etc/passwd", "etc/passwd"),
            ("../../a.las", "a.las"),
            ("a/./../b.las", "a/b.las"),
            ("..", ""),
            ("a\nb.las", "ab.las"),
        ] {
            assert_eq!(plain(name), expected);
        }
    }
}

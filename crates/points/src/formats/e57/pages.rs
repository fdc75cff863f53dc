//! The pages of an E57 file: each ends with a checksum, which is no part of what the file holds.
//!
//! Places in the file are *physical*, with the checksums counted, or *logical*, without them.

use super::crc::crc32c;
use crate::ScanError;
use crate::source::Source;
use std::ops::Range;

/// Bytes of a page's checksum.
const SUM_BYTES: u64 = 4;
/// Bytes of a page by the standard.
pub(super) const PAGE_BYTES: u64 = 1024;

/// A file as pages.
#[derive(Debug)]
pub(super) struct Pages {
    pub source: Source,
    page_bytes: u64,
    /// False if nobody looks at checksums.
    pub has_sums: bool,
}

/// Bytes of a file without checksums.
#[derive(Debug)]
pub(super) struct Content {
    pub bytes: Vec<u8>,
    /// Those of the bytes that are in pages with a wrong checksum.
    pub damaged: Vec<Range<usize>>,
}

impl Pages {
    /// A file with pages of `page_bytes`, which are more than their checksum has.
    pub fn new(source: Source, page_bytes: u64) -> Self {
        Self { source, page_bytes: page_bytes.max(SUM_BYTES + 1), has_sums: true }
    }

    fn content_bytes(&self) -> u64 {
        self.page_bytes - SUM_BYTES
    }

    /// Logical size of the file.
    pub fn len(&self) -> u64 {
        let (whole, rest) = (self.source.len() / self.page_bytes, self.source.len() % self.page_bytes);
        whole * self.content_bytes() + rest.min(self.content_bytes())
    }

    /// The logical place of a physical one; `None` for a place in a checksum or behind the file's end.
    pub fn logical(&self, physical: u64) -> Option<u64> {
        let (page, within) = (physical / self.page_bytes, physical % self.page_bytes);
        let is_there = physical < self.source.len() && within < self.content_bytes();
        is_there.then(|| page * self.content_bytes() + within)
    }

    /// The physical place of a logical one.
    pub fn physical(&self, logical: u64) -> u64 {
        let pages_before = logical / self.content_bytes();
        logical.saturating_add(pages_before * SUM_BYTES)
    }

    /// Reads `len` bytes from a logical place, fewer where the file ends before.
    ///
    /// # Errors
    /// The system cannot read the file.
    pub fn read(&self, logical: u64, len: u64) -> Result<Content, ScanError> {
        let end = logical.saturating_add(len).min(self.len());
        let mut content = Content { bytes: Vec::new(), damaged: Vec::new() };
        if logical >= end {
            return Ok(content);
        }
        let (first, last) = (logical / self.content_bytes(), (end - 1) / self.content_bytes());
        let pages = self.source.bytes(first * self.page_bytes, (last - first + 1) * self.page_bytes)?;
        // The file is as long as these bytes, so that they can be in memory.
        content.bytes.reserve((end - logical) as usize);
        for (number, page) in (first..).zip(pages.chunks(self.page_bytes as usize)) {
            let (bytes, sum) = page.split_at(page.len().min(self.content_bytes() as usize));
            let start = number * self.content_bytes();
            let from = logical.saturating_sub(start).min(bytes.len() as u64) as usize;
            let to = end.saturating_sub(start).min(bytes.len() as u64) as usize;
            let before = content.bytes.len();
            content.bytes.extend_from_slice(&bytes[from..to.max(from)]);
            // The last page of a file that was cut off has no checksum.
            let is_damaged =
                self.has_sums && sum.len() == SUM_BYTES as usize && crc32c(bytes).to_be_bytes() != sum;
            match content.damaged.last_mut() {
                Some(range) if is_damaged && range.end == before => range.end = content.bytes.len(),
                _ if is_damaged => content.damaged.push(before..content.bytes.len()),
                _ => {}
            }
        }
        Ok(content)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn pages(bytes: &[u8]) -> Pages {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(bytes).unwrap();
        Pages::new(Source::open(file.path()).unwrap(), 20)
    }

    #[test]
    fn sums_are_left_out_and_checked() {
        let content: Vec<u8> = (0..40).collect();
        let mut file: Vec<u8> = Vec::new();
        for page in content.chunks(16) {
            file.extend(page);
            file.extend(crc32c(page).to_be_bytes());
        }
        // The last page is cut off within its content.
        file.truncate(48);
        let read = |file: &[u8], at, len| {
            let Content { bytes, damaged } = pages(file).read(at, len).unwrap();
            (bytes, damaged)
        };
        assert_eq!(read(&file, 0, 99), (content.clone(), vec![]));
        assert_eq!(read(&file, 14, 4), (content[14..18].to_vec(), vec![]));
        assert_eq!(read(&file, 40, 4), (vec![], vec![]));
        assert_eq!(read(&file, u64::MAX, u64::MAX), (vec![], vec![]));
        file[21] ^= 1;
        let damaged = read(&file, 14, 20);
        assert_eq!(damaged.1, std::slice::from_ref(&(2..18)));
        assert_eq!(damaged.0.len(), 20);
    }

    #[test]
    fn places_with_and_without_sums() {
        let pages = pages(&[0; 48]);
        assert_eq!(pages.len(), 40);
        for (physical, logical) in
            [(0, Some(0)), (15, Some(15)), (16, None), (20, Some(16)), (47, Some(39)), (48, None)]
        {
            assert_eq!(pages.logical(physical), logical);
            assert!(logical.is_none_or(|logical| pages.physical(logical) == physical));
        }
    }
}

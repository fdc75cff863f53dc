//! The first bytes of an E57 file: where its description is.

use super::pages::{PAGE_BYTES, Pages};
use crate::ScanError;
use crate::source::Source;
use base::words::counted;

/// What all E57 files begin with.
pub(super) const SIGNATURE: &[u8] = b"ASTM-E57";
/// Bytes of the header.
const HEADER_BYTES: u64 = 48;
/// Most bytes of a description: that of a thousand scans has a few million.
const MOST_DESCRIPTION: u64 = 1 << 28;
/// Sizes of pages that are believed.
const PAGE_SIZES: std::ops::RangeInclusive<u64> = 64..=1 << 20;

/// The header, and the description that it leads to.
#[derive(Debug)]
pub(super) struct E57Header {
    pub pages: Pages,
    /// "1.0".
    pub version: String,
    /// The description, which is XML.
    pub text: String,
    /// Sentences about what was odd, whose subject is the file.
    pub oddities: Vec<String>,
}

impl E57Header {
    /// Reads the header and the description.
    ///
    /// # Errors
    /// The system cannot read the file, or it has no description.
    pub fn read(source: Source) -> Result<Self, ScanError> {
        let head = source.bytes(0, HEADER_BYTES)?;
        let path = source.path().to_owned();
        if (head.len() as u64) < HEADER_BYTES {
            let (len, needed) = (source.len(), HEADER_BYTES);
            return Err(ScanError::Truncated { path, len, what: "header", needed });
        }
        let word = |at: usize| head[at..].first_chunk().map_or(0, |bytes| u32::from_le_bytes(*bytes));
        let long = |at: usize| head[at..].first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
        let (version, announced, at, num_bytes) =
            (format!("{}.{}", word(8), word(12)), long(16), long(24), long(32));
        let mut oddities = Vec::new();
        let mut page_bytes = long(40);
        if !PAGE_SIZES.contains(&page_bytes) {
            oddities.push(format!("states a page size of {page_bytes}; {PAGE_BYTES} was taken"));
            page_bytes = PAGE_BYTES;
        }
        let mut pages = Pages::new(source, page_bytes);
        let len = pages.source.len();
        let Some(start) = pages.logical(at).filter(|_| at >= HEADER_BYTES) else {
            if at >= len.max(HEADER_BYTES) {
                let needed = at.saturating_add(num_bytes);
                return Err(ScanError::Truncated { path, len, what: "description (XML)", needed });
            }
            let problem = format!("is {at}, which is no place for a description; get the file again");
            return Err(ScanError::Field { path, offset: 24, field: "xmlPhysicalOffset", problem });
        };
        let content = pages.read(start, num_bytes.min(MOST_DESCRIPTION))?;
        let damaged: usize = content.damaged.iter().map(std::ops::Range::len).sum();
        let first_page = pages.read(0, 1)?;
        if damaged > 0 && damaged == content.bytes.len() && !first_page.damaged.is_empty() {
            // A writer that cannot make checksums is likelier than damage to every one of these pages.
            pages.has_sums = false;
            oddities.push("has wrong checksums throughout, which were not looked at".into());
        } else if damaged > 0 {
            oddities
                .push("has a damaged description (its checksum is wrong): what it says may be wrong".into());
        } else if !first_page.damaged.is_empty() {
            oddities.push("has a damaged header (its checksum is wrong): what it says may be wrong".into());
        }
        if announced > len {
            oddities.push(format!(
                "should have {} and has {len}: it was cut off; get it again",
                counted(announced, "byte")
            ));
        }
        let text = String::from_utf8_lossy(&content.bytes).into_owned();
        Ok(Self { pages, version, text, oddities })
    }
}

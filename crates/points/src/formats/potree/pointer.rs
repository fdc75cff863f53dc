//! Git LFS pointers, which lie in folders in place of files that were not fetched.

use crate::ScanError;
use crate::source::Source;

/// How a pointer begins.
const START: &[u8] = b"version https://git-lfs";
/// No pointer is longer.
const MOST_BYTES: u64 = 1024;

/// True if a file is a pointer.
///
/// # Errors
/// The system cannot read the file.
pub(super) fn is_one(source: &Source) -> Result<bool, ScanError> {
    Ok(source.len() <= MOST_BYTES && source.bytes(0, START.len() as u64)? == START)
}

//! Reads files as the program does unless it is told more.

use base::task::CancelToken;
use points::{ReadOptions, Scan, ScanError, read};
use std::path::{Path, PathBuf};

/// Reads one file.
///
/// # Errors
/// If the file is not there, or not to be read.
pub fn file(path: &Path) -> Result<Scan, ScanError> {
    files(&[path.to_owned()])
}

/// Reads files as one scan.
///
/// # Errors
/// If a file is not there, or not to be read.
pub fn files(paths: &[PathBuf]) -> Result<Scan, ScanError> {
    read(paths, &ReadOptions::AS_FILES_SAY, &CancelToken::default())
}

//! Real scans, in the folder that `SCANWALK_TEST_DATA` names.

use base::task::CancelToken;
use points::{ReadOptions, Scan, read};
use std::path::{Path, PathBuf};

/// The folder of real scans.
///
/// # Panics
/// If there is none: tests that need it are ignored unless the feature `with-scans` says that there is.
pub fn folder() -> PathBuf {
    std::env::var_os("SCANWALK_TEST_DATA")
        .map(PathBuf::from)
        .expect("SCANWALK_TEST_DATA names a folder of real scans")
}

/// Reads a file of the folder; the error is its message.
pub fn read_in(folder: &Path, name: &str) -> Result<Scan, String> {
    read(&[folder.join(name)], &ReadOptions::default(), &CancelToken::default())
        .map_err(|error| error.to_string())
}

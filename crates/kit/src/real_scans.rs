//! Real scans, where `SCANWALK_TEST_DATA` names a folder of them.

use base::task::CancelToken;
use points::{ReadOptions, Scan, read};
use std::path::{Path, PathBuf};

/// The folder, or a line that says why the test is skipped.
pub fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os("SCANWALK_TEST_DATA").map(PathBuf::from);
    if folder.is_none() {
        eprintln!("skipped: SCANWALK_TEST_DATA does not name a folder of real scans");
    }
    folder
}

/// A file of it, or the message.
pub fn read_in(folder: &Path, name: &str) -> Result<Scan, String> {
    read(&[folder.join(name)], &ReadOptions::default(), &CancelToken::default())
        .map_err(|error| error.to_string())
}

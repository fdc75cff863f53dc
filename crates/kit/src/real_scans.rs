//! Real scans, in the folder that `SCANWALK_TEST_DATA` names.

use crate::reading;
use points::Scan;
use std::path::{Path, PathBuf};

/// A real room, below the folder.
pub const ROOM: &str = "laz-indoor-rooms/indoor-rooms.laz";

/// The folder of real scans, if one is named.
pub fn named_folder() -> Option<PathBuf> {
    std::env::var_os("SCANWALK_TEST_DATA").map(PathBuf::from)
}

/// The folder of real scans.
///
/// # Panics
/// If there is none: tests that need it are ignored unless the feature `with-scans` says that there is.
pub fn folder() -> PathBuf {
    named_folder().expect("SCANWALK_TEST_DATA names a folder of real scans")
}

/// Reads a file of the folder; the error is its message.
pub fn read_in(folder: &Path, name: &str) -> Result<Scan, String> {
    reading::file(&folder.join(name)).map_err(|error| error.to_string())
}

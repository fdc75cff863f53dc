//! What can go wrong with a file; every message names the file, the place in it, and what to do.

use crate::{Attribute, Type, format_endings, format_names};
use base::task::Cancelled;
use base::words::advice;
use std::io;
use std::path::{Path, PathBuf};

/// Why a scan could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ScanError {
    /// No file was named.
    #[error("no scan was named: give one or more {}", format_names("or") + " files")]
    NoFiles,
    /// Only files that lie beside scans were named.
    #[error(
        "{path}: lies beside a scan and holds no points (an index, a coordinate system): \
         name the scan, a {formats} file",
        path = path.display(), formats = format_names("or")
    )]
    OnlySidecars {
        /// The first of these files.
        path: PathBuf,
    },
    /// The user asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The operating system refused to open or read the file.
    #[error("{path}: cannot be read{place}: {error}{advice}", path = path.display(), place = at(*offset), advice = advice(error))]
    Io {
        /// The file.
        path: PathBuf,
        /// Byte at which reading failed; `None` while opening.
        offset: Option<u64>,
        /// The system's error. It is not a `source`, because the message holds its words already.
        error: io::Error,
    },
    /// The path is that of a folder, a pipe, a device, or a link to nothing.
    #[error("{path}: is {kind}, not a file: {advice}", path = path.display())]
    NotAFile {
        /// What was named.
        path: PathBuf,
        /// "a folder".
        kind: &'static str,
        /// What to do.
        advice: String,
    },
    /// The file is of no format that can be read.
    #[error(
        "{path}: is not a {formats} file: {looks_like}; {advice}",
        path = path.display(), formats = format_names("or")
    )]
    NotAScan {
        /// The file.
        path: PathBuf,
        /// What its first bytes say.
        looks_like: String,
        /// What to do.
        advice: String,
    },
    /// A header field makes no sense.
    #[error("{path}: {field} (byte {offset}) {problem}", path = path.display())]
    Field {
        /// The file.
        path: PathBuf,
        /// Where the field starts.
        offset: u64,
        /// The field's name in the format's specification.
        field: &'static str,
        /// What is wrong and what to do, as the end of a sentence.
        problem: String,
    },
    /// A line of text makes no sense.
    #[error("{path}: line {line}: {problem}", path = path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// The line's number, from 1.
        line: u64,
        /// What is wrong and what to do.
        problem: String,
    },
    /// The file ends too early for anything to be read.
    #[error(
        "{path}: ends at byte {len}, within its {what}, which needs {needed} bytes: \
         the file was cut off; copy or download it again",
        path = path.display()
    )]
    Truncated {
        /// The file.
        path: PathBuf,
        /// Its size in bytes.
        len: u64,
        /// The part that is not whole.
        what: &'static str,
        /// Bytes that the part needs, counted from the file's start.
        needed: u64,
    },
    /// The file has no points to show.
    #[error("{path}: holds no points: {reason}", path = path.display())]
    NoPoints {
        /// The file.
        path: PathBuf,
        /// Why, and what to do.
        reason: String,
    },
    /// The file has coordinates that nothing on Earth has.
    #[error(
        "{path}: has points {farthest:.1e} units from zero, and {limit:e} is the most: \
         its scale or offset is broken; export it again",
        path = path.display(),
        limit = super::FARTHEST
    )]
    TooFar {
        /// The file.
        path: PathBuf,
        /// Its largest coordinate.
        farthest: f64,
    },
    /// The reader of the file's format hands over a column that its schema does not have, or that nobody takes.
    #[error(
        "{path}: its reader hands over {attribute:?} as {kind:?}, which is a fault of scanwalk: report it, or write the \
         file anew with another program",
        path = path.display()
    )]
    Column {
        /// The file.
        path: PathBuf,
        /// The column's attribute.
        attribute: Attribute,
        /// The column's type.
        kind: Type,
    },
    /// The points are compressed in a way that cannot be undone here.
    #[error("{path}: its compressed points cannot be read: {reason}", path = path.display())]
    Compression {
        /// The file.
        path: PathBuf,
        /// Why, and what to do.
        reason: String,
    },
    /// An archive cannot be unpacked.
    #[error("{path}: cannot be unpacked: {problem}", path = path.display())]
    Archive {
        /// The archive.
        path: PathBuf,
        /// Why, and what to do.
        problem: String,
    },
    /// A part of the file could not be read, and the user asks for all of it.
    #[error(
        "{path}: {loss}; --strict (cloud.strict) refuses files that cannot be read to their end: get it again, or show \
         what is left of it without",
        path = path.display()
    )]
    Incomplete {
        /// The file.
        path: PathBuf,
        /// What is missing, as a sentence whose subject is the file.
        loss: String,
    },
    /// The points do not fit into memory.
    #[error(
        "{path}: no memory for {num_points} points: \
         close other programs, or show fewer files at once",
        path = path.display()
    )]
    Memory {
        /// The file.
        path: PathBuf,
        /// Points that were to be held.
        num_points: u64,
    },
}

impl ScanError {
    /// True if the file is to blame, so that others can still be read. A missing file is not to blame: the name is a
    /// slip of whoever gave it.
    pub(crate) fn is_of_one_file(&self) -> bool {
        match self {
            Self::NoFiles | Self::OnlySidecars { .. } | Self::Cancelled(_) | Self::Memory { .. } => false,
            Self::Io { error, .. } => error.kind() != io::ErrorKind::NotFound,
            _ => true,
        }
    }

    /// A folder that is no scan.
    pub(crate) fn folder(path: &Path) -> Self {
        let example = format_endings().next().map(|ending| format!(" (for example FOLDER/*.{ending})"));
        let advice = format!("name the files in it{}", example.unwrap_or_default());
        Self::NotAFile { path: path.to_owned(), kind: "a folder", advice }
    }

    /// An I/O failure at a byte.
    pub(crate) fn io(path: &Path, offset: Option<u64>, error: io::Error) -> Self {
        Self::Io { path: path.to_owned(), offset, error }
    }
}

fn at(offset: Option<u64>) -> String {
    offset.map_or_else(String::new, |byte| format!(" at byte {byte}"))
}

//! What is written, how its name must end, and what it may take the place of.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Bytes at the start of a file that tell what it is.
const HEAD_BYTES: u64 = 1024;

/// What an output is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputKind {
    /// A PNG.
    Picture,
    /// Distances as a NumPy array.
    Depth,
    /// Counts and times as JSON.
    Metrics,
    /// A row a frame, as CSV.
    FrameLog,
    /// A page: HTML, or tables as Markdown.
    Page,
    /// A path of the head.
    Poses,
    /// The scans that were opened last, as JSON.
    RecentScans,
    /// A scan, in a format that one of these endings stands for; its header is written last.
    Scan(&'static [&'static str]),
}

impl OutputKind {
    /// Kinds whose endings are always the same.
    const FIXED: [Self; 7] = [
        Self::Picture,
        Self::Depth,
        Self::Metrics,
        Self::FrameLog,
        Self::Page,
        Self::Poses,
        Self::RecentScans,
    ];

    /// The kind in words.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Picture => "a picture",
            Self::Depth => "an array of depths",
            Self::Metrics => "a file of metrics",
            Self::FrameLog => "a frame log",
            Self::Page => "a page",
            Self::Poses => "a pose path",
            Self::RecentScans => "a list of recent scans",
            Self::Scan(_) => "a scan",
        }
    }

    /// Endings that its name may have.
    pub(super) fn endings(self) -> &'static [&'static str] {
        match self {
            Self::Picture => &["png"],
            Self::Depth => &["npy"],
            Self::Metrics | Self::RecentScans => &["json"],
            Self::FrameLog => &["csv"],
            Self::Page => &["html", "htm", "md"],
            Self::Poses => &["poses"],
            Self::Scan(endings) => endings,
        }
    }

    /// True if the ending must say what is written. Other kinds may end in anything that does not say something else.
    fn needs_ending(self) -> bool {
        matches!(self, Self::Picture | Self::Page | Self::Scan(_))
    }

    /// True if `path` may be the name of an output of this kind. `of_scans`: the endings of files that are read.
    pub(super) fn may_be_named(self, path: &Path, of_scans: &[String]) -> bool {
        let ending = ending(path);
        let is_one_of = |endings: &[&str]| ending.as_deref().is_some_and(|e| endings.contains(&e));
        let says_something_else = is_one_of(&["toml"])
            || Self::FIXED.iter().any(|kind| is_one_of(kind.endings()))
            || ending.as_ref().is_some_and(|ending| of_scans.contains(ending));
        is_one_of(self.endings()) || !self.needs_ending() && !says_something_else
    }

    /// Bytes that an older output of this kind has near its start. Scans have none: a scan is taken for the user's,
    /// whoever made it.
    fn marks(self) -> &'static [&'static [u8]] {
        match self {
            Self::Picture => &[b"\x89PNG\r\n\x1a\n"],
            Self::Depth => &[b"{'descr': '<f4', 'fortran_order': False, 'shape': ("],
            Self::Metrics => &[b"\"gpu_bytes\": "],
            Self::FrameLog => &[b"# scanwalk frame log"],
            Self::Page => &[b"content=\"scanwalk ", b"# The papers' tables"],
            Self::Poses => &[b"time_s,x,y,z,qx,qy,qz,qw"],
            Self::RecentScans => &[b"\"recent_scans\": ["],
            Self::Scan(_) => &[],
        }
    }

    /// True if an output of this kind may replace what is at `path`: nothing, an empty file, or an older one of its
    /// kind.
    pub(super) fn may_replace(self, path: &Path) -> bool {
        let mut head = Vec::new();
        match File::open(path).and_then(|file| file.take(HEAD_BYTES).read_to_end(&mut head)) {
            Ok(_) => head.is_empty() || self.marks().iter().any(|mark| has(&head, mark)),
            Err(error) => error.kind() == io::ErrorKind::NotFound,
        }
    }

    /// True if it would fill a terminal with what nobody can read.
    pub(super) fn is_binary(self) -> bool {
        matches!(self, Self::Picture | Self::Depth | Self::Scan(_))
    }
}

fn has(head: &[u8], mark: &[u8]) -> bool {
    head.windows(mark.len()).any(|bytes| bytes == mark)
}

/// The ending behind the last dot, in lower case.
fn ending(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}

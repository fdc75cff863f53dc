//! Why something is not written, in sentences that name the files and what to do.

use super::OutputKind;
use std::io;
use std::path::{Path, PathBuf};

/// What is wrong with an output.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The name's ending says that the output is something else.
    #[error("{option} {}: {} needs a name that ends in {}{}", path.display(), kind.name(), endings(*kind), pattern_hint(path))]
    Ending {
        /// The option, such as "-o".
        option: &'static str,
        /// The output's path, as the user wrote it.
        path: PathBuf,
        /// The kind of output.
        kind: OutputKind,
    },
    /// Writing the output would destroy something that is read.
    #[error("{option} {} would be written over {}, which is read as {what}; name another file", path.display(), read.display())]
    IsRead {
        /// The option, such as "-o".
        option: &'static str,
        /// The output's path, as the user wrote it.
        path: PathBuf,
        /// The same file, as it is read.
        read: PathBuf,
        /// What the file is read as, such as "a scan".
        what: &'static str,
    },
    /// The file that has the name is not of the output's kind, or is a scan, which may be all that the user has.
    #[error("{option} {}: {}; name another file, or add --force to replace it", path.display(), exists(*kind))]
    Exists {
        /// The option, such as "-o".
        option: &'static str,
        /// The output's path, as the user wrote it.
        path: PathBuf,
        /// The kind of output.
        kind: OutputKind,
    },
    /// Stdout, on which the command prints, goes into a file that is read.
    #[error("stdout goes into {}, which is read as {what}; send it to another file", read.display())]
    StdoutIsRead {
        /// The file that is read.
        read: PathBuf,
        /// What the file is read as, such as "a scan".
        what: &'static str,
    },
    /// Two outputs are one file.
    #[error("{option} {} and {other_option} {} are the same file; name another for one of them", path.display(), other.display())]
    Twice {
        /// The option of one, such as "--depth".
        option: &'static str,
        /// The path of one, as the user wrote it.
        path: PathBuf,
        /// The option of the other, such as "-o".
        other_option: &'static str,
        /// The path of the other, as the user wrote it.
        other: PathBuf,
    },
    /// The output cannot go to stdout, or to this pipe or device.
    #[error("{option} {}: {problem}", path.display())]
    Stream {
        /// The option, such as "-o".
        option: &'static str,
        /// The output's path, as the user wrote it.
        path: PathBuf,
        /// What is wrong and what to do.
        problem: &'static str,
    },
    /// A folder has the name.
    #[error("{option} {}: is a folder; name a file in it", path.display())]
    IsFolder {
        /// The option, such as "-o".
        option: &'static str,
        /// The output's path, as the user wrote it.
        path: PathBuf,
    },
    /// There is no folder to write into.
    #[error("{option} {}: cannot be written: there is no folder {}; make it, or name another file", path.display(), folder.display())]
    NoFolder {
        /// The option, such as "-o".
        option: &'static str,
        /// The output's path, as the user wrote it.
        path: PathBuf,
        /// The folder that is missing.
        folder: PathBuf,
    },
    /// The folder, or the file that has the name, may not be written.
    #[error("{option} {}: cannot be written: {source}; check that you may write to its folder and to what has that name, or name another file", path.display())]
    Locked {
        /// The option, such as "-o".
        option: &'static str,
        /// The output's path, as the user wrote it.
        path: PathBuf,
        /// The system's words.
        source: io::Error,
    },
    /// Writing failed: a full disk, a pipe that nobody reads.
    #[error("{}: cannot be written, and nothing was kept of it: {source}; check the free space", path.display())]
    Write {
        /// The output's path, as the user wrote it.
        path: PathBuf,
        /// The system's words.
        source: io::Error,
    },
}

impl OutputError {
    /// True if the command asks for something that makes no sense; false if the disk is not as it should be.
    #[must_use]
    pub fn is_usage(&self) -> bool {
        match self {
            Self::Ending { .. }
            | Self::IsRead { .. }
            | Self::Exists { .. }
            | Self::StdoutIsRead { .. }
            | Self::Twice { .. }
            | Self::Stream { .. } => true,
            Self::IsFolder { .. } | Self::NoFolder { .. } | Self::Locked { .. } | Self::Write { .. } => false,
        }
    }

    /// True if it is a pipe whose reader has read enough.
    #[must_use]
    pub fn is_closed_pipe(&self) -> bool {
        matches!(self, Self::Locked { source, .. } | Self::Write { source, .. } if source.kind() == io::ErrorKind::BrokenPipe)
    }
}

/// The endings of a kind: ".html or .htm".
fn endings(kind: OutputKind) -> String {
    kind.endings().iter().map(|ending| format!(".{ending}")).collect::<Vec<_>>().join(" or ")
}

/// Why a file is not replaced.
fn exists(kind: OutputKind) -> String {
    match kind {
        OutputKind::Scan(_) => "is there already, and a scan takes no file's place unasked".into(),
        _ => format!("is there already, and is not {}", kind.name()),
    }
}

/// A hint about `-o *.las`, which the shell makes `-o first.las second.las …` of.
fn pattern_hint(path: &Path) -> String {
    // A device is no match of a pattern.
    if !path.is_file() {
        return String::new();
    }
    let ending = path.extension().map(|ending| format!(".{}", ending.display())).unwrap_or_default();
    format!(
        "; this file exists: if you wrote a pattern such as *{ending}, the shell put its first match here, so write a \
         name of your own before the pattern"
    )
}

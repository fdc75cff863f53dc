//! Where an output goes, and what tells one file from another.

use std::ffi::OsString;
use std::fs::{self, Metadata};
use std::io;
use std::path::{Path, PathBuf};

/// Links that are followed at most; the system gives up at as many.
const MAX_LINKS: usize = 40;

/// Where the bytes go.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum OutputPlace {
    /// The program's own output.
    Stdout,
    /// A pipe, a device, or a file that somebody else has opened: written as it is.
    Stream(PathBuf),
    /// A name in a folder that exists; links are followed.
    File {
        /// The folder, without links.
        folder: PathBuf,
        /// The file's name in the folder.
        name: OsString,
    },
}

/// Why a path is no place to write to.
#[derive(Debug)]
pub(super) enum NoOutputPlace {
    IsFolder,
    NoFolder(PathBuf),
    Disk,
    Io(io::Error),
}

impl OutputPlace {
    /// Finds the place of a path: follows links, `.` and `..`, and creates nothing.
    pub fn of(path: &Path) -> Result<Self, NoOutputPlace> {
        let mut at = path.to_path_buf();
        for _ in 0..MAX_LINKS {
            if is_stdout(&at) {
                return Ok(Self::Stdout);
            }
            if at
                .as_os_str()
                .as_encoded_bytes()
                .last()
                .is_some_and(|byte| std::path::is_separator((*byte).into()))
            {
                return Err(NoOutputPlace::IsFolder);
            }
            match fs::metadata(&at) {
                Ok(found) if found.is_dir() => return Err(NoOutputPlace::IsFolder),
                Ok(found) if is_disk(&found) => return Err(NoOutputPlace::Disk),
                Ok(found) if !found.is_file() || is_open_already(&at) => return Ok(Self::Stream(at)),
                _ => {}
            }
            match fs::read_link(&at) {
                // An absolute link takes the place of the whole path.
                Ok(link) => at = parent(&at).join(link),
                Err(_) => return Self::in_folder(&at),
            }
        }
        Err(NoOutputPlace::Io(io::Error::other("the link leads to itself")))
    }

    fn in_folder(path: &Path) -> Result<Self, NoOutputPlace> {
        let Some(name) = path.file_name() else { return Err(NoOutputPlace::IsFolder) };
        let folder = parent(path);
        match fs::canonicalize(folder) {
            Ok(folder) if folder.is_dir() => Ok(Self::File { folder, name: name.to_owned() }),
            Ok(_) => Err(NoOutputPlace::NoFolder(folder.to_owned())),
            Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => {
                Err(NoOutputPlace::NoFolder(folder.to_owned()))
            }
            Err(error) => Err(NoOutputPlace::Io(error)),
        }
    }

    /// The name that the file gets.
    pub fn goal(&self) -> Option<PathBuf> {
        match self {
            Self::File { folder, name } => Some(folder.join(name)),
            Self::Stdout | Self::Stream(_) => None,
        }
    }

    /// Tells whether it could be written, as far as that is possible without writing.
    pub fn try_it(&self) -> io::Result<()> {
        let Self::File { folder, .. } = self else { return Ok(()) };
        // The temporary file has no name, or loses it at once.
        tempfile::tempfile_in(folder)?;
        // A file that its owner protects is not replaced, though its folder would allow it.
        match self.goal().filter(|goal| goal.exists()) {
            Some(goal) => fs::File::options().write(true).open(goal).map(drop),
            None => Ok(()),
        }
    }
}

/// The folder that a path is in.
fn parent(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn is_stdout(path: &Path) -> bool {
    ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"].iter().any(|name| path.as_os_str() == *name)
}

/// True if the shell has opened the file for us (`3> file`): then it is written, not replaced.
fn is_open_already(path: &Path) -> bool {
    ["/dev/fd", "/proc/self/fd"].iter().any(|folder| path.parent() == Some(Path::new(folder)))
        || path == Path::new("/dev/stderr")
}

#[cfg(unix)]
fn is_disk(found: &Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_block_device(&found.file_type())
}

#[cfg(not(unix))]
fn is_disk(_: &Metadata) -> bool {
    false
}

/// What tells one file from another, however it is named.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct FileIdentity {
    /// Device and inode, where the system has them: hard links share them.
    node: Option<(u64, u64)>,
    /// The path where it is, or would be, without links.
    place: Option<PathBuf>,
}

impl FileIdentity {
    /// The identity of a file that is read.
    pub fn of_read(path: &Path) -> Self {
        let place = fs::canonicalize(path).ok().or_else(|| OutputPlace::of(path).ok()?.goal());
        Self { node: node(path), place: place.filter(|_| !is_endless(path)) }
    }

    /// The identity of a place to write to.
    pub fn of_written(place: &OutputPlace) -> Self {
        match place {
            OutputPlace::Stdout => Self { node: node(Path::new("/dev/stdout")), place: None },
            OutputPlace::Stream(path) => Self { node: node(path), place: None },
            OutputPlace::File { .. } => {
                let goal = place.goal();
                Self { node: goal.as_deref().and_then(node), place: goal }
            }
        }
    }

    pub fn is(&self, other: &Self) -> bool {
        let is_same = |a: &PathBuf| other.place.as_ref().is_some_and(|b| a == b);
        self.node.is_some() && self.node == other.node || self.place.as_ref().is_some_and(is_same)
    }

    /// True if both may be one file. Names that differ in upper and lower case only are one on some disks, and nobody
    /// means two by them.
    pub fn may_be(&self, other: &Self) -> bool {
        let lower = |place: &PathBuf| place.to_string_lossy().to_lowercase();
        self.is(other)
            || self.place.as_ref().zip(other.place.as_ref()).is_some_and(|(a, b)| lower(a) == lower(b))
    }
}

/// Device and inode of a file or pipe. Terminals and the like have none here: what is written to them destroys
/// nothing.
#[cfg(unix)]
fn node(path: &Path) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    let found = fs::metadata(path).ok().filter(|found| !is_character_device(found))?;
    Some((found.dev(), found.ino()))
}

#[cfg(not(unix))]
fn node(_: &Path) -> Option<(u64, u64)> {
    None
}

fn is_endless(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|found| is_character_device(&found))
}

#[cfg(unix)]
fn is_character_device(found: &Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_char_device(&found.file_type())
}

#[cfg(not(unix))]
fn is_character_device(_: &Metadata) -> bool {
    false
}

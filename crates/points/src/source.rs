//! A file that is read by position, from any thread.
//!
//! The file is not memory-mapped on purpose: a file that shrinks while it is mapped (a network share, a sync tool)
//! kills the process with SIGBUS, whereas a positioned read just comes back short.

use super::ScanError;
use super::unpacked::{self, UnpackedMember};
use std::fs::File;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What a path names that is a link to nothing.
const DANGLING: &str = "a link to a file that is not there";

/// An open file and its size.
#[derive(Debug)]
pub(crate) struct Source {
    path: PathBuf,
    file: Arc<File>,
    /// First byte, where it is a part of the system's file.
    start: u64,
    len: u64,
    /// What is lost of a member of an archive.
    loss: Option<String>,
}

impl Source {
    /// Opens a regular file, or a member of an archive that is unpacked now. Looks at the kind of file first, because opening a pipe would wait for a writer.
    ///
    /// # Errors
    /// The file is not found, may not be read, or is a folder, a pipe, a device or a link to nothing.
    pub fn open(path: &Path) -> Result<Self, ScanError> {
        if let Some(UnpackedMember { file, start, len, loss, .. }) = unpacked::find(path) {
            return Ok(Self { path: path.to_owned(), file, start, len, loss });
        }
        let fail = |source| ScanError::io(path, None, source);
        let metadata = match std::fs::metadata(path) {
            // A pattern such as *.laz finds the link all the same.
            Err(error) if error.kind() == ErrorKind::NotFound && path.is_symlink() => {
                let advice = "it may have been moved or renamed".into();
                return Err(ScanError::NotAFile { path: path.to_owned(), kind: DANGLING, advice });
            }
            found => found.map_err(fail)?,
        };
        if metadata.is_dir() {
            return Err(ScanError::folder(path));
        }
        if !metadata.is_file() {
            let advice = "save it as a file first".into();
            return Err(ScanError::NotAFile { path: path.to_owned(), kind: "a pipe or device", advice });
        }
        let file = File::open(path).map_err(fail)?;
        let (file, len) = (Arc::new(file), metadata.len());
        Ok(Self { path: path.to_owned(), file, start: 0, len, loss: None })
    }

    /// What could not be unpacked of a member of an archive, as a sentence whose subject is the member.
    pub fn loss(&self) -> Option<&str> {
        self.loss.as_deref()
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Size of the file in bytes when it was opened.
    pub fn len(&self) -> u64 {
        self.len
    }

    /// Fills `buffer` from `offset` as far as the file reaches; returns how many bytes that were.
    ///
    /// # Errors
    /// The system cannot read the file; nothing is read then.
    pub fn read_at(&self, mut buffer: &mut [u8], mut offset: u64) -> io::Result<usize> {
        // Behind a member of an archive there may be another.
        let within = self.len.saturating_sub(offset).min(buffer.len() as u64) as usize;
        buffer = &mut buffer[..within];
        offset = offset.saturating_add(self.start);
        let mut num_read = 0;
        while !buffer.is_empty() {
            match positioned_read(&self.file, buffer, offset) {
                Ok(0) => break,
                Ok(count) => {
                    num_read += count;
                    offset += count as u64;
                    buffer = &mut buffer[count..];
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(num_read)
    }

    /// Reads up to `limit` bytes from `offset`, fewer where the file ends before.
    ///
    /// # Errors
    /// The system cannot read the file; the error has the byte.
    pub fn bytes(&self, offset: u64, limit: u64) -> Result<Vec<u8>, ScanError> {
        let wanted = limit.min(self.len.saturating_sub(offset));
        let fail = |source| ScanError::io(&self.path, Some(offset), source);
        let mut buffer = Vec::new();
        let size = usize::try_from(wanted).map_err(|_| fail(io::ErrorKind::OutOfMemory.into()))?;
        buffer.try_reserve_exact(size).map_err(|_| fail(io::ErrorKind::OutOfMemory.into()))?;
        buffer.resize(size, 0);
        let num_read = self.read_at(&mut buffer, offset).map_err(fail)?;
        buffer.truncate(num_read);
        Ok(buffer)
    }

    /// A cursor over the file from `offset` to its end.
    pub fn reader(&self, offset: u64) -> SourceReader<'_> {
        SourceReader { source: self, offset }
    }
}

/// Reads a [`Source`] from front to back.
pub(crate) struct SourceReader<'a> {
    source: &'a Source,
    offset: u64,
}

impl Read for SourceReader<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.source.read_at(buffer, self.offset)?;
        self.offset += count as u64;
        Ok(count)
    }
}

impl Seek for SourceReader<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let target = match to {
            SeekFrom::Start(offset) => Some(offset),
            SeekFrom::Current(delta) => self.offset.checked_add_signed(delta),
            SeekFrom::End(delta) => self.source.len.checked_add_signed(delta),
        };
        self.offset = target.ok_or(io::ErrorKind::InvalidInput)?;
        Ok(self.offset)
    }
}

#[cfg(unix)]
fn positioned_read(file: &File, buffer: &mut [u8], offset: u64) -> io::Result<usize> {
    std::os::unix::fs::FileExt::read_at(file, buffer, offset)
}

#[cfg(windows)]
fn positioned_read(file: &File, buffer: &mut [u8], offset: u64) -> io::Result<usize> {
    std::os::windows::fs::FileExt::seek_read(file, buffer, offset)
}

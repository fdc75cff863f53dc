//! A file while it is written: under another name in its folder until it is whole.

use super::place::OutputPlace;
use super::{Output, Partials};
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Stdout, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// An output being written. If it is dropped before [`Output::keep`], nothing is left of it, and the file that had its
/// name stays.
#[derive(Debug)]
pub struct OutputFile(Sink);

#[derive(Debug)]
enum Sink {
    Stdout(Stdout),
    /// A device or a pipe; or a file that has its name already.
    Open(File),
    /// Boxed: it is much larger than the others.
    Partial(Box<Partial>),
}

/// A file that has not its name yet.
#[derive(Debug)]
struct Partial {
    /// `None` only while it gets its name.
    file: Option<NamedTempFile>,
    path: PathBuf,
    goal: PathBuf,
    fresh: bool,
    partials: Partials,
}

impl OutputFile {
    pub(super) fn begin(output: &Output) -> io::Result<Self> {
        Ok(Self(match &output.place {
            OutputPlace::Stdout => Sink::Stdout(io::stdout()),
            OutputPlace::Stream(path) => Sink::Open(File::options().write(true).open(path)?),
            OutputPlace::File { folder, name } => {
                Sink::Partial(Box::new(Partial::begin(folder, folder.join(name), output)?))
            }
        }))
    }

    /// Gives the file its name now, in place of the file that had it; later bytes go into it as they come. This is for
    /// files that are worth reading before they are whole.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn publish(&mut self) -> io::Result<()> {
        if let Sink::Partial(partial) = &mut self.0 {
            self.0 = Sink::Open(partial.publish()?);
        }
        Ok(())
    }

    /// Gives the whole file its name, once it is safe on the disk.
    pub(super) fn keep(mut self) -> io::Result<()> {
        self.flush()?;
        if let Sink::Partial(partial) = &self.0 {
            // Without this, a loss of power could leave the new name without its bytes.
            partial.file()?.sync_data()?;
        }
        self.publish()
    }

    /// Bytes so far; 0 for what has no size.
    ///
    /// # Errors
    /// The system's error.
    pub fn num_bytes(&self) -> io::Result<u64> {
        match &self.0 {
            Sink::Stdout(_) => Ok(0),
            Sink::Open(file) => Ok(file.metadata()?.len()),
            Sink::Partial(partial) => Ok(partial.file()?.metadata()?.len()),
        }
    }

    fn writer(&mut self) -> io::Result<&mut dyn Write> {
        Ok(match &mut self.0 {
            Sink::Stdout(stdout) => stdout,
            Sink::Open(file) => file,
            Sink::Partial(partial) => partial.file_mut()?,
        })
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.writer()?.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer()?.flush()
    }
}

impl Seek for OutputFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match &mut self.0 {
            Sink::Stdout(_) => Err(io::ErrorKind::NotSeekable.into()),
            Sink::Open(file) => file.seek(to),
            Sink::Partial(partial) => partial.file_mut()?.seek(to),
        }
    }
}

impl Partial {
    fn begin(folder: &Path, goal: PathBuf, output: &Output) -> io::Result<Self> {
        let partials = output.partials.clone();
        // The name is not made of the goal's, which may be as long as names can be.
        let file = tempfile::Builder::new()
            .prefix(".scanwalk-")
            .suffix(".part")
            .make_in(folder, |path| partials.create(path))?;
        let path = file.path().to_owned();
        let partial = Self { file: Some(file), path, goal, fresh: output.fresh, partials };
        if let Ok(before) = std::fs::metadata(&partial.goal) {
            // The old file's permissions are kept, as if it were written over.
            partial.file()?.set_permissions(before.permissions())?;
        }
        Ok(partial)
    }

    /// Gives the file its own name, and returns it.
    fn publish(&mut self) -> io::Result<File> {
        let file = self.file.take().ok_or_else(gone)?;
        let (goal, fresh) = (&self.goal, self.fresh);
        self.partials.finish(&self.path, || {
            // If it fails, the file is removed as the error is dropped.
            if fresh { file.persist_noclobber(goal) } else { file.persist(goal) }.map_err(|error| error.error)
        })
    }

    /// The file; fails after `publish` did, since the file is gone then.
    fn file(&self) -> io::Result<&File> {
        self.file.as_ref().map(NamedTempFile::as_file).ok_or_else(gone)
    }

    fn file_mut(&mut self) -> io::Result<&mut File> {
        self.file.as_mut().map(NamedTempFile::as_file_mut).ok_or_else(gone)
    }
}

fn gone() -> io::Error {
    io::Error::other("the file was removed")
}

impl Drop for Partial {
    fn drop(&mut self) {
        // The file is removed first and then forgotten: in between, the end of the program would remove it too.
        self.file = None;
        self.partials.forget(&self.path);
    }
}

//! The files that scanwalk writes for a user. No other module creates, renames or removes one
//! (`tests/program/house/calls.rs`).
//!
//! A command declares all that it reads and all that it writes ([`Files`]) before it does either. [`Files::check`]
//! refuses what would destroy something that is read, or a file that is none of the kind that is written, tells of a
//! folder that is missing or cannot be written, and only then gives out [`Output`]s; nothing can be written without
//! one.
//!
//! An output is written under another name in its folder and gets its own when it is whole ([`OutputFile`]), so that
//! at any moment there is the old file or the new one. A name that is a link keeps being one: what it leads to is
//! replaced. Devices, pipes and stdout are written as they are.

mod error;
mod files;
mod kind;
mod partial;
mod place;
#[cfg(test)]
mod tests;
mod write;

pub use error::OutputError;
pub use files::{Files, Outputs};
pub use kind::OutputKind;
pub use partial::Partials;
pub use write::OutputFile;

use place::OutputPlace;
use std::path::{Path, PathBuf};

/// A file that may be written.
#[derive(Clone, Debug)]
pub struct Output {
    /// The path, as the user wrote it.
    path: PathBuf,
    place: OutputPlace,
    partials: Partials,
    /// True if a file that has the name already stays, and writing fails.
    fresh: bool,
}

impl Output {
    /// The only output of a program that reads nothing.
    ///
    /// # Errors
    /// A wrong ending, a folder or another kind of file of that name, a folder that is missing or cannot be written.
    pub fn new(path: impl Into<PathBuf>, kind: OutputKind) -> Result<Self, OutputError> {
        let path = path.into();
        let mut files = Files::default();
        files.writes("the output", &path, kind);
        let mut outputs = files.check(&Partials::default())?;
        // One was declared, so one comes back.
        Ok(outputs.take(kind).pop().expect("the output that was declared"))
    }

    /// A file whose name the program chose: it never takes the place of another.
    ///
    /// # Errors
    /// Those of [`Output::new`].
    pub fn fresh(path: impl Into<PathBuf>, kind: OutputKind) -> Result<Self, OutputError> {
        Ok(Self { fresh: true, ..Self::new(path, kind)? })
    }

    /// A file that the program keeps for itself, in a folder that is made if it is missing.
    ///
    /// # Errors
    /// Those of [`Output::new`].
    pub fn of_program(path: impl Into<PathBuf>, kind: OutputKind) -> Result<Self, OutputError> {
        let path = path.into();
        if let Some(folder) = path.parent() {
            // Where this fails, the check below says why nothing can be written there.
            let _ = std::fs::create_dir_all(folder);
        }
        Self::new(path, kind)
    }

    /// The path, as the user wrote it.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Begins the file; its name is still the old file's.
    ///
    /// # Errors
    /// It cannot be created.
    pub fn begin(&self) -> Result<OutputFile, OutputError> {
        OutputFile::begin(self).map_err(|source| self.failed(source))
    }

    /// Writes the whole file.
    ///
    /// # Errors
    /// It cannot be written; nothing is left of it then.
    pub fn write(&self, bytes: &[u8]) -> Result<(), OutputError> {
        let mut file = self.begin()?;
        std::io::Write::write_all(&mut file, bytes).map_err(|source| self.failed(source))?;
        self.keep(file)
    }

    /// Gives a whole file its name.
    ///
    /// # Errors
    /// The disk refuses; nothing is left of the file then.
    pub fn keep(&self, file: OutputFile) -> Result<(), OutputError> {
        file.keep().map_err(|source| self.failed(source))
    }

    /// Turns an error of writing into the file into one that names it, for `map_err`.
    pub fn failed(&self, source: std::io::Error) -> OutputError {
        OutputError::Write { path: self.path.clone(), source }
    }
}

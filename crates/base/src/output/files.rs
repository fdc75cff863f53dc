//! All that a command reads and writes, checked before it begins.

use super::place::{FileIdentity, NoOutputPlace, OutputPlace};
use super::{Output, OutputError, OutputKind, Partials};
use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};

/// What a command reads and writes.
#[derive(Debug, Default)]
pub struct Files {
    reads: Vec<(&'static str, PathBuf)>,
    writes: Vec<(&'static str, PathBuf, OutputKind)>,
    /// Endings of scans.
    of_scans: Vec<String>,
    prints: bool,
    forced: bool,
}

impl Files {
    /// Declares a file that is read, as `what` ("a scan").
    pub fn reads(&mut self, what: &'static str, path: &Path) {
        self.reads.push((what, path.to_owned()));
    }

    /// Declares the endings of files that are scans: no other output may have one.
    pub fn scans_end_in(&mut self, endings: impl IntoIterator<Item = String>) {
        self.of_scans.extend(endings);
    }

    /// Declares a file that is written, as `option` ("-o") names it; `-` is stdout.
    pub fn writes(&mut self, option: &'static str, path: &Path, kind: OutputKind) {
        self.writes.push((option, path.to_owned(), kind));
    }

    /// Declares that the command prints its answer on stdout.
    pub fn prints(&mut self) {
        self.prints = true;
    }

    /// Declares that outputs may take the place of whatever has their names, except of files that are read.
    pub fn force(&mut self) {
        self.forced = true;
    }

    /// Checks all declared files; nothing is created or changed. Files that `partials` knows of are removed when it
    /// says so.
    ///
    /// # Errors
    /// An output with a wrong ending; one that is read, or written twice; one whose name a file of another kind has, or
    /// any scan; a place where nothing can be written.
    pub fn check(self, partials: &Partials) -> Result<Outputs, OutputError> {
        let reads: Vec<(&str, &PathBuf, FileIdentity)> =
            self.reads.iter().map(|(what, path)| (*what, path, FileIdentity::of_read(path))).collect();
        let find = |identity: &FileIdentity| reads.iter().find(|(_, _, read)| read.is(identity));
        if let Some((what, read, _)) = find(&FileIdentity::of_written(&OutputPlace::Stdout)) {
            return Err(OutputError::StdoutIsRead { read: read.to_path_buf(), what });
        }
        let mut written: Vec<(&'static str, &PathBuf, FileIdentity)> = Vec::new();
        let mut outputs = Outputs::default();
        for (option, path, kind) in &self.writes {
            let place = OutputPlace::of(path).map_err(|problem| no_place(option, path, problem))?;
            let identity = FileIdentity::of_written(&place);
            if let Some((what, read, _)) = find(&identity) {
                let (path, read) = (path.clone(), read.to_path_buf());
                return Err(OutputError::IsRead { option, path, read, what });
            }
            let ends_anyhow =
                !matches!(kind, OutputKind::Scan(_)) && !matches!(place, OutputPlace::File { .. });
            if !ends_anyhow && !kind.may_be_named(path, &self.of_scans) {
                return Err(OutputError::Ending { option, path: path.clone(), kind: *kind });
            }
            if let Some(problem) = self.stream_problem(&place, *kind) {
                return Err(OutputError::Stream { option, path: path.clone(), problem });
            }
            let before = written.iter().find(|(_, other, identity_of_other)| {
                identity_of_other.may_be(&identity)
                    || place == OutputPlace::Stdout && OutputPlace::of(other).is_ok_and(|p| p == place)
            });
            if let Some((other_option, other, _)) = before {
                let (path, other) = (path.clone(), other.to_path_buf());
                return Err(OutputError::Twice { option, path, other_option, other });
            }
            if let Some(Err(source)) = place.goal().map(std::fs::symlink_metadata)
                && source.kind() == io::ErrorKind::InvalidFilename
            {
                return Err(OutputError::Locked { option, path: path.clone(), source });
            }
            if !self.forced && place.goal().is_some_and(|goal| !kind.may_replace(&goal)) {
                return Err(OutputError::Exists { option, path: path.clone(), kind: *kind });
            }
            written.push((option, path, identity));
            let output = Output { path: path.clone(), place, partials: partials.clone(), fresh: false };
            outputs.0.push((*kind, output));
        }
        // This comes last because it touches the disk, if only to see that it can be written.
        for ((_, output), (option, path, _)) in outputs.0.iter().zip(&self.writes) {
            output.place.try_it().map_err(|source| OutputError::Locked {
                option,
                path: path.clone(),
                source,
            })?;
        }
        Ok(outputs)
    }

    /// The problem with writing a kind of output to a pipe, a device or stdout, if there is one.
    fn stream_problem(&self, place: &OutputPlace, kind: OutputKind) -> Option<&'static str> {
        match place {
            OutputPlace::File { .. } => None,
            OutputPlace::Stdout if self.prints => Some("what the command prints goes to stdout; name a file"),
            OutputPlace::Stdout | OutputPlace::Stream(_)
                if matches!(kind, OutputKind::Scan(_)) && !can_go_back(place) =>
            {
                Some("a scan's header is written last, so it needs a file; name one")
            }
            OutputPlace::Stdout if kind.is_binary() && io::stdout().is_terminal() => {
                Some("stdout is a terminal; send it to a file or a program, or name a file")
            }
            OutputPlace::Stdout | OutputPlace::Stream(_) => None,
        }
    }
}

/// True for devices such as `/dev/null`.
fn can_go_back(place: &OutputPlace) -> bool {
    #[cfg(unix)]
    if let OutputPlace::Stream(path) = place {
        use std::os::unix::fs::FileTypeExt;
        return std::fs::metadata(path).is_ok_and(|found| found.file_type().is_char_device());
    }
    matches!(place, OutputPlace::File { .. })
}

fn no_place(option: &'static str, path: &Path, problem: NoOutputPlace) -> OutputError {
    let path = path.to_owned();
    match problem {
        NoOutputPlace::IsFolder => OutputError::IsFolder { option, path },
        NoOutputPlace::NoFolder(folder) => OutputError::NoFolder { option, path, folder },
        NoOutputPlace::Disk => {
            let problem = "is a whole disk, and all that is on it would be lost; name a file";
            OutputError::Stream { option, path, problem }
        }
        NoOutputPlace::Io(source) => OutputError::Locked { option, path, source },
    }
}

/// Outputs that passed the check, in the order in which they were declared.
#[derive(Debug, Default)]
pub struct Outputs(Vec<(OutputKind, Output)>);

impl Outputs {
    /// Takes out the outputs of a kind.
    pub fn take(&mut self, kind: OutputKind) -> Vec<Output> {
        self.0.extract_if(.., |(of, _)| *of == kind).map(|(_, output)| output).collect()
    }

    /// Takes out the first output of a kind, if one was declared.
    pub fn take_one(&mut self, kind: OutputKind) -> Option<Output> {
        let at = self.0.iter().position(|(of, _)| *of == kind)?;
        Some(self.0.remove(at).1)
    }
}

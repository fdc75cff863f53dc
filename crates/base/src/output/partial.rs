//! The partial files of a program, which are known so that one that is ended at once leaves none behind.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The partial files of a program.
#[derive(Clone, Debug, Default)]
pub struct Partials(Arc<Mutex<State>>);

#[derive(Debug, Default)]
struct State {
    paths: Vec<PathBuf>,
    /// True once the program ends: no file is begun any more, and none gets its name.
    ended: bool,
}

impl Partials {
    /// Removes all partial files and lets none begin any more: to be called right before the program ends without
    /// unwinding.
    pub fn discard(&self) {
        let mut state = self.lock();
        state.ended = true;
        for path in state.paths.drain(..) {
            // The program ends anyway; there is nobody to tell.
            let _ = std::fs::remove_file(path);
        }
    }

    /// Creates a file whose name no other has, as a plain create would: the system's mask decides who may read it.
    pub(super) fn create(&self, path: &Path) -> io::Result<File> {
        let mut state = self.alive()?;
        let file = File::options().read(true).write(true).create_new(true).open(path)?;
        state.paths.push(path.to_owned());
        Ok(file)
    }

    /// Has `finish` give a file its name, or fails once the program ends.
    pub(super) fn finish<T>(&self, path: &Path, finish: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
        let mut state = self.alive()?;
        let finished = finish()?;
        state.paths.retain(|partial| partial != path);
        Ok(finished)
    }

    /// Forgets a file that has been removed.
    pub(super) fn forget(&self, path: &Path) {
        self.lock().paths.retain(|partial| partial != path);
    }

    fn alive(&self) -> io::Result<MutexGuard<'_, State>> {
        let state = self.lock();
        if state.ended { Err(io::Error::other("the program was ended")) } else { Ok(state) }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

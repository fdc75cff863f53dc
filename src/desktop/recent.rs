//! The scans that were opened last: a short list in the user's own folder. It is read and written on a thread of its own, since
//! a folder may lie on a network; and nothing depends on it.

use base::output::{Output, OutputKind};
use etcetera::BaseStrategy;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};

/// Scans that are kept at most.
const MOST: usize = 10;

/// A scan that was opened before.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct RecentScan {
    /// Files, which are one scan.
    pub files: Vec<PathBuf>,
    /// False if a file is gone.
    pub is_there: bool,
}

/// The list as its file has it, the newest scan first.
#[derive(Debug, Default, PartialEq, Deserialize, Serialize)]
struct RecentList {
    recent_scans: Vec<Vec<PathBuf>>,
}

/// The scans that were opened last, as far as they are known.
#[derive(Debug, Default)]
pub(super) struct Recent {
    /// `None`: nothing is kept.
    file: Option<PathBuf>,
    scans: Vec<RecentScan>,
    /// What the thread finds that is under way.
    looking: Option<Receiver<Vec<RecentScan>>>,
}

/// The file of the user's list, if there is a place for it.
pub(super) fn file_of_user() -> Option<PathBuf> {
    let places = etcetera::choose_base_strategy().ok()?;
    let folder = places.state_dir().unwrap_or_else(|| places.data_dir());
    Some(folder.join("scanwalk").join("recent.json"))
}

impl Recent {
    /// The list of this file, which is looked at.
    pub(super) fn new(file: Option<PathBuf>) -> Self {
        let mut recent = Self { file, ..Self::default() };
        recent.look(None);
        recent
    }

    /// Takes in that a scan was opened.
    pub(super) fn add(&mut self, files: &[PathBuf]) {
        let whole = |path: &PathBuf| std::path::absolute(path).unwrap_or_else(|_| path.clone());
        self.look(Some(files.iter().map(whole).collect()));
    }

    /// Takes in what a thread has found; true if there is news.
    pub(super) fn take_in(&mut self) -> bool {
        let found = self.looking.as_ref().and_then(|looking| looking.try_recv().ok());
        let has_come = found.is_some();
        if let Some(scans) = found {
            (self.scans, self.looking) = (scans, None);
        }
        has_come
    }

    /// The scans, the newest first.
    pub(super) fn scans(&self) -> &[RecentScan] {
        &self.scans
    }

    /// Has a thread look at the file, and add a scan.
    fn look(&mut self, added: Option<Vec<PathBuf>>) {
        let Some(file) = self.file.clone() else { return };
        let (found, looking) = channel();
        // Two threads that write one file at once would lose a scan.
        let before = self.looking.replace(looking);
        std::thread::spawn(move || {
            before.map(|before| before.recv());
            // Nobody waits for it any more once the window is closed.
            let _ = found.send(look(&file, added));
        });
    }
}

/// Reads the list, adds a scan, and tells which of them are there.
fn look(file: &Path, added: Option<Vec<PathBuf>>) -> Vec<RecentScan> {
    // A list that cannot be read is begun anew.
    let mut list: RecentList =
        std::fs::read(file).ok().and_then(|text| serde_json::from_slice(&text).ok()).unwrap_or_default();
    if let Some(added) = added {
        list.add(added);
        if let Err(problem) = list.write(file) {
            tracing::debug!("the scans that were opened last are not kept: {problem}");
        }
    }
    let is_there = |files: &Vec<PathBuf>| files.iter().all(|file| file.exists());
    list.recent_scans.into_iter().map(|files| RecentScan { is_there: is_there(&files), files }).collect()
}

impl RecentList {
    /// Puts a scan first, once.
    fn add(&mut self, files: Vec<PathBuf>) {
        self.recent_scans.retain(|known| *known != files);
        self.recent_scans.insert(0, files);
        self.recent_scans.truncate(MOST);
    }

    fn write(&self, file: &Path) -> Result<(), Box<dyn std::error::Error>> {
        // Names that are no text are an error here.
        let text = serde_json::to_string_pretty(self)?;
        Output::of_program(file, OutputKind::RecentScans)?.write(text.as_bytes())?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the list has once its thread has looked.
    fn names(recent: &mut Recent) -> Vec<(String, bool)> {
        kit::wait::wait_for("the list", || recent.take_in().then_some(()));
        let name = |scan: &RecentScan| {
            let name = scan.files[0].file_name().unwrap_or_default().display().to_string();
            (name, scan.is_there)
        };
        recent.scans().iter().map(name).collect()
    }

    #[test]
    fn the_newest_comes_first_and_what_is_gone_is_known() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("state/scanwalk/recent.json");
        let scan = |name: &str| vec![folder.path().join(name)];
        std::fs::write(folder.path().join("a.las"), "").unwrap();
        let mut recent = Recent::new(Some(file.clone()));
        assert_eq!(names(&mut recent), [], "there is no file yet");
        for name in ["a.las", "gone.las", "a.las"] {
            recent.add(&scan(name));
        }
        let of = |name: &str, is_there| (name.to_owned(), is_there);
        let wanted = [of("a.las", true), of("gone.las", false)];
        assert_eq!(names(&mut recent), wanted);
        assert_eq!(names(&mut Recent::new(Some(file.clone()))), wanted, "the next walk has it");
        for number in 0..2 * MOST {
            recent.add(&scan(&format!("{number}.las")));
        }
        assert_eq!(names(&mut recent).len(), MOST);
        // Whatever else has the file's name is left alone, and nothing fails.
        std::fs::write(&file, "something of the user's").unwrap();
        recent.add(&scan("a.las"));
        assert_eq!(names(&mut recent).len(), 1);
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "something of the user's");
    }

    #[test]
    fn without_a_file_nothing_is_kept() {
        let mut recent = Recent::new(None);
        recent.add(&["a.las".into()]);
        assert!(!recent.take_in() && recent.scans().is_empty());
    }
}

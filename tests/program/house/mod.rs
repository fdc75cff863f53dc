//! The house's own rules, kept by reading its files: which room may name which, where `unsafe` may stand, how long a
//! file gets, what types are called, what the documents must mention. Each rule is shown to fail on a sample.

mod calls;
mod circles;
mod dependencies;
mod documents;
mod format_names;
mod messages;
mod rooms;
mod types;

use kit::program;
use std::path::{Path, PathBuf};

/// A file: its path from the root, with `/`, and its text.
pub(crate) struct File {
    pub path: String,
    pub text: String,
}

impl File {
    /// True for a module of tests that is a file, or in a folder, of its own.
    fn is_of_tests(&self) -> bool {
        self.path.ends_with("tests.rs") || self.path.contains("/tests/")
    }
}

/// Files with one of these endings below `folder`.
fn files(folder: &str, endings: &[&str]) -> Vec<File> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    let mut folders = vec![root.join(folder)];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        let paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
        for path in paths {
            let name = path.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
            if path.is_dir() {
                folders.push(path);
            } else if endings.iter().any(|ending| name.ends_with(ending)) {
                found.push(File { path: name, text: std::fs::read_to_string(&path).unwrap() });
            }
        }
    }
    found.sort_by(|a, b| a.path.cmp(&b.path));
    found
}

/// All files of the project that are text.
pub(crate) fn tracked() -> Vec<File> {
    let root = env!("CARGO_MANIFEST_DIR");
    let listed = program::run(program::command("git").args(["-C", root, "ls-files", "-z"])).ok();
    let paths = listed.text().split_terminator('\0');
    // Pictures and scans are no text.
    let file = |path: &str| {
        let text = std::fs::read_to_string(Path::new(root).join(path)).ok()?;
        Some(File { path: path.into(), text })
    };
    paths.filter_map(file).collect()
}

fn sources() -> Vec<File> {
    let mut sources = files("src", &[".rs"]);
    sources.extend(files("crates", &[".rs"]));
    // The test kit is not part of the program.
    sources.retain(|file| !file.path.starts_with("crates/kit/"));
    assert!(sources.len() > 20, "the sources were not found");
    sources
}

/// Lines of code with their numbers; anything behind `//` is left out.
fn code(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().map(|(at, line)| (at + 1, line.split("//").next().unwrap_or_default()))
}

/// True if `word` stands in `line` and is not part of a longer name.
fn names(line: &str, word: &str) -> bool {
    let part_of_name = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
    line.match_indices(word).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        let after = line[at + word.len()..].chars().next();
        let word_starts = word.starts_with(|c: char| c.is_alphanumeric());
        !(part_of_name(after) || word_starts && part_of_name(before))
    })
}

/// The part of a file before its module of tests.
fn without_tests(file: &File) -> &str {
    file.text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default()
}

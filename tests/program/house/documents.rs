//! How long files get, what they and the documents must say, and what no file may.

use super::{File, files, sources, tracked};
use std::path::Path;

const MAX_LINES: usize = 500;

fn too_long(file: &File) -> Option<String> {
    let num_lines = file.text.lines().count();
    (num_lines > MAX_LINES).then(|| format!("{} has {num_lines} lines", file.path))
}

#[test]
fn files_stay_small_and_say_what_they_are_for() {
    let mut all = sources();
    let undocumented: Vec<&str> =
        all.iter().filter(|file| !is_documented(file)).map(|file| file.path.as_str()).collect();
    assert!(undocumented.is_empty(), "no module doc: {undocumented:#?}");
    all.extend(files("tests", &[".rs"]));
    all.extend(files("shaders", &[".wgsl"]));
    all.extend(files("scripts", &[""]));
    let faults: Vec<String> = all.iter().filter_map(too_long).collect();
    assert!(faults.is_empty(), "{faults:#?}");
    let sample = |text: String| File { path: "src/x.rs".into(), text };
    assert!(too_long(&sample("x\n".repeat(MAX_LINES + 1))).is_some());
    assert!(too_long(&sample("x\n".repeat(MAX_LINES))).is_none());
    assert!(!is_documented(&sample("use x;\n//! late".into())));
}

fn is_documented(file: &File) -> bool {
    file.text.starts_with("//! ")
}

const MAX_ARCHITECTURE_LINES: usize = 150;

/// Rooms, and folders of `src`, that the text does not name, and its excess length.
fn architecture_faults(text: &str, folders: &[String]) -> Vec<String> {
    let unnamed = folders.iter().filter(|folder| !text.contains(&format!("`{folder}/`")));
    let mut faults: Vec<String> = unnamed.map(|folder| format!("{folder}/ is not named")).collect();
    let num_lines = text.lines().count();
    if num_lines > MAX_ARCHITECTURE_LINES {
        faults.push(format!("{num_lines} lines; {MAX_ARCHITECTURE_LINES} are enough"));
    }
    faults
}

#[test]
fn the_architecture_names_every_part_and_stays_short() {
    let folder = |file: &File| {
        let mut parts = file.path.split('/');
        let (top, name) = (parts.next()?, parts.next()?);
        parts.next().map(|_| format!("{top}/{name}"))
    };
    let mut folders: Vec<String> = sources().iter().filter_map(folder).collect();
    folders.dedup();
    let faults = architecture_faults(include_str!("../../../docs/ARCHITECTURE.md"), &folders);
    assert!(faults.is_empty(), "{faults:#?}");
    assert_eq!(architecture_faults("see `crates/xr/`", &["crates/xr".into(), "src/walk".into()]).len(), 1);
    assert_eq!(architecture_faults(&"\n".repeat(MAX_ARCHITECTURE_LINES + 1), &[]).len(), 1);
}

/// Lines with places that exist on one machine only. The words are put together here so that this file has none of
/// them.
fn machine_paths(file: &File) -> Vec<String> {
    let words =
        [concat!("/wo", "rk/"), concat!("/ro", "ot/"), concat!("/ho", "me/"), concat!("../sha", "red")];
    // Continuous integration may find test data beside the checkout.
    let allowed = |word: &str| file.path == ".ci/run" && word.starts_with("..");
    let mut faults = Vec::new();
    for (at, line) in file.text.lines().enumerate() {
        let found = words.iter().filter(|word| line.contains(**word) && !allowed(word));
        faults.extend(found.map(|word| format!("{}:{} has {word}", file.path, at + 1)));
    }
    faults
}

#[test]
fn nothing_names_one_machine() {
    let faults: Vec<String> = tracked().iter().flat_map(machine_paths).collect();
    assert!(faults.is_empty(), "{faults:#?}");
    let sample = |path: &str| {
        let text = concat!("cd /wo", "rk/scan\nls ../sha", "red/data\n").into();
        machine_paths(&File { path: path.into(), text }).len()
    };
    assert_eq!(sample("README.md"), 2);
    assert_eq!(sample(".ci/run"), 1);
}

#[test]
fn the_readme_starts_with_the_two_commands() {
    let has_both_early = |text: &str| {
        let early: Vec<&str> = text.lines().take(25).collect();
        ["scripts/demo", "scripts/test"]
            .iter()
            .all(|script| early.iter().any(|line| line.starts_with(script)))
    };
    assert!(has_both_early(include_str!("../../../README.md")));
    assert!(!has_both_early("scripts/demo\n\nTests are elsewhere."));
    for script in ["scripts/demo", "scripts/test"] {
        assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join(script).is_file(), "{script}");
    }
}

/// Terms of a table that come before the term above them in the alphabet.
fn misplaced_terms(text: &str) -> Vec<String> {
    let term =
        |line: &str| Some(line.strip_prefix("| **")?.split(" | ").next()?.replace('*', "").to_lowercase());
    let terms: Vec<String> = text.lines().filter_map(term).collect();
    assert!(!terms.is_empty(), "the terms were not found");
    terms.windows(2).filter(|pair| pair[0] > pair[1]).map(|pair| pair[1].clone()).collect()
}

#[test]
fn terms_are_in_the_order_of_the_alphabet() {
    let misplaced = misplaced_terms(include_str!("../../../docs/TERMS.md"));
    assert!(misplaced.is_empty(), "{misplaced:#?}");
    let table =
        "# Terms\n\n| term | meaning |\n|---|---|\n| **node** (of a tree) | b |\n| **node block** | a |\n";
    assert_eq!(
        misplaced_terms(&format!("{table}| **LOD** | c |\n| **local frame** | d |")),
        ["lod", "local frame"]
    );
}

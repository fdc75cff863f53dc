//! The house's own rules, kept by reading its files: which module may name what, where `unsafe` may stand, how
//! long a file gets, what the documents must mention. Each rule is shown to fail on a sample.

use std::path::{Path, PathBuf};
use std::process::Command;

/// A file: its path from the root, with `/`, and its text.
struct File {
    path: String,
    text: String,
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

fn sources() -> Vec<File> {
    let sources = files("src", &[".rs"]);
    assert!(sources.len() > 20, "the sources were not found");
    sources
}

/// Lines of code with their numbers: what stands behind `//` is left out.
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

/// Which folder of `src` must not name what.
const MUST_NOT_NAME: [(&str, &[&str]); 9] = [
    ("cloud", &["wgpu", "ash", "openxr", "winit", "crate::gpu", "crate::render", "crate::xr"]),
    ("twin", &["wgpu", "ash", "openxr", "winit", "crate::gpu", "crate::render", "crate::xr"]),
    ("scan", &["wgpu", "ash", "openxr", "winit", "crate::gpu", "crate::render", "crate::twin"]),
    ("synth", &["wgpu", "ash", "openxr", "winit", "crate::gpu", "crate::render"]),
    ("render", &["openxr", "winit", "egui", "crate::xr", "crate::desktop", "crate::walk"]),
    (
        "gpu",
        &["openxr", "winit", "crate::cloud", "crate::config", "crate::scan", "crate::render", "crate::walk"],
    ),
    ("report", &["wgpu", "ash", "openxr", "winit", "crate::gpu", "crate::render", "crate::cli"]),
    (
        "output",
        &["wgpu", "ash", "openxr", "winit", "crate::cli", "crate::gpu", "crate::scan", "crate::config"],
    ),
    ("timing", &["wgpu", "ash", "openxr", "winit", "crate::gpu", "crate::render", "crate::walk"]),
];

/// Names that the file must not use, with their lines.
fn forbidden_names(file: &File) -> Vec<String> {
    let mut faults = Vec::new();
    for (folder, words) in MUST_NOT_NAME {
        if !file.path.starts_with(&format!("src/{folder}/")) {
            continue;
        }
        for (line, text) in code(&file.text) {
            let used = words.iter().filter(|word| names(text, word));
            faults.extend(used.map(|word| format!("{}:{line} names {word}", file.path)));
        }
    }
    faults
}

#[test]
fn dependencies_point_one_way() {
    let faults: Vec<String> = sources().iter().flat_map(forbidden_names).collect();
    assert!(faults.is_empty(), "{faults:#?}");
    let sample = |path: &str, text: &str| forbidden_names(&File { path: path.into(), text: text.into() });
    assert_eq!(sample("src/cloud/x.rs", "fn f() {}\nuse wgpu::Buffer;"), ["src/cloud/x.rs:2 names wgpu"]);
    assert_eq!(sample("src/render/x.rs", "openxr::Posef").len(), 1);
    assert_eq!(sample("src/gpu/x.rs", "use crate::config::Config;").len(), 1);
    assert!(sample("src/cloud/x.rs", "// wgpu\nlet hash = wgpu_free; // crate::gpu").is_empty());
    assert!(sample("src/gpu/x.rs", "use wgpu::Buffer;").is_empty());
}

/// The files that wrap raw handles; the one that chains the depth layer, which the openxr crate does not wrap; the one that
/// sets environment variables before there are threads; and the one that vouches for our shaders.
const MAY_BE_UNSAFE: [&str; 5] = [
    "src/xr/vulkan.rs",
    "src/xr/swapchain.rs",
    "src/xr/depth_layer.rs",
    "src/cli/quiet.rs",
    "src/gpu/trusted.rs",
];

fn unsafe_code(file: &File) -> Vec<String> {
    if MAY_BE_UNSAFE.contains(&file.path.as_str()) {
        return Vec::new();
    }
    let lines = code(&file.text).filter(|(_, text)| names(text, "unsafe") || names(text, "unsafe_code"));
    lines.map(|(line, _)| format!("{}:{line} is unsafe", file.path)).collect()
}

#[test]
fn unsafe_stands_where_raw_handles_are_wrapped() {
    let faults: Vec<String> = sources().iter().flat_map(unsafe_code).collect();
    assert!(faults.is_empty(), "{faults:#?}");
    let sample = |path: &str| {
        unsafe_code(&File { path: path.into(), text: "#![allow(unsafe_code)]\nunsafe { f() }".into() })
    };
    assert_eq!(sample("src/gpu/open.rs").len(), 2);
    assert!(sample("src/xr/vulkan.rs").is_empty());
}

/// `print!` and `println!` panic when the reader of a pipe has gone; `writeln!` gives an error.
fn panicking_prints(file: &File) -> Vec<String> {
    let prints = |text: &str| names(text, "println!") || names(text, "print!");
    let lines = code(&file.text).filter(|(_, text)| prints(text));
    lines.map(|(line, _)| format!("{}:{line}: write to stdout with writeln!", file.path)).collect()
}

#[test]
fn a_closed_pipe_never_panics() {
    let faults: Vec<String> = sources().iter().flat_map(panicking_prints).collect();
    assert!(faults.is_empty(), "{faults:#?}");
    let sample = |text: &str| panicking_prints(&File { path: "src/x.rs".into(), text: text.into() }).len();
    assert_eq!(sample("println!(\"x\");\nprint!(\"y\");"), 2);
    assert_eq!(sample("eprintln!(\"x\");"), 0);
}

/// What creates, replaces, renames, links or removes a file. A folder of its own for what nobody asked to keep
/// (`tempfile::tempdir`) is no such thing.
const WRITES_FILES: [&str; 24] = [
    "File::create",
    "File::create_new",
    "File::options",
    "OpenOptions",
    "fs::write",
    "fs::copy",
    "fs::rename",
    "fs::remove_file",
    "fs::remove_dir",
    "fs::remove_dir_all",
    "fs::create_dir",
    "fs::create_dir_all",
    "fs::hard_link",
    "fs::set_permissions",
    "fs::symlink",
    "DirBuilder",
    "NamedTempFile",
    "tempfile::Builder",
    "tempfile::tempfile",
    "tempfile_in",
    "symlink",
    "symlink_file",
    "set_len",
    "persist",
];

/// What stands before a file's module of tests.
fn without_tests(file: &File) -> &str {
    file.text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default()
}

/// Tests in `src` may write what they like: what stands behind `#[cfg(test)]` before a module of tests, and files of
/// tests.
fn written_files(file: &File) -> Vec<String> {
    if file.path.starts_with("src/output/") || file.path.ends_with("tests.rs") {
        return Vec::new();
    }
    let program = without_tests(file);
    let mut faults = Vec::new();
    for (line, text) in code(program) {
        let used = WRITES_FILES.iter().filter(|word| names(text, word));
        faults.extend(used.map(|word| {
            format!("{}:{line} uses {word}: declare the file and write it as an output::Output", file.path)
        }));
    }
    faults
}

/// So that nothing that scanwalk writes destroys what it reads: `output` compares all that a command reads and writes,
/// and nothing can be written around it.
#[test]
fn files_are_written_in_one_place() {
    let faults: Vec<String> = sources().iter().flat_map(written_files).collect();
    assert!(faults.is_empty(), "{faults:#?}");
    let sample = |path: &str, text: &str| written_files(&File { path: path.into(), text: text.into() }).len();
    for text in [
        "let file = File::create(path)?;",
        "std::fs::write(path, text)?;",
        "use std::fs::{self, OpenOptions};",
        "File::options().write(true).open(path)",
        "let file = tempfile::NamedTempFile::new()?;",
        "fs::rename(a, b)",
    ] {
        assert_eq!(sample("src/shot.rs", text), 1, "{text}");
    }
    assert_eq!(sample("src/output/write.rs", "fs::rename(a, b)"), 0);
    assert_eq!(sample("src/x.rs", "File::open(path) // not File::create(path)\ntempfile::tempdir()"), 0);
    assert_eq!(sample("src/x.rs", "#[cfg(test)]\nmod tests {\n    fs::write(a, b);\n}"), 0);
    assert_eq!(
        sample("src/x.rs", "#[cfg(test)]\nuse x;\nfs::write(a, b);"),
        1,
        "only modules of tests are let out"
    );
}

/// What messages count.
const COUNTED: [&str; 22] = [
    "cells",
    "chunks",
    "columns",
    "discs",
    "faces",
    "files",
    "frames",
    "images",
    "lines",
    "names",
    "nodes",
    "periods",
    "points",
    "poses",
    "rows",
    "splats",
    "tiles",
    "triangles",
    "values",
    "vertices",
    "warnings",
    "bytes",
];
/// These say it of numbers that are never 1: of all of a scan that is too large, of the most that is read, of all that a
/// few are part of. Others name no count.
const NEVER_ONE: [&str; 16] = [
    "of {all} points",
    "no memory for {num_points} points",
    "the scan has {0} points",
    "the scan's {points} points ({bytes} bytes)",
    "the scan's {num_points} points and {num_triangles} triangles",
    "needs {bytes} bytes in one buffer",
    "{path}: {points} points are too many",
    "than {MAX_ROWS} rows",
    "than {MAX_FRAMES} frames",
    "than {MAX_STAGES} columns",
    "needs {needed} bytes",
    "the file has {end} bytes",
    "of {} nodes, {} M points read, {} M drawn",
    "{}/{} nodes",
    "points of {record_bytes} bytes",
    "{method} draws points",
];

/// Counts in messages whose noun is plural even if there is one.
fn always_plural(file: &File) -> Vec<String> {
    if file.path.ends_with("tests.rs") || file.path.starts_with("src/bench/") {
        return Vec::new();
    }
    let program = without_tests(file);
    let is_plural = |text: &str| {
        let text = NEVER_ONE.iter().fold(text.to_owned(), |text, phrase| text.replace(phrase, ""));
        text.split('}').skip(1).any(|behind| {
            // A count, a word in between that describes it, and the noun.
            let Some(words) = behind.strip_prefix(' ') else { return false };
            let mut words = words.split([' ', '"', ',', ';', ':', '.', ')']).take(2);
            words.next().is_some_and(|word| {
                let is_describing =
                    ["more", "whole", "header", "display", "column", "damaged"].contains(&word);
                COUNTED.contains(&word)
                    || is_describing && words.next().is_some_and(|word| COUNTED.contains(&word))
            })
        })
    };
    let lines = code(program).filter(|(_, text)| text.contains('"') && is_plural(text));
    lines
        .map(|(line, text)| format!("{}:{line}: write with words::counted: {}", file.path, text.trim()))
        .collect()
}

#[test]
fn one_is_singular_in_every_message() {
    let faults: Vec<String> = sources().iter().flat_map(always_plural).collect();
    assert!(faults.is_empty(), "{faults:#?}");
    let sample = |text: &str| always_plural(&File { path: "src/x.rs".into(), text: text.into() }).len();
    for text in [
        "\"has {num} lines\"",
        "\"{num_more} more files: \"",
        "format!(\"({} frames)\", n)",
        "\"{n:.0} rows\"",
    ] {
        assert_eq!(sample(text), 1, "{text}");
    }
    for text in
        ["\"{lines} that are\"", "\"than {MAX_ROWS} rows\"", "} // {n} points", "let points = {x}; lines()"]
    {
        assert_eq!(sample(text), 0, "{text}");
    }
}

/// Where a library stages its uploads through the bare queue; see `QueueGuard::for_uploads`.
const MAY_TOUCH_THE_QUEUE: [&str; 3] =
    ["src/gpu/queue.rs", "src/desktop/painter.rs", "src/desktop/painter_tests.rs"];

fn bare_queues(file: &File) -> Vec<String> {
    if MAY_TOUCH_THE_QUEUE.contains(&file.path.as_str()) {
        return Vec::new();
    }
    let lines = code(&file.text).filter(|(_, text)| names(text, "for_uploads"));
    lines.map(|(line, _)| format!("{}:{line}: the queue without its lock", file.path)).collect()
}

#[test]
fn the_queue_stays_behind_its_lock() {
    let faults: Vec<String> = sources().iter().flat_map(bare_queues).collect();
    assert!(faults.is_empty(), "{faults:#?}");
    let file = |path: &str| File { path: path.into(), text: "queue.lock().for_uploads().clone();".into() };
    assert_eq!(bare_queues(&file("src/walk/run.rs")).len(), 1);
    assert!(bare_queues(&file("src/desktop/painter.rs")).is_empty());
}

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

/// Folders of `src` that the text does not name, and its excess length.
fn architecture_faults(text: &str, folders: &[String]) -> Vec<String> {
    let unnamed = folders.iter().filter(|folder| !text.contains(&format!("`src/{folder}/`")));
    let mut faults: Vec<String> = unnamed.map(|folder| format!("src/{folder}/ is not named")).collect();
    let num_lines = text.lines().count();
    if num_lines > MAX_ARCHITECTURE_LINES {
        faults.push(format!("{num_lines} lines; {MAX_ARCHITECTURE_LINES} are enough"));
    }
    faults
}

#[test]
fn the_architecture_names_every_part_and_stays_short() {
    let mut folders: Vec<String> = sources()
        .iter()
        .filter_map(|file| Some(file.path.strip_prefix("src/")?.split_once('/')?.0.to_owned()))
        .collect();
    folders.dedup();
    let faults = architecture_faults(include_str!("../docs/ARCHITECTURE.md"), &folders);
    assert!(faults.is_empty(), "{faults:#?}");
    assert_eq!(architecture_faults("see `src/gpu/`", &["gpu".into(), "walk".into()]).len(), 1);
    assert_eq!(architecture_faults(&"\n".repeat(MAX_ARCHITECTURE_LINES + 1), &[]).len(), 1);
}

/// Places that exist on one machine only, with their lines. Put together here so that this file has none.
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
    let root = env!("CARGO_MANIFEST_DIR");
    let tracked = Command::new("git").args(["-C", root, "ls-files", "-z"]).output();
    let Some(tracked) = tracked.ok().filter(|listed| listed.status.success()) else {
        println!("skipped: not a git checkout, so nothing tells which files are the project's");
        return;
    };
    let mut faults = Vec::new();
    for path in String::from_utf8(tracked.stdout).unwrap().split_terminator('\0') {
        // Pictures and scans are no text.
        let Ok(text) = std::fs::read_to_string(Path::new(root).join(path)) else { continue };
        faults.extend(machine_paths(&File { path: path.into(), text }));
    }
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
    assert!(has_both_early(include_str!("../README.md")));
    assert!(!has_both_early("scripts/demo\n\nTests are elsewhere."));
    for script in ["scripts/demo", "scripts/test"] {
        assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join(script).is_file(), "{script}");
    }
}

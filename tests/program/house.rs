//! The house's own rules, kept by reading its files: which room may name which, where `unsafe` may stand, how long a
//! file gets, what the documents must mention. Each rule is shown to fail on a sample.

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

/// The rooms from the bottom up. Each may name the rooms that stand beside it here, which come before it, and no
/// other. Cargo refuses circles and what a manifest does not list; this table keeps the manifests.
const ROOMS: [(&str, &[&str]); 10] = [
    ("base", &[]),
    ("raw", &[]),
    ("timing", &["base"]),
    ("points", &["base"]),
    ("cloud", &["base", "points"]),
    ("render", &["base", "cloud", "raw", "timing"]),
    ("xr", &["base", "raw", "render"]),
    ("lab", &["base", "cloud", "points", "render", "timing"]),
    ("kit", &["base", "cloud", "lab", "points", "render"]),
    ("", &["base", "cloud", "lab", "points", "raw", "render", "timing", "xr"]),
];
/// Libraries that a room must not have: the GPU is unknown to files and clouds; the renderer knows no headset, no window and no
/// settings file; windows are the program's matter.
const NOT_IN: [(&str, &[&str]); 8] = [
    ("wgpu", &["base", "timing", "points", "cloud"]),
    ("ash", &["base", "timing", "points", "cloud", "render", "lab"]),
    ("openxr", &["base", "timing", "points", "cloud", "render", "lab"]),
    ("wgpu-hal", &["base", "timing", "points", "cloud", "render", "lab", "xr"]),
    ("winit", &["base", "timing", "points", "cloud", "raw", "render", "lab", "xr"]),
    ("egui", &["base", "timing", "points", "cloud", "raw", "render", "lab", "xr"]),
    ("toml", &["base", "timing", "cloud", "raw", "render", "lab", "xr"]),
    ("las", &["base", "timing", "cloud", "raw", "render", "xr"]),
];

/// Names below `[dependencies]` of a room's manifest.
fn dependencies(manifest: &str) -> Vec<String> {
    let table: toml::Table = manifest.parse().expect("a manifest is TOML");
    let of = |name: &str| table.get(name).and_then(toml::Value::as_table);
    of("dependencies").into_iter().flat_map(|names| names.keys().cloned()).collect()
}

/// Dependencies in the manifest of `room` that it may not have.
fn forbidden_dependencies(room: &str, manifest: &str) -> Vec<String> {
    let may_name = ROOMS.iter().find(|(name, _)| *name == room).map_or(&[][..], |(_, below)| *below);
    let names = dependencies(manifest);
    let is_forbidden = |name: &&String| {
        let is_room = ROOMS.iter().any(|(room, _)| room == name);
        let is_kept_out = NOT_IN.iter().any(|(library, rooms)| library == name && rooms.contains(&room));
        is_room && !may_name.contains(&name.as_str()) || is_kept_out
    };
    names.iter().filter(is_forbidden).map(|name| format!("{room} depends on {name}")).collect()
}

/// The manifest of a room; the program's own room is "".
fn manifest(room: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = if room.is_empty() { root.to_owned() } else { root.join("crates").join(room) };
    std::fs::read_to_string(folder.join("Cargo.toml")).unwrap()
}

#[test]
fn dependencies_point_one_way() {
    let rooms = ROOMS.map(|(room, _)| room);
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    for entry in std::fs::read_dir(crates).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(rooms.contains(&name.as_str()), "crates/{name} is in no table");
    }
    for (at, (room, below)) in ROOMS.iter().enumerate() {
        assert!(below.iter().all(|name| rooms[..at].contains(name)), "{room}: from the bottom up");
        assert_eq!(forbidden_dependencies(room, &manifest(room)), [""; 0]);
    }
    let sample = |room: &str, name: &str| {
        forbidden_dependencies(room, &format!("[dependencies]\n{name}.workspace = true\n")).len()
    };
    assert_eq!(sample("cloud", "wgpu"), 1);
    assert_eq!(sample("render", "xr"), 1);
    assert_eq!(sample("points", "cloud"), 1);
    assert_eq!(sample("cloud", "points") + sample("xr", "openxr"), 0);
}

/// Whether a room's code cannot be unsafe, whatever its files allow.
fn forbids_unsafe(room: &str, manifest: &str, lib: &str) -> bool {
    if room.is_empty() {
        return lib.contains("\n#![forbid(unsafe_code)]\n");
    }
    manifest.contains("\n[lints]\nworkspace = true\n")
}

#[test]
fn unsafe_stands_in_one_room() {
    assert!(manifest("").contains("[workspace.lints.rust]\nunsafe_code = \"forbid\"\n"));
    let lib = concat!(include_str!("../../src/lib.rs"), include_str!("../../src/main.rs"));
    assert_eq!(lib.matches("\n#![forbid(unsafe_code)]\n").count(), 2);
    let open: Vec<&str> = ROOMS
        .map(|(room, _)| room)
        .into_iter()
        .filter(|room| !forbids_unsafe(room, &manifest(room), lib))
        .collect();
    assert_eq!(open, ["raw"]);
    assert!(!forbids_unsafe("xr", "[package]\n", ""));
    assert!(!forbids_unsafe("", "", "//! x\n"));
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

/// Functions that create, replace, rename, link or remove a file. A temporary folder for files that nobody asked to
/// keep (`tempfile::tempdir`) is allowed.
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

/// The part of a file before its module of tests.
fn without_tests(file: &File) -> &str {
    file.text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default()
}

/// Files that a source writes past `output`. Tests in `src` may write what they like: modules of tests behind
/// `#[cfg(test)]`, and files of tests.
fn written_files(file: &File) -> Vec<String> {
    if file.path.starts_with("crates/base/src/output/") || file.path.ends_with("tests.rs") {
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

/// Nothing that scanwalk writes may destroy what it reads: `output` compares all that a command reads and writes, and
/// nothing can be written around it.
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
        assert_eq!(sample("src/offscreen/mod.rs", text), 1, "{text}");
    }
    assert_eq!(sample("crates/base/src/output/write.rs", "fs::rename(a, b)"), 0);
    assert_eq!(sample("src/x.rs", "File::open(path) // not File::create(path)\ntempfile::tempdir()"), 0);
    assert_eq!(sample("src/x.rs", "#[cfg(test)]\nmod tests {\n    fs::write(a, b);\n}"), 0);
    assert_eq!(
        sample("src/x.rs", "#[cfg(test)]\nuse x;\nfs::write(a, b);"),
        1,
        "only modules of tests are let out"
    );
}

/// Nouns that messages count.
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
/// Phrases whose number is never 1: all of a scan that is too large, the most that is read, the whole that a few are
/// part of. Other phrases name no count.
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
    if file.path.ends_with("tests.rs") || file.path.starts_with("crates/lab/src/bench/") {
        return Vec::new();
    }
    let program = without_tests(file);
    let is_plural = |text: &str| {
        let text = NEVER_ONE.iter().fold(text.to_owned(), |text, phrase| text.replace(phrase, ""));
        text.split('}').skip(1).any(|behind| {
            // A count is followed by a word that describes the noun, if any, and by the noun.
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

/// Files in which a library stages its uploads through the bare queue; see `QueueGuard::for_uploads`.
const MAY_TOUCH_THE_QUEUE: [&str; 3] =
    ["crates/render/src/gpu/queue.rs", "src/desktop/painter.rs", "src/desktop/painter_tests.rs"];

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

/// Files that see settings as such: the command line makes them, and `resolve` makes of them what each room is told.
const SEES_SETTINGS: [&str; 4] = ["src/cli/", "src/config/", "src/resolve.rs", "src/lib.rs"];

/// Lines in other files that name the settings.
fn settings_seen(file: &File) -> Vec<String> {
    if SEES_SETTINGS.iter().any(|place| file.path.starts_with(place)) {
        return Vec::new();
    }
    let is_named = |text: &str| {
        text.contains("config::") || ["Config", "crate::config"].iter().any(|word| names(text, word))
    };
    let lines = code(&file.text).filter(|(_, text)| is_named(text));
    lines.map(|(line, _)| format!("{}:{line}: take options of your own", file.path)).collect()
}

#[test]
fn settings_are_resolved_once() {
    let faults: Vec<String> = sources().iter().flat_map(settings_seen).collect();
    assert!(faults.is_empty(), "{faults:#?}");
    let sample = |path: &str, text: &str| settings_seen(&File { path: path.into(), text: text.into() }).len();
    for text in ["config: &Config,", "use crate::config::FrameConfig;", "use crate::{config::Mirror, view};"]
    {
        assert_eq!(sample("src/walk/run.rs", text), 1, "{text}");
        assert_eq!(sample("src/cli/mod.rs", text), 0, "{text}");
    }
    assert_eq!(sample("src/desktop/screen.rs", "let config: SurfaceConfiguration = self.config;"), 0);
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
    let faults = architecture_faults(include_str!("../../docs/ARCHITECTURE.md"), &folders);
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
    let root = env!("CARGO_MANIFEST_DIR");
    let tracked = Command::new("git").args(["-C", root, "ls-files", "-z"]).output();
    let tracked = tracked
        .ok()
        .filter(|listed| listed.status.success())
        .expect("a git checkout, which lists the project's files");
    let mut faults = Vec::new();
    for path in String::from_utf8(tracked.stdout).unwrap().split_terminator('\0') {
        // Pictures and scans are not text.
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
    assert!(has_both_early(include_str!("../../README.md")));
    assert!(!has_both_early("scripts/demo\n\nTests are elsewhere."));
    for script in ["scripts/demo", "scripts/test"] {
        assert!(Path::new(env!("CARGO_MANIFEST_DIR")).join(script).is_file(), "{script}");
    }
}

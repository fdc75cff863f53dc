//! What code may call only in certain places: prints, writing files, the bare queue, settings.

use super::{File, code, names, sources, without_tests};

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

/// Where files may be written, and why.
const MAY_WRITE: [(&str, &str); 2] = [
    ("crates/base/src/output/", "it compares all that is written with all that is read"),
    ("crates/points/src/unpacked.rs", "a file without a name takes no other file's place"),
];

/// Files that a source writes past `output`. Tests in `src` may write what they like: modules of tests behind
/// `#[cfg(test)]`, and files of tests.
fn written_files(file: &File) -> Vec<String> {
    if MAY_WRITE.iter().any(|(place, _)| file.path.starts_with(place)) || file.is_of_tests() {
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
    for (place, reason) in MAY_WRITE {
        assert!(sources().iter().any(|file| file.path.starts_with(place)), "{place} is gone: {reason}");
    }
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

/// The one place that asks wgpu's device whether work is done: wgpu panics there where the device is lost.
const POLLS: &str = "crates/render/src/gpu/lost.rs";

fn bare_polls(file: &File) -> Vec<String> {
    if file.path == POLLS {
        return Vec::new();
    }
    let lines = code(&file.text).filter(|(_, text)| text.contains("device.poll("));
    lines.map(|(line, _)| format!("{}:{line}: ask by Gpu::poll", file.path)).collect()
}

#[test]
fn a_lost_gpu_panics_nowhere() {
    let faults: Vec<String> = sources().iter().flat_map(bare_polls).collect();
    assert!(faults.is_empty(), "{faults:#?}");
    let file = |path: &str| File { path: path.into(), text: "gpu.device.poll(wait)?;".into() };
    assert_eq!((bare_polls(&file("src/walk/run.rs")).len(), bare_polls(&file(POLLS)).len()), (1, 0));
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

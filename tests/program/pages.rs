//! The things that comments and documents point to exist: files by their paths, sections of the specification, papers
//! by their keys.

use crate::house::{File, tracked};
use std::path::Path;

/// Folders that a named path begins with, seen from the root.
const TOPS: [&str; 8] = ["benches/", "config/", "crates/", "docs/", "scripts/", "shaders/", "src/", "tests/"];
/// Endings of a file's name.
const ENDINGS: [&str; 9] = [".rs", ".wgsl", ".md", ".toml", ".csv", ".json", ".png", ".html", "/"];

/// The words of a text that may be paths.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let is_part = |c: char| c.is_alphanumeric() || "/._-*{}".contains(c);
    text.split(move |c: char| !is_part(c)).map(|word| word.trim_end_matches('.'))
}

/// Paths that a text names and that do not exist.
fn lost_paths(text: &str, exists: &impl Fn(&str) -> bool) -> Vec<String> {
    let is_path = |word: &&str| {
        TOPS.iter().any(|top| word.starts_with(top))
            && ENDINGS.iter().any(|ending| word.ends_with(ending))
            && !word.contains(['*', '{', '}'])
    };
    words(text).filter(is_path).filter(|path| !exists(path)).map(String::from).collect()
}

/// Sections that a text names and that the specification lacks.
fn lost_sections(text: &str, specification: &str) -> Vec<String> {
    let mut lost = Vec::new();
    for (at, _) in text.match_indices("FRAME.md §") {
        let number: String =
            text[at..].chars().skip("FRAME.md §".chars().count()).take_while(char::is_ascii_digit).collect();
        if !specification.contains(&format!("\n## {number}. ")) {
            lost.push(format!("FRAME.md §{number}"));
        }
    }
    lost
}

/// The key of what a part of a text in brackets cites: a name or a year in front of a section or at the beginning.
fn key(part: &str, is_first: bool) -> Option<&str> {
    let (key, has_section) = part.split_once(" §").map_or((part, false), |(key, _)| (key, true));
    let word = key.split(' ').next()?;
    let is_year = word.len() == 4 && word.chars().all(|c| c.is_ascii_digit());
    let is_name =
        word.starts_with(|c: char| c.is_ascii_uppercase()) && word.chars().all(char::is_alphanumeric);
    (has_section || is_first && (is_year || is_name)).then_some(key)
}

/// Keys of papers that a text cites, and that the list of references lacks. Links are no citations.
fn lost_keys(text: &str, references: &str) -> Vec<String> {
    let bracket = |rest: &'_ str| {
        let (inside, after) = rest.split_once(']')?;
        (!after.starts_with('(')).then(|| inside.to_owned())
    };
    let keys = text.split('[').skip(1).filter_map(bracket).flat_map(|inside| {
        let keys = inside.split(", ").enumerate().filter_map(|(at, part)| key(part, at == 0));
        keys.map(str::to_owned).collect::<Vec<_>>()
    });
    keys.filter(|key| !references.contains(&format!("\n| {key} |"))).collect()
}

/// The text behind `//` or `#`; all of a document.
fn prose(path: &str, text: &str) -> String {
    let comment = |line: &str| match path.rsplit('.').next() {
        Some("rs" | "wgsl") => line.split_once("//").map(|(_, comment)| comment.to_owned()),
        Some("md") => Some(line.to_owned()),
        _ => line.split_once('#').map(|(_, comment)| comment.to_owned()),
    };
    text.lines().filter_map(comment).collect::<Vec<_>>().join("\n")
}

/// Formats that pages must name and do not.
fn lost_formats(readme: &str, formats: &str, name_all: &dyn Fn(&str) -> String) -> Vec<String> {
    let (and, or) = (name_all("and"), name_all("or"));
    let said = [format!("scanwalk reads {and} files"), format!("- {and} only.")];
    let mut lost: Vec<String> = said.into_iter().filter(|said| !readme.contains(said)).collect();
    // The text is "LAS, LAZ or PLY".
    let names = or.split([' ', ',']).filter(|name| !name.is_empty() && *name != "or");
    let has_row = |name: &&str| {
        let starts = |line: &str| line.split([' ', '|']).find(|word| !word.is_empty()) == Some(*name);
        formats.lines().any(|line| line.starts_with('|') && starts(line))
    };
    lost.extend(names.filter(|name| !has_row(name)).map(|name| format!("a row of {name}")));
    lost
}

#[test]
fn pages_name_the_formats_that_are_read() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = |name: &str| std::fs::read_to_string(root.join(name)).unwrap();
    let (readme, formats) = (page("README.md"), page("docs/FORMATS.md"));
    assert_eq!(lost_formats(&readme, &formats, &points::format_names), [""; 0]);
    // A further format would be missed in all places.
    let more = |before_last: &str| format!("LAS, LAZ, PLY {before_last} NEWEST");
    assert_eq!(lost_formats(&readme, &formats, &more).len(), 3);
}

#[test]
fn what_comments_name_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = |name: &str| std::fs::read_to_string(root.join("docs").join(name)).unwrap();
    let (specification, references) = (page("FRAME.md"), page("REFERENCES.md"));
    let mut lost = Vec::new();
    for File { path, text } in tracked() {
        let is_prose = [".rs", ".wgsl", ".md", ".toml"].iter().any(|ending| path.ends_with(ending))
            || path.starts_with("scripts/");
        // This file has samples of lost paths.
        if !is_prose || path.ends_with("tests/program/pages.rs") {
            continue;
        }
        let text = prose(&path, &text);
        // A path is seen from the root, or from the folder of the file.
        let beside = Path::new(&path).parent().unwrap_or(Path::new(""));
        let in_room = path.strip_prefix("crates/").and_then(|rest| rest.split('/').next());
        let exists = |name: &str| {
            let room = in_room.map(|room| root.join("crates").join(room).join(name));
            root.join(name).exists()
                || root.join(beside).join(name).exists()
                || room.is_some_and(|path| path.exists())
        };
        let found =
            [lost_paths(&text, &exists), lost_sections(&text, &specification), lost_keys(&text, &references)];
        lost.extend(found.concat().into_iter().map(|name| format!("{path} names {name}")));
    }
    assert!(lost.is_empty(), "{lost:#?}");
}

#[test]
fn what_is_not_there_is_found() {
    let nothing = |_: &str| false;
    assert_eq!(lost_paths("see `src/layout.rs`, docs/bench/x.", &nothing), ["src/layout.rs"]);
    assert_eq!(lost_paths("src/*.rs and tests/", &nothing), ["tests/"]);
    assert_eq!(lost_paths("see src/lib.rs.", &|_: &str| true), [""; 0]);
    assert_eq!(lost_sections("(docs/FRAME.md §2 and FRAME.md §12)", "\n## 2. Spaces"), ["FRAME.md §12"]);
    let keys = |text| lost_keys(text, "\n| 2022 | x |\n| LAS | y |");
    assert_eq!(keys("[2022 §3.2, SPT §4] [x; 2] [`a`]"), ["SPT"]);
    assert_eq!(keys("[2021, tables 1 and 2] [LAS 1.4 R15, table 7] [2013]"), ["2021", "LAS 1.4 R15", "2013"]);
    assert_eq!(keys("[2022, table 2] [LAS §2.4] [Terms](TERMS.md) [ARG...] [1, 2]"), [""; 0]);
    assert_eq!(prose("a.rs", "let x = 1; // src/x.rs\ncode"), " src/x.rs");
}

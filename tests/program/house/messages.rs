//! The grammar of messages that count.

use super::{File, code, sources, without_tests};

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
    if file.is_of_tests() || file.path.starts_with("crates/lab/src/bench/") {
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

//! Formats are named by the list of them alone: no sentence and no help text beside it knows one.

use super::{File, sources, without_tests};

/// The folder of the formats and their list.
const FORMATS: &str = "crates/points/src/formats/";
/// Folders that may name formats, and why.
const MAY_NAME: [(&str, &str); 1] =
    [("crates/lab/src/synth/", "made-up scans are written, by writers of their own")];
/// Formats that scanwalk's own tables have, too.
const OWN: [&str; 1] = ["csv"];
/// Files whose comments on fields and variants are help texts.
const HELP: [&str; 2] = ["src/cli/", "src/config/table.rs"];

/// True if a format's name stands in a line of code or help: `LAS` as a word, `"las"`, or `.las` without a file's name
/// before it. Examples such as `castle.laz` are names of files.
fn has_name(line: &str, name: &str) -> bool {
    // A second point makes a range of it: `..xyz`.
    let is_part = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || matches!(c, '_' | '.'));
    let (upper, ending) = (name.to_uppercase(), format!(".{}", name.to_lowercase()));
    let stands_alone = |word: &str| {
        line.match_indices(word).any(|(at, _)| {
            !is_part(line[..at].chars().next_back()) && !is_part(line[at + word.len()..].chars().next())
        })
    };
    stands_alone(&upper) || stands_alone(&ending) || line.contains(&format!("\"{}\"", name.to_lowercase()))
}

/// Lines of a file that name a format.
fn named_formats(file: &File, names: &[String]) -> Vec<String> {
    if file.path.starts_with(FORMATS)
        || MAY_NAME.iter().any(|(folder, _)| file.path.starts_with(folder))
        || file.is_of_tests()
    {
        return Vec::new();
    }
    let is_help = HELP.iter().any(|path| file.path.starts_with(path));
    let said = |line: &str| {
        let line = line.trim_start().to_owned();
        match line.strip_prefix("/// ") {
            Some(help) if is_help => help.to_owned(),
            _ => line.split("//").next().unwrap_or_default().to_owned(),
        }
    };
    let lines = without_tests(file).lines().enumerate();
    let naming = lines.filter(|(_, line)| names.iter().any(|name| has_name(&said(line), name)));
    naming.map(|(at, line)| format!("{}:{}: {}", file.path, at + 1, line.trim())).collect()
}

#[test]
fn formats_are_named_by_their_list_alone() {
    let names = points::format_names("or").to_lowercase();
    let names = names.split([' ', ',']).filter(|name| !name.is_empty() && *name != "or").map(str::to_owned);
    let names = names.chain(points::format_endings()).filter(|name| !OWN.contains(&name.as_str()));
    let names: Vec<String> = names.collect();
    let faults: Vec<String> = sources().iter().flat_map(|file| named_formats(file, &names)).collect();
    assert!(faults.is_empty(), "take the names from points::format_names and the like: {faults:#?}");
    for (folder, reason) in MAY_NAME {
        assert!(sources().iter().any(|file| file.path.starts_with(folder)), "{folder} is gone: {reason}");
    }
}

#[test]
fn a_format_that_is_named_is_found() {
    let names = ["las", "laz", "ply"].map(String::from);
    let num =
        |path: &str, text: &str| named_formats(&File { path: path.into(), text: text.into() }, &names).len();
    for text in ["\"is not a LAS file\"", "[\"prj\", \"ply\"]", "\"FOLDER/*.laz\"", "\"name it .las or so\""]
    {
        assert_eq!(num("src/x.rs", text), 1, "{text}");
        assert_eq!(num("crates/points/src/formats/x.rs", text), 0, "{text}");
        assert_eq!(num("src/x.rs", &format!("#[cfg(test)]\nmod tests {{\n{text}\n}}")), 0, "{text}");
    }
    for text in [
        "\"scanwalk view castle.laz\"",
        "use las::Reader;",
        "// LAS has z up",
        "self.laz",
        "ATLAS",
        "/// LAS",
    ] {
        assert_eq!(num("src/x.rs", text), 0, "{text}");
    }
    assert_eq!(num("src/config/table.rs", "/// true: points that LAS files flag"), 1);
}

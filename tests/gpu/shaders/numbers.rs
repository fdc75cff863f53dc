//! Flags, masks and places of bits have names, which host and shaders share: numbers in their place are refused, in shaders
//! and in their CPU references. Floats of shaders have such names too.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Numbers that may stand where they do: file, number with its operator, and why.
const ALLOWED: [(&str, &str, &str); 23] = [
    ("boxes.wgsl", ">> 2u", "a box's edge by its vertex"),
    ("boxes.wgsl", ">> 1u", "a box's edge by its vertex"),
    ("overlay.wgsl", ">> 1u", "the corner of a triangle over the image"),
    ("scenery.wgsl", ">> 1u", "the corner of a triangle over the image"),
    ("depth-image.wgsl", ">> 1u", "the corner of a triangle over the image"),
    ("mirror.wgsl", "<< 1u", "the corner of a triangle over the image"),
    ("mirror.wgsl", "& 2u", "the corner of a triangle over the image"),
    ("nodes.inc.wgsl", ">> 1u", "two f16 in a word, which WGSL unpacks"),
    ("points.inc.wgsl", "<< vec4<u32>(1u)", "an octant's number: a bit an axis"),
    ("points.inc.wgsl", "<< vec4<u32>(2u)", "an octant's number: a bit an axis"),
    ("point_list.wgsl", "0x00800000u", "the smallest float that hardware does not take for 0"),
    ("points.rs", "<< 1", "an octant's number: a bit an axis"),
    ("points.rs", "<< 2", "an octant's number: a bit an axis"),
    ("cull.rs", "0xffff", "two f16 in a word, as WGSL unpacks them"),
    ("cull.rs", "& 0xffff", "two f16 in a word, as WGSL unpacks them"),
    ("overlay.wgsl", "4.0", "the corner of a triangle over the image"),
    ("scenery.wgsl", "4.0", "the corner of a triangle over the image"),
    ("depth-image.wgsl", "4.0", "the corner of a triangle over the image"),
    ("scenery.wgsl", "0.25", "the mean of four places in a pixel"),
    ("dilate.wgsl", "0.49", "less than a half, so that a square stays below"),
    ("boxes.wgsl", "0.001", "pixels of an edge that is too short to have a direction"),
    ("boxes.wgsl", "0.75", "half the width in pixels of an edge, at least"),
    ("boxes.wgsl", "1080.0", "pixels of height for which an edge is two pixels wide"),
];

/// Finds hexadecimal numbers, shifts by numbers or of numbers except 1, and masks that are numbers except 1, in code
/// without comments.
fn numbers(text: &str) -> Vec<String> {
    let code = without_comments(text);
    let mut found: Vec<String> = words(&code).filter(|word| word.starts_with("0x")).map(Into::into).collect();
    let is_number = |word: &str| word.starts_with(|c: char| c.is_ascii_digit());
    for operator in [" << ", " >> ", " & "] {
        for (at, _) in code.match_indices(operator) {
            let sign = operator.trim();
            let before = code[..at].rsplit(|c: char| !c.is_alphanumeric()).next().unwrap_or("");
            if is_number(before) && !is_one(before) {
                found.push(format!("{before} {sign}"));
            }
            let after = operand(&code[at + operator.len()..]);
            let inner = after.split_once('(').map_or(after, |(_, inner)| inner);
            let is_free = |word: &str| !is_number(word) || is_zero(word) || sign == "&" && is_one(word);
            if !words(inner).all(is_free) {
                found.push(format!("{sign} {after}"));
            }
        }
    }
    found
}

/// Finds floats in code without comments, except those that say nothing of their own: 0, a half, 1 and 2.
fn floats(text: &str) -> Vec<String> {
    let code = without_comments(text);
    let words = code.split(|c: char| !c.is_alphanumeric() && !matches!(c, '_' | '.'));
    let is_float = |word: &&str| {
        word.starts_with(|c: char| c.is_ascii_digit())
            && !word.starts_with("0x")
            && word.contains(['.', 'e', 'f', 'h'])
            && !matches!(*word, "0.0" | "0.5" | "1.0" | "2.0")
    };
    words.filter(is_float).map(Into::into).collect()
}

fn without_comments(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n")
}

/// An operand up to its end: a name or number, or a vector of these.
fn operand(code: &str) -> &str {
    let word = code.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(code.len());
    let is_vector = code.starts_with("vec") && code[word..].starts_with('<');
    match code.find(')') {
        Some(end) if is_vector => &code[..=end],
        _ => &code[..word],
    }
}

fn words(code: &str) -> impl Iterator<Item = &str> {
    code.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}

fn is_one(word: &str) -> bool {
    matches!(word, "1" | "1u" | "1lu")
}

fn is_zero(word: &str) -> bool {
    matches!(word, "0" | "0u" | "0lu")
}

/// The files of shaders and CPU references.
fn files() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let in_folder = |folder: &str| {
        let entries = std::fs::read_dir(root.join(folder)).expect("a folder");
        entries.map(|entry| entry.expect("an entry").path()).filter(|path| path.is_file())
    };
    ["shaders", "shaders/methods", "shaders/spt", "crates/lab/src/reference", "crates/lab/src/reference/tree"]
        .into_iter()
        .flat_map(in_folder)
        .collect()
}

#[test]
fn shaders_and_references_have_names_for_numbers() {
    let mut used = BTreeSet::new();
    for path in files() {
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&path).expect("a text");
        let floats = if name.ends_with(".wgsl") { floats(&text) } else { Vec::new() };
        for number in numbers(&text).into_iter().chain(floats) {
            let allowed = ALLOWED.iter().position(|(file, text, _)| *file == name && *text == number);
            used.insert(allowed.unwrap_or_else(|| panic!("{}: '{number}' has no name", path.display())));
        }
    }
    let idle: Vec<_> = (0..ALLOWED.len()).filter(|i| !used.contains(i)).map(|i| ALLOWED[i]).collect();
    assert!(idle.is_empty(), "these are no longer there: {idle:?}");
}

#[test]
fn numbers_in_place_of_names_are_noticed() {
    let same = |code: &str, want: &[&str]| assert_eq!(numbers(code), want, "{code}");
    same("(flags & (16u << eye)) != 0u", &["16u <<"]);
    same("x & 0x3ffu", &["0x3ffu", "& 0x3ffu"]);
    same("hi >> vec4<u32>(10u)", &[">> vec4<u32>(10u)"]);
    same("word >> vec3<u32>(0u, 8u, BLUE_SHIFT)", &[">> vec3<u32>(0u, 8u, BLUE_SHIFT)"]);
    same("color >> (8 * channel) & 255", &["& 255"]);
    same("u64(a) << 32u", &["<< 32u"]);
    same("let x = id >> 1;", &[">> 1"]);
    // Names, bits, and what only looks like a shift, are allowed.
    same("(1u << SHIFT) - 1u; x & MASK; x & 1u; x >> vec3<u32>(0u, GREEN_SHIFT, BLUE_SHIFT)", &[]);
    same("var<storage, read> a: array<vec2<u32>>; bitcast<vec4<u32>>(1.0); // x << 8u, 0xff", &[]);
}

#[test]
fn floats_in_place_of_names_are_noticed() {
    let same = |code: &str, want: &[&str]| assert_eq!(floats(code), want, "{code}");
    same("const ALPHA: vec2<f32> = vec2<f32>(0.22, 0.9);", &["0.22", "0.9"]);
    same("pow((c+0.055)/1.055, vec3<f32>(2.4)) - 1e-3", &["0.055", "1.055", "2.4", "1e"]);
    same("x*-4.0; 3f; 14.", &["4.0", "3f", "14."]);
    // Plain numbers, names, members, whole numbers and comments are allowed.
    same("0.5 * a.x1 + 2.0 * OCTAVES - view.near - 12; 0x1fu; vec3f(0.0) // 0.7", &[]);
}

//! Says in words what a file of no readable format looks like, so that the message helps.

use super::{Candidate, format_names, splat_format_names};
use crate::ScanError;

/// Advice for a file of a kind that other programs convert; [`NAMES`] stands for the names of all readable formats.
const CONVERT: &str = "this is not supported yet, convert it to FORMATS";
/// Advice for a Gaussian splat of another format; [`SPLAT_NAMES`] stands for the names of the formats that hold splats.
const EXPORT_SPLAT: &str = "export it as SPLATS";
/// Advice for an archive.
const UNPACK: &str = "unpack it, and name the FORMATS files in it";
/// Advice for a file that is no scan.
const OTHER: &str = "name a FORMATS file";
/// Stands in an advice for the names of the formats that can be read.
const NAMES: &str = "FORMATS";
/// Stands in an advice for the names of the formats whose files may hold splats.
const SPLAT_NAMES: &str = "SPLATS";

/// First bytes of a file, what it is, and what to do.
const SIGNATURES: &[(&[u8], &str, &str)] = &[
    (b"\x1f\x9d", "it is a compressed file (.Z)", UNPACK),
    // In an archive of the kinds that are opened, there is one more.
    (b"PK\x03\x04", "it is a ZIP archive", UNPACK),
    (b"\x1f\x8b", "it is a gzip archive", UNPACK),
    (b"\x28\xb5\x2f\xfd", "it is a Zstandard archive", UNPACK),
    (b"\x04\x22\x4d\x18", "it is an LZ4 archive", UNPACK),
    (b"7z\xbc\xaf\x27\x1c", "it is a 7-Zip archive", UNPACK),
    (b"\xfd7zXZ\0", "it is an xz archive", UNPACK),
    (b"BZh", "it is a bzip2 archive", UNPACK),
    (b"Rar!\x1a\x07", "it is a RAR archive", UNPACK),
    (b"glTF", "it is a glTF model", CONVERT),
    (b"Kaydara FBX Binary", "it is an FBX model", CONVERT),
    (b"solid ", "it is an STL model", CONVERT),
    (b"OFF\n", "it is an OFF model", CONVERT),
    (b"\x89HDF\r\n\x1a\n", "it is an HDF5 file", CONVERT),
    (b"CCB2", "it is a CloudCompare entity", CONVERT),
    (b"pnts", "it is a tile of 3D Tiles", CONVERT),
    (b"b3dm", "it is a tile of 3D Tiles", CONVERT),
    (b"# vtk DataFile", "it is a VTK file", CONVERT),
    (b"AC10", "it is a DWG drawing", CONVERT),
    (b"  0\nSECTION", "it is a DXF drawing", CONVERT),
    (b"  0\r\nSECTION", "it is a DXF drawing", CONVERT),
    (b"\x93NUMPY", "it is a NumPy array", CONVERT),
    (b"PAR1", "it is a Parquet table", CONVERT),
    (b"SQLite format 3\0", "it is an SQLite database", OTHER),
    (b"II*\0", "it is a TIFF picture", OTHER),
    (b"MM\0*", "it is a TIFF picture", OTHER),
    (b"\x89PNG", "it is a PNG picture", OTHER),
    (b"\xff\xd8\xff", "it is a JPEG picture", OTHER),
    (b"%PDF", "it is a PDF document", OTHER),
];

/// Files that begin as archives do, or with nothing that tells them: their ending, their first bytes, what they are,
/// and what to do.
const ENDINGS: &[(&str, &[u8], &str, &str)] = &[
    // An SPZ file is packed with gzip, but holds nothing that a user could unpack.
    ("spz", b"\x1f\x8b", "it is a compressed Gaussian splat (SPZ)", EXPORT_SPLAT),
    ("splat", b"", "it is a Gaussian splat without a header", EXPORT_SPLAT),
    ("ksplat", b"", "it is a compressed Gaussian splat (KSPLAT)", EXPORT_SPLAT),
    ("usdz", b"PK", "it is a USDZ model", CONVERT),
    ("3mf", b"PK", "it is a 3MF model", CONVERT),
    ("kmz", b"PK", "it is a KMZ file of places on a map", OTHER),
];

/// The byte at which a tar archive says that it is one, and the bytes there.
const TAR: (usize, &[u8]) = (257, b"ustar");

/// True for a file whose ending says what it is, although it begins as an archive does, or as anything.
pub(super) fn is_told_by_ending(candidate: &Candidate) -> bool {
    by_ending(candidate).is_some()
}

/// What a file is by its ending, and what to do.
fn by_ending(candidate: &Candidate) -> Option<(&'static str, &'static str)> {
    let Candidate { path, head, .. } = *candidate;
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    let is_it = |(known, start, ..): &&(&str, &[u8], &str, &str)| {
        ending == *known && !head.is_empty() && head.starts_with(start)
    };
    ENDINGS.iter().find(is_it).map(|(_, _, what, advice)| (*what, *advice))
}

/// The error for a file or a folder that has no reader.
pub(crate) fn not_a_scan(candidate: &Candidate) -> ScanError {
    let Candidate { path, is_folder, head } = *candidate;
    if is_folder {
        return ScanError::folder(path);
    }
    let (looks_like, advice) = match by_ending(candidate) {
        Some((what, advice)) => (what.to_owned(), advice),
        None => describe(head),
    };
    let advice = advice.replace(NAMES, &format_names("or")).replace(SPLAT_NAMES, &splat_format_names());
    ScanError::NotAScan { path: path.to_owned(), looks_like, advice }
}

fn describe(head: &[u8]) -> (String, &'static str) {
    if head.is_empty() {
        return ("it is empty".into(), "copy or download it again");
    }
    if head.iter().all(|&byte| byte == 0) {
        return ("it starts with zeros only".into(), "its copy or download was not completed: get it again");
    }
    if head.starts_with(b"version https://git-lfs") {
        let advice = "fetch the real file with `git lfs pull`";
        return ("it is a Git LFS pointer, a note of where the real file lies".into(), advice);
    }
    if let Some((_, what, advice)) = SIGNATURES.iter().find(|(signature, ..)| head.starts_with(signature)) {
        return ((*what).into(), advice);
    }
    if head.get(TAR.0..).is_some_and(|rest| rest.starts_with(TAR.1)) {
        return ("it is a tar archive".into(), UNPACK);
    }
    if head.starts_with(b"\xff\xfe") || head.starts_with(b"\xfe\xff") {
        return (
            "it is text of two bytes a character (UTF-16)".into(),
            "save it as plain text (ASCII or UTF-8)",
        );
    }
    // Some editors write a byte order mark first.
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    if head.starts_with(b"<") {
        return ("it is XML or a web page".into(), "check where it was downloaded from");
    }
    if head.starts_with(b"{") {
        return ("it is JSON".into(), CONVERT);
    }
    if is_text(head) {
        return describe_text(&String::from_utf8_lossy(head));
    }
    let start: Vec<String> = head.iter().take(4).map(|byte| format!("{byte:02x}")).collect();
    let looks_like = format!("it starts with the bytes {}, as no scan does", start.join(" "));
    (looks_like, "it is damaged or of another kind; get it again or convert it to FORMATS")
}

/// Describes text by its first lines that are no comments.
fn describe_text(text: &str) -> (String, &'static str) {
    let is_said = |line: &&str| !line.is_empty() && !line.starts_with('#');
    let mut lines = text.lines().map(str::trim).filter(is_said);
    let first = lines.next().unwrap_or_default();
    // Canadian Well Logging Society: a "Log ASCII Standard" file has sections that start at ~V.
    if first.starts_with('~') {
        let what =
            "it is a well log (CWLS Log ASCII Standard), which has only its ending in common with scans";
        return (what.into(), "name a file of a laser scanner");
    }
    let is_number = |word: &str| word.parse::<f64>().is_ok();
    let words = |line: &str| {
        let words = line.split([' ', '\t', ',', ';']).filter(|word| !word.is_empty());
        words.map(str::to_owned).collect::<Vec<String>>()
    };
    let rows = std::iter::once(first).chain(lines).map(words);
    let is_row = |row: &Vec<String>| row.len() >= 3 && row[..3].iter().all(|word| is_number(word));
    let is_corner = |row: &Vec<String>| row.first().is_some_and(|word| word == "v" || word == "mtllib");
    let rows: Vec<Vec<String>> = rows.collect();
    if rows.iter().any(is_corner) {
        return ("it is an OBJ model".into(), CONVERT);
    }
    if first.to_ascii_lowercase().starts_with("ncols") {
        return ("it is a grid of heights (ESRI ASCII)".into(), CONVERT);
    }
    if rows.iter().any(is_row) {
        let what = "it is text with rows of numbers, among much else";
        return (what.into(), "save it with one point a line, x, y and z first, and nothing before them");
    }
    ("it is text, but no rows of numbers".into(), "check that this is the file you mean; name a FORMATS file")
}

/// True if all characters are printable or white space. A multi-byte character cut off at the end does not count
/// against it.
pub(super) fn is_text(head: &[u8]) -> bool {
    let text = match std::str::from_utf8(head) {
        Ok(text) => text,
        Err(error) if error.error_len().is_none() => {
            std::str::from_utf8(&head[..error.valid_up_to()]).unwrap_or_default()
        }
        Err(_) => return false,
    };
    !text.is_empty() && text.chars().all(|c| !c.is_control() || c.is_whitespace())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn says_what_it_sees_and_what_to_do() {
        let tar = [&[b'a'; 257][..], b"ustar\x0000"].concat();
        let cases: [(&[u8], &str, &str); 23] = [
            (b"", "empty", "again"),
            (&[0; 512], "zeros", "get it again"),
            (b"version https://git-lfs.github.com/spec/v1\noid sha256:", "Git LFS", "git lfs pull"),
            (b"CCB2\x01\0\0\0", "CloudCompare", "convert it to LAS"),
            (b"  0\r\nSECTION\r\n", "DXF", "convert it to LAS"),
            (b"# vtk DataFile Version 3.0\n", "VTK", "convert it to LAS"),
            (b"  <html>", "web page", "downloaded"),
            (b"PK\x03\x04\x14\0", "ZIP archive", "unpack it"),
            (b"\x1f\x8b\x08", "gzip", "unpack it"),
            (b"\x28\xb5\x2f\xfd\0", "Zstandard", "unpack it"),
            (b"7z\xbc\xaf\x27\x1c\0", "7-Zip", "unpack it"),
            (b"\xfd7zXZ\0\0", "xz", "unpack it"),
            (b"BZh91AY", "bzip2", "unpack it"),
            (b"Rar!\x1a\x07\x01", "RAR", "unpack it"),
            (&tar, "tar", "unpack it"),
            ("Notes\nof\n1.0 2.0 3.0 \u{e9}\n".as_bytes(), "rows of numbers", "one point a line"),
            (b"NCOLS 5\nNROWS 4\n1 2 3 4 5\n", "grid of heights", "convert it to LAS"),
            (b"\xff\xfe1\0 \0", "UTF-16", "UTF-8"),
            (b"# made by hand\nmtllib a.mtl\nv 1 2 3\n", "OBJ", "convert"),
            (b"Meeting on 1 2 3\nNothing decided\n", "no rows of numbers", "the file you mean"),
            (b"~VERSION INFORMATION\n VERS. 2.0 :\n", "well log", "of a laser scanner"),
            (b"# converted\n\n~V\nVERS. 3.0\n~A\n1 2 3\n", "well log", "of a laser scanner"),
            (b"\x8f\x00\x01\x02", "8f 00 01 02", "convert"),
        ];
        let said = |name: &str, head: &[u8]| {
            not_a_scan(&Candidate { path: Path::new(name), is_folder: false, head }).to_string()
        };
        for (head, expected, advice) in cases {
            let message = said("a.las", head);
            let says = message.contains(expected) && message.contains(advice);
            assert!(message.starts_with("a.las: ") && says, "{message}");
        }
        for (name, head, expected, advice) in [
            ("a.SPZ", &b"\x1f\x8b\x08"[..], "Gaussian splat", "export it as PLY"),
            ("a.splat", &[7, 0, 1, 2], "Gaussian splat", "export it as PLY"),
            ("a.usdz", b"PK\x03\x04", "USDZ", "convert it to LAS"),
            ("a.usdz", b"\x1f\x8b\x08", "gzip", "unpack it"),
            ("a.splat", b"", "empty", "again"),
        ] {
            let message = said(name, head);
            assert!(message.contains(expected) && message.contains(advice), "{message}");
        }
    }

    #[test]
    fn text_cut_in_a_character_is_text_and_binary_is_not() {
        assert!(is_text(&"abc é".as_bytes()[..5]));
        assert!(!is_text(b"abc\xff\xfedef"));
        assert!(!is_text(b"abc\0"));
    }
}

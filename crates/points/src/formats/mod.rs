//! The formats that can be read: one list, from which all else takes their names.

mod las;
mod ply;
mod sniff;

use crate::block::{Block, Trailer};
use crate::source::Source;
use crate::{Header, Projection, ScanError, Schema};
use base::task::Progress;
use std::path::Path;

/// One file format. To add one: a folder beside this file, and an entry in [`FORMATS`].
pub(crate) trait Format: Sync {
    /// Its names, as people write them: one for each kind of file, whose ending is the name too.
    fn names(&self) -> &'static [&'static str];

    /// True if it is of this format. A format that is known by its content looks at nothing else.
    fn probe(&self, candidate: &Candidate) -> bool;

    /// Opens the file or folder, reads and checks its header.
    fn open(&self, path: &Path) -> Result<Box<dyn Dataset>, ScanError>;
}

/// What a user named, as far as it is seen before anybody knows its format.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate<'a> {
    /// Where it is, and what it is called.
    pub path: &'a Path,
    /// True for a folder, which may be a scan of many files.
    pub is_folder: bool,
    /// A file's first bytes, up to [`HEAD_BYTES`]; none of a folder.
    pub head: &'a [u8],
}

/// An opened file.
///
/// A format decodes on all cores as it sees fit, and holds only the block that it hands over and those in work. Memory
/// is taken for points that can be read, never for those that a header claims. Damaged points are left out and reported
/// at the end. (A tree of nodes, each a block, is a dataset too: its nodes come in the order of the file.)
pub trait Dataset {
    /// What the file says of itself.
    fn header(&self) -> &Header;

    /// The attributes that the file stores for each point.
    fn schema(&self) -> &Schema;

    /// Hands over all points that can be read, at least one, in file order, with the wanted attributes that the file
    /// has.
    ///
    /// # Errors
    /// Nothing can be read, the user stops it, there is no memory, or `take` fails.
    fn read(&self, want: &Projection, take: &mut Take, progress: &Progress) -> Result<Trailer, ScanError>;
}

/// Takes in a block.
pub type Take<'a> = dyn FnMut(Block) -> Result<(), ScanError> + Send + 'a;

/// All formats that can be read.
const FORMATS: [&dyn Format; 2] = [&las::Las, &ply::Ply];
/// Bytes from a file's start that tell its format.
const HEAD_BYTES: u64 = 512;

/// Opens a file of any format, and reads its header.
///
/// # Errors
/// It cannot be opened, is of no format that can be read, or has no readable header.
pub fn open(path: &Path) -> Result<Box<dyn Dataset>, ScanError> {
    open_as(&FORMATS, path)
}

/// Opens a file or a folder of one of these formats.
fn open_as(formats: &[&dyn Format], path: &Path) -> Result<Box<dyn Dataset>, ScanError> {
    let is_folder = path.is_dir();
    let head = if is_folder { Vec::new() } else { Source::open(path)?.bytes(0, HEAD_BYTES)? };
    let candidate = Candidate { path, is_folder, head: &head };
    match formats.iter().find(|format| format.probe(&candidate)) {
        Some(format) => format.open(path),
        None => Err(sniff::not_a_scan(&candidate)),
    }
}

/// The endings of files of all formats, in lower case.
pub fn format_endings() -> impl Iterator<Item = String> {
    FORMATS.iter().flat_map(|format| format.names()).map(|name| name.to_ascii_lowercase())
}

/// The names of all formats in a sentence, with this word before the last: "LAS, LAZ or PLY".
#[must_use]
pub fn format_names(before_last: &str) -> String {
    let names: Vec<&str> = FORMATS.iter().flat_map(|format| format.names()).copied().collect();
    match names.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} {before_last} {last}", others.join(", ")),
        _ => names.concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A made-up format whose files and folders have names that end in `.named`, whatever is in them.
    struct Named;

    impl Format for Named {
        fn names(&self) -> &'static [&'static str] {
            &["NAMED"]
        }

        fn probe(&self, candidate: &Candidate) -> bool {
            let has_content = candidate.is_folder == candidate.head.is_empty();
            has_content && candidate.path.extension().is_some_and(|ending| ending == "named")
        }

        fn open(&self, path: &Path) -> Result<Box<dyn Dataset>, ScanError> {
            Err(ScanError::NoPoints { path: path.to_owned(), reason: "it is made up".into() })
        }
    }

    #[test]
    fn a_format_may_be_known_by_its_name_and_may_be_a_folder() {
        let folder = tempfile::tempdir().unwrap();
        let error = |formats: &[&dyn Format], name: &str| {
            open_as(formats, &folder.path().join(name)).err().expect("no points").to_string()
        };
        std::fs::write(folder.path().join("a.named"), "1 2 3").unwrap();
        std::fs::write(folder.path().join("a.txt"), "1 2 3").unwrap();
        std::fs::write(folder.path().join("las.named"), "LASF").unwrap();
        std::fs::create_dir(folder.path().join("tiles.named")).unwrap();
        std::fs::create_dir(folder.path().join("tiles")).unwrap();
        let all: [&dyn Format; 3] = [&las::Las, &ply::Ply, &Named];
        for name in ["a.named", "tiles.named"] {
            assert!(error(&all, name).contains("it is made up"), "{name}");
        }
        // The formats before it decide by the content.
        assert!(error(&all, "las.named").contains("header"), "{}", error(&all, "las.named"));
        assert!(error(&all, "a.txt").contains("rows of numbers"));
        assert!(error(&all, "tiles").contains("is a folder"));
        assert!(error(&FORMATS, "a.named").contains("rows of numbers"));
        assert!(error(&FORMATS, "tiles.named").contains("is a folder"));
    }
}

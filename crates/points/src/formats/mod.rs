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

    /// True if a file that starts with `head` (up to [`HEAD_BYTES`]) is of this format.
    fn probe(&self, head: &[u8]) -> bool;

    /// Reads and checks the header.
    fn open(&self, source: Source) -> Result<Box<dyn Dataset>, ScanError>;
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
    let source = Source::open(path)?;
    let head = source.bytes(0, HEAD_BYTES)?;
    match FORMATS.iter().find(|format| format.probe(&head)) {
        Some(format) => format.open(source),
        None => Err(sniff::not_a_scan(path, &head)),
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

//! Archives: files of any format that are packed as ZIP, gzip or Zstandard, opened as if they were unpacked.
//!
//! Members are unpacked to a temporary file before any is opened, because readers go back and forth. Which members are
//! scans, their first bytes tell; a scan that is a folder of files is not looked for.

#[cfg(test)]
mod archive_tests;
mod pour;
mod zip;

use super::zstd::{MOST_WINDOW, ZstdReader};
use super::{Candidate, Format, HEAD_BYTES, sniff};
use crate::ScanError;
use crate::source::Source;
use crate::unpacked::UnpackRoom;
use base::task::{Progress, Task};
use flate2::bufread::{DeflateDecoder, MultiGzDecoder};
use pour::{CountedReader, PourLimit, Poured};
use std::ffi::OsStr;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// What the names of archives end in.
pub(super) const ENDINGS: [&str; 3] = ["zip", "gz", "zst"];
/// Bytes of an archive that are read at once.
const BUFFER_BYTES: usize = 1 << 18;
/// Folder of what macOS notes of members.
const NOTES: &str = "__MACOSX/";

/// How an archive is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ArchiveKind {
    /// ZIP, of many members.
    Zip,
    /// gzip, of one member.
    Gzip,
    /// Zstandard, of one member.
    Zstandard,
}

impl ArchiveKind {
    /// The kind of an archive; `None` for a file that is none.
    pub fn of(candidate: &Candidate) -> Option<Self> {
        let head = candidate.head;
        let is_zip = head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06");
        let kind = match head {
            _ if is_zip => Self::Zip,
            [0x1f, 0x8b, 8, ..] => Self::Gzip,
            [0x28, 0xb5, 0x2f, 0xfd, ..] => Self::Zstandard,
            _ => return None,
        };
        // Some formats are packed, and nothing that a user could unpack.
        (!sniff::is_told_by_ending(candidate)).then_some(kind)
    }
}

/// Archives whose members are unpacked, which lasts as long as this does.
#[derive(Debug, Default)]
pub(crate) struct Archives {
    room: Option<UnpackRoom>,
    /// Members that are left out, and why, as ends of sentences.
    pub left_out: Vec<(PathBuf, String)>,
}

/// An archive that is being unpacked.
struct OpenArchive<'a> {
    formats: &'a [&'a dyn Format],
    source: &'a Source,
    room: &'a mut UnpackRoom,
    limit: PourLimit,
    progress: Progress,
}

impl Archives {
    /// The names under which the members of an archive are found that are of one of these formats, in the order of their
    /// names; the path itself of a file that is no archive.
    ///
    /// # Errors
    /// The user stops it, the archive cannot be unpacked, or no member is of such a format.
    pub fn members(
        &mut self,
        formats: &[&dyn Format],
        path: &Path,
        task: &Task,
    ) -> Result<Vec<PathBuf>, ScanError> {
        // What cannot be opened says why when it is opened as a scan.
        let Ok(source) = Source::open(path) else { return Ok(vec![path.to_owned()]) };
        let head = source.bytes(0, HEAD_BYTES)?;
        let candidate = Candidate { path, is_folder: false, head: &head };
        let is_scan = formats.iter().any(|format| format.probe(&candidate));
        let Some(kind) = ArchiveKind::of(&candidate).filter(|_| !is_scan) else {
            return Ok(vec![path.to_owned()]);
        };
        let fail = |problem| ScanError::Archive { path: path.to_owned(), problem };
        let no_file = |error: io::Error| {
            let folder = std::env::temp_dir();
            fail(format!("no temporary file can be made in {}: {error}", folder.display()))
        };
        let room = match self.room.take() {
            Some(room) => room,
            None => UnpackRoom::new().map_err(no_file)?,
        };
        let progress = task.begin("unpacking", "bytes", source.len());
        let limit = PourLimit::of(source.len());
        let room = self.room.insert(room);
        let mut archive = OpenArchive { formats, source: &source, room, limit, progress };
        match kind {
            ArchiveKind::Zip => archive.zip(&mut self.left_out),
            ArchiveKind::Gzip => archive.alone(|packed| Box::new(MultiGzDecoder::new(packed))),
            ArchiveKind::Zstandard => archive.alone(|packed| Box::new(ZstdReader::new(packed, MOST_WINDOW))),
        }
    }
}

impl OpenArchive<'_> {
    /// Unpacks the only member of an archive.
    fn alone<'s>(
        &'s mut self,
        unpacking: impl FnOnce(CountedReader<'s, Box<dyn BufRead + 's>>) -> Box<dyn Read + 's>,
    ) -> Result<Vec<PathBuf>, ScanError> {
        let Self { formats, source, room, limit, progress } = self;
        let archive = source.path();
        let name = named(archive, Path::new(archive.file_stem().unwrap_or(OsStr::new("file"))));
        let packed: Box<dyn BufRead> = Box::new(BufReader::with_capacity(BUFFER_BYTES, source.reader(0)));
        let mut unpacked = unpacking(CountedReader { packed, progress });
        let head = head(&mut *unpacked);
        let head = head.map_err(|error| ScanError::Archive {
            path: archive.to_owned(),
            problem: format!("it is damaged ({error}); get it again"),
        })?;
        let candidate = Candidate { path: &name, is_folder: false, head: &head };
        if !is_of_one(formats, &candidate) {
            return Err(sniff::not_a_scan(&candidate));
        }
        let poured = Poured { archive, name: &name, crc: None, head: &head };
        poured.into(room, &mut *unpacked, limit, progress)?;
        Ok(vec![name])
    }

    /// Unpacks all members that are scans.
    fn zip(&mut self, all_left_out: &mut Vec<(PathBuf, String)>) -> Result<Vec<PathBuf>, ScanError> {
        let Self { formats, source, room, limit, progress } = self;
        let archive = source.path();
        let fail = |problem| ScanError::Archive { path: archive.to_owned(), problem };
        let members = zip::members(source)?.map_err(fail)?;
        let (mut names, mut first_problem) = (Vec::new(), None);
        let num_before = all_left_out.len();
        for member in members.iter().filter(|member| !member.name.starts_with(NOTES)) {
            let name = named(archive, Path::new(&member.name));
            let mut left_out = |reason: String| {
                first_problem.get_or_insert_with(|| format!("{}: {reason}", name.display()));
                all_left_out.push((name.clone(), reason));
            };
            if member.is_encrypted {
                // What it is cannot be seen, so only its name tells whether anybody misses it.
                if super::is_named_as_scan(Path::new(&member.name)) {
                    left_out("is encrypted; unpack the archive yourself".into());
                }
                continue;
            }
            let offset = match member.data_offset(source)? {
                Ok(offset) => offset,
                Err(reason) => {
                    left_out(reason);
                    continue;
                }
            };
            let packed =
                BufReader::with_capacity(BUFFER_BYTES, source.reader(offset)).take(member.packed_bytes);
            let packed = CountedReader { packed, progress };
            let mut unpacked: Box<dyn Read> = match member.method {
                0 => Box::new(packed),
                8 => Box::new(DeflateDecoder::new(packed)),
                93 => Box::new(ZstdReader::new(packed, MOST_WINDOW)),
                method => {
                    if super::is_named_as_scan(Path::new(&member.name)) {
                        left_out(format!(
                            "is packed by method {method}, which is not known; unpack the archive yourself"
                        ));
                    }
                    continue;
                }
            };
            let head = match head(&mut *unpacked) {
                Ok(head) => head,
                Err(error) => {
                    left_out(format!("is damaged ({error})"));
                    continue;
                }
            };
            let candidate = Candidate { path: &name, is_folder: false, head: &head };
            if is_of_one(formats, &candidate) {
                let poured = Poured { archive, name: &name, crc: Some(member.crc), head: &head };
                poured.into(room, &mut *unpacked, limit, progress)?;
                names.push(name);
            }
        }
        if names.is_empty() {
            // The error says it.
            all_left_out.truncate(num_before);
            return Err(fail(first_problem.unwrap_or_else(|| {
                let formats = super::format_names("or");
                format!("it has no {formats} file in it; scans that are folders have to be unpacked first")
            })));
        }
        Ok(names)
    }
}

/// The first bytes, as many as tell a format; fewer if the rest is damaged.
fn head(unpacked: &mut dyn Read) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    match unpacked.take(HEAD_BYTES).read_to_end(&mut head) {
        Err(error) if head.is_empty() => Err(error),
        // The damage shows again when the rest is unpacked.
        _ => Ok(head),
    }
}

/// True if a member is of one of these formats. Formats of folders need files that lie beside.
fn is_of_one(formats: &[&dyn Format], candidate: &Candidate) -> bool {
    formats.iter().any(|format| !format.opens_folders() && format.probe(candidate))
}

/// The name of a member for people: "scans.zip: room.laz".
fn named(archive: &Path, member: &Path) -> PathBuf {
    let mut name = archive.as_os_str().to_owned();
    name.push(": ");
    name.push(member);
    name.into()
}

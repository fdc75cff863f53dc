//! The formats that can be read: one list, from which all else takes their names.

mod archive;
mod e57;
mod ept;
mod las;
mod measured;
mod names;
mod node;
mod number;
mod pcd;
mod plan;
mod ply;
mod potree;
mod ptx;
mod rows;
mod sniff;
mod text;
mod zstd;

use crate::block::{Block, Trailer};
use crate::source::Source;
use crate::{Attribute, Column, ColumnNames, Header, Projection, ScanError};
use archive::ArchiveKind;
use base::task::{CancelToken, Progress, Task};
use base::words::counted;
use std::path::{Path, PathBuf};

pub(crate) use archive::Archives;

/// One file format. To add one: a folder beside this file, and an entry in [`FORMATS`].
pub(crate) trait Format: Sync {
    /// Its names, as people write them: one for each kind of file.
    fn names(&self) -> &'static [&'static str];

    /// What the names of its files end in, in lower case, where these are not the format's names: `"las"`, or the whole
    /// name of a file that all scans have.
    fn endings(&self) -> Option<&'static [&'static str]> {
        None
    }

    /// Endings of files that lie beside its files and hold no points, in lower case. Those that lie beside files of any
    /// format are known already.
    fn sidecars(&self) -> &'static [&'static str] {
        &[]
    }

    /// True if a folder may be a scan of this format.
    fn opens_folders(&self) -> bool {
        false
    }

    /// The one file that stands for a scan of several, if `path` names such a scan, by whatever of its files or its
    /// folder.
    fn main_file(&self, _path: &Path) -> Option<PathBuf> {
        None
    }

    /// True if its files may hold Gaussian splats.
    fn has_splats(&self) -> bool {
        false
    }

    /// True if it is of this format. A format that is known by its content looks at nothing else.
    fn probe(&self, candidate: &Candidate) -> bool;

    /// Opens the file or folder, reads and checks its header. `hints` say what a file may not say itself.
    fn open(&self, path: &Path, hints: &OpenHints) -> Result<Box<dyn Dataset>, ScanError>;
}

/// What a user says of files that they do not say themselves, and that is needed to open them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OpenHints {
    /// Columns of text.
    pub columns: ColumnNames,
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
    /// What the file says of itself, and what it stores for each point.
    fn header(&self) -> &Header;

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
const FORMATS: [&dyn Format; 8] =
    [&las::Las, &ply::Ply, &pcd::Pcd, &e57::E57, &ptx::Ptx, &ept::Ept, &potree::Potree, &text::Text];
/// Bytes from a file's start that tell its format.
const HEAD_BYTES: u64 = 512;

/// Opens a file of any format, and reads its header. The first scan in an archive is opened, once it is
/// unpacked.
///
/// # Errors
/// It cannot be opened, is of no format that can be read, or has no readable header.
pub fn open(path: &Path, hints: &OpenHints) -> Result<Box<dyn Dataset>, ScanError> {
    open_as(&FORMATS, path, hints)
}

/// Opens a file or a folder of one of these formats.
fn open_as(formats: &[&dyn Format], path: &Path, hints: &OpenHints) -> Result<Box<dyn Dataset>, ScanError> {
    let source = if path.is_dir() { None } else { Some(Source::open(path)?) };
    let head = source.as_ref().map(|source| source.bytes(0, HEAD_BYTES)).transpose()?.unwrap_or_default();
    let is_folder = source.is_none();
    let candidate = Candidate { path, is_folder, head: &head };
    let may_be = |format: &&&dyn Format| (!is_folder || format.opens_folders()) && format.probe(&candidate);
    match formats.iter().find(may_be) {
        Some(format) => {
            let dataset = CheckedDataset(format.open(path, hints)?);
            match source.as_ref().and_then(Source::loss) {
                Some(loss) => Ok(Box::new(UnpackedDataset::of(Box::new(dataset), Some(loss.to_owned())))),
                None => Ok(Box::new(dataset)),
            }
        }
        None if ArchiveKind::of(&candidate).is_some() => open_first(formats, &candidate, hints),
        None => Err(sniff::not_a_scan(&candidate)),
    }
}

/// Opens the first scan in an archive.
fn open_first(
    formats: &[&dyn Format],
    archive: &Candidate,
    hints: &OpenHints,
) -> Result<Box<dyn Dataset>, ScanError> {
    let mut archives = Archives::default();
    let members = archives.members(formats, archive.path, &Task::new(&CancelToken::default()))?;
    let Some((first, others)) = members.split_first().filter(|(first, _)| *first != archive.path) else {
        return Err(sniff::not_a_scan(archive));
    };
    let mut dataset = UnpackedDataset::of(open_as(formats, first, hints)?, None);
    if !others.is_empty() {
        let more = counted(others.len(), "more scan");
        dataset.header.warnings.push(format!("is in an archive with {more}, of which nothing is read"));
    }
    Ok(Box::new(UnpackedDataset { _archives: archives, ..dataset }))
}

/// A member of an archive.
struct UnpackedDataset {
    dataset: Box<dyn Dataset>,
    header: Header,
    /// What could not be unpacked of it, as a sentence whose subject is the member.
    loss: Option<String>,
    /// What keeps it unpacked, if nobody else does.
    _archives: Archives,
}

impl UnpackedDataset {
    fn of(dataset: Box<dyn Dataset>, loss: Option<String>) -> Self {
        let header = dataset.header().clone();
        Self { dataset, header, loss, _archives: Archives::default() }
    }
}

impl Dataset for UnpackedDataset {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&self, want: &Projection, take: &mut Take, progress: &Progress) -> Result<Trailer, ScanError> {
        let mut end = self.dataset.read(want, take, progress)?;
        end.losses.splice(0..0, self.loss.clone());
        Ok(end)
    }
}

/// A dataset whose blocks are compared with its schema before anybody gets them.
struct CheckedDataset(Box<dyn Dataset>);

impl Dataset for CheckedDataset {
    fn header(&self) -> &Header {
        self.0.header()
    }

    fn read(&self, want: &Projection, take: &mut Take, progress: &Progress) -> Result<Trailer, ScanError> {
        let Header { path, schema, .. } = self.header();
        let mut take_checked = |block: Block| {
            let is_right = |(attribute, column): &&(Attribute, Column)| {
                let is_wanted = want.wants(attribute);
                let is_of_its_type = schema
                    .fields
                    .iter()
                    .any(|field| (&field.attribute, field.kind) == (attribute, column.kind()));
                is_wanted && is_of_its_type && column.num_values().is_none_or(|num| num == block.xyz.len())
            };
            match block.columns.iter().find(|column| !is_right(column)) {
                Some((attribute, column)) => Err(ScanError::Column {
                    path: path.clone(),
                    attribute: attribute.clone(),
                    kind: column.kind(),
                }),
                None => take(block),
            }
        };
        self.0.read(want, &mut take_checked, progress)
    }
}

/// Columns of x, y and z among names, as all formats know them.
pub(crate) fn place_of(names: &[&str]) -> Option<[usize; 3]> {
    names::place(names)
}

/// The one file that stands for a scan of several files, if a path names such a scan.
pub(crate) fn main_file(path: &Path) -> Option<PathBuf> {
    FORMATS.iter().find_map(|format| format.main_file(path))
}

/// The names under which the scans in an archive can be opened while `archives` last, once it is unpacked; the path
/// itself of a file that is no archive.
///
/// # Errors
/// The user stops it, or the archive has no scan that can be unpacked.
pub(crate) fn scans_in(path: &Path, archives: &mut Archives, task: &Task) -> Result<Vec<PathBuf>, ScanError> {
    archives.members(&FORMATS, path, task)
}

/// The endings of files of all formats, in lower case; the whole name of a file that all scans of a format have.
pub fn format_endings() -> impl Iterator<Item = String> {
    FORMATS.iter().flat_map(|format| {
        let endings = format.endings().unwrap_or_else(|| format.names());
        endings.iter().map(|ending| ending.to_ascii_lowercase())
    })
}

/// True for names that files of some format have, or archives, in which such files may be.
#[must_use]
pub fn is_named_as_scan(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let ends_in = |ending: &str| {
        let before = name.strip_suffix(ending);
        before.is_some_and(|before| before.ends_with('.') || before.is_empty() && ending.contains('.'))
    };
    archive::ENDINGS.into_iter().any(ends_in) || format_endings().any(|ending| ends_in(&ending))
}

/// The endings of files that lie beside scans of some format and hold no points, in lower case.
pub(crate) fn sidecar_endings() -> impl Iterator<Item = &'static str> {
    FORMATS.iter().flat_map(|format| format.sidecars()).copied()
}

/// The names of all formats in a sentence, with this word before the last: "LAS, LAZ, PLY or PTS".
#[must_use]
pub fn format_names(before_last: &str) -> String {
    names_of(&FORMATS, before_last)
}

/// The names of the formats whose files may hold Gaussian splats, in a sentence.
fn splat_format_names() -> String {
    let formats: Vec<&dyn Format> = FORMATS.iter().filter(|format| format.has_splats()).copied().collect();
    names_of(&formats, "or")
}

fn names_of(formats: &[&dyn Format], before_last: &str) -> String {
    let names: Vec<&str> = formats.iter().flat_map(|format| format.names()).copied().collect();
    match names.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} {before_last} {last}", others.join(", ")),
        _ => names.concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Field, Grid, Schema, Type};

    /// A made-up format whose files and folders have names that end in `.named`, whatever is in them.
    struct Named;

    impl Format for Named {
        fn names(&self) -> &'static [&'static str] {
            &["NAMED"]
        }

        fn opens_folders(&self) -> bool {
            true
        }

        fn probe(&self, candidate: &Candidate) -> bool {
            let has_content = candidate.is_folder == candidate.head.is_empty();
            has_content && candidate.path.extension().is_some_and(|ending| ending == "named")
        }

        fn open(&self, path: &Path, _: &OpenHints) -> Result<Box<dyn Dataset>, ScanError> {
            Err(ScanError::NoPoints { path: path.to_owned(), reason: "it is made up".into() })
        }
    }

    #[test]
    fn a_format_may_be_known_by_its_name_and_may_be_a_folder() {
        let folder = tempfile::tempdir().unwrap();
        let error = |formats: &[&dyn Format], name: &str| {
            open_as(formats, &folder.path().join(name), &OpenHints::default())
                .err()
                .expect("no points")
                .to_string()
        };
        std::fs::write(folder.path().join("a.named"), "some words").unwrap();
        std::fs::write(folder.path().join("a.txt"), "some words").unwrap();
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

    /// A made-up file whose format is at fault: it hands over this column for each of its blocks.
    struct Faulty {
        header: Header,
        column: (Attribute, Column),
    }

    impl Dataset for Faulty {
        fn header(&self) -> &Header {
            &self.header
        }

        fn read(&self, _: &Projection, take: &mut Take, _: &Progress) -> Result<Trailer, ScanError> {
            let mut block = Block::new(Grid::default(), []);
            block.xyz = vec![[0; 3]; 2];
            block.columns.push(self.column.clone());
            take(block)?;
            Ok(Trailer::default())
        }
    }

    #[test]
    fn a_column_that_is_not_in_the_schema_is_an_error() {
        let read = |attribute, column| {
            let fields = vec![
                Field::plain(Attribute::GpsTime, Type::F64),
                Field::plain(Attribute::Color, Type::U16x3),
            ];
            let schema = Schema { fields, ..Schema::default() };
            let header = Header { path: "a.named".into(), schema, ..Header::default() };
            let file = CheckedDataset(Box::new(Faulty { header, column: (attribute, column) }));
            let want = Projection::of([Attribute::GpsTime, Attribute::Intensity]);
            file.read(&want, &mut |_| Ok(()), &Progress::hidden()).map_err(|error| error.to_string())
        };
        assert!(read(Attribute::GpsTime, Column::F64(vec![1.0, 2.0])).is_ok());
        for (attribute, column) in [
            // Another type than the schema says, too few values, not in the schema, and not asked for.
            (Attribute::GpsTime, Column::F32(vec![1.0, 2.0])),
            (Attribute::GpsTime, Column::F64(vec![1.0])),
            (Attribute::Intensity, Column::U16(vec![1, 2])),
            (Attribute::Color, Column::U16x3(vec![[0; 3]; 2])),
        ] {
            let error = read(attribute, column).unwrap_err();
            assert!(error.starts_with("a.named: ") && error.contains("a fault of scanwalk"), "{error}");
        }
    }
}

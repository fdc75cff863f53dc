//! Potree: scans that were converted to be walked through in a browser, as folders of files, in versions 1.4–1.8 and 2.
//!
//! ```text
//!  metadata.json ──▶ hierarchy.bin ──▶ NodeTree ──▶ octree.bin, node by node     ──▶ blocks   (version 2)
//!  cloud.js ──▶ .hrc files, or inline ──▶ NodeTree ──▶ .bin, .las, .laz of each node ──▶ blocks   (version 1)
//! ```

mod attributes;
mod cloud;
mod cube_grid;
mod hierarchy;
mod hrc;
mod json;
mod las_nodes;
mod metadata;
mod morton;
mod nested;
mod nodes;
mod octree;
mod pointer;
mod records;
#[cfg(test)]
mod tests;
mod tree;
mod unfold;
mod values;

use super::{Candidate, Dataset, Format, OpenHints};
use crate::ScanError;
use crate::source::Source;
use base::words::counted;
use nested::{CLOUD, PotreeFiles};
use octree::{HIERARCHY, METADATA, OCTREE, PotreeOctree};
use std::path::{Path, PathBuf};
use tree::NodeTree;

/// Bytes of a description that tell what it describes.
const HEAD_BYTES: u64 = 4096;
/// The key that a description of version 2 has, and that of no other format.
const KEY_2: &str = "\"firstChunkSize\"";
/// The key that a description of version 1 has, and that of no other format.
const KEY_1: &str = "\"octreeDir\"";

/// The format Potree.
pub(super) struct Potree;

/// The file that describes a scan, by version.
enum PotreeFile {
    Version1(PathBuf),
    Version2(PathBuf),
}

impl PotreeFile {
    /// The description of the scan that a user names: it, its folder, or a file beside it.
    fn of(path: &Path) -> Option<Self> {
        if path.is_dir() {
            return Self::in_folder(path);
        }
        let name = path.file_name()?.to_str()?.to_ascii_lowercase();
        match name.as_str() {
            HIERARCHY | OCTREE => {
                Self::in_folder(path.parent()?).filter(|found| matches!(found, Self::Version2(_)))
            }
            _ if name.ends_with(".json") && has_key(path, KEY_2) => Some(Self::Version2(path.to_owned())),
            _ if name.ends_with(".js") && has_key(path, KEY_1) => Some(Self::Version1(path.to_owned())),
            _ => None,
        }
    }

    fn in_folder(folder: &Path) -> Option<Self> {
        let [newer, older] = [METADATA, CLOUD].map(|name| folder.join(name));
        if has_key(&newer, KEY_2) {
            return Some(Self::Version2(newer));
        }
        has_key(&older, KEY_1).then_some(Self::Version1(older))
    }
}

/// True if a file is a JSON object that has this key near its start.
fn has_key(path: &Path, key: &str) -> bool {
    let head = Source::open(path).and_then(|source| source.bytes(0, HEAD_BYTES)).unwrap_or_default();
    let head = String::from_utf8_lossy(&head);
    head.trim_start_matches('\u{feff}').trim_start().starts_with('{') && head.contains(key)
}

impl Format for Potree {
    fn names(&self) -> &'static [&'static str] {
        &["Potree"]
    }

    fn endings(&self) -> Option<&'static [&'static str]> {
        Some(&[METADATA, CLOUD])
    }

    fn opens_folders(&self) -> bool {
        true
    }

    fn main_file(&self, path: &Path) -> Option<PathBuf> {
        PotreeFile::of(path).map(|found| match found {
            PotreeFile::Version1(path) | PotreeFile::Version2(path) => path,
        })
    }

    fn probe(&self, candidate: &Candidate) -> bool {
        PotreeFile::of(candidate.path).is_some()
    }

    fn open(&self, path: &Path, _: &OpenHints) -> Result<Box<dyn Dataset>, ScanError> {
        match PotreeFile::of(path) {
            Some(PotreeFile::Version2(metadata)) => Ok(Box::new(PotreeOctree::open(path, &metadata)?)),
            Some(PotreeFile::Version1(cloud)) => Ok(Box::new(PotreeFiles::open(path, &cloud)?)),
            // It was there when it was probed.
            None => {
                Err(ScanError::NoPoints { path: path.to_owned(), reason: "its description is gone".into() })
            }
        }
    }
}

/// What a scan has beside points, in words.
fn tree_part(tree: &NodeTree) -> String {
    format!(
        "octree: {} on {}",
        counted(tree.nodes.len(), "node"),
        counted(u32::from(tree.depth) + 1, "level")
    )
}

//! The hierarchy of Potree 1: inline in `cloud.js`, or in `.hrc` files of a few levels each.
//!
//! An `.hrc` file has entries of 5 bytes, breadth first: the mask of a node's children, and its number of points (u32),
//! which is 0 for most leaves and so tells nothing. A node on the file's last level that has children has a file of its
//! own, which begins with the node anew.

use super::cloud::Cloud1;
use super::pointer;
use super::tree::{NodeName, NodeTree, StoredNode};
use crate::ScanError;
use crate::source::Source;
use base::words::{agreeing, counted};
use std::collections::{BTreeMap, VecDeque};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Bytes of an entry.
const ENTRY_BYTES: usize = 5;

/// Where the files of nodes are: all in one folder, or in folders of a few levels each.
#[derive(Clone, Debug)]
pub(super) struct NodeFolders {
    octree_dir: PathBuf,
    /// Levels of a folder; `None` if all files are in one.
    step: Option<usize>,
}

impl NodeFolders {
    /// The folders of a scan, as the root's files lie.
    pub fn of(cloud: &Cloud1) -> Self {
        let nested = Self { octree_dir: cloud.octree_dir.clone(), step: Some(cloud.step.max(1)) };
        let flat = Self { step: None, ..nested.clone() };
        let has_root = |folders: &Self| {
            [cloud.files.ending(), "hrc"].iter().any(|ending| folders.file(NodeName::ROOT, ending).is_file())
        };
        if cloud.step > 0 && (has_root(&nested) || !has_root(&flat)) { nested } else { flat }
    }

    /// Path of a node's file.
    pub fn file(&self, key: NodeName, ending: &str) -> PathBuf {
        let name = key.name();
        let mut path = self.octree_dir.clone();
        if let Some(step) = self.step {
            path.push("r");
            // Digits are ASCII.
            path.extend(
                name.as_bytes()[1..]
                    .chunks_exact(step)
                    .map(|digits| digits.iter().map(|&digit| char::from(digit)).collect::<String>()),
            );
        }
        path.push(format!("{name}.{ending}"));
        path
    }
}

/// The tree of a scan, with the sizes of its nodes' files; 0 for nodes whose file is not there.
///
/// # Errors
/// There is no hierarchy, or the system cannot read it.
pub(super) fn read(named: &Path, cloud: &Cloud1, folders: &NodeFolders) -> Result<NodeTree, ScanError> {
    let mut tree = cloud.tree.clone();
    let mut found: BTreeMap<NodeName, u64> = cloud.inline.iter().copied().collect();
    if found.is_empty() {
        found = read_files(named, cloud, folders, &mut tree.losses)?;
    }
    tree.nodes = found
        .into_iter()
        .map(|(key, num_points)| {
            let file = std::fs::metadata(folders.file(key, cloud.files.ending()));
            let num_bytes = file.map_or(0, |file| file.len());
            StoredNode { key, offset: 0, num_bytes, num_points }
        })
        .collect();
    Ok(tree.in_order())
}

/// The nodes that the files name, and the numbers of their points.
fn read_files(
    named: &Path,
    cloud: &Cloud1,
    folders: &NodeFolders,
    losses: &mut Vec<String>,
) -> Result<BTreeMap<NodeName, u64>, ScanError> {
    let mut found = BTreeMap::new();
    let mut ahead = VecDeque::from([NodeName::ROOT]);
    let (mut num_missing, mut num_deep) = (0u64, 0u64);
    while let Some(first) = ahead.pop_front() {
        let path = folders.file(first, "hrc");
        let source = match Source::open(&path) {
            Ok(source) if !pointer::is_one(&source)? => source,
            // Each file counts as one, however it is lost.
            _ if first != NodeName::ROOT => {
                num_missing += 1;
                continue;
            }
            Err(ScanError::Io { error, .. }) if error.kind() == ErrorKind::NotFound => {
                let reason =
                    format!("its hierarchy, {}, is not there; get the whole folder again", path.display());
                return Err(ScanError::NoPoints { path: named.to_owned(), reason });
            }
            Err(error) => return Err(error),
            Ok(_) => {
                let reason = format!(
                    "{} is a Git LFS pointer; fetch the real files with `git lfs pull`",
                    path.display()
                );
                return Err(ScanError::NoPoints { path: named.to_owned(), reason });
            }
        };
        let bytes = source.bytes(0, source.len())?;
        let mut keys = VecDeque::from([first]);
        for entry in bytes.chunks_exact(ENTRY_BYTES) {
            let Some(key) = keys.pop_front() else { break };
            let num_points = entry[1..].iter().rev().fold(0, |num, &byte| num << 8 | u64::from(byte));
            found.insert(key, num_points);
            if is_cut_at(cloud, key) && key != first && entry[0] != 0 {
                ahead.push_back(key);
                continue;
            }
            for child in key.children(entry[0]) {
                match child {
                    Some(child) => keys.push_back(child),
                    None => num_deep += 1,
                }
            }
        }
        // A node without an entry is there all the same, if its file is.
        for key in keys {
            found.entry(key).or_insert(0);
        }
    }
    if num_missing > 0 {
        let (parts, are) = (counted(num_missing, "part"), agreeing(num_missing, "is", "are"));
        losses.push(format!(
            "has {parts} of its hierarchy (.hrc) that {are} missing; what lies below is left out"
        ));
    }
    if num_deep > 0 {
        losses.push(format!("has {} too deep in its tree", counted(num_deep, "node")));
    }
    Ok(found)
}

/// True if the hierarchy goes on in another file below a node.
fn is_cut_at(cloud: &Cloud1, key: NodeName) -> bool {
    cloud.step > 0 && usize::from(key.level()).is_multiple_of(cloud.step)
}

//! The octree of a COPC file: its nodes, each a chunk of the LAZ file, from the pages of the hierarchy.
//!
//! The pages are an index beside LAZ's own table of chunks, so nothing depends on them but the order: a hierarchy that is
//! damaged, or has not all chunks, is not used.

use super::chunks::{Chunks, LazChunk};
use super::header::LasHeader;
use crate::ScanError;
use crate::formats::node::NodeKey;
use crate::source::Source;
use base::words::counted;
use std::collections::{HashMap, HashSet};

/// Bytes of an entry of a page: a key, the place of the node's points or of a further page, and their number.
const ENTRY_BYTES: u64 = 32;
/// Stands in place of a number of points where an entry leads to a further page.
const IS_PAGE: i32 = -1;

/// What the info record says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CopcInfo {
    /// Edge of a cell of the root's sampling grid.
    pub spacing: f64,
    /// Where the root page lies: first byte, bytes.
    pub root_page: (u64, u64),
}

/// A node of the octree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CopcNode {
    pub key: NodeKey,
    /// Its points: a chunk of the file, whose number of points is known.
    pub chunk: LazChunk,
    /// Edge of a cell of its sampling grid.
    pub spacing: f64,
}

/// The nodes that have points, breadth first from the root.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct CopcTree {
    pub nodes: Vec<CopcNode>,
}

impl CopcInfo {
    /// Parses the payload of the info record; `None` if it is too short.
    pub fn parse(payload: &[u8]) -> Option<Self> {
        let bytes = |at: usize| payload.get(at..)?.first_chunk::<8>().copied();
        let whole = |at| bytes(at).map(u64::from_le_bytes);
        Some(Self { spacing: bytes(32).map(f64::from_le_bytes)?, root_page: (whole(40)?, whole(48)?) })
    }
}

impl CopcTree {
    /// Reads all pages of the hierarchy. Fails, with the reason as the end of a sentence, if any of it is damaged.
    ///
    /// # Errors
    /// The system cannot read the file.
    pub fn read(
        source: &Source,
        header: &LasHeader,
        info: &CopcInfo,
    ) -> Result<Result<Self, String>, ScanError> {
        let mut walk = HierarchyWalk::default();
        let mut pages = vec![info.root_page];
        while let Some((offset, num_bytes)) = pages.pop() {
            if !walk.pages.insert(offset) {
                return Ok(Err(format!("leads to its page at byte {offset} twice")));
            }
            let is_inside = offset.checked_add(num_bytes).is_some_and(|end| end <= source.len());
            // Pages that overlap each other are damage too: together they are at most as large as the file.
            walk.num_bytes = walk.num_bytes.saturating_add(num_bytes);
            if !is_inside || walk.num_bytes > source.len() {
                return Ok(Err(format!("has a page at byte {offset} that is not in the file")));
            }
            if num_bytes % ENTRY_BYTES != 0 {
                return Ok(Err(format!("has a page of {}", counted(num_bytes, "byte"))));
            }
            let page = source.bytes(offset, num_bytes)?;
            if page.len() as u64 != num_bytes {
                return Ok(Err("is cut off by the file's end".into()));
            }
            for entry in page.chunks_exact(ENTRY_BYTES as usize) {
                if let Err(reason) = walk.enter(entry, &mut pages) {
                    return Ok(Err(reason));
                }
            }
        }
        Ok(walk.finish(source, header, info))
    }

    /// Points of all nodes.
    fn num_points(&self) -> u64 {
        total(self.nodes.iter().map(|node| &node.chunk))
    }
}

/// What was found of the hierarchy so far.
#[derive(Debug, Default)]
struct HierarchyWalk {
    /// First bytes of the pages that were read, or are being read.
    pages: HashSet<u64>,
    num_bytes: u64,
    nodes: HashMap<NodeKey, LazChunk>,
}

impl HierarchyWalk {
    /// Takes in an entry of a page.
    fn enter(&mut self, entry: &[u8], pages: &mut Vec<(u64, u64)>) -> Result<(), String> {
        let word = |at: usize| entry[at..].first_chunk().map_or(0, |bytes| i32::from_le_bytes(*bytes));
        let offset = entry[16..].first_chunk().map_or(0, |bytes| u64::from_le_bytes(*bytes));
        let [depth, x, y, z] = [0, 4, 8, 12].map(|at| i64::from(word(at)));
        let key = NodeKey::new(depth, [x, y, z])
            .ok_or_else(|| format!("names a node {depth}-{x}-{y}-{z}, which cannot be"))?;
        let num_bytes = word(24);
        let size =
            u64::try_from(num_bytes).map_err(|_| format!("has node {key} with a size of {num_bytes}"))?;
        match word(28) {
            IS_PAGE => pages.push((offset, size)),
            0 => {}
            num => {
                let num = u64::try_from(num)
                    .map_err(|_| format!("has node {key} with a number of points of {num}"))?;
                let chunk = LazChunk { offset, num_bytes: size, num_points: Some(num) };
                if self.nodes.insert(key, chunk).is_some() {
                    return Err(format!("has node {key} twice"));
                }
            }
        }
        Ok(())
    }

    /// Puts the nodes in order, if their chunks lie where points are, and do not overlap.
    fn finish(self, source: &Source, header: &LasHeader, info: &CopcInfo) -> Result<CopcTree, String> {
        let spacing = Some(info.spacing).filter(|spacing| spacing.is_finite()).unwrap_or(0.0);
        let node = |(key, chunk): (NodeKey, LazChunk)| CopcNode { key, chunk, spacing: key.spacing(spacing) };
        let mut nodes: Vec<CopcNode> = self.nodes.into_iter().map(node).collect();
        nodes.sort_unstable_by_key(|node| node.chunk.offset);
        let mut end = header.points_offset;
        for CopcNode { key, chunk, .. } in &nodes {
            if chunk.offset < end {
                return Err(format!("has node {key} overlap another"));
            }
            end =
                chunk.offset.checked_add(chunk.num_bytes).filter(|end| *end <= source.len()).ok_or_else(
                    || format!("has node {key} end beyond the file's end, byte {}", source.len()),
                )?;
        }
        nodes.sort_unstable_by_key(|node| node.key);
        if nodes.is_empty() { Err("has no nodes with points".into()) } else { Ok(CopcTree { nodes }) }
    }
}

fn total<'a>(chunks: impl Iterator<Item = &'a LazChunk>) -> u64 {
    chunks.fold(0, |sum, chunk| sum.saturating_add(chunk.num_points.unwrap_or(0)))
}

/// Puts the chunks that LAZ's own table has in the order of the octree, and says why if that cannot be. The octree takes
/// the place of a table that is of no use.
///
/// # Errors
/// The system cannot read the file.
pub(super) fn in_order(
    source: &Source,
    header: &LasHeader,
    info: Option<CopcInfo>,
    chunks: Chunks,
) -> Result<(Chunks, Option<String>), ScanError> {
    let tree = match &info {
        Some(info) => CopcTree::read(source, header, info)?,
        None => Err("is not described".into()),
    };
    let listed = match &chunks {
        Chunks::Listed(listed) | Chunks::Followed(listed, _) => &listed[..],
        Chunks::Unknown(_) => &[],
    };
    let problem = match tree {
        Err(reason) => format!("{reason}; its points are read in the order of the file"),
        Ok(tree) => {
            let (num, num_listed) = (tree.num_points(), total(listed.iter()));
            let of_tree: HashSet<(u64, u64)> =
                tree.nodes.iter().map(|node| (node.chunk.offset, node.chunk.num_bytes)).collect();
            let has_all = listed.iter().all(|chunk| of_tree.contains(&(chunk.offset, chunk.num_bytes)));
            if num >= num_listed && (has_all || !matches!(chunks, Chunks::Listed(_))) {
                let sentence = match chunks {
                    Chunks::Listed(_) => None,
                    Chunks::Followed(_, reason) | Chunks::Unknown(reason) => {
                        Some(format!("{reason}; the hierarchy of its octree was taken instead"))
                    }
                };
                return Ok((Chunks::Listed(tree.nodes.iter().map(|node| node.chunk).collect()), sentence));
            }
            let points = counted(num_listed, "point");
            format!("has {num} of {points} that are in the file; all are read, in the order of the file")
        }
    };
    Ok((chunks, Some(format!("is COPC, but its hierarchy {problem}"))))
}

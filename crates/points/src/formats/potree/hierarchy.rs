//! The hierarchy of Potree 2: entries of 22 bytes, in chunks of a few levels, which point to each other.
//!
//! An entry is: type (2 stands for another chunk, which begins with the node anew), the mask of its children, the number
//! of its points (u32), and where they start and how many bytes they have (u64 each; of the chunk for type 2). The type
//! tells nothing else: nodes that are called leaves have children. A node of no bytes has no points, whatever it says.

use super::tree::{NodeName, NodeTree, StoredNode};
use crate::ScanError;
use crate::source::Source;
use base::words::{agreeing, counted};
use std::collections::{HashSet, VecDeque};

/// Bytes of an entry.
const ENTRY_BYTES: u64 = 22;
/// Type of an entry that stands for another chunk.
const PROXY: u8 = 2;

/// A chunk that is still to be read: the node that it begins with, its first byte, and its bytes.
type ChunkAhead = (NodeName, u64, u64);

/// What an entry says.
struct Entry {
    kind: u8,
    children: u8,
    num_points: u64,
    offset: u64,
    num_bytes: u64,
}

impl Entry {
    fn parse(bytes: &[u8; ENTRY_BYTES as usize]) -> Self {
        let number = |at: usize, len: usize| {
            bytes[at..at + len].iter().rev().fold(0, |number, &byte| number << 8 | u64::from(byte))
        };
        Self {
            kind: bytes[0],
            children: bytes[1],
            num_points: number(2, 4),
            offset: number(6, 8),
            num_bytes: number(14, 8),
        }
    }
}

/// Adds the nodes of a hierarchy whose first chunk has this many bytes to a tree. As many entries are read as the file
/// has, and each chunk once, so that chunks which lead to each other end.
///
/// # Errors
/// The system cannot read the file.
pub(super) fn read(source: &Source, first_chunk: u64, mut tree: NodeTree) -> Result<NodeTree, ScanError> {
    let mut left = source.len() / ENTRY_BYTES;
    let mut ahead = VecDeque::from([(NodeName::ROOT, 0, first_chunk)]);
    let mut seen = HashSet::new();
    let (mut num_again, mut num_cut, mut num_deep) = (0u64, 0u64, 0u64);
    while let Some((key, offset, num_bytes)) = ahead.pop_front() {
        if !seen.insert(offset) {
            num_again += 1;
            continue;
        }
        let bytes = source.bytes(offset, num_bytes.min(left * ENTRY_BYTES))?;
        let mut keys = VecDeque::from([key]);
        for bytes in bytes.as_chunks().0 {
            // Entries that nothing leads to may follow.
            let Some(key) = keys.pop_front() else { break };
            left -= 1;
            let entry = Entry::parse(bytes);
            if entry.kind == PROXY {
                ahead.push_back((key, entry.offset, entry.num_bytes) as ChunkAhead);
                continue;
            }
            if entry.num_bytes > 0 && entry.num_points > 0 {
                let Entry { num_points, offset, num_bytes, .. } = entry;
                tree.nodes.push(StoredNode { key, offset, num_bytes, num_points });
            }
            for child in key.children(entry.children) {
                match child {
                    Some(child) => keys.push_back(child),
                    None => num_deep += 1,
                }
            }
        }
        num_cut += keys.len() as u64;
    }
    let losses = [
        (num_cut, "whose entries in its hierarchy are missing"),
        (num_again, "whose entries in its hierarchy are those of other nodes"),
        (num_deep, "too deep in its tree"),
    ];
    let lost = losses.iter().filter(|(num, _)| *num > 0).map(|(num, why)| {
        let (nodes, are) = (counted(num, "node"), agreeing(num, "it is", "they are"));
        format!("has {nodes} {why}; {are} left out, with what lies below")
    });
    tree.losses.extend(lost);
    Ok(tree.in_order())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An entry's bytes.
    fn entry(kind: u8, children: u8, num_points: u32, offset: u64, num_bytes: u64) -> Vec<u8> {
        let mut bytes = vec![kind, children];
        bytes.extend(num_points.to_le_bytes());
        bytes.extend(offset.to_le_bytes());
        bytes.extend(num_bytes.to_le_bytes());
        bytes
    }

    fn tree_of(entries: &[Vec<u8>], first_chunk: u64) -> NodeTree {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hierarchy.bin");
        std::fs::write(&path, entries.concat()).unwrap();
        read(&Source::open(&path).unwrap(), first_chunk, NodeTree::default()).unwrap()
    }

    fn names(tree: &NodeTree) -> String {
        tree.nodes.iter().map(|node| node.key.name()).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn masks_and_proxies_lead_on_and_the_type_tells_nothing() {
        let entries = [
            entry(0, 0b1000_0001, 5, 0, 60),
            // The first child is called a leaf, but has a child; the second stands for another chunk.
            entry(1, 0b10, 4, 60, 48),
            entry(PROXY, 0, 3, 110, 44),
            // This one has no bytes.
            entry(0, 0, 7, 108, 0),
            // Nothing leads here.
            entry(0, 1, 9, 108, 99),
            entry(0, 0b100, 3, 108, 36),
            entry(1, 0, 2, 144, 24),
        ];
        let tree = tree_of(&entries, 88);
        assert_eq!((names(&tree).as_str(), tree.depth), ("r r0 r7 r72", 2));
        assert_eq!(tree.losses, [""; 0]);
        let last = tree.nodes[3];
        assert_eq!((last.offset, last.num_bytes, last.num_points), (144, 24, 2));
    }

    #[test]
    fn chunks_that_lead_to_each_other_end() {
        let looped = [entry(0, 1, 5, 0, 60), entry(PROXY, 1, 5, 0, 44)];
        let tree = tree_of(&looped, 44);
        assert_eq!(names(&tree), "r");
        assert!(tree.losses[0].contains("1 node whose entries in its hierarchy are those of other"));
        // Each entry of a long file stands for a chunk that begins one entry further on.
        let chain: Vec<Vec<u8>> =
            (0..2000u64).map(|at| entry(PROXY, 255, 5, 22 * (at + 1), u64::MAX)).collect();
        assert!(tree_of(&chain, u64::MAX).nodes.is_empty());
        // All nodes have all children, and overlapping chunks.
        let wide: Vec<Vec<u8>> =
            (0..3000u64).map(|at| entry((at % 5 == 4) as u8 * 2, 255, 1, at, 1 << 40)).collect();
        assert!(tree_of(&wide, u64::MAX).nodes.len() <= 3000);
        // A tree of one child a level ends where keys do.
        let deep: Vec<Vec<u8>> = (0..100).map(|_| entry(0, 1, 1, 0, 1)).collect();
        let tree = tree_of(&deep, 2200);
        assert_eq!((tree.nodes.len(), tree.depth), (41, 40));
        assert!(tree.losses[0].contains("1 node too deep"), "{:?}", tree.losses);
    }

    #[test]
    fn what_is_cut_off_is_counted() {
        let entries =
            [entry(0, 0b1110, 5, 0, 60), entry(0, 0, 4, 60, 48), entry(0, 0, 4, 60, 48)[..9].to_vec()];
        let tree = tree_of(&entries, 88);
        assert_eq!(names(&tree), "r r1");
        assert!(tree.losses[0].contains("has 2 nodes whose entries"), "{:?}", tree.losses);
        assert!(tree_of(&[], 88).losses[0].contains("1 node"));
    }
}

//! Reads nodes in parallel, a window of them at a time, and hands them over in order, small ones together in a block.

use super::tree::StoredNode;
use crate::ScanError;
use crate::block::Block;
use crate::formats::Take;
use base::task::{Cancelled, Progress};
use base::words::{agreeing, counted};
use rayon::prelude::*;

/// Bytes of the nodes that are in work, for each thread. They are held twice: while they are read, and handed over.
const BYTES_PER_THREAD: u64 = 1 << 21;
/// Nodes in work, for each thread.
const NODES_PER_THREAD: usize = 256;
/// Most points of nodes that are put together: more would only be copied.
const MOST_TOGETHER: usize = 1 << 18;
/// Nodes that a sentence names.
const MOST_NAMED: usize = 3;

/// What keeps points of a node from being read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum PotreeFault {
    /// Its file is not there.
    Missing,
    /// Its file is a Git LFS pointer.
    Pointer,
    /// Its bytes end before its points.
    Cut,
    /// Its points lie in the bytes of other nodes.
    Shared,
    /// It has other attributes than the first.
    Differs,
    /// Its bytes make no sense.
    Damaged(String),
}

/// What could be read of a node.
#[derive(Debug, Default)]
pub(super) struct DecodedNode {
    pub block: Option<Block>,
    pub fault: Option<PotreeFault>,
    /// Points of the node that lie too far from the others to be held.
    pub num_far: u64,
    /// What else was odd.
    pub odd: Option<String>,
}

impl DecodedNode {
    /// A node of which nothing can be read.
    pub fn lost(fault: PotreeFault) -> Self {
        Self { fault: Some(fault), ..Self::default() }
    }
}

/// What was read of all nodes.
#[derive(Debug, Default)]
pub(super) struct NodesRead {
    pub num_points: u64,
    /// Sentences about what could not be read, whose subject is the file.
    pub losses: Vec<String>,
    /// Sentences about what else was odd, whose subject is the file.
    pub warnings: Vec<String>,
}

/// Decodes all nodes by `decode`, and hands them over in blocks of about this many points.
///
/// # Errors
/// The user stops it, or `decode` or `take` fail.
pub(super) fn read(
    nodes: &[StoredNode],
    decode: impl Fn(&StoredNode) -> Result<DecodedNode, ScanError> + Sync,
    block_points: usize,
    take: &mut Take,
    progress: &Progress,
) -> Result<NodesRead, ScanError> {
    let most = block_points.clamp(1, MOST_TOGETHER);
    let mut handover = NodeHandover {
        take,
        most,
        together: None,
        faults: Vec::new(),
        read: NodesRead::default(),
        num_far: 0,
    };
    let mut decoded = Vec::new();
    let mut left = nodes;
    while !left.is_empty() {
        let (window, rest) = left.split_at(window_len(left));
        left = rest;
        let decode = |node: &StoredNode| {
            if progress.is_cancelled() {
                return Err(Cancelled.into());
            }
            Ok((*node, decode(node)?))
        };
        let before = std::mem::take(&mut decoded);
        let (now, handed_over) = rayon::join(
            || window.par_iter().map(decode).collect::<Result<_, ScanError>>(),
            || handover.all(before),
        );
        handed_over?;
        decoded = now?;
        if progress.is_cancelled() {
            return Err(Cancelled.into());
        }
    }
    handover.all(decoded)?;
    handover.finish()
}

/// Number of nodes that are read at a time.
fn window_len(nodes: &[StoredNode]) -> usize {
    let threads = rayon::current_num_threads();
    let most_bytes = BYTES_PER_THREAD * threads as u64;
    let mut num_bytes = 0u64;
    let fits = |node: &&StoredNode| {
        num_bytes = num_bytes.saturating_add(node.num_bytes);
        num_bytes <= most_bytes
    };
    nodes.iter().take(NODES_PER_THREAD * threads).take_while(fits).count().max(1)
}

/// Nodes on their way to whoever wants them.
struct NodeHandover<'a, 'b> {
    take: &'a mut Take<'b>,
    most: usize,
    together: Option<Block>,
    faults: Vec<(StoredNode, PotreeFault)>,
    num_far: u64,
    read: NodesRead,
}

impl NodeHandover<'_, '_> {
    fn all(&mut self, decoded: Vec<(StoredNode, DecodedNode)>) -> Result<(), ScanError> {
        for (node, DecodedNode { block, fault, num_far, odd }) in decoded {
            self.faults.extend(fault.map(|fault| (node, fault)));
            self.num_far += num_far;
            let odd = odd.filter(|odd| !self.read.warnings.contains(odd));
            self.read.warnings.extend(odd.filter(|_| self.read.warnings.len() < MOST_NAMED));
            if let Some(block) = block.filter(|block| !block.xyz.is_empty()) {
                self.read.num_points += block.xyz.len() as u64;
                self.add(block)?;
            }
        }
        Ok(())
    }

    /// Puts a node's points with those before, or hands those over if there would be too many.
    fn add(&mut self, block: Block) -> Result<(), ScanError> {
        let num_points = block.xyz.len();
        let fits = |together: &Block| together.xyz.len() + num_points <= self.most;
        let together = match self.together.take() {
            Some(together) if fits(&together) => joined(together, block),
            Some(full) => {
                (self.take)(full)?;
                block
            }
            None => block,
        };
        if together.xyz.len() >= self.most {
            return (self.take)(together);
        }
        self.together = Some(together);
        Ok(())
    }

    fn finish(mut self) -> Result<NodesRead, ScanError> {
        if let Some(last) = self.together.take() {
            (self.take)(last)?;
        }
        let Self { mut read, faults, num_far, .. } = self;
        read.losses = sentences(&faults);
        if num_far > 0 {
            read.warnings.push(format!(
                "has {} too far outside its box to be held with the others; {} left out",
                counted(num_far, "point"),
                agreeing(num_far, "it is", "they are"),
            ));
        }
        Ok(read)
    }
}

/// The points of both blocks, which have the same columns.
pub(super) fn joined(mut first: Block, later: Block) -> Block {
    let num_points = first.xyz.len();
    first.xyz.extend(later.xyz);
    for ((_, column), (_, later)) in first.columns.iter_mut().zip(later.columns) {
        column.append(later, num_points);
    }
    first.stats = first.stats.union(later.stats);
    first
}

/// Sentences about what was lost, one for each kind of fault.
fn sentences(faults: &[(StoredNode, PotreeFault)]) -> Vec<String> {
    type IsOfKind = fn(&PotreeFault) -> bool;
    let kinds: [(IsOfKind, &str, &str, &str); 6] = [
        (|fault| *fault == PotreeFault::Missing, "whose file is", "whose files are", " missing"),
        (
            |fault| *fault == PotreeFault::Pointer,
            "that is",
            "that are",
            " only in Git LFS (`git lfs pull` gets them)",
        ),
        (|fault| *fault == PotreeFault::Cut, "that is", "that are", " cut off"),
        (
            |fault| *fault == PotreeFault::Shared,
            "whose points lie",
            "whose points lie",
            " in those of other nodes",
        ),
        (|fault| *fault == PotreeFault::Differs, "that has", "that have", " other attributes than the first"),
        (|fault| matches!(fault, PotreeFault::Damaged(_)), "that is", "that are", " damaged"),
    ];
    let sentence = |(is_of_kind, one, many, rest): &(fn(&PotreeFault) -> bool, &str, &str, &str)| {
        let found: Vec<&(StoredNode, PotreeFault)> =
            faults.iter().filter(|(_, fault)| is_of_kind(fault)).collect();
        let (_, first) = found.first()?;
        let num = found.len();
        let why = match first {
            PotreeFault::Damaged(why) => format!(" ({why})"),
            _ => String::new(),
        };
        let mut names: Vec<String> = found.iter().take(MOST_NAMED).map(|(node, _)| node.key.name()).collect();
        if num > MOST_NAMED {
            names.push(format!("{} more", num - MOST_NAMED));
        }
        let (nodes, are) = (counted(num, "node"), agreeing(num, one, many));
        let what = if *first == PotreeFault::Cut {
            "what is missing is"
        } else {
            agreeing(num, "it is", "they are")
        };
        Some(format!("has {nodes} {are}{rest}{why}: {}; {what} left out", names.join(", ")))
    };
    kinds.iter().filter_map(sentence).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tree::NodeName;
    use super::*;
    use crate::{Attribute, Column, Grid, Type};

    fn node(number: u8, num_points: u64) -> StoredNode {
        let key = NodeName::ROOT.child(number).unwrap();
        StoredNode { key, offset: u64::from(number), num_bytes: 12 * num_points, num_points }
    }

    fn block(node: &StoredNode) -> Block {
        let mut block = Block::new(Grid::default(), [(Attribute::UserData, Type::U8)]);
        block.xyz = (0..node.num_points).map(|at| [node.offset as i32, at as i32, 0]).collect();
        block.columns[0].1 = Column::U8(vec![node.offset as u8; node.num_points as usize]);
        block.with_stats()
    }

    fn lens(nodes: &[StoredNode], block_points: usize) -> Vec<usize> {
        let (mut lens, mut numbers) = (Vec::new(), Vec::new());
        let decode =
            |node: &StoredNode| Ok(DecodedNode { block: Some(block(node)), ..DecodedNode::default() });
        let mut take = |block: Block| {
            let Some(Column::U8(values)) = block.column(&Attribute::UserData) else { panic!("no column") };
            assert!(block.xyz.iter().zip(values).all(|(xyz, value)| xyz[0] == i32::from(*value)));
            assert_eq!(block.stats, block.clone().with_stats().stats);
            numbers.extend(values.iter().copied());
            lens.push(block.xyz.len());
            Ok(())
        };
        let read = read(nodes, decode, block_points, &mut take, &Progress::hidden()).unwrap();
        assert_eq!(read.num_points, nodes.iter().map(|node| node.num_points).sum::<u64>());
        assert!(numbers.is_sorted(), "the order changed");
        lens
    }

    #[test]
    fn small_nodes_come_together_in_order() {
        let nodes: Vec<StoredNode> =
            [5, 0, 3, 4, 20, 1, 2].iter().zip(0..).map(|(num, at)| node(at, *num)).collect();
        assert_eq!(lens(&nodes, usize::MAX), [35]);
        assert_eq!(lens(&nodes, 8), [8, 4, 20, 3]);
        assert_eq!(lens(&nodes, 1), [5, 3, 4, 20, 1, 2]);
        assert_eq!(lens(&[], 8), [0; 0]);
    }

    #[test]
    fn windows_are_bounded_by_bytes_and_have_a_node_at_least() {
        let large = StoredNode { num_bytes: u64::MAX, ..node(0, 1) };
        assert_eq!(window_len(&[large; 3]), 1);
        assert!(window_len(&vec![node(1, 1); 1_000_000]) <= 256 * rayon::current_num_threads());
    }

    #[test]
    fn faults_are_counted_and_named() {
        let faults: Vec<(StoredNode, PotreeFault)> = (0..5)
            .map(|at| (node(at, 1), PotreeFault::Missing))
            .chain([(node(6, 1), PotreeFault::Damaged("has no end".into())), (node(7, 1), PotreeFault::Cut)])
            .collect();
        assert_eq!(
            sentences(&faults),
            [
                "has 5 nodes whose files are missing: r0, r1, r2, 2 more; they are left out",
                "has 1 node that is cut off: r7; what is missing is left out",
                "has 1 node that is damaged (has no end): r6; it is left out",
            ]
        );
    }

    #[test]
    fn reading_stops_when_asked_or_when_a_node_fails() {
        let fail = |_: &StoredNode| Err(ScanError::NoPoints { path: "a".into(), reason: "b".into() });
        assert!(read(&[node(0, 1)], fail, 1, &mut |_| Ok(()), &Progress::hidden()).is_err());
    }
}

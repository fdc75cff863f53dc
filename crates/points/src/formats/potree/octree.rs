//! A scan of Potree 2: metadata, a hierarchy, and one file with the points of all nodes.

use super::metadata::{Metadata, NodeEncoding};
use super::nodes::{self, DecodedNode, NodesRead, PotreeFault};
use super::tree::{NodeTree, StoredNode};
use super::unfold::{self, CannotUnfold};
use super::{hierarchy, pointer, tree_part};
use crate::block::Trailer;
use crate::formats::{Dataset, Take};
use crate::source::Source;
use crate::{Header, Projection, ScanError, guard};
use base::task::Progress;
use base::words::counted;
use std::io::ErrorKind;
use std::path::Path;

/// Bytes that nodes may have together, for each byte of their file: those of real nodes are the file's. A little more
/// is allowed, so that a single wrong size costs its own node alone.
const MOST_SHARED: u64 = 2;

/// Name of the file that has the metadata.
pub(super) const METADATA: &str = "metadata.json";
/// Name of the file that has the nodes.
pub(super) const HIERARCHY: &str = "hierarchy.bin";
/// Name of the file that has the points.
pub(super) const OCTREE: &str = "octree.bin";

/// An opened scan.
pub(super) struct PotreeOctree {
    metadata: Metadata,
    tree: NodeTree,
    octree: Source,
    header: Header,
}

impl PotreeOctree {
    /// Opens the scan whose metadata are these, and which the user names by `named`.
    ///
    /// # Errors
    /// A part of it is missing or senseless.
    pub fn open(named: &Path, metadata_path: &Path) -> Result<Self, ScanError> {
        let metadata = Metadata::read(&Source::open(metadata_path)?)?;
        let beside = |name: &str| part(named, &metadata_path.with_file_name(name), name);
        let (hierarchy, octree) = (beside(HIERARCHY)?, beside(OCTREE)?);
        let tree = hierarchy::read(&hierarchy, metadata.first_chunk, metadata.tree.clone())?;
        let tree = without_shared(tree, octree.len());
        let num_points = tree.nodes.iter().map(|node| believed(&metadata, node, octree.len())).sum();
        let no_points = |reason| ScanError::NoPoints { path: named.to_owned(), reason };
        if num_points == 0 {
            let claimed: u64 = tree.nodes.iter().map(|node| node.num_points).sum();
            return Err(no_points(match octree.len() {
                _ if claimed == 0 => match metadata.announced_points {
                    Some(announced) if announced > 0 => format!(
                        "it announces {}, but no node in {HIERARCHY} has any: whatever was converted was cut off; convert \
                         it again",
                        counted(announced, "point")
                    ),
                    _ => format!("no node in {HIERARCHY} has any; convert the scan again"),
                },
                0 => format!(
                    "{HIERARCHY} lists {}, but {OCTREE} is empty: whatever was converted was cut off; convert it again",
                    counted(claimed, "point")
                ),
                len => format!(
                    "{HIERARCHY} lists {}, but none of them is in the {} of {OCTREE}; get the whole folder again",
                    counted(claimed, "point"),
                    counted(len, "byte")
                ),
            }));
        }
        let Metadata { version, encoding_name, crs, layout, .. } = &metadata;
        let header = Header {
            path: named.to_owned(),
            format: format!("Potree {version}, {encoding_name}"),
            num_points,
            schema: layout.columns.schema(),
            parts: vec![tree_part(&tree)],
            crs: crs.name.clone(),
            unit_m: crs.unit_m,
            vertical_unit_m: crs.vertical_unit_m,
            axes: crs.axes,
            is_on_fixed_grid: true,
            ..Header::default()
        };
        Ok(Self { metadata, tree, octree, header })
    }
}

/// Opens a file beside the metadata.
fn part(named: &Path, path: &Path, name: &str) -> Result<Source, ScanError> {
    let no_points = |reason| ScanError::NoPoints { path: named.to_owned(), reason };
    let source = Source::open(path).map_err(|error| match error {
        ScanError::Io { error, .. } if error.kind() == ErrorKind::NotFound => {
            no_points(format!("{name}, which belongs to it, is not there; get the whole folder again"))
        }
        error => error,
    })?;
    if pointer::is_one(&source)? {
        return Err(no_points(format!(
            "its {name} is a Git LFS pointer; fetch the real file with `git lfs pull`"
        )));
    }
    Ok(source)
}

/// Leaves out nodes once there are more bytes in them than the file can have, and says so.
fn without_shared(mut tree: NodeTree, file_bytes: u64) -> NodeTree {
    let mut left = file_bytes.saturating_mul(MOST_SHARED);
    let num_before = tree.nodes.len();
    tree.nodes.retain(|node| {
        // Nodes beyond the file's end cost nothing.
        let num_bytes = node.num_bytes.min(file_bytes.saturating_sub(node.offset));
        let fits = num_bytes <= left;
        left -= if fits { num_bytes } else { 0 };
        fits
    });
    let num_shared = num_before - tree.nodes.len();
    if num_shared > 0 {
        tree.losses.push(format!(
            "has {} whose points lie in those of others, in {} of {OCTREE}; they are left out",
            counted(num_shared, "node"),
            counted(file_bytes, "byte")
        ));
    }
    tree
}

/// Points of a node that its bytes can hold.
fn believed(metadata: &Metadata, node: &StoredNode, file_bytes: u64) -> u64 {
    let there = node.num_bytes.min(file_bytes.saturating_sub(node.offset));
    match metadata.encoding {
        NodeEncoding::Records => node.num_points.min(there / metadata.layout.record_bytes as u64),
        NodeEncoding::Brotli if there < node.num_bytes => 0,
        NodeEncoding::Brotli => {
            Some(node.num_points).filter(|&num| num <= unfold::most_points(there)).unwrap_or(0)
        }
    }
}

impl Dataset for PotreeOctree {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&self, want: &Projection, take: &mut Take, progress: &Progress) -> Result<Trailer, ScanError> {
        let Self { metadata, tree, octree, header } = self;
        let wanted = metadata.layout.columns.wanted(want);
        let memory = || ScanError::Memory { path: header.path.clone(), num_points: header.num_points };
        let decode = |node: &StoredNode| {
            let num_points = believed(metadata, node, octree.len());
            let needed = match metadata.encoding {
                NodeEncoding::Records => num_points * metadata.layout.record_bytes as u64,
                NodeEncoding::Brotli => node.num_bytes,
            };
            let is_there = node.num_bytes <= octree.len().saturating_sub(node.offset);
            if num_points == 0 {
                let claims = format!("claims {} in {}", node.num_points, counted(node.num_bytes, "byte"));
                let fault = if is_there { PotreeFault::Damaged(claims) } else { PotreeFault::Cut };
                return Ok(DecodedNode::lost(fault));
            }
            let bytes = match octree.bytes(node.offset, needed) {
                Ok(bytes) => bytes,
                Err(error) => return Ok(DecodedNode::lost(PotreeFault::Damaged(error.to_string()))),
            };
            let block = match metadata.encoding {
                NodeEncoding::Records => {
                    let found = metadata.layout.records(&bytes, &wanted, metadata.grid, Some);
                    found.ok_or_else(memory)?.0
                }
                NodeEncoding::Brotli => {
                    let num_points = usize::try_from(num_points).map_err(|_| memory())?;
                    let unfold = || metadata.layout.folded(&bytes, num_points, &wanted, metadata.grid);
                    match guard::catch(unfold) {
                        Ok(Ok(block)) => block,
                        Ok(Err(CannotUnfold::Memory)) => return Err(memory()),
                        Ok(Err(CannotUnfold::Ends)) => return Ok(DecodedNode::lost(PotreeFault::Cut)),
                        Ok(Err(CannotUnfold::Damaged)) => {
                            return Ok(DecodedNode::lost(PotreeFault::Damaged("its compression".into())));
                        }
                        Err(panic) => return Ok(DecodedNode::lost(PotreeFault::Damaged(panic))),
                    }
                }
            };
            progress.add(block.xyz.len() as u64);
            let is_cut = (block.xyz.len() as u64) < node.num_points;
            Ok(DecodedNode {
                fault: is_cut.then_some(PotreeFault::Cut),
                block: Some(block),
                ..DecodedNode::default()
            })
        };
        let read = nodes::read(&tree.nodes, decode, want.block_points(), take, progress)?;
        let white = metadata.layout.columns.white;
        trailer(header, tree, metadata.announced_points, read).map(|trailer| Trailer { white, ..trailer })
    }
}

/// What is to be said of a scan whose nodes were read.
///
/// # Errors
/// No point could be read.
pub(super) fn trailer(
    header: &Header,
    tree: &NodeTree,
    announced: Option<u64>,
    read: NodesRead,
) -> Result<Trailer, ScanError> {
    let NodesRead { num_points, losses, mut warnings } = read;
    let losses: Vec<String> = tree.losses.iter().cloned().chain(losses).collect();
    if num_points == 0 {
        let said = losses.iter().chain(&warnings).next();
        let reason = said.map_or("none could be read".to_owned(), |said| format!("it {said}"));
        return Err(ScanError::NoPoints {
            path: header.path.clone(),
            reason: format!("{reason}; get it again"),
        });
    }
    if let Some(announced) = announced.filter(|&announced| announced != num_points && losses.is_empty()) {
        warnings.push(format!("announces {}, but its nodes hold {num_points}", counted(announced, "point")));
    }
    Ok(Trailer { losses, warnings, ..Trailer::default() })
}

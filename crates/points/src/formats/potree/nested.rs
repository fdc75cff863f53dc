//! A scan of Potree 1: `cloud.js`, a hierarchy, and a file for each node.

use super::cloud::{Cloud1, NodeFiles};
use super::cube_grid::PotreeGrid;
use super::hrc::{self, NodeFolders};
use super::las_nodes::LasNodes;
use super::nodes::{self, DecodedNode, PotreeFault};
use super::octree::trailer;
use super::records::RecordLayout;
use super::tree::{NodeTree, StoredNode};
use super::{pointer, tree_part};
use crate::block::Trailer;
use crate::formats::{Dataset, Take};
use crate::source::Source;
use crate::{Header, Projection, ScanError, Schema};
use base::task::Progress;
use std::io::ErrorKind;
use std::path::Path;

/// Name of the file that describes the scan.
pub(super) const CLOUD: &str = "cloud.js";

/// An opened scan.
pub(super) struct PotreeFiles {
    cloud: Cloud1,
    folders: NodeFolders,
    tree: NodeTree,
    header: Header,
}

impl PotreeFiles {
    /// Opens the scan with this `cloud.js`, which the user names by `named`.
    ///
    /// # Errors
    /// A part of it is missing or senseless.
    pub fn open(named: &Path, cloud_path: &Path) -> Result<Self, ScanError> {
        let cloud = Cloud1::read(&Source::open(cloud_path)?)?;
        let folders = NodeFolders::of(&cloud);
        let tree = hrc::read(named, &cloud, &folders)?;
        let (schema, num_points) = match &cloud.files {
            NodeFiles::Binary(layout) => {
                let num_points = |node: &StoredNode| node.num_bytes / layout.record_bytes as u64;
                (layout.columns.schema(), tree.nodes.iter().map(num_points).sum())
            }
            NodeFiles::Las(ending) => {
                let there = tree.nodes.iter().filter(|node| node.num_bytes > 0);
                let stated = there.clone().fold(0u64, |sum, node| sum.saturating_add(node.num_points));
                let num_there = there.count() as u64;
                (schema(&tree, &folders, ending), stated.max(num_there))
            }
        };
        if num_points == 0 {
            let first = folders.file(super::tree::NodeName::ROOT, cloud.files.ending());
            let reason = format!(
                "none of the files that its hierarchy names, such as {}, has any; get the whole folder again",
                first.display()
            );
            return Err(ScanError::NoPoints { path: named.to_owned(), reason });
        }
        let header = Header {
            path: named.to_owned(),
            format: format!("Potree {}, {}", cloud.version, cloud.files.name()),
            num_points,
            schema,
            parts: vec![tree_part(&tree)],
            crs: cloud.crs.name.clone(),
            unit_m: cloud.crs.unit_m,
            vertical_unit_m: cloud.crs.vertical_unit_m,
            axes: cloud.crs.axes,
            is_on_fixed_grid: true,
            ..Header::default()
        };
        Ok(Self { cloud, folders, tree, header })
    }

    /// Reads the records of a node's file.
    fn records(
        &self,
        node: &StoredNode,
        layout: &RecordLayout,
        decode: impl Fn(&[u8]) -> Option<DecodedNode>,
    ) -> Result<DecodedNode, ScanError> {
        let source = match Source::open(&self.folders.file(node.key, self.cloud.files.ending())) {
            Ok(source) => source,
            Err(ScanError::Io { error, .. }) if error.kind() == ErrorKind::NotFound => {
                return Ok(DecodedNode::lost(PotreeFault::Missing));
            }
            Err(error) => return Ok(DecodedNode::lost(PotreeFault::Damaged(error.to_string()))),
        };
        let bytes = match source.bytes(0, source.len()) {
            Ok(_) if pointer::is_one(&source)? => return Ok(DecodedNode::lost(PotreeFault::Pointer)),
            Ok(bytes) => bytes,
            Err(error) => return Ok(DecodedNode::lost(PotreeFault::Damaged(error.to_string()))),
        };
        let memory =
            || ScanError::Memory { path: self.header.path.clone(), num_points: self.header.num_points };
        let mut decoded = decode(&bytes).ok_or_else(memory)?;
        if !bytes.len().is_multiple_of(layout.record_bytes) {
            decoded.fault = Some(PotreeFault::Cut);
        }
        Ok(decoded)
    }
}

/// What the first node that can be opened stores for each point, which is to be what all do.
fn schema(tree: &NodeTree, folders: &NodeFolders, ending: &'static str) -> Schema {
    let nothing = Schema::default();
    let files = LasNodes { folders, ending, schema: &nothing };
    let first = tree.nodes.iter().filter(|node| node.num_bytes > 0).find_map(|node| files.open(node).ok());
    first.map(|first| first.header().schema.clone()).unwrap_or_default()
}

impl Dataset for PotreeFiles {
    fn header(&self) -> &Header {
        &self.header
    }

    fn read(&self, want: &Projection, take: &mut Take, progress: &Progress) -> Result<Trailer, ScanError> {
        let Self { cloud, folders, tree, header } = self;
        let (read, white) = match &cloud.files {
            NodeFiles::Binary(layout) => {
                let grid = PotreeGrid::of(tree.root, cloud.scale);
                let wanted = layout.columns.wanted(want);
                let decode = |node: &StoredNode| {
                    let corner = grid.corner(node.key);
                    let decoded = self.records(node, layout, |bytes| {
                        let place = |stored| grid.place(corner, stored);
                        let (block, num_far) = layout.records(bytes, &wanted, grid.grid, place)?;
                        Some(DecodedNode { block: Some(block), num_far, ..DecodedNode::default() })
                    })?;
                    let num_points = decoded.block.as_ref().map_or(0, |block| block.xyz.len());
                    progress.add(num_points as u64);
                    Ok(decoded)
                };
                let read = nodes::read(&tree.nodes, decode, want.block_points(), take, progress)?;
                (read, layout.columns.white)
            }
            NodeFiles::Las(ending) => {
                let files = LasNodes { folders, ending, schema: &header.schema };
                let common = files.common_grid(tree, progress)?;
                let decode = |node: &StoredNode| files.decode(node, &common, want, progress);
                (nodes::read(&tree.nodes, decode, want.block_points(), take, progress)?, None)
            }
        };
        trailer(header, tree, cloud.announced_points, read).map(|trailer| Trailer { white, ..trailer })
    }
}

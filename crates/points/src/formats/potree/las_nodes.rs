//! The nodes of Potree 1 that are LAS or LAZ files: each is read as the file that it is, and put on the grid of the first.
//!
//! Nodes on one grid, as the converter writes them, are handed over as they are. Grids of one scale that are whole steps
//! apart are shifted, exactly. For all others a grid is made, as for formats that store other numbers, after all places
//! were read once.

use super::hrc::NodeFolders;
use super::nodes::{DecodedNode, PotreeFault};
use super::tree::{NodeTree, StoredNode};
use crate::block::Block;
use crate::column::Column;
use crate::formats::{Dataset, Format, OpenHints, las};
use crate::grid::FittedGrid;
use crate::source::Source;
use crate::stats::Stats;
use crate::{Grid, Projection, ScanError, Schema};
use base::space::Bounds;
use base::task::{Cancelled, Progress};
use rayon::prelude::*;
use std::io::ErrorKind;

/// Part of a step that grids may be apart from whole steps: less than what decimals lose in an offset.
const MOST_OFF: f64 = 1e-3;
/// Places that a grid is chosen by.
const SAMPLE: usize = 1 << 18;

/// The nodes' files.
pub(super) struct LasNodes<'a> {
    pub folders: &'a NodeFolders,
    pub ending: &'static str,
    /// What all nodes store for each point.
    pub schema: &'a Schema,
}

/// The grid that nodes are put on.
pub(super) enum CommonGrid {
    /// That of all nodes, or one of the same steps.
    Steps(Grid),
    /// One that was made for all places.
    Fitted(Box<FittedGrid>),
}

impl LasNodes<'_> {
    /// Opens a node's file.
    pub fn open(&self, node: &StoredNode) -> Result<Box<dyn Dataset>, PotreeFault> {
        let path = self.folders.file(node.key, self.ending);
        las::Las.open(&path, &OpenHints::default()).map_err(|error| self.fault(node, &error))
    }

    fn fault(&self, node: &StoredNode, error: &ScanError) -> PotreeFault {
        let path = self.folders.file(node.key, self.ending);
        let starts_as = |start: &[u8]| std::fs::read(&path).is_ok_and(|bytes| bytes.starts_with(start));
        match error {
            ScanError::Io { error, .. } if error.kind() == ErrorKind::NotFound => PotreeFault::Missing,
            _ if node.num_bytes < 1024 && starts_as(b"version https://git-lfs") => PotreeFault::Pointer,
            // The error names the file, which has the node's name.
            error => PotreeFault::Damaged(error.to_string()),
        }
    }

    /// Reads a node, without its place on the common grid.
    fn blocks(
        &self,
        node: &StoredNode,
        want: &Projection,
        progress: &Progress,
    ) -> Result<(Vec<Block>, Option<PotreeFault>), ScanError> {
        let dataset = match self.open(node) {
            Ok(dataset) => dataset,
            Err(fault) => return Ok((Vec::new(), Some(fault))),
        };
        if dataset.header().schema != *self.schema {
            return Ok((Vec::new(), Some(PotreeFault::Differs)));
        }
        let mut blocks = Vec::new();
        let mut take = |block| {
            blocks.push(block);
            Ok(())
        };
        match dataset.read(want, &mut take, progress) {
            Ok(trailer) => {
                let fault = trailer.losses.into_iter().next().map(PotreeFault::Damaged);
                Ok((blocks, fault))
            }
            Err(error @ (ScanError::Cancelled(_) | ScanError::Memory { .. })) => Err(error),
            Err(error) => Ok((Vec::new(), Some(self.fault(node, &error)))),
        }
    }

    /// Finds the grid for all nodes: the first's, if all can be put on it exactly.
    ///
    /// # Errors
    /// The user stops it, or there is no memory.
    pub fn common_grid(&self, tree: &NodeTree, progress: &Progress) -> Result<CommonGrid, ScanError> {
        let grids: Vec<Grid> = tree
            .nodes
            .par_iter()
            .filter(|node| node.num_bytes > 0 && !progress.is_cancelled())
            .filter_map(|node| las::grid(&Source::open(&self.folders.file(node.key, self.ending)).ok()?).ok())
            .collect();
        if progress.is_cancelled() {
            return Err(Cancelled.into());
        }
        let Some(&first) = grids.first() else { return Ok(CommonGrid::Steps(Grid::default())) };
        if grids.iter().all(|grid| shift(*grid, first).is_some()) {
            return Ok(CommonGrid::Steps(first));
        }
        self.fitted(tree, progress)
    }

    /// The grid for all places, which are read for it.
    fn fitted(&self, tree: &NodeTree, progress: &Progress) -> Result<CommonGrid, ScanError> {
        let none = Projection::of([]);
        let each = SAMPLE.div_ceil(tree.nodes.len().max(1));
        let hidden = Progress::hidden();
        let survey = |node: &StoredNode| {
            if progress.is_cancelled() {
                return Err(Cancelled.into());
            }
            let (mut sample, mut bounds) = (Vec::new(), Bounds::EMPTY);
            for block in self.blocks(node, &none, &hidden)?.0 {
                let places = block.xyz.iter().map(|&xyz| block.grid.p_in_world(xyz));
                bounds = places.clone().fold(bounds, Bounds::with);
                sample.extend(places.step_by(block.xyz.len().div_ceil(each).max(1)));
            }
            Ok((sample, bounds))
        };
        let found = tree.nodes.par_iter().map(survey).collect::<Result<Vec<_>, ScanError>>()?;
        let all = found.iter().fold(Bounds::EMPTY, |all, (_, bounds)| all.union(*bounds));
        let sample = found.into_iter().flat_map(|(sample, _)| sample).collect();
        Ok(CommonGrid::Fitted(Box::new(FittedGrid::over(sample, all))))
    }

    /// Reads a node onto the common grid.
    ///
    /// # Errors
    /// The user stops it, or there is no memory.
    pub fn decode(
        &self,
        node: &StoredNode,
        common: &CommonGrid,
        want: &Projection,
        progress: &Progress,
    ) -> Result<DecodedNode, ScanError> {
        let (blocks, fault) = self.blocks(node, want, progress)?;
        let mut decoded = DecodedNode { fault, ..DecodedNode::default() };
        for block in blocks {
            let (block, num_far) = common.put(block);
            decoded.num_far += num_far;
            decoded.block = Some(match decoded.block.take() {
                Some(before) => super::nodes::joined(before, block),
                None => block,
            });
        }
        Ok(decoded)
    }
}

impl CommonGrid {
    /// Puts a block on this grid, without the points that it does not hold; their number.
    fn put(&self, block: Block) -> (Block, u64) {
        let own = block.grid;
        match self {
            Self::Steps(grid) => match shift(own, *grid) {
                Some([0, 0, 0]) => (Block { grid: *grid, ..block }, 0),
                Some(by) => moved(block, *grid, |xyz| {
                    let mut placed = [0; 3];
                    for axis in 0..3 {
                        placed[axis] = i32::try_from(i64::from(xyz[axis]) + by[axis]).ok()?;
                    }
                    Some(placed)
                }),
                // All nodes were looked at, so this one changed since.
                None => moved(block, *grid, |_| None),
            },
            Self::Fitted(fitted) => moved(block, fitted.grid, |xyz| {
                let p = own.p_in_world(xyz).to_array();
                fitted.holds(&p).then(|| fitted.snap(&p))
            }),
        }
    }
}

/// Steps by which one grid's origin is from another's; `None` if these are no whole steps of the same size.
fn shift(from: Grid, to: Grid) -> Option<[i64; 3]> {
    if from.scale != to.scale {
        return None;
    }
    let steps = (from.offset - to.offset) / to.scale;
    let is_whole =
        steps.to_array().iter().all(|steps| steps.abs() < 1e15 && (steps - steps.round()).abs() <= MOST_OFF);
    is_whole.then(|| steps.to_array().map(|steps| steps.round() as i64))
}

/// A block on another grid, without the points that have no place there; their number.
fn moved(mut block: Block, grid: Grid, place: impl Fn([i32; 3]) -> Option<[i32; 3]>) -> (Block, u64) {
    let placed: Vec<Option<[i32; 3]>> = block.xyz.iter().map(|&xyz| place(xyz)).collect();
    let num_far = placed.iter().filter(|placed| placed.is_none()).count() as u64;
    if num_far > 0 {
        let columns =
            block.columns.iter().map(|(attribute, column)| (attribute.clone(), kept(column, &placed)));
        block.columns = columns.collect();
    }
    block.xyz = placed.into_iter().flatten().collect();
    (Block { grid, stats: Stats::EMPTY, ..block }.with_stats(), num_far)
}

/// The values of the points that have a place.
fn kept(column: &Column, placed: &[Option<[i32; 3]>]) -> Column {
    let mut kept = Column::new(column.kind());
    let is_kept = |at: usize| placed[at].is_some();
    let left = || (0..placed.len()).filter(|&at| is_kept(at));
    kept.take_from(column, left());
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Attribute;
    use glam::DVec3;

    fn grid(scale: f64, offset: [f64; 3]) -> Grid {
        Grid { scale: DVec3::splat(scale), offset: DVec3::from_array(offset) }
    }

    fn block(grid: Grid, xyz: &[[i32; 3]]) -> Block {
        let mut block = Block::new(grid, []);
        block.xyz = xyz.to_vec();
        let values = (0..xyz.len() as u16).collect();
        block.columns.push((Attribute::SourceId, Column::U16(values)));
        block
    }

    #[test]
    fn whole_steps_are_shifted_exactly_and_others_are_not() {
        let to = grid(0.001, [400_000.0, 7_000_000.123, 0.0]);
        assert_eq!(shift(grid(0.001, [400_000.5, 7_000_000.121, -1.0]), to), Some([500, -2, -1000]));
        assert_eq!(shift(grid(0.001, [400_000.000_5, 7_000_000.123, 0.0]), to), None);
        assert_eq!(shift(grid(0.01, [400_000.0, 7_000_000.123, 0.0]), to), None);
        let own = grid(0.001, [400_000.5, 7_000_000.123, 0.0]);
        let (put, num_far) =
            CommonGrid::Steps(to).put(block(own, &[[1, 2, 3], [i32::MAX, 0, 0], [-500, 0, 9]]));
        assert_eq!((put.xyz, num_far), (vec![[501, 2, 3], [0, 0, 9]], 1));
        assert_eq!(put.columns[0].1, Column::U16(vec![0, 2]));
        assert_eq!(put.stats.xyz_max, [501, 2, 9]);
    }

    #[test]
    fn other_grids_are_fitted_within_half_a_step() {
        let nodes = [grid(0.001, [5.0005, 0.0, 0.0]), grid(0.01, [5.0, 1.0, 2.0])];
        let xyz: Vec<[i32; 3]> = (0..50).map(|at| [at * 37, at * 11 - 200, at]).collect();
        let places: Vec<DVec3> =
            nodes.iter().flat_map(|node| xyz.iter().map(|&xyz| node.p_in_world(xyz))).collect();
        let all = Bounds::around(&places);
        let fitted = FittedGrid::over(places.clone(), all);
        let most = 0.5 * fitted.grid.scale.max_element() * (1.0 + 1e-6);
        let common = CommonGrid::Fitted(Box::new(fitted));
        let mut expected = places.iter();
        for node in nodes {
            let (put, num_far) = common.put(block(node, &xyz));
            assert_eq!(num_far, 0);
            for xyz in put.xyz {
                let moved = (put.grid.p_in_world(xyz) - *expected.next().unwrap()).abs().max_element();
                assert!(moved <= most && most < 1e-8, "{moved} {most}");
            }
        }
    }
}

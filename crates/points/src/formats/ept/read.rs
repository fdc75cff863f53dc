//! Reads the nodes in groups, in parallel, breadth first, and hands over what follows each other in larger blocks.

use super::hierarchy::{EptNode, EptTree};
use super::info::{EptInfo, NodePacking};
use super::nodes::{self, EptFault};
use super::ranges::Ranges;
use super::records::{RecordReader, has_columns};
use super::regrid;
use crate::block::Block;
use crate::column::{Column, Type};
use crate::formats::las::Las;
use crate::formats::{Dataset, Format, OpenHints, Take};
use crate::source::Source;
use crate::{Attribute, Grid, Projection, ScanError, Schema};
use base::task::{Cancelled, Progress};
use base::words::{agreeing, counted};
use rayon::prelude::*;
use std::path::Path;

/// Nodes in work for each thread.
const NODES_PER_THREAD: usize = 2;
/// Most points of a block, however large blocks may be.
const MOST_BLOCK_POINTS: usize = 1 << 20;
/// Nodes that are named one by one.
const MOST_NAMED: usize = 5;

/// What is read, and how.
pub(super) struct EptReading<'a> {
    pub folder: &'a Path,
    pub info: &'a EptInfo,
    pub tree: &'a EptTree,
    /// Attributes of the points.
    pub schema: &'a Schema,
    /// The scan's grid, where its nodes are LAZ files.
    pub grid: Grid,
    pub want: &'a Projection,
    pub progress: &'a Progress,
}

/// The points of a node.
#[derive(Debug)]
pub(super) struct NodePoints {
    block: Block,
    /// What could not be read, as ends of sentences.
    losses: Vec<String>,
    /// Points left out, because they have no place.
    num_without_place: u64,
    /// True if it has not all columns.
    lacks_columns: bool,
    /// The largest step that its points moved, in steps of the scan's grid, if they were put on it.
    moved: Option<f64>,
}

/// What was read.
#[derive(Debug, Default)]
pub(super) struct EptRead {
    pub num_points: u64,
    pub losses: Vec<String>,
    pub warnings: Vec<String>,
}

impl EptReading<'_> {
    /// Reads all nodes.
    ///
    /// # Errors
    /// The user stops it, there is no memory, nothing can be read, or `take` fails.
    pub fn all(&self, take: &mut Take) -> Result<EptRead, ScanError> {
        match self.info.packing {
            NodePacking::Laszip => {
                let wanted = self.schema.fields.iter().filter(|field| self.want.wants(&field.attribute));
                let columns: Vec<_> = wanted.map(|field| (field.attribute.clone(), field.kind)).collect();
                self.read(take, &|node| self.laz_node(node, &columns))
            }
            NodePacking::Binary | NodePacking::Zstandard => {
                let ranges = self.ranges()?;
                let reader = RecordReader::new(&self.info.dims, self.want, ranges.as_ref());
                self.read(take, &|node| self.record_node(node, &reader))
            }
        }
    }

    /// The ranges of all points, if they are needed.
    fn ranges(&self) -> Result<Option<Ranges>, ScanError> {
        let dims = &self.info.dims;
        let intensity = dims.intensity_to_spread(self.want);
        if !dims.needs_ranges_of_places() && intensity.is_none() {
            return Ok(None);
        }
        let of_node = |node: &EptNode| {
            self.progress.check()?;
            match nodes::records(self.folder, self.info, node) {
                Ok(records) => Ok(Ranges::of(dims, intensity, &records.bytes)),
                Err(EptFault::Fatal(error)) => Err(error),
                // It is told by the second pass.
                Err(_) => Ok(Ranges::none(dims, intensity)),
            }
        };
        let none = || Ranges::none(dims, intensity);
        let all = self.tree.nodes.par_iter().map(of_node);
        let all = all.try_reduce(none, |a, b| Ok(a.union(b)))?;
        Ok(Some(all))
    }

    /// Reads a group of nodes while the group before it is handed over.
    fn read(
        &self,
        take: &mut Take,
        read_node: &(dyn Fn(&EptNode) -> Result<NodePoints, EptFault> + Sync),
    ) -> Result<EptRead, ScanError> {
        let mut merger = NodeMerger::new(self, take);
        let mut before = Vec::new();
        for group in self.tree.nodes.chunks(NODES_PER_THREAD * rayon::current_num_threads()) {
            let read = || group.par_iter().map(|node| (*node, read_node(node))).collect::<Vec<_>>();
            let handed_over = std::mem::take(&mut before);
            let (now, done) = rayon::join(read, || merger.take_in(handed_over));
            done?;
            before = now;
            if self.progress.is_cancelled() {
                return Err(Cancelled.into());
            }
        }
        merger.take_in(before)?;
        merger.finish()
    }

    fn record_node(&self, node: &EptNode, reader: &RecordReader) -> Result<NodePoints, EptFault> {
        self.progress.check().map_err(ScanError::from)?;
        let records = nodes::records(self.folder, self.info, node)?;
        let (block, num_without_place) = reader.block(&records.bytes).map_err(|_| self.memory(node))?;
        self.progress.add(block.xyz.len() as u64);
        let losses = records.loss.into_iter().collect();
        Ok(NodePoints { block, losses, num_without_place, lacks_columns: false, moved: None })
    }

    fn laz_node(&self, node: &EptNode, columns: &[(Attribute, Type)]) -> Result<NodePoints, EptFault> {
        self.progress.check().map_err(ScanError::from)?;
        let path = nodes::path(self.folder, node.key, NodePacking::Laszip);
        let file = open_laz(&path)?;
        let mut all: Option<Block> = None;
        let most = nodes::most_points(node.announced);
        let mut take = |block: Block| match &mut all {
            Some(all) if (all.xyz.len() + block.xyz.len()) as u64 > most => {
                let reason = format!("they are more than {most}, far more than its hierarchy announces");
                Err(ScanError::Compression { path: path.clone(), reason })
            }
            Some(all) => all.append(block).map_err(|_| self.memory_error(node)),
            None => {
                all = Some(block);
                Ok(())
            }
        };
        let end = file.read(self.want, &mut take, self.progress)?;
        let Some(mut block) = all else { return Err(EptFault::Unreadable("holds no points".into())) };
        let lacks_columns = !has_columns(&block, columns);
        if lacks_columns {
            block = with_columns(block, columns).ok_or_else(|| self.memory(node))?;
        }
        let (mut num_without_place, mut moved) = (0, None);
        if block.grid != self.grid {
            (num_without_place, moved) = regrid::onto(&mut block, self.grid);
        }
        Ok(NodePoints { block, losses: end.losses, num_without_place, lacks_columns, moved })
    }

    fn memory_error(&self, node: &EptNode) -> ScanError {
        ScanError::Memory { path: self.folder.to_owned(), num_points: node.announced }
    }

    fn memory(&self, node: &EptNode) -> EptFault {
        EptFault::Fatal(self.memory_error(node))
    }
}

/// Opens the LAZ file of a node.
pub(super) fn open_laz(path: &Path) -> Result<Box<dyn Dataset>, EptFault> {
    let head = Source::open(path)?.bytes(0, 4)?;
    if head != b"LASF" {
        return Err(EptFault::Unreadable("is no LAZ file".into()));
    }
    Ok(Las.open(path, &OpenHints::default())?)
}

/// The block with these columns: its own, or else zeros. `None` if there is no memory.
fn with_columns(block: Block, columns: &[(Attribute, Type)]) -> Option<Block> {
    let Block { grid, xyz, columns: mut found, stats } = block;
    let column = |(attribute, kind): &(Attribute, Type)| {
        let is_it = |(other, column): &(Attribute, Column)| other == attribute && column.kind() == *kind;
        let column = match found.iter().position(is_it) {
            Some(at) => found.swap_remove(at).1,
            None => Column::zeros(*kind, xyz.len())?,
        };
        Some((attribute.clone(), column))
    };
    let columns = columns.iter().map(column).collect::<Option<_>>()?;
    Some(Block { grid, xyz, columns, stats })
}

/// Nodes' points on their way to whoever wants them.
struct NodeMerger<'a, 'b> {
    reading: &'a EptReading<'a>,
    take: &'a mut Take<'b>,
    /// Points that are to be handed over together.
    block: Option<Block>,
    most: usize,
    read: EptRead,
    missing: Vec<EptNode>,
    unreadable: Vec<String>,
    num_without_place: u64,
    lacking: Vec<EptNode>,
    moved: Vec<(EptNode, f64)>,
    miscounted: Vec<EptNode>,
}

impl<'a, 'b> NodeMerger<'a, 'b> {
    fn new(reading: &'a EptReading<'a>, take: &'a mut Take<'b>) -> Self {
        Self {
            reading,
            take,
            block: None,
            most: reading.want.block_points().min(MOST_BLOCK_POINTS),
            read: EptRead::default(),
            missing: Vec::new(),
            unreadable: Vec::new(),
            num_without_place: 0,
            lacking: Vec::new(),
            moved: Vec::new(),
            miscounted: Vec::new(),
        }
    }

    fn take_in(&mut self, nodes: Vec<(EptNode, Result<NodePoints, EptFault>)>) -> Result<(), ScanError> {
        for (node, points) in nodes {
            match points {
                Ok(points) => self.add(node, points)?,
                Err(EptFault::Fatal(error)) => return Err(error),
                // A node without points need not have a file.
                Err(EptFault::Missing) if node.announced == 0 => {}
                Err(EptFault::Missing) => self.missing.push(node),
                Err(EptFault::Unreadable(reason)) => {
                    self.unreadable.push(format!("node {} {reason}; it is left out", node.key));
                }
            }
        }
        Ok(())
    }

    fn add(&mut self, node: EptNode, points: NodePoints) -> Result<(), ScanError> {
        let NodePoints { block, losses, num_without_place, lacks_columns, moved } = points;
        let num_points = block.xyz.len() as u64;
        self.unreadable.extend(losses.iter().map(|loss| format!("node {} {loss}", node.key)));
        self.num_without_place += num_without_place;
        self.lacking.extend(lacks_columns.then_some(node));
        self.moved.extend(moved.map(|steps| (node, steps)));
        let is_miscounted = num_points + num_without_place != node.announced && losses.is_empty();
        self.miscounted.extend(is_miscounted.then_some(node));
        self.read.num_points += num_points;
        if num_points == 0 {
            return Ok(());
        }
        match &mut self.block {
            Some(held) if held.xyz.len() + block.xyz.len() <= self.most => {
                let memory = |_| self.reading.memory_error(&node);
                held.append(block).map_err(memory)
            }
            held => match held.replace(block) {
                Some(full) => (self.take)(full),
                None => Ok(()),
            },
        }
    }

    /// Hands over the rest, and says what is lost and odd.
    fn finish(mut self) -> Result<EptRead, ScanError> {
        if let Some(last) = self.block.take() {
            (self.take)(last)?;
        }
        let num_missing = self.missing.len();
        if num_missing > 0 {
            let (nodes, are) = (counted(num_missing, "node"), agreeing(num_missing, "is", "are"));
            let files = agreeing(num_missing, "whose file", "whose files");
            self.read.losses.push(format!("has {nodes} {files} {are} missing ({})", names(&self.missing)));
        }
        let more = self.unreadable.len().saturating_sub(MOST_NAMED);
        self.read.losses.extend(self.unreadable.into_iter().take(MOST_NAMED));
        if more > 0 {
            let (nodes, are) = (counted(more, "more node"), agreeing(more, "is", "are"));
            self.read.losses.push(format!("{nodes} {are} damaged"));
        }
        let warnings = &mut self.read.warnings;
        if self.num_without_place > 0 {
            let (num, are) = (self.num_without_place, agreeing(self.num_without_place, "is", "are"));
            let points = counted(num, "point");
            warnings.push(format!(
                "has {points} without a place, or too far from all others, that {are} left out"
            ));
        }
        if !self.miscounted.is_empty() {
            let nodes = counted(self.miscounted.len(), "node");
            let numbers = agreeing(self.miscounted.len(), "another number", "other numbers");
            let names = names(&self.miscounted);
            warnings.push(format!(
                "has {nodes} with {numbers} of points than its hierarchy announces ({names}); all were read"
            ));
        }
        if !self.lacking.is_empty() {
            let nodes = counted(self.lacking.len(), "node");
            let names = names(&self.lacking);
            warnings.push(format!("has {nodes} without all attributes ({names}), which are 0 there"));
        }
        if let Some((_, most)) = self.moved.iter().max_by(|a, b| a.1.total_cmp(&b.1)) {
            let nodes: Vec<EptNode> = self.moved.iter().map(|(node, _)| *node).collect();
            let (num, names) = (counted(nodes.len(), "node"), names(&nodes));
            let moved = if *most < 1e-3 { "exactly".into() } else { format!("by up to {most:.2} steps") };
            warnings
                .push(format!("has {num} on other grids than its own ({names}); their points moved {moved}"));
        }
        Ok(self.read)
    }
}

/// Names of nodes in a sentence: "1-0-0-0, 2-1-1-1 and 4 more".
fn names(nodes: &[EptNode]) -> String {
    let named: Vec<String> = nodes.iter().take(MOST_NAMED).map(|node| node.key.to_string()).collect();
    match nodes.len().saturating_sub(MOST_NAMED) {
        0 => named.join(", "),
        more => format!("{} and {more} more", named.join(", ")),
    }
}

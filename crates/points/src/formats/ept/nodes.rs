//! The files of nodes: their records, unpacked and compared with the schema before any is taken for points.

use super::dims::Dims;
use super::hierarchy::EptNode;
use super::info::{EptInfo, NodePacking};
use crate::ScanError;
use crate::formats::node::NodeKey;
use crate::formats::zstd::{MOST_WINDOW, ZstdReader};
use crate::source::Source;
use base::space::Bounds;
use base::words::counted;
use glam::DVec3;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

/// Bytes and points that a node may have beside those that the hierarchy announces, and times as many as those.
const BYTES_FOR_FREE: u64 = 16 << 20;
const POINTS_FOR_FREE: u64 = 1 << 22;
const MOST_TIMES: u64 = 4;
/// Most bytes that a packed byte may become: records of equal points come near.
const MOST_RATIO: u64 = 2000;
/// Edges that points may lie beyond their node, if nothing else vouches for them.
const BEYOND: f64 = 0.01;

/// Why a node's points are lost.
#[derive(Debug)]
pub(super) enum EptFault {
    /// Its file is not there.
    Missing,
    /// Its file cannot be read, as the end of a sentence.
    Unreadable(String),
    /// Nothing more is to be read.
    Fatal(ScanError),
}

/// The records of a node.
#[derive(Debug, Default)]
pub(super) struct NodeRecords {
    pub bytes: Vec<u8>,
    /// What could not be read, as the end of a sentence.
    pub loss: Option<String>,
}

impl From<ScanError> for EptFault {
    fn from(error: ScanError) -> Self {
        match error {
            ScanError::Io { error, .. } if error.kind() == io::ErrorKind::NotFound => Self::Missing,
            error @ (ScanError::Cancelled(_) | ScanError::Memory { .. }) => Self::Fatal(error),
            error => Self::Unreadable(format!("cannot be read ({error})")),
        }
    }
}

/// Where a node's file is.
pub(super) fn path(folder: &Path, key: NodeKey, packing: NodePacking) -> PathBuf {
    folder.join("ept-data").join(format!("{key}.{}", packing.ending()))
}

/// Reads the records of a node that is no LAZ file.
pub(super) fn records(folder: &Path, info: &EptInfo, node: &EptNode) -> Result<NodeRecords, EptFault> {
    let source = Source::open(&path(folder, node.key, info.packing))?;
    let record_bytes = info.dims.record_bytes as u64;
    let announced = node.announced.saturating_mul(record_bytes);
    let (mut bytes, loss) = match info.packing {
        NodePacking::Zstandard => unpack(&source, announced)?,
        _ => (source.bytes(0, most_bytes(announced) + 1)?, None),
    };
    if bytes.len() as u64 > most_bytes(announced) {
        let reason =
            format!("has more than {MOST_TIMES} times the bytes of {}", counted(node.announced, "point"));
        return Err(EptFault::Unreadable(reason));
    }
    let (num, rest) = (bytes.len() as u64 / record_bytes, bytes.len() as u64 % record_bytes);
    if num == node.announced && rest == 0 {
        return Ok(NodeRecords { bytes, loss });
    }
    let whole = &bytes[..(num * record_bytes) as usize];
    // Another number of points may be true, but it may also be that the schema describes other points.
    let is_longer = num >= node.announced;
    if rest != 0 && is_longer || !lie_in_node(info, node, whole) {
        return Err(EptFault::Unreadable(format!(
            "has {} for {}, which are not the {record_bytes} each that the schema describes",
            counted(bytes.len(), "byte"),
            counted(node.announced, "point"),
        )));
    }
    bytes.truncate((num * record_bytes) as usize);
    let cut_off = || format!("has {num} of {}", counted(node.announced, "point"));
    Ok(NodeRecords { bytes, loss: loss.or_else(|| (!is_longer).then(cut_off)) })
}

/// Most bytes that a node may have whose points should have so many.
fn most_bytes(announced: u64) -> u64 {
    announced.saturating_mul(MOST_TIMES).saturating_add(BYTES_FOR_FREE).min(u64::MAX - 1)
}

/// Most points that a node may have of which the hierarchy announces so many.
pub(super) fn most_points(announced: u64) -> u64 {
    announced.saturating_mul(MOST_TIMES).saturating_add(POINTS_FOR_FREE)
}

/// Unpacks a node, as far as it can be, within bounds.
fn unpack(source: &Source, announced: u64) -> Result<(Vec<u8>, Option<String>), EptFault> {
    let by_size = source.len().saturating_mul(MOST_RATIO).saturating_add(1 << 16);
    let most = most_bytes(announced).min(by_size);
    let window = most.next_power_of_two().min(MOST_WINDOW);
    let packed = BufReader::with_capacity(1 << 16, source.reader(0));
    let (mut bytes, mut unpacked) = (Vec::new(), ZstdReader::new(packed, window).take(most + 1));
    // The size that the hierarchy announces is taken only as far as the packed bytes bear it out.
    let expected = announced.min(source.len().saturating_mul(8));
    let memory = |_| EptFault::Unreadable("needs more memory than there is".into());
    bytes.try_reserve(usize::try_from(expected).unwrap_or(0)).map_err(memory)?;
    let loss = unpacked
        .read_to_end(&mut bytes)
        .err()
        .map(|error| format!("is damaged after {} ({error})", counted(bytes.len(), "byte")));
    if bytes.len() as u64 > most {
        let points = counted(announced, "byte");
        return Err(EptFault::Unreadable(format!("unpacks to more than {most} instead of {points}")));
    }
    match loss {
        Some(loss) if bytes.is_empty() => Err(EptFault::Unreadable(loss)),
        loss => Ok((bytes, loss)),
    }
}

/// True if all records have places in the node's cube, and there is one.
fn lie_in_node(info: &EptInfo, node: &EptNode, records: &[u8]) -> bool {
    let Some(Bounds { min, max }) = info.cube else { return false };
    let (corner, part) = node.key.cube();
    let (corner, edge) = (min + (max - min) * DVec3::from_array(corner), (max - min) * part);
    let cube = Bounds { min: corner, max: corner + edge }.grown(BEYOND * edge.max_element());
    let Dims { record_bytes, places, .. } = &info.dims;
    let place = |record: &[u8]| DVec3::from_array([0, 1, 2].map(|axis| places[axis].value(record)));
    records.chunks_exact(*record_bytes).all(|record| cube.contains(place(record)))
}

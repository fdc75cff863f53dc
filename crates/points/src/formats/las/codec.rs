//! One chunk of LAZ points: what it must look like, and its decompression.
//!
//! A chunk is checked before it is handed to the decompressor, which believes sizes that a chunk states.

use super::record::{self, Extractor};
use crate::block::Block;
use crate::{Attribute, Grid};
use base::words::counted;
use laz::laszip::LazItemType;
use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor};
use laz::{DecompressionSelection, LazItem};
use std::io::{self, Cursor, Read, Seek};

/// Records that are decompressed before they become columns: few enough to stay in a core's cache.
const RUN_POINTS: u64 = 1 << 12;
/// Most points that a chunk may hold per byte. Real chunks hold less than one; only made-up chunks with thousands of
/// equal points come near.
const MOST_POINTS_PER_BYTE: u64 = 1000;
/// Points that a chunk may hold on top of those per byte.
const POINTS_FOR_FREE: u64 = 1 << 16;
/// Points that memory is taken for at once, per byte that was really read.
const VOUCHED_POINTS_PER_BYTE: u64 = 2;

/// How the records of a file are compressed.
#[derive(Clone, Debug)]
pub(super) struct Codec {
    pub items: Vec<LazItem>,
    /// Bytes of a decompressed record.
    pub record_bytes: usize,
    /// True for LAS 1.4's layered chunks, which state their own count and size.
    pub layered: bool,
    num_layers: usize,
}

/// What the head of a layered chunk states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LayeredHead {
    pub num_points: u64,
    pub num_bytes: u64,
}

impl Codec {
    /// The codec of the items in a LASzip record.
    pub fn new(items: Vec<LazItem>) -> Result<Self, String> {
        let first = items.first().ok_or("its LASzip record lists no items")?;
        let layered = first.version() >= 3;
        if !matches!(first.item_type(), LazItemType::Point10 | LazItemType::Point14) {
            return Err("its LASzip record does not start with the point itself".into());
        }
        let num_layers = items.iter().map(|item| match item.item_type() {
            LazItemType::Point14 => 9,
            LazItemType::RGB14 | LazItemType::WavePacket14 => 1,
            LazItemType::RGBNIR14 => 2,
            LazItemType::Byte14(count) => usize::from(count),
            _ => 0,
        });
        let num_layers = num_layers.sum();
        let record_bytes = items.iter().map(|item| record::item_bytes(item.item_type())).sum();
        if record_bytes > usize::from(u16::MAX) {
            return Err(format!("its LASzip record describes points of {record_bytes} bytes"));
        }
        Ok(Self { items, record_bytes, layered, num_layers })
    }

    /// Bytes that every chunk has: its first point uncompressed, and a layered chunk's head.
    pub fn least_bytes(&self) -> usize {
        self.record_bytes + if self.layered { 4 + 4 * self.num_layers } else { 0 }
    }

    /// Reads the head of a layered chunk; `None` if `bytes` end before it does.
    pub fn layered_head(&self, bytes: &[u8]) -> Option<LayeredHead> {
        let head = bytes.get(self.record_bytes..self.least_bytes())?;
        let mut words = head.chunks_exact(4).map(|w| u64::from(u32::from_le_bytes([w[0], w[1], w[2], w[3]])));
        let num_points = words.next()?;
        Some(LayeredHead { num_points, num_bytes: self.least_bytes() as u64 + words.sum::<u64>() })
    }

    /// Decompresses the points of a whole chunk: `announced` points, if their number is known.
    ///
    /// # Errors
    /// Why the chunk is damaged, as the end of a sentence. May panic on damaged chunks.
    pub fn decode_chunk(
        &self,
        bytes: &[u8],
        announced: Option<u64>,
        wanted: &Wanted,
    ) -> Result<Block, String> {
        if bytes.len() < self.least_bytes() {
            return Err("is shorter than a single point".into());
        }
        let mut num_points = announced;
        if self.layered {
            let head = self.layered_head(bytes).ok_or("is shorter than its head")?;
            if head.num_bytes > bytes.len() as u64 {
                return Err(format!("states {} but has {}", counted(head.num_bytes, "byte"), bytes.len()));
            }
            if announced.is_some_and(|announced| announced != head.num_points) {
                return Err(format!(
                    "states {}, the file's table another number",
                    counted(head.num_points, "point")
                ));
            }
            num_points = Some(head.num_points);
        }
        let most = bytes.len() as u64 * MOST_POINTS_PER_BYTE + POINTS_FOR_FREE;
        let limit = num_points.unwrap_or(most);
        if limit > most {
            return Err(format!("states {} in {}", counted(limit, "point"), counted(bytes.len(), "byte")));
        }
        let mut block = wanted.extractor.block(wanted.grid);
        // Memory is taken at once for the points that the chunk's own bytes vouch for, and for more as they come.
        let vouched = limit.min(bytes.len() as u64 * VOUCHED_POINTS_PER_BYTE) as usize;
        block.reserve(vouched).map_err(|_| "needs more memory than there is")?;
        let mut cursor = Cursor::new(bytes);
        match self.decode(&mut cursor, limit, wanted, &mut block) {
            // Without a count, the end of the bytes is the end of the points.
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof && num_points.is_none() => {}
            Err(error) => return Err(format!("is damaged ({error})")),
            Ok(()) if !self.layered && num_points.is_some() && cursor.position() != bytes.len() as u64 => {
                let used = cursor.position();
                return Err(format!("is damaged (its points end at byte {used} of {})", bytes.len()));
            }
            Ok(()) => {}
        }
        Ok(block.with_stats())
    }

    /// Reads up to `num_points` points of one chunk that starts where `source` stands, and appends them.
    ///
    /// # Errors
    /// The source ends (the points before its end are whole), the chunk is damaged, or there is no memory. May panic on
    /// damage.
    pub fn decode<R: Read + Seek + Send + Sync>(
        &self,
        source: R,
        num_points: u64,
        wanted: &Wanted,
        block: &mut Block,
    ) -> io::Result<()> {
        let mut decompressor =
            self.decompressor(source, wanted.layers).map_err(|error| io::Error::other(error.to_string()))?;
        let mut records = vec![0; self.record_bytes * num_points.min(RUN_POINTS) as usize];
        let mut left = num_points;
        while left > 0 {
            let run = self.record_bytes * left.min(RUN_POINTS) as usize;
            let (mut num_bytes, mut end) = (0, Ok(()));
            for record in records[..run].chunks_exact_mut(self.record_bytes) {
                end = decompressor.decompress_next(record);
                if end.is_err() {
                    break;
                }
                num_bytes += self.record_bytes;
            }
            wanted.extractor.append(&records[..num_bytes], block).map_err(|_| io::ErrorKind::OutOfMemory)?;
            end?;
            left -= (num_bytes / self.record_bytes) as u64;
        }
        Ok(())
    }

    fn decompressor<'a, R: Read + Seek + Send + Sync + 'a>(
        &self,
        source: R,
        layers: DecompressionSelection,
    ) -> laz::Result<Box<dyn RecordDecompressor<R> + 'a>> {
        let mut decompressor: Box<dyn RecordDecompressor<R> + 'a> = if self.layered {
            Box::new(LayeredPointRecordDecompressor::new(source))
        } else {
            Box::new(SequentialPointRecordDecompressor::new(source))
        };
        decompressor.set_fields_from(&self.items)?;
        decompressor.set_selection(layers);
        Ok(decompressor)
    }
}

/// What is wanted of the points.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    pub grid: Grid,
    pub extractor: Extractor,
    /// Layers that have to be decompressed for the wanted attributes.
    pub layers: DecompressionSelection,
}

/// The layers of LAS 1.4's chunks that hold the wanted attributes. Places are always wanted.
pub(super) fn layers(extractor: &Extractor) -> DecompressionSelection {
    use Attribute as A;
    let mut layers = DecompressionSelection::base().decompress_z();
    for (attribute, _) in extractor.columns() {
        layers = match attribute {
            A::Intensity => layers.decompress_intensity(),
            A::Classification | A::Noise => layers.decompress_classification(),
            A::Synthetic
            | A::KeyPoint
            | A::Withheld
            | A::Overlap
            | A::ScanDirection
            | A::EdgeOfFlightLine => layers.decompress_flags(),
            A::ScanAngle => layers.decompress_scan_angle(),
            A::UserData => layers.decompress_user_data(),
            A::SourceId => layers.decompress_point_source_id(),
            A::GpsTime => layers.decompress_gps_time(),
            A::Color => layers.decompress_rgb(),
            A::NearInfrared => layers.decompress_nir(),
            A::Waveform(_) => layers.decompress_wavepacket(),
            A::Named(_) => layers.decompress_extra_bytes(),
            A::ReturnNumber | A::NumReturns | A::ScannerChannel | A::Normal | A::Opacity => layers,
        };
    }
    layers
}

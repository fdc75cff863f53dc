//! One chunk of LAZ points: what it must look like, and its decompression.
//!
//! A chunk is checked before it is handed to the decompressor, which believes sizes that a chunk states.

use super::record::{Flags, Layout};
use crate::Points;
use base::words::counted;
use laz::laszip::LazItemType;
use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor};
use laz::{DecompressionSelection, LazItem};
use std::io::{self, Cursor, Read, Seek};

/// Records decompressed between two requests for memory.
const BLOCK_POINTS: usize = 1 << 12;
/// Points that a chunk may hold per byte, and on top of that. Real chunks hold less than one a byte; only
/// made-up ones with thousands of equal points come near.
const MOST_POINTS_PER_BYTE: u64 = 1000;
const POINTS_FOR_FREE: u64 = 1 << 16;
/// Points that memory is taken for at once, per byte that was really read.
const VOUCHED_POINTS_PER_BYTE: u64 = 2;

/// How the records of a file are compressed.
#[derive(Clone, Debug)]
pub(super) struct Codec {
    items: Vec<LazItem>,
    /// Columns of a decompressed record.
    pub layout: Layout,
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
    /// From the items of the LASzip record. The layout follows the items and not the point format: some writers
    /// leave out what they do not compress (waveforms), and the rest is still readable.
    pub fn new(items: Vec<LazItem>) -> Result<Self, String> {
        let first = items.first().ok_or("its LASzip record lists no items")?;
        let layered = first.version() >= 3;
        if !matches!(first.item_type(), LazItemType::Point10 | LazItemType::Point14) {
            return Err("its LASzip record does not start with the point itself".into());
        }
        let (mut record_bytes, mut rgb_offset, mut num_layers) = (0, None, 0);
        for item in &items {
            let (bytes, layers) = match item.item_type() {
                LazItemType::Point10 => (20, 0),
                LazItemType::GpsTime => (8, 0),
                LazItemType::RGB12 => (6, 0),
                LazItemType::WavePacket13 => (29, 0),
                LazItemType::Byte(count) => (usize::from(count), 0),
                LazItemType::Point14 => (30, 9),
                LazItemType::RGB14 => (6, 1),
                LazItemType::RGBNIR14 => (8, 2),
                LazItemType::WavePacket14 => (29, 1),
                LazItemType::Byte14(count) => (usize::from(count), usize::from(count)),
            };
            let is_rgb =
                matches!(item.item_type(), LazItemType::RGB12 | LazItemType::RGB14 | LazItemType::RGBNIR14);
            rgb_offset = rgb_offset.or(is_rgb.then_some(record_bytes));
            record_bytes += bytes;
            num_layers += layers;
        }
        if record_bytes > usize::from(u16::MAX) {
            return Err(format!("its LASzip record describes points of {record_bytes} bytes"));
        }
        let is_extended = first.item_type() == LazItemType::Point14;
        let flags = if is_extended { Flags::EXTENDED } else { Flags::LEGACY };
        let layout = Layout { record_bytes, core_offset: 0, rgb_offset, flags };
        Ok(Self { items, layout, layered, num_layers })
    }

    /// Bytes that every chunk has: its first point uncompressed, and the head of a layered one.
    pub fn least_bytes(&self) -> usize {
        self.layout.record_bytes + if self.layered { 4 + 4 * self.num_layers } else { 0 }
    }

    /// Reads the head of a layered chunk; `None` if `bytes` end before it does.
    pub fn layered_head(&self, bytes: &[u8]) -> Option<LayeredHead> {
        let head = bytes.get(self.layout.record_bytes..self.least_bytes())?;
        let mut words = head.chunks_exact(4).map(|w| u64::from(u32::from_le_bytes([w[0], w[1], w[2], w[3]])));
        let num_points = words.next()?;
        Some(LayeredHead { num_points, num_bytes: self.least_bytes() as u64 + words.sum::<u64>() })
    }

    /// The points of a whole chunk; `announced` of them if that is known.
    ///
    /// # Errors
    /// Why the chunk is damaged, as the end of a sentence. May panic on damaged chunks.
    pub fn decode_chunk(
        &self,
        bytes: &[u8],
        announced: Option<u64>,
        show_withheld: bool,
    ) -> Result<Points, String> {
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
        let mut points = Points::default();
        // All at once if the chunk's own bytes vouch for it, otherwise as they come.
        let vouched = limit.min(bytes.len() as u64 * VOUCHED_POINTS_PER_BYTE) as usize;
        self.reserve(&mut points, vouched).map_err(|_| "needs more memory than there is")?;
        let mut cursor = Cursor::new(bytes);
        match self.decode(&mut cursor, limit, show_withheld, &mut points) {
            // Without a count, the end of the bytes is the end of the points.
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof && num_points.is_none() => {}
            Err(error) => return Err(format!("is damaged ({error})")),
            Ok(()) if !self.layered && num_points.is_some() && cursor.position() != bytes.len() as u64 => {
                let used = cursor.position();
                return Err(format!("is damaged (its points end at byte {used} of {})", bytes.len()));
            }
            Ok(()) => {}
        }
        Ok(points)
    }

    /// Reads up to `num_points` points of one chunk that starts where `source` stands, and appends them,
    /// but for those that are withheld and not to be shown.
    ///
    /// # Errors
    /// The end of the source (the points before it are whole), damage, no memory. May panic on damage.
    pub fn decode<R: Read + Seek + Send + Sync>(
        &self,
        source: R,
        num_points: u64,
        show_withheld: bool,
        points: &mut Points,
    ) -> io::Result<()> {
        let mut decompressor =
            self.decompressor(source).map_err(|error| io::Error::other(error.to_string()))?;
        let mut record = vec![0; self.layout.record_bytes];
        let mut left = num_points;
        while left > 0 {
            let block = left.min(BLOCK_POINTS as u64) as usize;
            self.reserve(points, block).map_err(|_| io::ErrorKind::OutOfMemory)?;
            for _ in 0..block {
                decompressor.decompress_next(&mut record)?;
                self.layout.push(&record, show_withheld, points);
            }
            left -= block as u64;
        }
        Ok(())
    }

    fn reserve(&self, points: &mut Points, more: usize) -> Result<(), std::collections::TryReserveError> {
        points.xyz.try_reserve(more)?;
        points.intensity.try_reserve(more)?;
        if self.layout.rgb_offset.is_some() { points.rgb.try_reserve(more) } else { Ok(()) }
    }

    fn decompressor<'a, R: Read + Seek + Send + Sync + 'a>(
        &self,
        source: R,
    ) -> laz::Result<Box<dyn RecordDecompressor<R> + 'a>> {
        let mut decompressor: Box<dyn RecordDecompressor<R> + 'a> = if self.layered {
            Box::new(LayeredPointRecordDecompressor::new(source))
        } else {
            Box::new(SequentialPointRecordDecompressor::new(source))
        };
        decompressor.set_fields_from(&self.items)?;
        let columns = DecompressionSelection::base()
            .decompress_z()
            .decompress_classification()
            .decompress_flags()
            .decompress_intensity()
            .decompress_rgb();
        decompressor.set_selection(columns);
        Ok(decompressor)
    }
}

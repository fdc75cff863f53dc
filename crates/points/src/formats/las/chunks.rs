//! Finds where the chunks of a LAZ file lie: by its chunk table, or, where that is lost, by the sizes that chunks
//! state.

use super::codec::Codec;
use crate::source::Source;
use crate::{ScanError, guard};
use base::words::counted;
use laz::laszip::ChunkTable;
use std::io::Cursor;

/// Bytes before the first chunk, which hold the position of the chunk table.
pub(super) const TABLE_POSITION_BYTES: u64 = 8;
/// Most bytes of an entry of the chunk table: two numbers of 32 bits, entropy coded.
const MOST_ENTRY_BYTES: u64 = 16;

/// A chunk of compressed points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LazChunk {
    /// First byte in the file.
    pub offset: u64,
    /// Size in bytes.
    pub num_bytes: u64,
    /// Number of points, where it is known.
    pub num_points: Option<u64>,
}

/// What is known of the chunks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Chunks {
    /// All chunks, from the chunk table.
    Listed(Vec<LazChunk>),
    /// Chunks found by following the sizes that they state, and why the table was of no use.
    Followed(Vec<LazChunk>, String),
    /// No chunks, so that points must be decompressed one after the other, and why.
    Unknown(String),
}

/// Finds the chunks of points that start at `points_offset`. `chunk_points` is the number of points of each chunk
/// except the last, or `None` if the table states the numbers.
///
/// # Errors
/// The system cannot read the file.
pub(super) fn find(
    source: &Source,
    codec: &Codec,
    points_offset: u64,
    chunk_points: Option<u32>,
    announced: u64,
) -> Result<Chunks, ScanError> {
    let data_offset = points_offset + TABLE_POSITION_BYTES;
    let reason = match table(source, codec, points_offset, chunk_points)? {
        Ok(mut chunks) => {
            if let Some(size) = chunk_points {
                count_last(&mut chunks, u64::from(size), announced);
            }
            return Ok(Chunks::Listed(chunks));
        }
        Err(reason) => reason,
    };
    if codec.layered { follow(source, codec, data_offset, reason) } else { Ok(Chunks::Unknown(reason)) }
}

/// Counts the points of the last chunk of fixed size: it holds the rest, if the header's count fits the number of
/// chunks.
fn count_last(chunks: &mut [LazChunk], size: u64, announced: u64) {
    let before = (chunks.len() as u64).saturating_sub(1).saturating_mul(size);
    if let Some(last) = chunks.last_mut() {
        last.num_points = announced.checked_sub(before).filter(|rest| (1..=size).contains(rest));
    }
}

type TableChunks = Result<Vec<LazChunk>, String>;

fn table(
    source: &Source,
    codec: &Codec,
    points_offset: u64,
    chunk_points: Option<u32>,
) -> Result<TableChunks, ScanError> {
    let data_offset = points_offset + TABLE_POSITION_BYTES;
    let position = |offset| -> Result<Option<u64>, ScanError> {
        let bytes = source.bytes(offset, 8)?;
        let value = bytes.first_chunk().map(|bytes| u64::from_le_bytes(*bytes));
        Ok(value.filter(|at| (data_offset..source.len().saturating_sub(7)).contains(at)))
    };
    // Writers that could not seek back leave the table's position in the last 8 bytes.
    let found = match position(points_offset)? {
        Some(found) => Some(found),
        None => position(source.len().saturating_sub(8))?,
    };
    let Some(table_offset) = found else { return Ok(Err("its chunk table is missing".into())) };
    let head = source.bytes(table_offset + 4, 4)?;
    let num_chunks = head.first_chunk().map_or(0, |bytes| u64::from(u32::from_le_bytes(*bytes)));
    let data_bytes = table_offset - data_offset;
    if num_chunks == 0 && data_bytes > 0 {
        return Ok(Err("its chunk table is empty".into()));
    }
    if num_chunks.saturating_mul(codec.least_bytes() as u64) > data_bytes {
        return Ok(Err(format!(
            "its chunk table claims {} in {}",
            counted(num_chunks, "chunk"),
            counted(data_bytes, "byte")
        )));
    }
    let bytes = source.bytes(table_offset, 64 + num_chunks * MOST_ENTRY_BYTES)?;
    let variable = chunk_points.is_none();
    let entries = match guard::catch(|| ChunkTable::read(&mut Cursor::new(bytes), variable)) {
        Ok(Ok(entries)) => entries,
        Ok(Err(error)) => return Ok(Err(format!("its chunk table is damaged ({error})"))),
        Err(panic) => return Ok(Err(format!("its chunk table is damaged ({panic})"))),
    };
    let mut chunks = Vec::with_capacity(entries.len());
    let mut offset = data_offset;
    for entry in &entries {
        // The `laz` crate widens numbers of 32 bits with their sign.
        let num_bytes = entry.byte_count & 0xffff_ffff;
        let num_points = chunk_points.map_or(entry.point_count & 0xffff_ffff, u64::from);
        if num_bytes > table_offset - offset {
            return Ok(Err("its chunk table is damaged (the chunks overlap it)".into()));
        }
        if num_points > 0 {
            chunks.push(LazChunk { offset, num_bytes, num_points: Some(num_points) });
        }
        offset += num_bytes;
    }
    Ok(Ok(chunks))
}

/// Follows layered chunks, which state their size, from one to the next until one is not whole or not plausible.
fn follow(source: &Source, codec: &Codec, data_offset: u64, reason: String) -> Result<Chunks, ScanError> {
    let mut chunks = Vec::new();
    let mut offset = data_offset;
    loop {
        let bytes = source.bytes(offset, codec.least_bytes() as u64)?;
        let Some(head) = codec.layered_head(&bytes) else { break };
        if head.num_points == 0 || head.num_bytes > source.len() - offset {
            break;
        }
        chunks.push(LazChunk { offset, num_bytes: head.num_bytes, num_points: Some(head.num_points) });
        offset += head.num_bytes;
    }
    Ok(Chunks::Followed(chunks, reason))
}

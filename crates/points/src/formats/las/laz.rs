//! Reads compressed points: chunks in parallel, handed over in file order. A broken chunk loses only itself.

use super::PointsRead;
use super::chunks::{self, Chunks, LazChunk, TABLE_POSITION_BYTES};
use super::codec::{self, Codec, Wanted};
use super::copc::{self, CopcInfo};
use super::extra::Extra;
use super::header::LasHeader;
use super::record::Layout;
use crate::block::Block;
use crate::formats::Take;
use crate::source::Source;
use crate::{Projection, ScanError, guard};
use base::task::{Cancelled, Progress};
use base::words::{agreeing, counted};
use laz::LazVlr;
use rayon::prelude::*;
use std::io::{self, BufReader};

/// Chunks in work for each thread: enough to even out their sizes, few enough to hold them in memory twice.
const CHUNKS_PER_THREAD: usize = 4;
/// Damaged chunks that are named one by one.
const MOST_NAMED: usize = 5;

/// How the points of a file are compressed and cut into chunks.
#[derive(Clone, Debug)]
pub(super) struct Laz {
    codec: Codec,
    chunking: Chunking,
    /// True if the chunks are nodes of an octree, and where that is described, if it is.
    copc: Option<Option<CopcInfo>>,
}

/// How the points are cut into chunks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Chunking {
    /// All points are one chunk and there is no chunk table (LASzip 1).
    Not,
    /// Each chunk except the last has this many points.
    Fixed(u32),
    /// Each chunk has as many points as the table states.
    Variable,
}

impl Laz {
    /// Parses the payload of the LASzip record.
    ///
    /// # Errors
    /// Why no point can be decompressed, and what to do.
    pub fn parse(payload: &[u8]) -> Result<Self, String> {
        let advice = "write it again with a current LASzip, or as LAS";
        let vlr = match guard::catch(|| LazVlr::read_from(payload)) {
            Ok(Ok(vlr)) => vlr,
            Ok(Err(error)) => return Err(format!("its LASzip record says: {error}; {advice}")),
            Err(panic) => return Err(format!("its LASzip record is damaged ({panic}); {advice}")),
        };
        // The `laz` crate does not tell the kind of compression, which is the record's first field.
        let chunking = match payload.first_chunk().map_or(0, |bytes| u16::from_le_bytes(*bytes)) {
            1 => Chunking::Not,
            2 | 3 if vlr.uses_variable_size_chunks() => Chunking::Variable,
            2 | 3 => Chunking::Fixed(vlr.chunk_size()),
            kind => {
                return Err(format!(
                    "its LASzip record names compression {kind}, only 1 to 3 are known; {advice}"
                ));
            }
        };
        let codec = Codec::new(vlr.items().clone()).map_err(|reason| format!("{reason}; {advice}"))?;
        Ok(Self { codec, chunking, copc: None })
    }

    /// The same of a COPC file, whose info record has this payload.
    pub fn of_copc(self, payload: &[u8]) -> Self {
        Self { copc: Some(CopcInfo::parse(payload)), ..self }
    }

    /// Bytes of a decompressed record.
    pub fn record_bytes(&self) -> usize {
        self.codec.record_bytes
    }

    /// How a decompressed record is made up, in a file of LAS 1.`minor`.
    pub fn layout(&self, minor: u8, extra: &[Extra]) -> Layout {
        Layout::of_items(&self.codec.items, minor, extra)
    }

    /// What is wanted of the points of this layout.
    pub fn wanted(header: &LasHeader, layout: &Layout, want: &Projection) -> Wanted {
        let extractor = layout.extractor(want);
        Wanted { grid: header.grid, layers: codec::layers(&extractor), extractor }
    }

    /// Reads all points that can be read.
    ///
    /// # Errors
    /// The user stops it, there is no memory, nothing can be read, or `take` fails.
    pub fn read(
        &self,
        source: &Source,
        header: &LasHeader,
        wanted: &Wanted,
        take: &mut Take,
        progress: &Progress,
    ) -> Result<PointsRead, ScanError> {
        let offset = header.points_offset;
        let reading = Reading { source, announced: header.announced_points, wanted, progress };
        let chunk_points = match self.chunking {
            Chunking::Not => return self.read_serially(&reading, take, offset, None),
            Chunking::Fixed(size) => Some(size),
            Chunking::Variable => None,
        };
        let found = chunks::find(source, &self.codec, offset, chunk_points, header.announced_points)?;
        let (found, sentence) = match self.copc {
            Some(info) => copc::in_order(source, header, info, found)?,
            None => (found, None),
        };
        let mut outcome = self.read_found(&reading, take, found, (offset, chunk_points))?;
        outcome.warnings.extend(sentence);
        Ok(outcome)
    }

    /// Reads the chunks that were found, or what is there without them.
    fn read_found(
        &self,
        reading: &Reading,
        take: &mut Take,
        found: Chunks,
        (offset, chunk_points): (u64, Option<u32>),
    ) -> Result<PointsRead, ScanError> {
        let source = reading.source;
        match found {
            Chunks::Listed(chunks) => self.read_chunks(reading, take, &chunks),
            Chunks::Followed(chunks, reason) => {
                let mut outcome = self.read_chunks(reading, take, &chunks)?;
                let (num, were) =
                    (counted(chunks.len(), "whole chunk"), agreeing(chunks.len(), "was", "were"));
                outcome.warnings.push(format!("{reason}; {num} {were} found without it"));
                Ok(outcome)
            }
            Chunks::Unknown(reason) => {
                let Some(size) = chunk_points else {
                    let reason = format!(
                        "{reason}, and without it nobody can tell where its chunks end; get it again"
                    );
                    return Err(ScanError::Compression { path: source.path().to_owned(), reason });
                };
                let mut outcome =
                    self.read_serially(reading, take, offset + TABLE_POSITION_BYTES, Some(size))?;
                outcome.warnings.push(format!("{reason}; it was read on one core instead of all"));
                Ok(outcome)
            }
        }
    }

    /// Decompresses a window of chunks while the window before it is handed over.
    fn read_chunks(
        &self,
        reading: &Reading,
        take: &mut Take,
        chunks: &[LazChunk],
    ) -> Result<PointsRead, ScanError> {
        let mut handover =
            Handover { take, outcome: PointsRead::default(), damaged: Vec::new(), num_chunks: 0, at: 0 };
        let mut decoded = Vec::new();
        for window in chunks.chunks(CHUNKS_PER_THREAD * rayon::current_num_threads()) {
            let decode = || window.par_iter().map(|chunk| (*chunk, self.read_chunk(reading, chunk)));
            let before = std::mem::take(&mut decoded);
            let (now, handed_over) = rayon::join(|| decode().collect(), || handover.all(before));
            handed_over?;
            decoded = now;
            if reading.progress.is_cancelled() {
                return Err(Cancelled.into());
            }
        }
        handover.all(decoded)?;
        handover.finish(reading.source)
    }

    fn read_chunk(&self, reading: &Reading, chunk: &LazChunk) -> Decoded {
        let Reading { source, progress, wanted, .. } = *reading;
        if progress.is_cancelled() {
            return Ok(wanted.extractor.block(wanted.grid));
        }
        let bytes = source.bytes(chunk.offset, chunk.num_bytes).map_err(|error| error.to_string())?;
        if (bytes.len() as u64) < chunk.num_bytes {
            return Err("is cut off by the file's end".into());
        }
        let block = guard::catch(|| self.codec.decode_chunk(&bytes, chunk.num_points, wanted))
            .unwrap_or_else(|panic| Err(format!("is damaged ({panic})")))?;
        progress.add(block.xyz.len() as u64);
        Ok(block)
    }

    /// Reads chunk after chunk on one core, up to the first that is damaged: no chunk says where it ends.
    fn read_serially(
        &self,
        reading: &Reading,
        take: &mut Take,
        offset: u64,
        chunk_points: Option<u32>,
    ) -> Result<PointsRead, ScanError> {
        let Reading { source, announced, wanted, progress } = *reading;
        let mut outcome = PointsRead::default();
        let mut reader = BufReader::with_capacity(1 << 20, source.reader(offset));
        let most = source.len().saturating_mul(1000);
        let announced = if announced == 0 { most } else { announced.min(most) };
        while outcome.num_points < announced {
            if progress.is_cancelled() {
                return Err(Cancelled.into());
            }
            let left = announced - outcome.num_points;
            let num_wanted = chunk_points.map_or(left, |size| left.min(u64::from(size)));
            let mut block = wanted.extractor.block(wanted.grid);
            let end = guard::catch(|| self.codec.decode(&mut reader, num_wanted, wanted, &mut block));
            let problem = match end {
                Ok(Ok(())) => None,
                Ok(Err(error)) if error.kind() == io::ErrorKind::UnexpectedEof => {
                    Some("the file is cut off".into())
                }
                Ok(Err(error)) if error.kind() == io::ErrorKind::OutOfMemory => {
                    return Err(ScanError::Memory { path: source.path().to_owned(), num_points: announced });
                }
                // Points before the error in this chunk may be nonsense already.
                Ok(Err(error)) => {
                    block.truncate(0);
                    Some(error.to_string())
                }
                Err(panic) => {
                    block = wanted.extractor.block(wanted.grid);
                    Some(panic)
                }
            };
            let num_read = block.xyz.len() as u64;
            progress.add(num_read);
            outcome.num_points += num_read;
            if num_read > 0 {
                take(block.with_stats())?;
            }
            if let Some(problem) = problem {
                let num_points = outcome.num_points;
                outcome
                    .losses
                    .push(format!("could be decompressed up to point {num_points} only: {problem}"));
                break;
            }
        }
        Ok(outcome)
    }
}

/// What is read, and how.
struct Reading<'a> {
    source: &'a Source,
    /// Points that the header announces.
    announced: u64,
    wanted: &'a Wanted,
    progress: &'a Progress,
}

/// A chunk's points, or why they are lost.
type Decoded = Result<Block, String>;

/// Chunks on their way to whoever wants them, in file order.
struct Handover<'a, 'b> {
    take: &'a mut Take<'b>,
    outcome: PointsRead,
    damaged: Vec<Damaged>,
    num_chunks: usize,
    /// Points of the chunks so far, including those of damaged chunks.
    at: u64,
}

impl Handover<'_, '_> {
    fn all(&mut self, decoded: Vec<(LazChunk, Decoded)>) -> Result<(), ScanError> {
        for (chunk, decoded) in decoded {
            self.num_chunks += 1;
            match decoded {
                Ok(block) => {
                    self.at += block.xyz.len() as u64;
                    self.outcome.num_points += block.xyz.len() as u64;
                    if !block.xyz.is_empty() {
                        (self.take)(block)?;
                    }
                }
                Err(reason) => {
                    let (number, first_point, num_points) = (self.num_chunks, self.at, chunk.num_points);
                    self.at += num_points.unwrap_or(0);
                    self.damaged.push(Damaged { number, first_point, num_points, reason });
                }
            }
        }
        Ok(())
    }

    /// Returns what was read, with a sentence for each lost chunk, or an error if nothing is left.
    fn finish(self, source: &Source) -> Result<PointsRead, ScanError> {
        let Self { mut outcome, damaged, num_chunks, .. } = self;
        if let (Some(first), 0) = (damaged.first(), outcome.num_points) {
            let reason = format!("{}; get the file again", first.sentence(num_chunks));
            return Err(ScanError::Compression { path: source.path().to_owned(), reason });
        }
        let named = damaged.iter().take(MOST_NAMED);
        outcome.losses.extend(named.map(|chunk| format!("{}; it is left out", chunk.sentence(num_chunks))));
        let more = damaged.len().saturating_sub(MOST_NAMED);
        if more > 0 {
            let (more, are) = (counted(more, "more chunk"), agreeing(more, "is", "are"));
            outcome.losses.push(format!("{more} {are} damaged and left out"));
        }
        Ok(outcome)
    }
}

/// A chunk that could not be read.
struct Damaged {
    number: usize,
    first_point: u64,
    num_points: Option<u64>,
    reason: String,
}

impl Damaged {
    fn sentence(&self, num_chunks: usize) -> String {
        let Self { number, first_point, num_points, reason } = self;
        let last = num_points.map_or_else(|| "the last".into(), |count| (first_point + count).to_string());
        format!("chunk {number} of {num_chunks} (points {} to {last}) {reason}", first_point + 1)
    }
}

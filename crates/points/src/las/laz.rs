//! Compressed points: chunks in parallel, in file order; a broken chunk loses only itself.

use super::chunks::{self, Chunk, Chunks, TABLE_POSITION_BYTES};
use super::codec::Codec;
use super::header::LasHeader;
use super::record::Flags;
use crate::source::Source;
use crate::stats::Stats;
use crate::{Columns, Points, ScanError, guard};
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
    cut: Cut,
}

/// How the points are cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cut {
    /// All points are one chunk and there is no chunk table (LASzip 1).
    Not,
    /// Chunks of so many points.
    Fixed(u32),
    /// Chunks of as many points as the table states.
    Variable,
}

impl Laz {
    /// From the payload of the LASzip record of a file of LAS 1.`minor`.
    ///
    /// # Errors
    /// Why nothing of it can be decompressed, and what to do.
    pub fn parse(payload: &[u8], minor: u8) -> Result<Self, String> {
        let advice = "write it again with a current LASzip, or as LAS";
        let vlr = match guard::catch(|| LazVlr::read_from(payload)) {
            Ok(Ok(vlr)) => vlr,
            Ok(Err(error)) => return Err(format!("its LASzip record says: {error}; {advice}")),
            Err(panic) => return Err(format!("its LASzip record is damaged ({panic}); {advice}")),
        };
        // The crate keeps the kind of compression to itself; it is the record's first field.
        let cut = match payload.first_chunk().map_or(0, |bytes| u16::from_le_bytes(*bytes)) {
            1 => Cut::Not,
            2 | 3 if vlr.uses_variable_size_chunks() => Cut::Variable,
            2 | 3 => Cut::Fixed(vlr.chunk_size()),
            kind => {
                return Err(format!(
                    "its LASzip record names compression {kind}, only 1 to 3 are known; {advice}"
                ));
            }
        };
        let mut codec = Codec::new(vlr.items().clone()).map_err(|reason| format!("{reason}; {advice}"))?;
        if minor == 0 {
            codec.layout.flags = Flags::FIRST;
        }
        Ok(Self { codec, cut })
    }

    /// Bytes of a decompressed record.
    pub fn record_bytes(&self) -> usize {
        self.codec.layout.record_bytes
    }

    /// True if records carry colour.
    pub fn has_rgb(&self) -> bool {
        self.codec.layout.rgb_offset.is_some()
    }

    /// Reads all points that can be read.
    ///
    /// # Errors
    /// Stopped, no memory, nothing readable at all.
    pub fn read(
        &self,
        source: &Source,
        header: &LasHeader,
        show_withheld: bool,
        progress: &Progress,
    ) -> Result<Columns, ScanError> {
        let offset = header.points_offset;
        let reading = Reading { source, header, show_withheld, progress };
        let chunk_points = match self.cut {
            Cut::Not => return self.read_serially(&reading, offset, None),
            Cut::Fixed(size) => Some(size),
            Cut::Variable => None,
        };
        match chunks::find(source, &self.codec, offset, chunk_points, header.announced_points)? {
            Chunks::Listed(chunks) => self.read_chunks(&reading, &chunks),
            Chunks::Followed(chunks, reason) => {
                let mut columns = self.read_chunks(&reading, &chunks)?;
                let (num, were) =
                    (counted(chunks.len(), "whole chunk"), agreeing(chunks.len(), "was", "were"));
                columns.warnings.insert(0, format!("{reason}; {num} {were} found without it"));
                Ok(columns)
            }
            Chunks::Unknown(reason) => {
                let Some(size) = chunk_points else {
                    let reason = format!(
                        "{reason}, and without it nobody can tell where its chunks end; get it again"
                    );
                    return Err(ScanError::Compression { path: source.path().to_owned(), reason });
                };
                let mut columns = self.read_serially(&reading, offset + TABLE_POSITION_BYTES, Some(size))?;
                columns.warnings.insert(0, format!("{reason}; it was read on one core instead of all"));
                Ok(columns)
            }
        }
    }

    /// While a window of chunks is decompressed, the one before it is appended.
    fn read_chunks(&self, reading: &Reading, chunks: &[Chunk]) -> Result<Columns, ScanError> {
        let Reading { source, progress, .. } = *reading;
        let mut assembly = Assembly { show_withheld: reading.show_withheld, ..Assembly::default() };
        let mut decoded = Vec::new();
        for window in chunks.chunks(CHUNKS_PER_THREAD * rayon::current_num_threads()) {
            let decode = || window.par_iter().map(|chunk| (*chunk, self.read_chunk(reading, chunk)));
            let before = std::mem::take(&mut decoded);
            let (now, appended) = rayon::join(|| decode().collect(), || assembly.append(source, before));
            appended?;
            decoded = now;
            if progress.is_cancelled() {
                return Err(Cancelled.into());
            }
        }
        assembly.append(source, decoded)?;
        assembly.finish(source)
    }

    fn read_chunk(&self, reading: &Reading, chunk: &Chunk) -> Decoded {
        let Reading { source, progress, show_withheld, .. } = *reading;
        if progress.is_cancelled() {
            return Ok((Points::default(), Stats::EMPTY));
        }
        let bytes = source.bytes(chunk.offset, chunk.num_bytes).map_err(|error| error.to_string())?;
        if (bytes.len() as u64) < chunk.num_bytes {
            return Err("is cut off by the file's end".into());
        }
        let points = guard::catch(|| self.codec.decode_chunk(&bytes, chunk.num_points, show_withheld))
            .unwrap_or_else(|panic| Err(format!("is damaged ({panic})")))?;
        let stats = Stats::of(&points.xyz, &points.intensity);
        progress.add(points.num_read(show_withheld));
        Ok((points, stats))
    }

    /// Chunk after chunk on one core, as far as it goes: no chunk says where it ends.
    fn read_serially(
        &self,
        reading: &Reading,
        offset: u64,
        chunk_points: Option<u32>,
    ) -> Result<Columns, ScanError> {
        let Reading { source, header, show_withheld, progress } = *reading;
        let mut columns = Columns::default();
        let mut reader = BufReader::with_capacity(1 << 20, source.reader(offset));
        let most = source.len().saturating_mul(1000);
        let announced = if header.announced_points == 0 { most } else { header.announced_points.min(most) };
        let points = &mut columns.points;
        while points.num_read(show_withheld) < announced {
            if progress.is_cancelled() {
                return Err(Cancelled.into());
            }
            let (before, num_withheld) = (points.xyz.len(), points.num_withheld);
            let num_read = points.num_read(show_withheld);
            let left = announced - num_read;
            let wanted = chunk_points.map_or(left, |size| left.min(u64::from(size)));
            let end = guard::catch(|| self.codec.decode(&mut reader, wanted, show_withheld, points));
            let problem = match end {
                Ok(Ok(())) => None,
                Ok(Err(error)) if error.kind() == io::ErrorKind::UnexpectedEof => {
                    Some("the file is cut off".into())
                }
                Ok(Err(error)) if error.kind() == io::ErrorKind::OutOfMemory => {
                    return Err(ScanError::Memory { path: source.path().to_owned(), num_points: announced });
                }
                Ok(Err(error)) => Some(truncated(points, before, num_withheld, error.to_string())),
                Err(panic) => Some(truncated(points, before, num_withheld, panic)),
            };
            progress.add(points.num_read(show_withheld) - num_read);
            if let Some(problem) = problem {
                let num_points = points.num_read(show_withheld);
                columns
                    .losses
                    .push(format!("could be decompressed up to point {num_points} only: {problem}"));
                break;
            }
        }
        columns.stats = Stats::of(&points.xyz, &points.intensity);
        Ok(columns)
    }
}

/// Drops the points of the chunk that went wrong: what came before the error may be nonsense already.
fn truncated(points: &mut Points, num_points: usize, num_withheld: u64, problem: String) -> String {
    points.xyz.truncate(num_points);
    points.rgb.truncate(num_points);
    points.intensity.truncate(num_points);
    points.noise.truncate(num_points);
    points.num_withheld = num_withheld;
    problem
}

/// What is read, and how.
struct Reading<'a> {
    source: &'a Source,
    header: &'a LasHeader,
    show_withheld: bool,
    progress: &'a Progress,
}

/// A chunk's points, or why they are lost.
type Decoded = Result<(Points, Stats), String>;

/// Chunks on their way into the columns of their file, in file order.
#[derive(Default)]
struct Assembly {
    columns: Columns,
    damaged: Vec<Damaged>,
    show_withheld: bool,
    num_chunks: usize,
    first_point: u64,
}

impl Assembly {
    fn append(&mut self, source: &Source, decoded: Vec<(Chunk, Decoded)>) -> Result<(), ScanError> {
        for (chunk, decoded) in decoded {
            self.num_chunks += 1;
            match decoded {
                Ok((points, stats)) => {
                    self.first_point += points.num_read(self.show_withheld);
                    self.extend(points, stats).map_err(|num_points| ScanError::Memory {
                        path: source.path().to_owned(),
                        num_points,
                    })?;
                }
                Err(reason) => {
                    let (number, first_point, num_points) =
                        (self.num_chunks, self.first_point, chunk.num_points);
                    self.first_point += num_points.unwrap_or(0);
                    self.damaged.push(Damaged { number, first_point, num_points, reason });
                }
            }
        }
        Ok(())
    }

    /// Columns grow with what was really read; the pages of spare capacity are never touched. The error is how
    /// many points there is no memory for.
    fn extend(&mut self, points: Points, stats: Stats) -> Result<(), u64> {
        let all = &mut self.columns.points;
        let num_points = (all.xyz.len() + points.xyz.len()) as u64;
        let reserved = all.xyz.try_reserve(points.xyz.len());
        let reserved = reserved.and_then(|()| all.rgb.try_reserve(points.rgb.len()));
        let reserved = reserved.and_then(|()| all.intensity.try_reserve(points.intensity.len()));
        reserved.map_err(|_| num_points)?;
        all.noise.append(&points.noise, all.xyz.len());
        all.num_withheld += points.num_withheld;
        all.xyz.extend_from_slice(&points.xyz);
        all.rgb.extend_from_slice(&points.rgb);
        all.intensity.extend_from_slice(&points.intensity);
        self.columns.stats = self.columns.stats.union(stats);
        Ok(())
    }

    /// The columns, with a warning for each lost chunk.
    fn finish(mut self, source: &Source) -> Result<Columns, ScanError> {
        report(source, &mut self.columns, self.num_chunks, &self.damaged)?;
        let points = &mut self.columns.points;
        points.xyz.shrink_to_fit();
        points.rgb.shrink_to_fit();
        points.intensity.shrink_to_fit();
        Ok(self.columns)
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

/// Warns of lost chunks; an error if nothing is left.
fn report(
    source: &Source,
    columns: &mut Columns,
    num_chunks: usize,
    damaged: &[Damaged],
) -> Result<(), ScanError> {
    if let Some(first) = damaged.first()
        && columns.points.xyz.is_empty()
        && columns.points.num_withheld == 0
    {
        let reason = format!("{}; get the file again", first.sentence(num_chunks));
        return Err(ScanError::Compression { path: source.path().to_owned(), reason });
    }
    let named = damaged.iter().take(MOST_NAMED);
    columns.losses.extend(named.map(|chunk| format!("{}; it is left out", chunk.sentence(num_chunks))));
    let more = damaged.len().saturating_sub(MOST_NAMED);
    if more > 0 {
        let (more, are) = (counted(more, "more chunk"), agreeing(more, "is", "are"));
        columns.losses.push(format!("{more} {are} damaged and left out"));
    }
    Ok(())
}

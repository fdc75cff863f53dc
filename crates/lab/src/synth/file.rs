//! Writes what a device measures as LAS or LAZ (a mesh: see `ply`): blocks of lines in parallel, bytes in order.

use super::device::MeasuringDevice;
use super::header::{Totals, WrittenHeader};
use super::record::WrittenLayout;
use super::{SynthKind, WrittenScan};
use base::output::{Output, OutputError, OutputFile, OutputKind};
use base::random::Rng;
use base::task::{Cancelled, Progress};
use laz::ParLasZipCompressor;
use rayon::prelude::*;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

/// Approximate number of points in a block: enough to keep a thread busy, few enough to hold many blocks.
const BLOCK_POINTS: u64 = 16_384;
/// Blocks that are made at once while those before are written; with their bytes about 10 MB.
const GROUP_BLOCKS: u64 = 16;

/// Why no scan was made.
#[derive(Debug, thiserror::Error)]
pub enum SynthError {
    /// No points were asked for.
    #[error("a scan needs at least one point; --points was 0")]
    NoPoints,
    /// LAS 1.2 counts points in 32 bits; a mesh is held in memory.
    #[error("{path}: {points} points are too many for this kind of scan and file; the most is {most}")]
    TooManyPoints {
        /// The file.
        path: PathBuf,
        /// Points asked for.
        points: u64,
        /// Points that are possible.
        most: u64,
    },
    /// The name's ending is of no format that can be written.
    #[error("{path}: the name must end in .{}; it says which of them is written", ENDINGS.join(" or ."))]
    Extension {
        /// The file.
        path: PathBuf,
    },
    /// Only the statue is a mesh.
    #[error("{path}: only photogrammetry can be made as a mesh; name the file .las or .laz")]
    NoMesh {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be created, or not get its name.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The disk is full or failed.
    #[error("cannot write {path}; nothing was kept. {needed_mb} MB are needed at most: check the free space")]
    Write {
        /// The file.
        path: PathBuf,
        /// Size of all points, uncompressed, rounded up.
        needed_mb: u64,
        /// The system's error.
        source: io::Error,
    },
    /// The header could not be made.
    #[error("cannot write the header of {path}")]
    Header {
        /// The file.
        path: PathBuf,
        /// The error of the LAS library.
        source: las::Error,
    },
    /// The user asked to stop.
    #[error("{path}: {source}; nothing was kept")]
    Cancelled {
        /// The file.
        path: PathBuf,
        /// How the work ended.
        source: Cancelled,
    },
}

impl SynthError {
    /// True if the options make no sense; false if writing failed.
    #[must_use]
    pub fn is_usage(&self) -> bool {
        match self {
            Self::NoPoints | Self::TooManyPoints { .. } | Self::Extension { .. } | Self::NoMesh { .. } => {
                true
            }
            Self::Output(error) => error.is_usage(),
            Self::Write { .. } | Self::Header { .. } | Self::Cancelled { .. } => false,
        }
    }
}

/// A file that may be written: its name and size make sense.
#[derive(Clone, Copy, Debug)]
pub struct SynthFile<'a> {
    pub(super) output: &'a Output,
    form: FileFormat,
}

/// Format of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FileFormat {
    Las,
    Laz,
    /// A mesh as PLY.
    Ply,
}

impl FileFormat {
    /// The format that each of [`ENDINGS`] stands for.
    const ALL: [Self; 3] = [Self::Las, Self::Laz, Self::Ply];
}

/// Endings of files that can be made.
const ENDINGS: [&str; 3] = ["las", "laz", "ply"];
/// A made-up scan.
pub const SCAN: OutputKind = OutputKind::Scan(&ENDINGS);

/// Help text for the file that is made.
#[must_use]
pub fn out_help() -> String {
    let endings = ENDINGS.map(|ending| format!(".{ending}")).join(", ");
    let is_mesh = |at: &usize| FileFormat::ALL[*at] == FileFormat::Ply;
    let meshes: Vec<&str> = (0..ENDINGS.len()).filter(is_mesh).map(|at| ENDINGS[at]).collect();
    format!(
        "The file to write, which must not be there yet (see --force). Its name ends in {endings}; .{} is a mesh with \
         normals, for photogrammetry only",
        meshes.join(" or .")
    )
}

/// Most points of a mesh; each takes about 150 bytes of memory while the mesh is made.
const MOST_MESH_POINTS: u64 = 100_000_000;

impl<'a> SynthFile<'a> {
    /// Checks the name and the number of points without touching the file.
    pub fn check(output: &'a Output, kind: SynthKind, points: u64) -> Result<Self, SynthError> {
        let path = output.path();
        let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        let known = ENDINGS.iter().position(|ending| extension.as_deref() == Some(*ending));
        let form = FileFormat::ALL[known.ok_or_else(|| SynthError::Extension { path: path.into() })?];
        let most = match (form, kind) {
            (FileFormat::Ply, SynthKind::Photogrammetry) => MOST_MESH_POINTS,
            (FileFormat::Ply, _) => return Err(SynthError::NoMesh { path: path.into() }),
            (_, SynthKind::Photogrammetry) => u64::from(u32::MAX),
            (_, _) => u64::MAX / 64,
        };
        if points == 0 {
            Err(SynthError::NoPoints)
        } else if points > most {
            Err(SynthError::TooManyPoints { path: path.into(), points, most })
        } else {
            Ok(Self { output, form })
        }
    }

    /// True for a mesh.
    pub fn is_mesh(&self) -> bool {
        self.form == FileFormat::Ply
    }

    /// Measures all points and writes them.
    pub fn write(
        &self,
        device: &impl MeasuringDevice,
        seed: u64,
        progress: &Progress,
    ) -> Result<WrittenScan, SynthError> {
        let path = || self.output.path().to_path_buf();
        let file = self.output.begin()?;
        let WrittenLayout { format, grid } = device.layout();
        let record_bytes = u64::from(format.record_bytes());
        let needed_mb = device.plan().points().saturating_mul(record_bytes).div_ceil(1_000_000);
        let mut header = WrittenHeader::new(format, grid, self.form == FileFormat::Laz);
        let written = (|| {
            let mut points = PointWriter::start(&header, file)?;
            write_points(device, seed, progress, &mut points, &mut header.totals)?;
            let mut file = points.finish()?;
            header.write_to(&mut file)?;
            let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
            let file_bytes = file.num_bytes()?;
            Ok((file, file_bytes))
        })();
        let (file, file_bytes) = written.map_err(|e| match e {
            WriteError::Io(source) => SynthError::Write { path: path(), needed_mb, source },
            WriteError::Header(source) => SynthError::Header { path: path(), source },
            WriteError::Cancelled(source) => SynthError::Cancelled { path: path(), source },
        })?;
        self.output.keep(file)?;
        Ok(WrittenScan {
            num_points: header.totals.num_points,
            file_bytes,
            bounds: header.totals.bounds(&grid),
        })
    }
}

/// Errors while writing; the caller adds the file's name.
#[derive(Debug, thiserror::Error)]
enum WriteError {
    #[error(transparent)]
    Io(#[from] io::Error),
    #[error(transparent)]
    Header(#[from] las::Error),
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Writes all points.
fn write_points(
    device: &impl MeasuringDevice,
    seed: u64,
    progress: &Progress,
    out: &mut PointWriter,
    totals: &mut Totals,
) -> Result<(), WriteError> {
    let plan = device.plan();
    // A block has whole lines, the same on every machine.
    let lines_per_block = (BLOCK_POINTS * plan.num_lines()).div_ceil(plan.points().max(1));
    let lines_per_block = lines_per_block.clamp(1, plan.num_lines());
    let num_blocks = plan.num_lines().div_ceil(lines_per_block);
    let group = |first: u64| -> Vec<EncodedLines> {
        let blocks = (first..num_blocks.min(first + GROUP_BLOCKS)).into_par_iter();
        blocks
            .filter(|_| !progress.is_cancelled())
            .map(|block| {
                EncodedLines::measure(device, seed, block * lines_per_block, lines_per_block, progress)
            })
            .collect()
    };
    let mut ready = group(0);
    for next in (GROUP_BLOCKS..num_blocks + GROUP_BLOCKS).step_by(GROUP_BLOCKS as usize) {
        progress.check()?;
        // One thread writes while the others make the next blocks.
        let (written, made) = rayon::join(|| out.write(&ready), || group(next));
        written?;
        for block in &ready {
            totals.add(&block.totals);
        }
        ready = made;
    }
    Ok(progress.check()?)
}

/// Records of consecutive lines, as bytes.
struct EncodedLines {
    bytes: Vec<u8>,
    totals: Totals,
}

impl EncodedLines {
    fn measure(
        device: &impl MeasuringDevice,
        seed: u64,
        first: u64,
        lines: u64,
        progress: &Progress,
    ) -> Self {
        let (plan, format) = (device.plan(), device.layout().format);
        let mut block = Self { bytes: Vec::new(), totals: Totals::default() };
        let mut records = Vec::new();
        for line in first..plan.num_lines().min(first + lines) {
            let num_points = plan.first_point(line + 1) - plan.first_point(line);
            if num_points == 0 {
                continue;
            }
            records.clear();
            device.measure(line, num_points, &mut Rng::new(seed, line), &mut records);
            debug_assert_eq!(records.len() as u64, num_points);
            for record in &records {
                block.totals.count(record);
                record.encode(format, &mut block.bytes);
            }
        }
        progress.add(block.totals.num_points);
        block
    }
}

/// Writer of the points' bytes, plain or compressed.
enum PointWriter {
    Plain(BufWriter<OutputFile>),
    Compressed(Box<ParLasZipCompressor<BufWriter<OutputFile>>>),
}

impl PointWriter {
    fn start(header: &WrittenHeader, file: OutputFile) -> Result<Self, WriteError> {
        let mut file = BufWriter::with_capacity(1 << 20, file);
        header.write_to(&mut file)?;
        Ok(match &header.laz {
            None => Self::Plain(file),
            Some(vlr) => {
                let compressor = ParLasZipCompressor::new(file, vlr.clone()).map_err(io::Error::other)?;
                Self::Compressed(Box::new(compressor))
            }
        })
    }

    fn write(&mut self, blocks: &[EncodedLines]) -> io::Result<()> {
        match self {
            Self::Plain(file) => blocks.iter().try_for_each(|block| file.write_all(&block.bytes)),
            Self::Compressed(compressor) => {
                // All bytes are handed over at once, so that the compressor works on several of its chunks in parallel.
                let bytes = blocks.iter().map(|b| b.bytes.as_slice()).collect::<Vec<_>>().concat();
                compressor.compress_many(&bytes)
            }
        }
    }

    fn finish(self) -> Result<BufWriter<OutputFile>, WriteError> {
        match self {
            Self::Plain(file) => Ok(file),
            Self::Compressed(mut compressor) => {
                compressor.done().map_err(|e| match e {
                    laz::LasZipError::IoError(e) => e,
                    other => io::Error::other(other),
                })?;
                Ok(compressor.into_inner())
            }
        }
    }
}

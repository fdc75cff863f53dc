//! Writes what a device measures as LAS or LAZ: blocks of lines in parallel, bytes in order, a temporary
//! name until the file is whole.

use super::device::Device;
use super::random::Rng;
use super::record::{Format, Layout, Record};
use super::{Kind, Summary};
use crate::progress::Progress;
use crate::scan::Lattice;
use crate::space::Bounds;
use glam::DVec3;

use laz::{LazItemRecordBuilder, LazVlr, ParLasZipCompressor};
use rayon::prelude::*;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Points that a block holds, about: large enough to keep a thread busy, small enough to hold many.
const BLOCK_POINTS: u64 = 16_384;
/// Blocks made at once while those before are written; with their bytes about 10 MB.
const GROUP_BLOCKS: u64 = 16;

/// Why no scan was made.
#[derive(Debug, thiserror::Error)]
pub enum SynthError {
    /// Nothing to write.
    #[error("a scan needs at least one point; --points was 0")]
    NoPoints,
    /// LAS 1.2 counts points in 32 bits.
    #[error("{path}: {points} points do not fit in this kind of file (LAS 1.2); the most is {most}")]
    TooManyPoints {
        /// The file.
        path: PathBuf,
        /// Asked for.
        points: u64,
        /// Possible.
        most: u64,
    },
    /// Neither LAS nor LAZ.
    #[error("{path}: the name must end in .las or .laz; it says which of the two is written")]
    Extension {
        /// The file.
        path: PathBuf,
    },
    /// A folder has the name.
    #[error("{path} is a folder; name a file in it, for instance {}", path.join("scan.las").display())]
    Folder {
        /// The folder.
        path: PathBuf,
    },
    /// The folder is missing or read-only.
    #[error("cannot create a file beside {path}; check that its folder exists and may be written")]
    Create {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The disk is full or failed.
    #[error("cannot write {path}; nothing was kept. {needed_mb} MB are needed at most: check the free space")]
    Write {
        /// The file.
        path: PathBuf,
        /// Size of all points, uncompressed, rounded up.
        needed_mb: u64,
        /// Why.
        source: io::Error,
    },
    /// The header could not be made.
    #[error("cannot write the header of {path}")]
    Header {
        /// The file.
        path: PathBuf,
        /// Why.
        source: las::Error,
    },
    /// Stopped on request.
    #[error("stopped before {path} was whole; nothing was kept")]
    Stopped {
        /// The file.
        path: PathBuf,
    },
}

/// A file that may be written: its name and size make sense.
#[derive(Clone, Copy, Debug)]
pub struct Target<'a> {
    path: &'a Path,
    compressed: bool,
}

impl<'a> Target<'a> {
    /// Looks at the name and the number of points; touches nothing.
    pub fn check(path: &'a Path, kind: Kind, points: u64) -> Result<Self, SynthError> {
        let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        let compressed = match extension.as_deref() {
            Some("las") => false,
            Some("laz") => true,
            _ => return Err(SynthError::Extension { path: path.into() }),
        };
        let most = if kind == Kind::Photogrammetry { u64::from(u32::MAX) } else { u64::MAX / 64 };
        if points == 0 {
            Err(SynthError::NoPoints)
        } else if points > most {
            Err(SynthError::TooManyPoints { path: path.into(), points, most })
        } else if path.is_dir() {
            Err(SynthError::Folder { path: path.into() })
        } else {
            Ok(Self { path, compressed })
        }
    }

    /// Measures everything and writes it.
    pub fn write(&self, device: &impl Device, seed: u64, progress: &Progress) -> Result<Summary, SynthError> {
        let path = || self.path.to_path_buf();
        let (partial, file) =
            Partial::create(self.path).map_err(|source| SynthError::Create { path: path(), source })?;
        let Layout { format, lattice } = device.layout();
        let record_bytes = u64::from(format.record_bytes());
        let needed_mb = device.plan().points().saturating_mul(record_bytes).div_ceil(1_000_000);
        let mut header = Header::new(format, lattice, self.compressed);
        let written = (|| {
            let mut points = header.start(file, self.compressed)?;
            let whole = write_points(device, seed, progress, &mut points, &mut header.totals)?;
            let mut file = points.finish()?;
            header.write_to(&mut file)?;
            file.flush()?;
            let file_bytes = file.get_ref().metadata()?.len();
            Ok((whole, file_bytes))
        })();
        let (whole, file_bytes) = written.map_err(|e| match e {
            WriteError::Io(source) => SynthError::Write { path: path(), needed_mb, source },
            WriteError::Header(source) => SynthError::Header { path: path(), source },
        })?;
        if !whole {
            return Err(SynthError::Stopped { path: path() });
        }
        partial.keep(self.path).map_err(|source| SynthError::Create { path: path(), source })?;
        Ok(Summary {
            num_points: header.totals.num_points,
            file_bytes,
            bounds: header.totals.bounds(&lattice),
        })
    }
}

/// What can fail while writing; gets the file's name further out.
#[derive(Debug, thiserror::Error)]
enum WriteError {
    #[error(transparent)]
    Io(#[from] io::Error),
    #[error(transparent)]
    Header(#[from] las::Error),
}

/// Writes all points; false if stopped before the end.
fn write_points(
    device: &impl Device,
    seed: u64,
    progress: &Progress,
    out: &mut PointWriter,
    totals: &mut Totals,
) -> Result<bool, WriteError> {
    let plan = device.plan();
    // Whole lines a block, the same whatever the machine.
    let lines_per_block = (BLOCK_POINTS * plan.num_lines()).div_ceil(plan.points().max(1));
    let lines_per_block = lines_per_block.clamp(1, plan.num_lines());
    let num_blocks = plan.num_lines().div_ceil(lines_per_block);
    let group = |first: u64| -> Vec<Block> {
        let blocks = (first..num_blocks.min(first + GROUP_BLOCKS)).into_par_iter();
        blocks
            .filter(|_| !progress.stopped())
            .map(|block| Block::measure(device, seed, block * lines_per_block, lines_per_block, progress))
            .collect()
    };
    let mut ready = group(0);
    for next in (GROUP_BLOCKS..num_blocks + GROUP_BLOCKS).step_by(GROUP_BLOCKS as usize) {
        if progress.stopped() {
            return Ok(false);
        }
        // One thread writes while the others make the next blocks.
        let (written, made) = rayon::join(|| out.write(&ready), || group(next));
        written?;
        for block in &ready {
            totals.add(&block.totals);
        }
        ready = made;
    }
    Ok(!progress.stopped())
}

/// Consecutive lines as bytes.
struct Block {
    bytes: Vec<u8>,
    totals: Totals,
}

impl Block {
    fn measure(device: &impl Device, seed: u64, first: u64, lines: u64, progress: &Progress) -> Self {
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

/// What the header says of the points.
#[derive(Clone, Debug)]
struct Totals {
    num_points: u64,
    by_return: [u64; 15],
    min: [i32; 3],
    max: [i32; 3],
}

impl Default for Totals {
    fn default() -> Self {
        Self { num_points: 0, by_return: [0; 15], min: [i32::MAX; 3], max: [i32::MIN; 3] }
    }
}

impl Totals {
    fn count(&mut self, record: &Record) {
        self.num_points += 1;
        self.by_return[usize::from(record.return_number.clamp(1, 15)) - 1] += 1;
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(record.xyz[axis]);
            self.max[axis] = self.max[axis].max(record.xyz[axis]);
        }
    }

    fn add(&mut self, other: &Self) {
        self.num_points += other.num_points;
        for (sum, more) in self.by_return.iter_mut().zip(other.by_return) {
            *sum += more;
        }
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(other.min[axis]);
            self.max[axis] = self.max[axis].max(other.max[axis]);
        }
    }

    fn bounds(&self, lattice: &Lattice) -> Bounds {
        if self.num_points == 0 {
            return Bounds::EMPTY;
        }
        Bounds { min: lattice.p_in_world(self.min), max: lattice.p_in_world(self.max) }
    }
}

/// The start of the file: LAS header and, for LAZ, the record that describes the compression.
struct Header {
    format: Format,
    lattice: Lattice,
    laz: Option<LazVlr>,
    totals: Totals,
}

/// A fixed date (the standard's example program knows no better): the day must not change the bytes.
const CREATED: (u16, u16) = (1, 2026);

impl Header {
    fn new(format: Format, lattice: Lattice, compressed: bool) -> Self {
        let laz = compressed.then(|| {
            let builder = LazItemRecordBuilder::default_for_point_format_id(format.id(), 0);
            // Fails for point formats that LAZ does not know; both of ours are among the known ones.
            LazVlr::from_laz_items(builder.expect("point formats 2 and 7 can be compressed"))
        });
        Self { format, lattice, laz, totals: Totals::default() }
    }

    fn start(&self, file: File, compressed: bool) -> Result<PointWriter, WriteError> {
        debug_assert_eq!(compressed, self.laz.is_some());
        let mut file = BufWriter::with_capacity(1 << 20, file);
        self.write_to(&mut file)?;
        Ok(match &self.laz {
            None => PointWriter::Plain(file),
            Some(vlr) => {
                let compressor = ParLasZipCompressor::new(file, vlr.clone()).map_err(io::Error::other)?;
                PointWriter::Compressed(Box::new(compressor))
            }
        })
    }

    fn raw(&self) -> las::raw::Header {
        let Totals { num_points, by_return, .. } = self.totals;
        let Bounds { min, max } = match self.totals.bounds(&self.lattice) {
            b if b.is_empty() => Bounds { min: DVec3::ZERO, max: DVec3::ZERO },
            b => b,
        };
        let new = self.format == Format::Rgb7;
        let header_size: u16 = if new { 375 } else { 227 };
        let vlr_bytes = if self.laz.is_some() { 54 + self.laz_record().len() as u32 } else { 0 };
        // Format 7 is not of the old header's world: its 32-bit counts stay 0 [LAS 1.4 R15, 2.4].
        let legacy = |count: u64| if new { 0 } else { u32::try_from(count).unwrap_or(0) };
        las::raw::Header {
            version: las::Version::new(1, if new { 4 } else { 2 }),
            // Bit 4: coordinate systems as WKT, as format 7 demands; bit 0: GPS time without week.
            global_encoding: if new { 0b1_0001 } else { 0 },
            system_identifier: text("made up"),
            generating_software: text("scanwalk synth"),
            file_creation_day_of_year: CREATED.0,
            file_creation_year: CREATED.1,
            header_size,
            offset_to_point_data: u32::from(header_size) + vlr_bytes,
            number_of_variable_length_records: u32::from(self.laz.is_some()),
            point_data_record_format: self.format.id() | if self.laz.is_some() { 0x80 } else { 0 },
            point_data_record_length: self.format.record_bytes(),
            number_of_point_records: legacy(num_points),
            number_of_points_by_return: std::array::from_fn(|i| legacy(by_return[i])),
            x_scale_factor: self.lattice.scale.x,
            y_scale_factor: self.lattice.scale.y,
            z_scale_factor: self.lattice.scale.z,
            x_offset: self.lattice.offset.x,
            y_offset: self.lattice.offset.y,
            z_offset: self.lattice.offset.z,
            max_x: max.x,
            min_x: min.x,
            max_y: max.y,
            min_y: min.y,
            max_z: max.z,
            min_z: min.z,
            large_file: new.then_some(las::raw::header::LargeFile {
                number_of_point_records: num_points,
                number_of_points_by_return: by_return,
            }),
            ..las::raw::Header::default()
        }
    }

    fn laz_record(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        if let Some(vlr) = &self.laz {
            // Writing to memory cannot fail.
            let _ = vlr.write_to(&mut bytes);
        }
        bytes
    }

    /// Writes it to the start of the file; once as a place holder, once with the true counts.
    fn write_to(&self, file: &mut BufWriter<File>) -> Result<(), WriteError> {
        file.seek(SeekFrom::Start(0))?;
        self.raw().write_to(&mut *file)?;
        if self.laz.is_some() {
            let record = self.laz_record();
            file.write_all(&0_u16.to_le_bytes())?;
            file.write_all(&text::<16>(LazVlr::USER_ID))?;
            file.write_all(&LazVlr::RECORD_ID.to_le_bytes())?;
            file.write_all(&(record.len() as u16).to_le_bytes())?;
            file.write_all(&text::<32>("compression"))?;
            file.write_all(&record)?;
        }
        Ok(())
    }
}

/// A fixed-width text field, filled with zeros.
fn text<const N: usize>(text: &str) -> [u8; N] {
    std::array::from_fn(|i| text.as_bytes().get(i).copied().unwrap_or(0))
}

/// Where the points' bytes go.
enum PointWriter {
    Plain(BufWriter<File>),
    Compressed(Box<ParLasZipCompressor<BufWriter<File>>>),
}

impl PointWriter {
    fn write(&mut self, blocks: &[Block]) -> io::Result<()> {
        match self {
            Self::Plain(file) => blocks.iter().try_for_each(|block| file.write_all(&block.bytes)),
            Self::Compressed(compressor) => {
                // All at once: the compressor works on several of its chunks in parallel.
                let bytes = blocks.iter().map(|b| b.bytes.as_slice()).collect::<Vec<_>>().concat();
                compressor.compress_many(&bytes)
            }
        }
    }

    fn finish(self) -> Result<BufWriter<File>, WriteError> {
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

/// A file under a temporary name beside its goal; removed unless kept.
struct Partial(PathBuf);

impl Partial {
    fn create(goal: &Path) -> io::Result<(Self, File)> {
        let name = goal.file_name().unwrap_or_default().to_string_lossy();
        let path = goal.with_file_name(format!(".{name}.{}.part", std::process::id()));
        let file = OpenOptions::new().write(true).create(true).truncate(true).open(&path)?;
        Ok((Self(path), file))
    }

    fn keep(self, goal: &Path) -> io::Result<()> {
        fs::rename(&self.0, goal)
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        // After `keep` there is nothing of that name; and a failure to tidy up must not hide the reason.
        let _ = fs::remove_file(&self.0);
    }
}

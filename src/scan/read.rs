//! Several files of any format to one [`Scan`].

use super::source::Source;
use super::{
    Columns, FORMATS, HEAD_BYTES, Header, ReadOptions, Reader, Scan, ScanError, ScanFile, color, sniff,
};
use crate::progress::{Job, Progress};
use crate::space::Bounds;
use std::path::{Path, PathBuf};

/// Reads files as one scan with z up, in the order given; shows its progress, and ends soon after the job is told to stop.
///
/// Files of which only a part can be read give that part and a warning in [`Scan::warnings`]. All headers are
/// checked before the first point is read.
///
/// # Errors
/// The first file of which nothing can be read, with the reason and what to do; [`ScanError::Stopped`].
pub fn read(paths: &[PathBuf], options: &ReadOptions, job: impl Into<Job>) -> Result<Scan, ScanError> {
    Ok(read_with_headers(paths, options, job)?.0.upright(options.up).with_scene())
}

/// Reads the headers only.
///
/// # Errors
/// The first file that cannot be opened or has no readable header.
pub fn peek(paths: &[PathBuf]) -> Result<Vec<Header>, ScanError> {
    Ok(open_all(paths)?.iter().map(|reader| reader.header().clone()).collect())
}

/// The scan in the files' own coordinates, without its scene, and what each file says of itself.
pub(super) fn read_with_headers(
    paths: &[PathBuf],
    _options: &ReadOptions,
    job: impl Into<Job>,
) -> Result<(Scan, Vec<Header>), ScanError> {
    let readers = open_all(paths)?;
    let headers: Vec<Header> = readers.iter().map(|reader| reader.header().clone()).collect();
    let expected = headers.iter().fold(0u64, |sum, header| sum.saturating_add(header.num_points));
    let progress = Progress::new("reading", "points", expected, job);
    let mut scan = Scan::default();
    for reader in readers {
        let columns = reader.read(&progress)?;
        add(&mut scan, reader.header(), columns);
    }
    name_system(&mut scan, &headers);
    Ok((scan, headers))
}

fn open_all(paths: &[PathBuf]) -> Result<Vec<Box<dyn Reader>>, ScanError> {
    if paths.is_empty() {
        return Err(ScanError::NoFiles);
    }
    paths.iter().map(|path| open(path)).collect()
}

fn open(path: &Path) -> Result<Box<dyn Reader>, ScanError> {
    let source = Source::open(path)?;
    let head = source.bytes(0, HEAD_BYTES)?;
    match FORMATS.iter().find(|format| format.recognises(&head)) {
        Some(format) => format.open(source),
        None => Err(sniff::not_a_scan(path, &head)),
    }
}

fn add(scan: &mut Scan, header: &Header, mut columns: Columns) {
    let sentences = header.warnings.iter().chain(&columns.warnings);
    scan.warnings.extend(sentences.map(|sentence| format!("{}: {sentence}", header.path.display())));
    let stats = columns.stats;
    let color = color::source(&stats);
    if stats.rgb_max == 0 {
        // Black throughout is no colour; the column would only cost memory.
        columns.points.rgb = Vec::new();
    }
    // Scales may be negative, so either corner of the lattice may be the smaller one.
    let corners = [stats.xyz_min, stats.xyz_max].map(|xyz| columns.lattice.p_in_world(xyz));
    scan.files.push(ScanFile {
        path: header.path.clone(),
        format: header.format.clone(),
        lattice: columns.lattice,
        points: columns.points,
        triangles: columns.triangles,
        color,
        bounds: Bounds::EMPTY.with(corners[0]).with(corners[1]),
    });
}

/// The coordinate system and unit of the first file that names one; a warning for files that differ.
fn name_system(scan: &mut Scan, headers: &[Header]) {
    scan.crs = headers.iter().find_map(|header| header.crs.clone());
    scan.unit_m = headers.iter().find_map(|header| header.unit_m);
    for header in headers {
        let path = header.path.display();
        if let (Some(all), Some(own)) = (&scan.crs, &header.crs)
            && all != own
        {
            scan.warnings.push(format!("{path}: has the coordinate system {own}, other files {all}"));
        }
        if let (Some(all), Some(own)) = (scan.unit_m, header.unit_m)
            && all != own
        {
            scan.warnings
                .push(format!("{path}: has units of {own} m, other files {all} m; they do not fit together"));
        }
    }
}

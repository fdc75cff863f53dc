//! Reads several files of any format into one [`Scan`].

use super::block::Trailer;
use super::collect::{self, CannotCollect, Collected};
use super::color::{self, ColorChoice};
use super::formats::{Archives, scans_in};
use super::inputs::{self, Inputs};
use super::{
    FARTHEST, Header, InFile, ReadOptions, Scan, ScanError, ScanFile, WorldFromFile, open, uncolored, world,
};
use base::space::Bounds;
use base::task::{CancelToken, Progress, Task};
use base::words::{agreeing, counted};
use std::path::{Path, PathBuf};

/// Reads files as one scan with z up and one scale on all axes, in the order given. Shows its progress, and ends soon
/// after the task is cancelled.
///
/// Unless `options` are strict, a file of which only a part can be read gives that part and a warning in
/// [`Scan::warnings`], and a file of which nothing can be read gives only a warning, if others can be read. All headers
/// are checked before the first point is read. One file is open at a time.
///
/// # Errors
/// The first file of which nothing can be read, or not all if `options` are strict, with the reason and what to do;
/// [`ScanError::Cancelled`].
pub fn read(paths: &[PathBuf], options: &ReadOptions, task: impl Into<Task>) -> Result<Scan, ScanError> {
    Ok(read_with_headers(paths, options, task)?.0)
}

/// Reads the headers only.
///
/// # Errors
/// The first file that cannot be opened or has no readable header.
pub fn peek(paths: &[PathBuf], options: &ReadOptions) -> Result<Vec<Header>, ScanError> {
    let (mut archives, task) = (Archives::default(), Task::new(&CancelToken::default()));
    let mut headers = Vec::new();
    for path in inputs::choose(paths)?.paths {
        for scan in scans_in(&path, &mut archives, &task)? {
            headers.push(open(&scan, &options.hints())?.header().clone());
        }
    }
    Ok(headers)
}

/// Reads the scan, and what each file in it says of itself.
pub(super) fn read_with_headers(
    paths: &[PathBuf],
    options: &ReadOptions,
    task: impl Into<Task>,
) -> Result<(Scan, Vec<Header>), ScanError> {
    let read = |path: &Path, progress: &Progress| file(path, options, progress);
    let FilesRead { files, remarks, failures } = each(paths, options, task, read)?;
    let (mut scan, mut headers) = (Scan { warnings: remarks, ..Scan::default() }, Vec::new());
    for file in files {
        headers.push(file.header.clone());
        add(&mut scan, file, options.show_withheld);
    }
    scan.warnings.extend(failures);
    name_system(&mut scan, &headers);
    world::place(&mut scan, &headers, options);
    uncolored::settle(&mut scan);
    let mut scan = scan.with_scene();
    scan.files.iter_mut().for_each(uncolored::find_grays);
    Ok((scan, headers))
}

/// What was read of each of some files.
pub(super) struct FilesRead<T> {
    pub files: Vec<T>,
    /// Sentences about files that were named and not chosen.
    pub remarks: Vec<String>,
    /// Sentences about files of which nothing can be read.
    pub failures: Vec<String>,
}

/// Reads the named files in turn, each by `read`, once the headers of all were checked.
pub(super) fn each<T>(
    named: &[PathBuf],
    options: &ReadOptions,
    task: impl Into<Task>,
    read: impl Fn(&Path, &Progress) -> Result<T, ScanError>,
) -> Result<FilesRead<T>, ScanError> {
    let Inputs { paths, mut remarks } = inputs::choose(named)?;
    let mut failures = Failures { strict: options.strict, errors: Vec::new() };
    let task = task.into();
    let (mut archives, mut scans) = (Archives::default(), Vec::new());
    for path in &paths {
        scans.extend(failures.sort(scans_in(path, &mut archives, &task))?.unwrap_or_default());
    }
    for (path, reason) in std::mem::take(&mut archives.left_out) {
        if options.strict {
            return Err(ScanError::Incomplete { path, loss: reason });
        }
        remarks.push(format!("{}: {reason}; it was left out", path.display()));
    }
    let mut announced = Vec::new();
    for path in &scans {
        let header = open(path, &options.hints()).map(|dataset| dataset.header().num_points);
        announced.extend(failures.sort(header)?.map(|num_points| (path, num_points)));
    }
    let expected = announced.iter().fold(0u64, |sum, (_, num_points)| sum.saturating_add(*num_points));
    let progress = task.begin("reading", "points", expected);
    let mut files = Vec::new();
    for (path, _) in announced {
        // The file is opened again, because the system allows fewer open files than a scan may have.
        files.extend(failures.sort(read(path, &progress))?);
    }
    let failures = failures.warnings(files.is_empty())?;
    Ok(FilesRead { files, remarks, failures })
}

/// Files of which nothing can be read.
struct Failures {
    strict: bool,
    errors: Vec<ScanError>,
}

impl Failures {
    /// Returns what was read; `None` for a file that is left out.
    fn sort<T>(&mut self, read: Result<T, ScanError>) -> Result<Option<T>, ScanError> {
        match read {
            Ok(read) => Ok(Some(read)),
            Err(error) if self.strict || !error.is_of_one_file() => Err(error),
            Err(error) => {
                self.errors.push(error);
                Ok(None)
            }
        }
    }

    /// Returns a sentence for each failure, or the first as an error if nothing else was read.
    fn warnings(self, nothing_read: bool) -> Result<Vec<String>, ScanError> {
        let mut errors = self.errors.into_iter().peekable();
        match errors.next_if(|_| nothing_read) {
            Some(first) => Err(first),
            None => Ok(errors
                .map(|error| format!("{error}; it was left out, the other files are shown"))
                .collect()),
        }
    }
}

/// A file in memory.
struct ReadFile {
    header: Header,
    collected: Collected,
    trailer: Trailer,
    /// What was odd, as sentences that name the file.
    sentences: Vec<String>,
}

/// Reads all that the walk wants of a file.
fn file(path: &Path, options: &ReadOptions, progress: &Progress) -> Result<ReadFile, ScanError> {
    let dataset = open(path, &options.hints())?;
    let mut collected = Collected::new();
    let mut take = |block| {
        let (path, num_points) = (path.to_owned(), collected.points.xyz.len() as u64);
        collected.add(block, options.show_withheld).map_err(|error| match error {
            CannotCollect::Memory => ScanError::Memory { path, num_points },
            CannotCollect::Column(attribute, kind) => ScanError::Column { path, attribute, kind },
        })
    };
    let trailer = dataset.read(&collect::wanted(), &mut take, progress)?;
    collected.shrink();
    if collected.points.xyz.is_empty() {
        let num_withheld = collected.points.num_withheld;
        let all = format!("all {num_withheld} are");
        let all = agreeing(num_withheld, "its only point is", &all);
        let advice = "--set cloud.show_withheld=true shows them";
        let reason = format!("{all} withheld, which means deleted; {advice}");
        return Err(ScanError::NoPoints { path: path.to_owned(), reason });
    }
    within_reach(path, &collected)?;
    let header = dataset.header().clone();
    let sentences = sentences(&header, &trailer, options.strict)?;
    Ok(ReadFile { header, collected, trailer, sentences })
}

/// What a file's header and its end say that is odd, as sentences that name the file.
///
/// # Errors
/// A part of the file could not be read, and the user is strict.
pub(super) fn sentences(header: &Header, trailer: &Trailer, strict: bool) -> Result<Vec<String>, ScanError> {
    match trailer.losses.first() {
        Some(loss) if strict => {
            return Err(ScanError::Incomplete { path: header.path.clone(), loss: loss.clone() });
        }
        _ => {}
    }
    let losses = trailer.losses.iter().map(|loss| format!("{loss}; get or export it again"));
    let sentences = header.warnings.iter().cloned().chain(losses).chain(trailer.warnings.iter().cloned());
    Ok(sentences.map(|sentence| format!("{}: {sentence}", header.path.display())).collect())
}

fn add(scan: &mut Scan, file: ReadFile, show_withheld: bool) {
    let ReadFile { header, collected, trailer, sentences } = file;
    let bounds = bounds(&collected);
    let Collected { grid, points, stats } = collected;
    let ColorChoice { coloring, sentences: of_colors } = color::choose(&stats, &points.rgb, trailer.white);
    let of_colors = of_colors.iter().map(|sentence| format!("{}: {sentence}", header.path.display()));
    scan.warnings.extend(sentences.into_iter().chain(of_colors));
    let num_withheld = points.num_withheld;
    if num_withheld > 0 && !show_withheld {
        let path = header.path.display();
        scan.warnings.push(format!(
            "{path}: has {} that {} withheld, which means deleted; {} not drawn (--set cloud.show_withheld=true \
             shows {})",
            counted(num_withheld, "point"),
            agreeing(num_withheld, "is", "are"),
            agreeing(num_withheld, "it is", "they are"),
            agreeing(num_withheld, "it", "them"),
        ));
    }
    scan.files.push(ScanFile {
        path: header.path,
        format: header.format,
        grid,
        points,
        triangles: trailer.triangles,
        coloring,
        bounds,
        in_file: InFile { grid, bounds },
        world_from_file: WorldFromFile::default(),
        stations: header.stations,
    });
}

/// True box of a file's points.
fn bounds(collected: &Collected) -> Bounds {
    // Scales may be negative, so either corner of the grid may be the smaller one.
    let corners = [collected.stats.xyz_min, collected.stats.xyz_max];
    Bounds::around(&corners.map(|xyz| collected.grid.p_in_world(xyz)))
}

/// Refuses a file whose points are too far away to be shown.
fn within_reach(path: &Path, collected: &Collected) -> Result<(), ScanError> {
    let bounds = bounds(collected);
    let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
    if farthest > FARTHEST { Err(ScanError::TooFar { path: path.to_owned(), farthest }) } else { Ok(()) }
}

/// Sets the coordinate system of the first file that names one, and warns of files that name another.
fn name_system(scan: &mut Scan, headers: &[Header]) {
    scan.crs = headers.iter().find_map(|header| header.crs.clone());
    for header in headers {
        let path = header.path.display();
        if let (Some(all), Some(own)) = (&scan.crs, &header.crs)
            && all != own
        {
            scan.warnings.push(format!("{path}: has the coordinate system {own}, other files {all}"));
        }
    }
}

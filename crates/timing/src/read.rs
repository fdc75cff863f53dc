//! Reading a frame log back: strictly, except that a log which is still growing, or whose program was killed,
//! may end in the middle of a line.

use super::Phase;
use super::columns::{CALLS, DROPPED, HEAD, TITLE};
use base::space::Pose;
use base::words::{advice, counted};
use glam::{DQuat, DVec3};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// Bytes of a line at most: no frame log has longer ones.
const MAX_LINE_BYTES: u64 = 64 << 10;
/// Frames of a log at most: more than a day at 90 Hz, and about 3 GB in memory; a pipe that never ends is no frame log.
const MAX_FRAMES: usize = 8_000_000;
/// Qualities of a log, and states of a session, at most: there are two and ten, and another version may have more.
const MAX_NAMES: usize = 16;
/// Facts of a header at most: there are six, and another version may have more.
const MAX_FACTS: usize = 64;
/// Stages of a frame at most: there are six, and another version may have more.
const MAX_STAGES: usize = 64;
/// Largest time, factor or coordinate that is taken, so that sums stay finite.
const MAX_NUMBER: f64 = 1e12;

/// Why a file is no frame log.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file cannot be read.
    #[error("{} cannot be read: {source}{advice}", path.display(), advice = advice(source))]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's words.
        source: io::Error,
    },
    /// The file holds something else.
    #[error("{}, line {line}: {problem}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Number of the line, counted from 1.
        line: usize,
        /// What is wrong in that line.
        problem: String,
    },
}

/// What a report needs of one row.
#[derive(Clone, Debug, PartialEq)]
pub struct LoggedFrame {
    /// Number of the frame, counted from 0.
    pub frame: u64,
    /// Seconds since the log began.
    pub time_s: f64,
    /// CPU milliseconds: wait, record, submit.
    pub cpu_ms: [f64; 3],
    /// GPU milliseconds of each of [`FrameLogFile::stages`]; NaN where the log has none.
    pub stage_ms: Vec<f64>,
    /// GPU milliseconds in all; NaN where the log has none.
    pub gpu_ms: f64,
    /// The frame's budget.
    pub budget_ms: f64,
    /// True if the GPU took longer than the budget.
    pub over_budget: bool,
    /// Display periods without a new image.
    pub missed_periods: u64,
    /// The governor's factor on the LOD thresholds; NaN where the log has none.
    pub lod_scale: f64,
    /// The governor's factor on the image's edge; NaN where the log has none.
    pub resolution_scale: f64,
    /// Place of its quality in [`FrameLogFile::qualities`]; `None` where the log has none.
    pub quality: Option<u8>,
    /// The head in scan coordinates; `None` where the log has none, and while no scan was shown.
    pub world_from_head: Option<Pose>,
    /// Milliseconds of the headset's calls, in the order of [`super::CallTimes::NAMES`]; NaN where the log has none.
    pub call_ms: [f64; 5],
    /// Place of the session's state in [`FrameLogFile::sessions`]; `None` where the log has none.
    pub session: Option<u8>,
    /// What the frame showed. A log without that column, of an older version, tells frames without a scan by their
    /// empty head.
    pub phase: Phase,
}

/// A frame log, read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameLogFile {
    /// The header's facts, name and value.
    pub facts: Vec<(String, String)>,
    /// Stages whose times the log has. Another version's log may have others than ours.
    pub stages: Vec<String>,
    /// Names of the qualities that frames were drawn in, in the order in which they first appear.
    pub qualities: Vec<String>,
    /// States of the headset's session, in the order in which they first appear.
    pub sessions: Vec<String>,
    /// The rows.
    pub frames: Vec<LoggedFrame>,
    /// Rows that the writer had no room for.
    pub num_dropped: u64,
    /// True if the last line was cut off, and left out.
    pub cut_off: bool,
}

impl FrameLogFile {
    /// The phase whose frames figures are made of: the walk, or in a log that ends before it begins, the last phase
    /// before it.
    #[must_use]
    pub fn counted_phase(&self) -> Phase {
        let has = |phase: &&Phase| self.frames.iter().any(|frame| frame.phase == **phase);
        Phase::DRAWN.iter().rev().find(has).copied().unwrap_or_default()
    }

    /// The frames that figures are made of: those of [`Self::counted_phase`].
    pub fn counted(&self) -> impl Iterator<Item = &LoggedFrame> {
        let counted = self.counted_phase();
        self.frames.iter().filter(move |frame| frame.phase == counted)
    }
}

/// Reads a frame log.
///
/// # Errors
/// An unreadable file, or one that is no frame log: with the line.
pub fn read(path: &Path) -> Result<FrameLogFile, ReadError> {
    let file = File::open(path).map_err(|source| ReadError::Io { path: path.to_owned(), source })?;
    let mut reader = LogReader { path, line: 0, columns: None, log: FrameLogFile::default() };
    let mut lines = BufReader::new(file);
    let mut bytes = Vec::new();
    loop {
        bytes.clear();
        let read = (&mut lines).take(MAX_LINE_BYTES).read_until(b'\n', &mut bytes);
        let num_bytes = read.map_err(|source| ReadError::Io { path: path.to_owned(), source })?;
        if num_bytes == 0 {
            return reader.finish();
        }
        reader.line += 1;
        if bytes.pop() != Some(b'\n') {
            if num_bytes as u64 == MAX_LINE_BYTES || reader.columns.is_none() {
                return Err(reader.no_frame_log());
            }
            reader.log.cut_off = true;
            return reader.finish();
        }
        match std::str::from_utf8(&bytes) {
            Ok(line) => reader.take(line.trim_end_matches('\r'))?,
            Err(_) => return Err(reader.no_frame_log()),
        }
    }
}

/// State of the reader between two lines.
struct LogReader<'a> {
    path: &'a Path,
    line: usize,
    columns: Option<Columns>,
    log: FrameLogFile,
}

/// Where the cells that matter are in a row.
struct Columns {
    count: usize,
    time: usize,
    cpu: [usize; 3],
    stages: Vec<usize>,
    frame: usize,
    gpu: usize,
    budget: usize,
    over_budget: usize,
    missed_periods: usize,
    lod_scale: Option<usize>,
    resolution_scale: Option<usize>,
    quality: Option<usize>,
    head: Option<[usize; 7]>,
    phase: Option<usize>,
    calls: [Option<usize>; 5],
    session: Option<usize>,
}

impl LogReader<'_> {
    fn error(&self, problem: String) -> ReadError {
        ReadError::Format { path: self.path.to_owned(), line: self.line, problem }
    }

    fn no_frame_log(&self) -> ReadError {
        self.error("this is no frame log; `scanwalk view --log FRAMES.csv` writes one".into())
    }

    /// Takes the next whole line.
    fn take(&mut self, line: &str) -> Result<(), ReadError> {
        if self.line == 1 {
            return if line.starts_with(TITLE) { Ok(()) } else { Err(self.no_frame_log()) };
        }
        if let Some(num) = line.strip_prefix(DROPPED) {
            self.log.num_dropped = num.trim().parse().map_err(|_| self.error(not_a("count", num)))?;
        } else if let Some(comment) = line.strip_prefix('#') {
            if let Some((name, value)) = comment.split_once(": ") {
                if self.log.facts.len() == MAX_FACTS {
                    return Err(self.error(format!("more than {MAX_FACTS} facts of the run")));
                }
                self.log.facts.push((name.trim().to_owned(), value.to_owned()));
            }
        } else if let Some(columns) = &self.columns {
            if self.log.frames.len() == MAX_FRAMES {
                return Err(self.error(format!("more than {MAX_FRAMES} frames; report on parts of the log")));
            }
            let frame = columns.frame(line, &mut self.log.qualities, &mut self.log.sessions);
            let frame = frame.map_err(|problem| self.error(problem))?;
            self.log.frames.push(frame);
        } else {
            let (columns, stages) = Columns::find(line).map_err(|problem| self.error(problem))?;
            self.columns = Some(columns);
            self.log.stages = stages;
        }
        Ok(())
    }

    fn finish(self) -> Result<FrameLogFile, ReadError> {
        if self.columns.is_some() { Ok(self.log) } else { Err(self.no_frame_log()) }
    }
}

impl Columns {
    /// Finds the columns by their names; every other column that ends in `_ms` is a stage.
    fn find(header: &str) -> Result<(Self, Vec<String>), String> {
        const NO_STAGE: [&str; 5] = ["wait_ms", "record_ms", "submit_ms", "gpu_ms", "budget_ms"];
        let names: Vec<&str> = header.split(',').collect();
        let find = |wanted: &str| names.iter().position(|name| *name == wanted);
        let at = |wanted: &str| find(wanted).ok_or_else(|| format!("the columns lack '{wanted}'"));
        let head: Vec<usize> = HEAD.iter().filter_map(|name| find(name)).collect();
        let is_stage =
            |name: &&str| name.ends_with("_ms") && !NO_STAGE.contains(name) && !CALLS.contains(name);
        let stages = names.iter().enumerate().filter(|(_, name)| is_stage(name));
        let (stages, stage_names): (Vec<usize>, Vec<String>) =
            stages.map(|(at, name)| (at, name.trim_end_matches("_ms").to_owned())).unzip();
        if stage_names.len() > MAX_STAGES {
            return Err(format!("more than {MAX_STAGES} columns of stages"));
        }
        let columns = Self {
            count: names.len(),
            frame: at("frame")?,
            time: at("time_s")?,
            cpu: [at("wait_ms")?, at("record_ms")?, at("submit_ms")?],
            stages,
            gpu: at("gpu_ms")?,
            budget: at("budget_ms")?,
            over_budget: at("over_budget")?,
            missed_periods: at("missed_periods")?,
            lod_scale: find("lod_scale"),
            resolution_scale: find("resolution_scale"),
            quality: find("quality"),
            head: head.try_into().ok(),
            phase: find("phase"),
            calls: CALLS.map(find),
            session: find("session"),
        };
        Ok((columns, stage_names))
    }

    /// Reads a row; a quality that none before had joins `qualities`, a session's state `sessions`.
    fn frame(
        &self,
        line: &str,
        qualities: &mut Vec<String>,
        sessions: &mut Vec<String>,
    ) -> Result<LoggedFrame, String> {
        let cells: Vec<&str> = line.split(',').collect();
        if cells.len() != self.count {
            return Err(format!(
                "{} under {}",
                counted(cells.len(), "cell"),
                counted(self.count, "column name")
            ));
        }
        let [wait, record, submit] = self.cpu.map(|at| number(cells[at]));
        let stages = self.stages.iter().map(|at| number_or_none(cells[*at]));
        let world_from_head = self.head.map(|at| head(at.map(|at| cells[at]))).transpose()?.flatten();
        let is_headless = self.head.is_some() && world_from_head.is_none();
        let factor = |column: Option<usize>| column.map_or(Ok(f64::NAN), |at| number_or_none(cells[at]));
        let mut call_ms = [f64::NAN; 5];
        for (ms, at) in call_ms.iter_mut().zip(self.calls) {
            *ms = factor(at)?;
        }
        Ok(LoggedFrame {
            frame: count(cells[self.frame])?,
            time_s: number(cells[self.time])?,
            cpu_ms: [wait?, record?, submit?],
            stage_ms: stages.collect::<Result<_, _>>()?,
            gpu_ms: number_or_none(cells[self.gpu])?,
            budget_ms: number(cells[self.budget])?,
            over_budget: match cells[self.over_budget] {
                "0" => false,
                "1" => true,
                other => return Err(not_a("0 or 1", other)),
            },
            missed_periods: count(cells[self.missed_periods])?,
            lod_scale: factor(self.lod_scale)?,
            resolution_scale: factor(self.resolution_scale)?,
            quality: self.quality.map(|at| place_of(cells[at], "quality", qualities)).transpose()?,
            world_from_head,
            call_ms,
            session: self.session.map(|at| place_of(cells[at], "session's state", sessions)).transpose()?,
            phase: match self.phase {
                Some(at) => phase(cells[at])?,
                None if is_headless => Phase::Waiting,
                None => Phase::Walking,
            },
        })
    }
}

/// A number that is at most [`MAX_NUMBER`] from 0.
fn number(cell: &str) -> Result<f64, String> {
    let value = cell.parse().ok().filter(|value: &f64| value.abs() <= MAX_NUMBER);
    value.ok_or_else(|| not_a("number", cell))
}

fn count(cell: &str) -> Result<u64, String> {
    cell.parse().map_err(|_| not_a("count", cell))
}

/// Where `name` is in `names`, to which it is added if it is new.
fn place_of(name: &str, what: &str, names: &mut Vec<String>) -> Result<u8, String> {
    let place = names.iter().position(|known| known == name).unwrap_or(names.len());
    if place == names.len() {
        names.push(name.to_owned());
    }
    u8::try_from(place).ok().filter(|_| place < MAX_NAMES).ok_or_else(|| not_a(what, name))
}

fn phase(cell: &str) -> Result<Phase, String> {
    Phase::ALL.into_iter().find(|phase| phase.name() == cell).ok_or_else(|| not_a("phase", cell))
}

/// A pose from its cells; `None` if they are all empty.
fn head(cells: [&str; 7]) -> Result<Option<Pose>, String> {
    if cells.iter().all(|cell| cell.is_empty()) {
        return Ok(None);
    }
    let mut values = [0.0; 7];
    for (value, cell) in values.iter_mut().zip(cells) {
        *value = number(cell)?;
    }
    let [x, y, z, qx, qy, qz, qw] = values;
    let orientation = DQuat::from_xyzw(qx, qy, qz, qw).normalize();
    if !orientation.is_finite() {
        return Err("the head's quaternion is zero".into());
    }
    Ok(Some(Pose { position: DVec3::new(x, y, z), orientation }))
}

/// A finite number, or NaN for an empty cell.
fn number_or_none(cell: &str) -> Result<f64, String> {
    if cell.is_empty() { Ok(f64::NAN) } else { number(cell) }
}

fn not_a(wanted: &str, cell: &str) -> String {
    let start: String = cell.chars().take(40).collect();
    format!("'{start}' is no {wanted}")
}

//! The frame log's writer: a bounded queue and a thread of its own, so that no disk ever holds up a frame.
//!
//! A log is read before it is whole, and is worth most after a crash. So it gets its name, and an older log loses
//! it, with the first row of a frame that shows a scan; from then on it grows under that name. A walk that fails
//! before leaves the older log.

use super::columns::{DROPPED, write_header, write_row};
use super::{FrameRow, RunFacts};
use base::output::{Output, OutputError, OutputFile};
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Rows that wait for the disk at most: half a minute at 120 Hz.
const QUEUE_ROWS: usize = 4096;
/// Longest time between two flushes: the log on the disk is never older than this.
const FLUSH_EVERY: Duration = Duration::from_secs(1);

/// Why no log could be started.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file cannot be made.
    #[error("the frame log: {0}")]
    Create(#[from] OutputError),
    /// The system has no thread for it.
    #[error("the frame log's thread cannot be started: {0}")]
    Thread(io::Error),
}

/// What became of a log.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LogSummary {
    /// Rows written.
    pub num_rows: u64,
    /// Rows lost because the disk did not keep up.
    pub num_dropped: u64,
    /// Why writing ended early: a full disk, a closed pipe. Already reported on stderr.
    pub error: Option<String>,
}

/// A frame log being written. If it is dropped before [`FrameLog::finish`], it ends with the rows so far; if none of
/// them is of a scan, nothing is left of it.
#[derive(Debug)]
pub struct FrameLog {
    /// Rows for the writer; `None` if no more follow.
    rows: SyncSender<Option<FrameRow>>,
    num_dropped: Arc<AtomicU64>,
    /// True if the log is to stay even if no scan was shown.
    finished: Arc<AtomicBool>,
    /// `None` once it has ended.
    writer: Mutex<Option<JoinHandle<LogSummary>>>,
}

impl FrameLog {
    /// Makes the file and starts the writer.
    ///
    /// # Errors
    /// The file cannot be made. Failures of later writes stop the log only, not the program.
    pub fn start(output: &Output, facts: &RunFacts) -> Result<Self, LogError> {
        let file = output.begin()?;
        let (rows, queue) = sync_channel(QUEUE_ROWS);
        let num_dropped = Arc::new(AtomicU64::new(0));
        let finished = Arc::new(AtomicBool::new(false));
        let writer = LogWriter {
            out: Some(BufWriter::new(file)),
            path: output.path().to_owned(),
            num_dropped: Arc::clone(&num_dropped),
            finished: Arc::clone(&finished),
            has_name: false,
            summary: LogSummary::default(),
        };
        let facts = facts.clone();
        let writer = thread::Builder::new()
            .name("frame log".into())
            .spawn(move || writer.run(&queue, &facts))
            .map_err(LogError::Thread)?;
        Ok(Self { rows, num_dropped, finished, writer: Mutex::new(Some(writer)) })
    }

    /// Hands a row to the writer; never waits, and allocates nothing. If the queue is full the row is counted as
    /// dropped.
    pub fn push(&self, row: FrameRow) {
        if self.rows.try_send(Some(row)).is_err() {
            self.num_dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Writes what is still queued, and tells what became of the log. Rows that come later are lost.
    pub fn finish(&self) -> LogSummary {
        self.finished.store(true, Ordering::Release);
        self.end()
    }

    fn end(&self) -> LogSummary {
        let writer = self.writer.lock().unwrap_or_else(PoisonError::into_inner).take();
        // This waits if the queue is full. The writer has ended early only if it panicked.
        let _ = self.rows.send(None);
        // A writer that panicked has said so itself; the frame thread goes on.
        writer.and_then(|writer| writer.join().ok()).unwrap_or_default()
    }
}

impl Drop for FrameLog {
    fn drop(&mut self) {
        self.end();
    }
}

/// The writer's side.
struct LogWriter {
    /// `None` after a failure: rows are then taken and thrown away.
    out: Option<BufWriter<OutputFile>>,
    path: PathBuf,
    num_dropped: Arc<AtomicU64>,
    finished: Arc<AtomicBool>,
    has_name: bool,
    summary: LogSummary,
}

impl LogWriter {
    fn run(mut self, queue: &Receiver<Option<FrameRow>>, facts: &RunFacts) -> LogSummary {
        self.write(|out| {
            write_header(out, facts)?;
            out.flush()
        });
        let mut flush_at = Instant::now() + FLUSH_EVERY;
        loop {
            match queue.recv_timeout(flush_at.saturating_duration_since(Instant::now())) {
                Ok(Some(row)) => {
                    self.summary.num_rows += u64::from(self.write(|out| write_row(out, &row)));
                    if row.points_resident > 0 {
                        self.name();
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Ok(None) | Err(RecvTimeoutError::Disconnected) => break,
            }
            if Instant::now() >= flush_at {
                self.write(Write::flush);
                flush_at = Instant::now() + FLUSH_EVERY;
            }
        }
        self.summary.num_dropped = self.num_dropped.load(Ordering::Relaxed);
        let num_dropped = self.summary.num_dropped;
        self.write(|out| {
            if num_dropped > 0 {
                writeln!(out, "{DROPPED}{num_dropped}")?;
            }
            out.flush()
        });
        if self.finished.load(Ordering::Acquire) {
            self.name();
        }
        self.summary
    }

    /// Gives the log its name, once.
    fn name(&mut self) {
        if !self.has_name {
            self.has_name = true;
            self.write(|out| {
                out.flush()?;
                out.get_mut().publish()
            });
        }
    }

    /// Writes, unless writing failed before; the first failure is reported, once. True if all went well.
    fn write(&mut self, write: impl FnOnce(&mut BufWriter<OutputFile>) -> io::Result<()>) -> bool {
        let Some(out) = &mut self.out else { return false };
        let Err(error) = write(out) else { return true };
        let sentence = format!("the frame log {} ends early: {error}", self.path.display());
        // The disk or pipe is gone, and perhaps stderr with it: nothing is left to say it to.
        let _ = writeln!(io::stderr(), "scanwalk: {sentence}; the walk goes on");
        self.summary.error = Some(sentence);
        // The writer is taken into parts and not dropped: dropping would try the write once more.
        if let Some(out) = self.out.take() {
            drop(out.into_parts());
        }
        false
    }
}

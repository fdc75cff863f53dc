//! The walk's rows of the frame log: each waits for its GPU times, which come some frames late, and is passed on in order.

use super::link::WalkEnd;
use render::FrameTimes;
use std::collections::VecDeque;
use std::time::{Duration, Instant};
use timing::log::FrameLog;
use timing::{FrameRow, ms};

/// Rows that wait for their GPU times; a frame's times come back a few frames late.
const MAX_PENDING_ROWS: usize = 32;

/// Rows under way, and what they count from frame to frame.
#[derive(Debug)]
pub(super) struct PendingRows {
    pending: VecDeque<FrameRow>,
    /// Frames so far.
    pub frame: u64,
    /// Frames that showed a scan.
    pub scan_frames: u64,
    /// When the first frame with a scan was noted.
    pub scan_shown: Option<Instant>,
    began: Instant,
    /// Milliseconds that clouds took of the frame thread since the last row, for the next row's `record_ms`.
    load_ms: f32,
    last_display_ns: Option<i64>,
    /// Bytes that were sent to the GPU up to the frame before, by anybody.
    written_bytes: u64,
}

impl PendingRows {
    /// Rows that begin now.
    pub fn new() -> Self {
        Self {
            pending: VecDeque::with_capacity(MAX_PENDING_ROWS + 1),
            frame: 0,
            scan_frames: 0,
            scan_shown: None,
            began: Instant::now(),
            load_ms: 0.0,
            last_display_ns: None,
            written_bytes: 0,
        }
    }

    /// Goes on with another headset, which has a clock of its own, and a GPU that `written_bytes` have been sent to.
    pub fn restart(&mut self, written_bytes: u64) {
        (self.last_display_ns, self.written_bytes) = (None, written_bytes);
    }

    /// Seconds from the log's beginning to `at`.
    pub fn seconds(&self, at: Instant) -> f64 {
        at.duration_since(self.began).as_secs_f64()
    }

    /// Seconds from the display of the frame before to this one's; 0 for the first.
    pub fn since_display_s(&self, predicted_display_ns: i64) -> f64 {
        self.last_display_ns.map_or(0.0, |last| (predicted_display_ns - last) as f64 * 1e-9)
    }

    /// Adds the time that taking a cloud has cost the frame thread.
    pub fn add_load(&mut self, time: Duration) {
        self.load_ms += ms(time);
    }

    /// Takes the milliseconds that clouds have cost since the last row.
    pub fn take_load_ms(&mut self) -> f32 {
        std::mem::take(&mut self.load_ms)
    }

    /// Display periods since the frame before in which no image of ours came.
    pub fn missed_periods(&self, predicted_display_ns: i64, period_ns: i64) -> u32 {
        let Some(last) = self.last_display_ns.filter(|_| period_ns > 0) else { return 0 };
        let periods = (predicted_display_ns - last + period_ns / 2) / period_ns;
        u32::try_from(periods - 1).unwrap_or(0)
    }

    /// Bytes sent to the GPU since the frame before, of `written_bytes` in all.
    pub fn uploaded(&mut self, written_bytes: u64) -> u64 {
        written_bytes - std::mem::replace(&mut self.written_bytes, written_bytes)
    }

    /// Notes a frame that has been submitted; `shows_scan` is true if it shows a scan.
    pub fn note(&mut self, row: FrameRow, shows_scan: bool) {
        self.last_display_ns = Some(row.predicted_display_ns);
        self.pending.push_back(row);
        self.frame += 1;
        if shows_scan {
            self.scan_frames += 1;
            self.scan_shown.get_or_insert_with(Instant::now);
        }
    }

    /// Joins a frame's GPU times with its row, and passes on all rows up to it.
    pub fn join(&mut self, times: &FrameTimes, pass_on: &mut dyn FnMut(FrameRow)) {
        while let Some(row) = self.pending.pop_front_if(|row| row.frame <= times.frame) {
            pass_on(if row.frame == times.frame { with_times(row, times) } else { row });
        }
    }

    /// Passes on, without times, the rows that have waited too long; at the end, all rows.
    pub fn give_up(&mut self, at_end: bool, pass_on: &mut dyn FnMut(FrameRow)) {
        let keep = if at_end { 0 } else { MAX_PENDING_ROWS };
        while self.pending.len() > keep {
            let Some(row) = self.pending.pop_front() else { break };
            pass_on(row);
        }
    }
}

/// Gives a row to the log and to the window.
pub(super) fn pass_on(log: Option<&FrameLog>, link: &WalkEnd, row: FrameRow) {
    if let Some(log) = log {
        log.push(row);
    }
    link.offer_row(row);
}

fn with_times(row: FrameRow, times: &FrameTimes) -> FrameRow {
    FrameRow {
        stage_ms: times.stage_ms,
        gpu_ms: times.gpu_ms,
        visible_nodes: times.visible_nodes,
        visible_batches: times.visible_batches,
        points_read: times.points_read,
        ..row
    }
}

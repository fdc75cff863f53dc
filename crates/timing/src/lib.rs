//! Frame timing: the row of a frame, the log that writes rows, and the reader that gives them back.

use base::space::Pose;

pub mod columns;
pub mod log;
pub mod pose_path;
mod read;

pub use log::{FrameLog, LogError, LogSummary};
pub use read::{FrameLogFile, LoggedFrame, ReadError, read};

/// The stages of a frame, in order. One name everywhere: shader, host, CPU reference, timer row, log column, test.
pub const STAGES: [&str; 6] = ["clear", "lod", "cull", "depth", "color", "resolve"];

/// GPU milliseconds of each of [`STAGES`]; NaN where the device gave no time.
pub type StageMs = [f32; STAGES.len()];

/// What a frame showed: only frames of the walk tell how fast a walk is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Phase {
    /// No scan is shown yet.
    Waiting,
    /// A scan is shown, and some of its nodes are still to be built or sent to the GPU.
    Arriving,
    /// The scan is shown as it stays.
    #[default]
    Walking,
}

impl Phase {
    /// All phases, in the order in which a walk goes through them.
    pub const ALL: [Self; 3] = [Self::Waiting, Self::Arriving, Self::Walking];

    /// Name in the log and in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Arriving => "arriving",
            Self::Walking => "walking",
        }
    }
}

/// Everything the log says of one frame. Small and `Copy`: it crosses threads by value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameRow {
    /// Number of the frame, counted from 0.
    pub frame: u64,
    /// Start of the frame on the CPU, seconds since the log began.
    pub time_s: f64,
    /// The runtime's predicted display time, nanoseconds of its clock.
    pub predicted_display_ns: i64,
    /// CPU: waiting for the runtime (or the simulated display).
    pub wait_ms: f32,
    /// CPU: recording commands, and before that taking a cloud that has become ready.
    pub record_ms: f32,
    /// CPU: locating the eyes and submitting.
    pub submit_ms: f32,
    /// GPU time of each stage.
    pub stage_ms: StageMs,
    /// GPU time from the first stage's start to the last one's end: an overlay for the window comes after it.
    pub gpu_ms: f32,
    /// 1000 / refresh rate.
    pub budget_ms: f32,
    /// Display periods that passed without a new image since the frame before.
    pub missed_periods: u32,
    /// Nodes of which `depth` drew something.
    pub visible_nodes: u32,
    /// Points in the batches that `depth` drew.
    pub points_read: u64,
    /// Points on the GPU.
    pub points_resident: u64,
    /// Factor on the LOD thresholds.
    pub lod_scale: f32,
    /// Factor on the image's edge.
    pub resolution_scale: f32,
    /// `closest` or `hqs`.
    pub quality: &'static str,
    /// Bytes sent to the GPU since the frame before: uploads of the loader too.
    pub upload_bytes: u64,
    /// Where the head was and looked, as a pose path has it; `None` while no scan is shown.
    pub world_from_head: Option<Pose>,
    /// What the frame showed.
    pub phase: Phase,
    /// Batches that `depth` drew.
    pub visible_batches: u32,
}

impl FrameRow {
    /// True if the GPU took longer than the budget.
    #[must_use]
    pub fn over_budget(&self) -> bool {
        self.gpu_ms > self.budget_ms
    }
}

/// What the log's `#` header tells of the run.
#[derive(Clone, Debug, Default)]
pub struct RunFacts {
    /// Files shown.
    pub scan: String,
    /// GPU name.
    pub device: String,
    /// Driver of the GPU, and its version.
    pub driver: String,
    /// OpenXR runtime, or "simulated".
    pub runtime: String,
    /// Pixels an eye, "1440x1600".
    pub resolution: String,
    /// Digest of the resolved configuration.
    pub config_digest: String,
}

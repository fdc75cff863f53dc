//! Frame timing: the row of a frame, the log that writes rows, and the reader that gives them back.

use base::space::Pose;
use glam::DVec3;
use std::time::Duration;

pub mod columns;
pub mod log;
pub mod pose_path;
mod read;

pub use log::{FrameLog, LogError, LogSummary};
pub use read::{FrameLogFile, LoggedFrame, ReadError, read};

/// The stages of a frame, in order. One name everywhere: shader, host, CPU reference, timer row, log column.
pub const STAGES: [&str; 7] = ["clear", "lod", "cull", "depth", "color", "resolve", "scenery"];

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
    /// Nothing: the headset's runtime said that nobody would see the frame, so it was not drawn.
    Unseen,
}

impl Phase {
    /// Phases of frames that were drawn, in the order in which a walk goes through them.
    pub const DRAWN: [Self; 3] = [Self::Waiting, Self::Arriving, Self::Walking];
    /// All phases.
    pub const ALL: [Self; 4] = [Self::Waiting, Self::Arriving, Self::Walking, Self::Unseen];

    /// Name in the log and in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Arriving => "arriving",
            Self::Walking => "walking",
            Self::Unseen => "unseen",
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
    /// What the headset's calls took.
    pub calls: CallTimes,
    /// State of the headset's session as OpenXR names it: "FOCUSED"; "simulated" if there is none.
    pub session: &'static str,
    /// Where the user's stage stands in the scan; `None` while no scan is shown.
    pub place: Option<Place>,
}

impl FrameRow {
    /// A row for tests, of a walk without a headset in which nothing is remarkable: they say what differs.
    #[must_use]
    pub fn sample() -> Self {
        Self {
            frame: 0,
            time_s: 0.0,
            predicted_display_ns: 0,
            wait_ms: 2.0,
            record_ms: 0.5,
            submit_ms: 0.25,
            stage_ms: [0.5; STAGES.len()],
            gpu_ms: 5.0,
            budget_ms: 11.111,
            missed_periods: 0,
            visible_nodes: 800,
            points_read: 8_000_000,
            points_resident: 52_400_000,
            lod_scale: 1.0,
            resolution_scale: 1.0,
            quality: "closest",
            upload_bytes: 0,
            world_from_head: None,
            phase: Phase::Walking,
            visible_batches: 900,
            calls: CallTimes::default(),
            session: "simulated",
            place: None,
        }
    }
}

/// A duration in milliseconds, as rows have it.
#[must_use]
pub fn ms(duration: Duration) -> f32 {
    (duration.as_secs_f64() * 1000.0) as f32
}

/// Milliseconds that a frame's calls to the headset took; NaN where there was no such call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CallTimes {
    /// Waiting until the compositor had finished reading the images.
    pub image_ms: f32,
    /// Locating the eyes.
    pub locate_ms: f32,
    /// Handing the commands to the GPU and releasing the images.
    pub release_ms: f32,
    /// Ending the frame.
    pub end_ms: f32,
    /// From the moment in which the eyes were located to the display that they were located for: how far ahead the runtime
    /// had to predict.
    pub pose_age_ms: f32,
}

impl CallTimes {
    /// Names of the times, in their order.
    pub const NAMES: [&str; 5] = ["image", "locate", "release", "end", "pose_age"];

    /// The times, in the order of [`Self::NAMES`].
    #[must_use]
    pub fn to_array(self) -> [f32; 5] {
        let Self { image_ms, locate_ms, release_ms, end_ms, pose_age_ms } = self;
        [image_ms, locate_ms, release_ms, end_ms, pose_age_ms]
    }
}

impl Default for CallTimes {
    /// The times of a headset that makes no calls.
    fn default() -> Self {
        Self {
            image_ms: f32::NAN,
            locate_ms: f32::NAN,
            release_ms: f32::NAN,
            end_ms: f32::NAN,
            pose_age_ms: f32::NAN,
        }
    }
}

/// Where the stage, the room that the user stands in, is in the scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Its floor's middle, world space.
    pub floor_in_world: DVec3,
    /// Its turn about the world's vertical, degrees, positive to the left.
    pub yaw_deg: f64,
    /// World units a meter of the user's.
    pub units_per_m: f64,
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

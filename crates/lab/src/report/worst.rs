//! The frames that took the GPU longest, and where the head was in them, so that they can be looked at again.

use timing::pose_path::PosePath;
use timing::{FrameLogFile, LoggedFrame};

/// Most frames that are reported.
const NUM_WORST: usize = 20;
/// Least seconds between two worst frames. Frames of one hitch see the same, so only the worst of them counts.
const APART_S: f64 = 0.5;
/// Seconds that the pose path stays at each worst frame, in which the LOD settles.
pub const HOLD_S: f64 = 2.0;

/// The counted frames with most GPU time, the worst first, each the worst within half a second.
#[must_use]
pub fn worst(log: &FrameLogFile) -> Vec<&LoggedFrame> {
    let mut frames: Vec<&LoggedFrame> = log.counted().filter(|frame| !frame.gpu_ms.is_nan()).collect();
    frames.sort_by(|a, b| b.gpu_ms.total_cmp(&a.gpu_ms));
    let mut worst: Vec<&LoggedFrame> = Vec::new();
    for frame in frames {
        if worst.len() == NUM_WORST {
            break;
        }
        if worst.iter().all(|worse| (worse.time_s - frame.time_s).abs() >= APART_S) {
            worst.push(frame);
        }
    }
    worst
}

/// A path of the head that shows the [`worst`] frames in turn, each for [`HOLD_S`]; `None` if the log has no pose of
/// them.
#[must_use]
pub fn worst_poses(log: &FrameLogFile) -> Option<PosePath> {
    PosePath::holding(worst(log).into_iter().filter_map(|frame| frame.world_from_head), HOLD_S)
}

/// The stage that took most of a frame, with its milliseconds; `None` where none was timed.
pub(super) fn dearest_stage<'a>(log: &'a FrameLogFile, frame: &LoggedFrame) -> Option<(&'a str, f64)> {
    let stages = log.stages.iter().zip(&frame.stage_ms).filter(|(_, ms)| !ms.is_nan());
    let (name, ms) = stages.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    Some((name.as_str(), *ms))
}

//! Motions of the head while pictures are compared: the tremor of somebody who stands still, a slow walk, and the part
//! of the walk that only level of detail would notice.

use super::picture::{only_eye, seen_from};
use base::space::{Pose, View};
use glam::{DQuat, DVec3};

/// Largest turn of the trembling head about each of two axes.
pub const TREMOR_DEG: f64 = 0.1;
/// Length of a step, as a share of the way to what is looked at: 13 mm where that is 6.5 m away, which at 90 frames
/// a second is a slow walk.
const STEP_SHARE: f64 = 0.002;

/// `num_frames` views: the first as it is, the others turned by up to 0.1° to the side and up or down, always the
/// same way.
pub fn tremor(view: &View, num_frames: usize) -> Vec<View> {
    let pose = only_eye(view).world_from_view;
    let mut random = 0x5ca1_ab1e_u64;
    let mut angle = || {
        // The high bits of a linear congruence are random enough to tremble by.
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let unit = (random >> 11) as f64 / (1u64 << 53) as f64;
        TREMOR_DEG.to_radians() * (2.0 * unit - 1.0)
    };
    let turned = |frame: usize| {
        let (yaw, pitch) = if frame == 0 { (0.0, 0.0) } else { (angle(), angle()) };
        let turn = DQuat::from_rotation_y(yaw) * DQuat::from_rotation_x(pitch);
        seen_from(view, Pose { orientation: (pose.orientation * turn).normalize(), ..pose })
    };
    (0..num_frames).map(turned).collect()
}

/// Factors on the thresholds of level of detail as the steps of [`walk`] would lower them for what is looked at.
pub fn approach(num_frames: usize) -> Vec<f32> {
    (1..num_frames).map(|frame| (1.0 - frame as f64 * STEP_SHARE) as f32).collect()
}

/// `num_frames` views on the way to `target`, looking ahead as at the start.
pub fn walk(view: &View, target: DVec3, num_frames: usize) -> Vec<View> {
    let pose = only_eye(view).world_from_view;
    let step = STEP_SHARE * (target - pose.position);
    let moved = |frame: usize| Pose { position: pose.position + frame as f64 * step, ..pose };
    (0..num_frames).map(|frame| seen_from(view, moved(frame))).collect()
}

//! Shows in the room before the viewer how far the loader is, while there is no scan.

use super::link::WalkEnd;
use super::locomotion::head_of;
use base::space::{Eye, Pose};
use glam::DVec3;
use render::Renderer;
use render::gpu::QueueGuard;
use xr::StageEye;

/// Distance of the bar before the viewer, meters.
const AWAY_M: f64 = 2.0;

/// Where the bar is shown while there is no scan.
#[derive(Debug, Default)]
pub(super) struct Waiting {
    /// Chosen when it is first shown, so that it stands still.
    stage_from_bar: Option<Pose>,
}

impl Waiting {
    /// Tells the renderer what to show; never waits for the loader.
    pub(super) fn show(
        &mut self,
        renderer: &mut Renderer,
        queue: &QueueGuard,
        link: &WalkEnd,
        (eyes, drawn_px, near): (&[StageEye; 2], [[u32; 2]; 2], f64),
    ) {
        let stage_from_bar = *self.stage_from_bar.get_or_insert_with(|| before(&head_of(eyes)));
        let sized = [0, 1].map(|eye: usize| Eye {
            world_from_view: eyes[eye].stage_from_view,
            fov: eyes[eye].fov,
            size_px: drawn_px[eye],
            gaze_in_view: Eye::AHEAD,
        });
        let fraction = link.try_doing().map(|done| done.fraction());
        renderer.set_waiting(queue, &sized, near, &stage_from_bar, fraction);
    }
}

/// A pose upright before a head, at its height.
fn before(stage_from_head: &Pose) -> Pose {
    let ahead = stage_from_head.orientation * DVec3::NEG_Z;
    let ahead = DVec3::new(ahead.x, 0.0, ahead.z).normalize_or(DVec3::NEG_Z);
    let position = stage_from_head.position + AWAY_M * ahead;
    Pose::look_at(position, position + ahead, DVec3::Y)
}

//! Views of the whole scan: from above, and from all around.

use super::Locomotion;
use crate::walk::start::Start;
use glam::{DQuat, DVec3};
use std::f64::consts::FRAC_PI_2;

impl Locomotion {
    /// Looks at the whole scan from above, north up, if the view may pitch; else from where all of it is seen.
    pub(super) fn look_down(&mut self) {
        let Start { overview, bounds, .. } = self.start;
        self.go(&overview);
        self.pitch = 0.0;
        if self.may_pitch {
            let size = bounds.size();
            // A view of 90 degrees holds the longer side, with a little to spare.
            let above = 0.55 * size.truncate().max_element().max(0.1 * size.z) + size.z;
            self.place.bring(self.stage_from_head.position, bounds.center().with_z(bounds.min.z + above));
            self.pitch = -FRAC_PI_2;
        }
    }

    /// Goes round the middle of the scan, which stays where it is in sight. The pitch changes only if it may.
    pub(super) fn orbit(&mut self, delta_px: [f32; 2]) {
        let [right, down] = delta_px.map(|px| -f64::from(px) * self.options.look_rad_per_px);
        let pivot = self.start.bounds.center();
        self.place.turn_about(self.place.p_in_stage(pivot), right);
        if self.may_pitch {
            let head = self.world_from_head(&self.stage_from_head);
            let pitch = (self.pitch + down).clamp(-FRAC_PI_2, FRAC_PI_2);
            let turn = DQuat::from_axis_angle(head.orientation * DVec3::X, pitch - self.pitch);
            self.pitch = pitch;
            self.place.bring(self.stage_from_head.position, pivot + turn * (head.position - pivot));
        }
        self.feet.forget();
    }
}

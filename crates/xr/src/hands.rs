//! The joints of hands, as the runtime tracks them without controllers (XR_EXT_hand_tracking).

use crate::headset::{HandJoints, Joint};
use crate::pose;
use openxr as xr;

/// The hands, left and right, that a runtime tracks.
pub(super) struct HandTrackers([xr::HandTracker; 2]);

impl HandTrackers {
    /// Starts to track both hands.
    ///
    /// # Errors
    /// What the runtime says.
    pub fn new(session: &xr::Session<xr::Vulkan>) -> xr::Result<Self> {
        let left = session.create_hand_tracker(xr::Hand::LEFT)?;
        Ok(Self([left, session.create_hand_tracker(xr::Hand::RIGHT)?]))
    }

    /// The joints of each hand that is seen, in `stage`, as the runtime predicts them for `display_time`.
    ///
    /// # Errors
    /// What the runtime says.
    pub fn locate(&self, stage: &xr::Space, display_time: xr::Time) -> xr::Result<[Option<HandJoints>; 2]> {
        let [left, right] = &self.0;
        let left = stage.locate_hand_joints(left, display_time)?;
        let right = stage.locate_hand_joints(right, display_time)?;
        Ok([left, right].map(|hand| hand.and_then(|located| joints(&located))))
    }
}

/// The joints, if the runtime knows where all of them are.
fn joints(located: &xr::HandJointLocations) -> Option<HandJoints> {
    let mut joints = [Joint::default(); xr::HAND_JOINT_COUNT];
    for (joint, location) in joints.iter_mut().zip(located) {
        *joint = Joint {
            stage_from_joint: pose::located(location.location_flags, &location.pose)?,
            radius_m: location.radius.into(),
        };
    }
    Some(joints)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hand_is_there_if_all_of_its_joints_are() {
        let known = xr::SpaceLocationFlags::POSITION_VALID | xr::SpaceLocationFlags::ORIENTATION_VALID;
        let mut located = [xr::HandJointLocation {
            location_flags: known,
            pose: xr::Posef { position: xr::Vector3f { x: 0.0, y: 1.0, z: -0.5 }, ..xr::Posef::IDENTITY },
            radius: 0.01,
        }; xr::HAND_JOINT_COUNT];
        let hand = joints(&located).unwrap();
        assert_eq!(hand[25].stage_from_joint.position, glam::DVec3::new(0.0, 1.0, -0.5));
        assert_eq!(hand[0].radius_m, f64::from(0.01_f32));
        located[25].location_flags = xr::SpaceLocationFlags::ORIENTATION_VALID;
        assert_eq!(joints(&located), None);
    }
}

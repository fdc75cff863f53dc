//! Poses as OpenXR locates them.

use base::space::Pose;
use glam::{DQuat, DVec3};
use openxr as xr;

/// The pose of what was located, if the runtime knows both place and direction. It may have guessed the place: that of
/// controllers that only feel how they are turned follows from a model of the arm.
pub(super) fn located(flags: xr::SpaceLocationFlags, pose: &xr::Posef) -> Option<Pose> {
    let known = xr::SpaceLocationFlags::POSITION_VALID | xr::SpaceLocationFlags::ORIENTATION_VALID;
    if !flags.contains(known) {
        return None;
    }
    let (p, q) = (pose.position, pose.orientation);
    let position = DVec3::new(p.x.into(), p.y.into(), p.z.into());
    let orientation = DQuat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into());
    // The specification demands unit length within 1%.
    let is_rotation = (orientation.length_squared() - 1.0).abs() < 0.02;
    (is_rotation && position.is_finite()).then(|| Pose { position, orientation: orientation.normalize() })
}

/// A pose as OpenXR takes it.
pub(super) fn to_runtime(pose: &Pose) -> xr::Posef {
    let (p, q) = (pose.position.as_vec3(), pose.orientation.as_quat());
    xr::Posef {
        position: xr::Vector3f { x: p.x, y: p.y, z: p.z },
        orientation: xr::Quaternionf { x: q.x, y: q.y, z: q.z, w: q.w },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_comes_back_as_it_went() {
        let pose = Pose { position: DVec3::new(1.0, 2.0, 3.0), orientation: DQuat::from_rotation_y(0.5) };
        let known = xr::SpaceLocationFlags::POSITION_VALID | xr::SpaceLocationFlags::ORIENTATION_VALID;
        let back = located(known, &to_runtime(&pose)).expect("a pose");
        assert!((back.position - pose.position).length() < 1e-6);
        assert!(back.orientation.angle_between(pose.orientation) < 1e-6);
    }

    #[test]
    fn a_pose_needs_place_and_direction() {
        let (place, direction) =
            (xr::SpaceLocationFlags::POSITION_VALID, xr::SpaceLocationFlags::ORIENTATION_VALID);
        let mut pose = xr::Posef { position: xr::Vector3f { x: 1.0, y: 2.0, z: 3.0 }, ..xr::Posef::IDENTITY };
        let wanted = Pose { position: DVec3::new(1.0, 2.0, 3.0), orientation: DQuat::IDENTITY };
        assert_eq!(located(place | direction, &pose), Some(wanted));
        for part in [place, direction, xr::SpaceLocationFlags::EMPTY] {
            assert_eq!(located(part, &pose), None);
        }
        pose.position.y = f32::NAN;
        assert_eq!(located(place | direction, &pose), None);
        pose.position.y = 2.0;
        pose.orientation.w = 0.5;
        assert_eq!(located(place | direction, &pose), None);
    }
}

//! Poses as OpenXR locates them.

use base::space::Pose;
use glam::{DQuat, DVec3};
use openxr as xr;

/// How far from the origin of its space a place may be, meters. A runtime whose service has died may mark memory that it
/// never wrote as a valid pose (seen with Monado: a head at 10²³ m). From here on the steps of an f32 are a millimeter.
const REACH_M: f32 = 8192.0;

/// Whether a runtime's place can be one of a head or a hand.
pub(super) fn is_place(at: xr::Vector3f) -> bool {
    // A NaN is not below any limit.
    [at.x, at.y, at.z].into_iter().all(|c| c.abs() < REACH_M)
}

/// Whether a runtime's orientation is a rotation.
pub(super) fn is_rotation(q: xr::Quaternionf) -> bool {
    // The specification demands unit length within 1%.
    (q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1.0).abs() < 0.02
}

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
    (is_rotation(q) && is_place(p)).then(|| Pose { position, orientation: orientation.normalize() })
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
        for nowhere in [f32::NAN, f32::NEG_INFINITY, 6e23] {
            pose.position.y = nowhere;
            assert_eq!(located(place | direction, &pose), None);
        }
        pose.position.y = 2.0;
        pose.orientation.w = 0.5;
        assert_eq!(located(place | direction, &pose), None);
    }
}

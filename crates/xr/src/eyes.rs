//! Where the eyes are: views as the runtime locates them, with the last good value where it has none.

use crate::{StageEye, pose};
use base::space::{Fov, Pose};
use glam::{DQuat, DVec3};
use openxr as xr;

/// Height of LOCAL's origin above the floor, meters. Runtimes put it at the eyes of the user when starting. It counts only
/// where the runtime has neither LOCAL_FLOOR nor STAGE.
pub(super) const LOCAL_ORIGIN_M: f32 = 1.6;

/// How far apart two eyes may be, meters: no head is so wide, whatever its runtime says.
const APART_M: f32 = 1.0;

/// The views that the next layer is submitted with, left then right.
///
/// They are kept as the runtime gave them (f32, angles): the layer must repeat them exactly, or the runtime would
/// reproject by the difference.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Eyes([xr::View; 2]);

impl Eyes {
    /// The eyes before anything is located: standing at the origin, eyes 64 mm apart, 90° of view.
    pub fn standing() -> Self {
        Self([-0.032, 0.032].map(|x| {
            let quarter = std::f32::consts::FRAC_PI_4;
            xr::View {
                pose: xr::Posef {
                    orientation: xr::Quaternionf { x: 0.0, y: 0.0, z: 0.0, w: 1.0 },
                    position: xr::Vector3f { x, y: LOCAL_ORIGIN_M, z: 0.0 },
                },
                fov: xr::Fovf {
                    angle_left: -quarter,
                    angle_right: quarter,
                    angle_up: quarter,
                    angle_down: -quarter,
                },
            }
        }))
    }

    /// Takes over what is valid of `located`; the rest stays as it was last, since a head that stands still
    /// is easier to bear than one that jumps to the origin when tracking is lost.
    ///
    /// # Errors
    /// ERROR_POSE_INVALID if what is marked as valid cannot be a pair of eyes. Nothing of it is taken over then.
    pub fn update(&mut self, flags: xr::ViewStateFlags, located: &[xr::View]) -> xr::Result<()> {
        let [turns, moves] = [xr::ViewStateFlags::ORIENTATION_VALID, xr::ViewStateFlags::POSITION_VALID]
            .map(|flag| flags.contains(flag));
        let are_eyes = (!turns || located.iter().all(|view| pose::is_rotation(view.pose.orientation)))
            && (!moves || are_places_of_eyes(located));
        if !are_eyes {
            return Err(xr::sys::Result::ERROR_POSE_INVALID);
        }
        for (eye, view) in self.0.iter_mut().zip(located) {
            if turns {
                eye.pose.orientation = view.pose.orientation;
            }
            if moves {
                eye.pose.position = view.pose.position;
            }
            if fov_is_usable(&view.fov) {
                eye.fov = view.fov;
            }
        }
        Ok(())
    }

    /// The views as OpenXR wants them for the layer.
    pub fn views(&self) -> &[xr::View; 2] {
        &self.0
    }

    /// The head, midway between the eyes, in the space that they were located in.
    pub fn head(&self) -> Pose {
        let [left, right] = self.in_stage(None).map(|eye| eye.stage_from_view);
        Pose {
            position: 0.5 * (left.position + right.position),
            orientation: left.orientation.slerp(right.orientation, 0.5),
        }
    }

    /// The eyes as the walk wants them, in the space that they were located in, with the direction of the gaze in that
    /// space.
    ///
    /// Both eyes look the same way: what they lack in convergence is small against the fovea's rings.
    pub fn in_stage(&self, gaze_in_stage: Option<DVec3>) -> [StageEye; 2] {
        self.0.map(|view| {
            let (q, p, fov) = (view.pose.orientation, view.pose.position, view.fov);
            let orientation = DQuat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into()).normalize();
            StageEye {
                stage_from_view: Pose {
                    position: DVec3::new(p.x.into(), p.y.into(), p.z.into()),
                    orientation,
                },
                gaze_in_view: gaze_in_stage.map(|gaze| orientation.inverse() * gaze),
                fov: Fov::from_angles(
                    fov.angle_left.into(),
                    fov.angle_right.into(),
                    fov.angle_up.into(),
                    fov.angle_down.into(),
                ),
            }
        })
    }
}

/// Whether places are those of one head's eyes.
fn are_places_of_eyes(located: &[xr::View]) -> bool {
    let mut places = located.iter().map(|view| view.pose.position);
    let Some(first) = places.next() else { return true };
    let near = |at: xr::Vector3f| {
        let [x, y, z] = [at.x - first.x, at.y - first.y, at.z - first.z];
        x * x + y * y + z * z < APART_M * APART_M
    };
    pose::is_place(first) && places.all(near)
}

/// Whether a field of view has an area and no edge at or beyond 90°.
fn fov_is_usable(fov: &xr::Fovf) -> bool {
    let limit = std::f32::consts::FRAC_PI_2;
    let inside = |angle: f32| angle > -limit && angle < limit;
    [fov.angle_left, fov.angle_right, fov.angle_up, fov.angle_down].into_iter().all(inside)
        && fov.angle_left < fov.angle_right
        && fov.angle_down < fov.angle_up
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tracked() -> xr::ViewStateFlags {
        xr::ViewStateFlags::ORIENTATION_VALID | xr::ViewStateFlags::POSITION_VALID
    }

    /// A view turned by 90° to the left, at (1, 2, 3), asymmetric.
    fn turned() -> xr::View {
        let half = std::f32::consts::FRAC_1_SQRT_2;
        xr::View {
            pose: xr::Posef {
                orientation: xr::Quaternionf { x: 0.0, y: half, z: 0.0, w: half },
                position: xr::Vector3f { x: 1.0, y: 2.0, z: 3.0 },
            },
            fov: xr::Fovf { angle_left: -0.9, angle_right: 0.7, angle_up: 0.8, angle_down: -0.85 },
        }
    }

    /// The other eye of that head, which looks straight ahead.
    fn beside(mut view: xr::View) -> xr::View {
        view.pose.position.x += 0.064;
        view.pose.orientation = xr::Quaternionf { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
        view
    }

    #[test]
    fn signs_and_order_survive() {
        let mut eyes = Eyes::standing();
        eyes.update(tracked(), &[turned(), beside(turned())]).unwrap();
        let [left, right] = eyes.in_stage(None);
        assert_eq!(left.stage_from_view.position, DVec3::new(1.0, 2.0, 3.0));
        // An eye turned left about y looks along −x.
        let forward = left.stage_from_view.orientation * DVec3::NEG_Z;
        assert!((forward - DVec3::NEG_X).length() < 1e-6, "{forward}");
        assert!((left.fov.left - f64::from(-0.9_f32).tan()).abs() < 1e-12);
        assert!((left.fov.down - f64::from(-0.85_f32).tan()).abs() < 1e-12);
        assert_eq!(right.stage_from_view.position.x, f64::from(1.064_f32));
    }

    #[test]
    fn the_head_is_between_the_eyes() {
        let head = Eyes::standing().head();
        assert_eq!(head.position, DVec3::new(0.0, LOCAL_ORIGIN_M.into(), 0.0));
        assert!((head.orientation * DVec3::NEG_Z - DVec3::NEG_Z).length() < 1e-9);
    }

    #[test]
    fn the_gaze_turns_with_the_eye() {
        let mut eyes = Eyes::standing();
        eyes.update(tracked(), &[turned(), beside(turned())]).unwrap();
        // The gaze goes where the left eye's view points, which is to the left of the right eye's view.
        let [left, right] = eyes.in_stage(Some(DVec3::NEG_X)).map(|eye| eye.gaze_in_view.unwrap());
        assert!((left - DVec3::NEG_Z).length() < 1e-6, "{left}");
        assert!((right - DVec3::NEG_X).length() < 1e-6, "{right}");
    }

    #[test]
    fn what_is_not_valid_stays_as_it_was() {
        let mut eyes = Eyes::standing();
        eyes.update(tracked(), &[turned(), turned()]).unwrap();
        let before = eyes;
        // Tracking is lost: openxr hands out zeros, and an all-zero field of view comes with them.
        let lost = xr::View {
            pose: xr::Posef::default(),
            fov: xr::Fovf { angle_left: 0.0, angle_right: 0.0, angle_up: 0.0, angle_down: 0.0 },
        };
        eyes.update(xr::ViewStateFlags::EMPTY, &[lost, lost]).unwrap();
        assert!(eyes == before);
        // Orientation alone is taken over alone.
        let mut moved = turned();
        moved.pose.position.x = 9.0;
        moved.pose.orientation = xr::Quaternionf { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
        eyes.update(xr::ViewStateFlags::ORIENTATION_VALID, &[moved, moved]).unwrap();
        assert_eq!(eyes.0[0].pose.position.x, 1.0);
        assert_eq!(eyes.0[0].pose.orientation.w, 1.0);
    }

    #[test]
    fn nonsense_marked_as_valid_is_refused() {
        let odd = |change: fn(&mut xr::View)| {
            let mut view = turned();
            change(&mut view);
            view
        };
        let poses: [fn(&mut xr::View); 5] = [
            |view| view.pose.orientation.w = f32::NAN,
            |view| view.pose.orientation.w = 0.0,
            |view| view.pose.position.y = f32::INFINITY,
            |view| view.pose.position.x = 6e23,
            |view| view.pose.position.z += 2.0,
        ];
        for change in poses {
            for pair in [[odd(change), turned()], [turned(), odd(change)]] {
                let mut eyes = Eyes::standing();
                let refused = eyes.update(tracked(), &pair);
                assert_eq!(refused, Err(xr::sys::Result::ERROR_POSE_INVALID));
                assert!(eyes == Eyes::standing());
            }
        }
        // A field of view alone that is none costs no pose.
        let mut eyes = Eyes::standing();
        let wide = odd(|view| view.fov.angle_left = -std::f32::consts::FRAC_PI_2);
        eyes.update(tracked(), &[wide, wide]).unwrap();
        assert_eq!(eyes.0[0].pose, turned().pose);
        assert_eq!(eyes.0[0].fov, Eyes::standing().0[0].fov);
    }
}

//! What hands mean that hold no controller: a pinch, a fist, a palm that faces the eyes, and where they point. Pure
//! functions of the hand's joints, in stage space.
//!
//! Gestures have two limits, one to begin and one to end: a hand that rests at a limit must not flicker.

use crate::headset::{HandJoints, joint};
use base::space::Pose;
use glam::{DMat3, DQuat, DVec3};

/// A pinch begins when the tips of thumb and index finger are closer than this, meters.
const PINCH_BEGINS_M: f64 = 0.015;
/// A pinch ends when they are farther apart than this, meters.
const PINCH_ENDS_M: f64 = 0.025;
/// A fist begins when the tips of all fingers except the thumb are closer to the middle of the palm than this, meters. The
/// palm's joint lies inside the hand, and so does the tip's, which takes about 25 mm of it.
const FIST_BEGINS_M: f64 = 0.055;
/// A fist ends when one of them is farther away than this, meters.
const FIST_ENDS_M: f64 = 0.075;
/// How hard a controller is squeezed, 0 to 1, when a grab begins.
const GRAB_BEGINS: f32 = 0.6;
/// How hard it is still squeezed when the grab ends.
const GRAB_ENDS: f32 = 0.4;
/// Cosine of the widest angle between a palm's normal and the direction to the eyes at which the palm faces them: 40°.
const FACING_COS: f64 = 0.766;
/// The shoulder of a hand, seen from the middle between the eyes: meters to the hand's side.
const SHOULDER_ASIDE_M: f64 = 0.17;
/// Meters from the height of the eyes down to the shoulders.
const SHOULDER_DOWN_M: f64 = 0.25;
/// Meters from the eyes back to the shoulders.
const SHOULDER_BACK_M: f64 = 0.08;

/// A grab by a squeeze of this strength, after it was one before or not.
pub(super) fn squeezed(before: bool, strength: f32) -> bool {
    strength > if before { GRAB_ENDS } else { GRAB_BEGINS }
}

/// A pinch of these joints, after it was one before or not.
pub(super) fn pinched(before: bool, joints: &HandJoints) -> bool {
    let apart_m = place(joints, joint::THUMB_TIP).distance(place(joints, joint::INDEX_TIP));
    apart_m < if before { PINCH_ENDS_M } else { PINCH_BEGINS_M }
}

/// A fist of these joints, after it was one before or not.
pub(super) fn fist(before: bool, joints: &HandJoints) -> bool {
    let palm = place(joints, joint::PALM);
    let tips = [joint::INDEX_TIP, joint::MIDDLE_TIP, joint::RING_TIP, joint::LITTLE_TIP];
    let limit_m = if before { FIST_ENDS_M } else { FIST_BEGINS_M };
    tips.iter().all(|tip| place(joints, *tip).distance(palm) < limit_m)
}

/// Where a bare hand points: from the knuckle of its index finger, along the line from its shoulder to the knuckle. The
/// shoulder is guessed below and beside the head, which a hand that shakes moves less than its own direction does.
pub(super) fn aim(joints: &HandJoints, stage_from_head: &Pose, hand: usize) -> Pose {
    let knuckle = place(joints, joint::INDEX_PROXIMAL);
    let shoulder = shoulder(stage_from_head, hand);
    // In stage space, y is up.
    Pose::look_at(knuckle, knuckle + (knuckle - shoulder), DVec3::Y)
}

/// The shoulder of a hand in stage space. The body is taken to be upright and to face where the head faces.
fn shoulder(stage_from_head: &Pose, hand: usize) -> DVec3 {
    let ahead = stage_from_head.orientation * DVec3::NEG_Z;
    // Whoever looks straight up or down still has a right side.
    let aside = stage_from_head.orientation * DVec3::X;
    let right = DVec3::new(aside.x, 0.0, aside.z)
        .try_normalize()
        .unwrap_or_else(|| ahead.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::X));
    let back = right.cross(DVec3::Y);
    let side = if hand == 0 { -SHOULDER_ASIDE_M } else { SHOULDER_ASIDE_M };
    stage_from_head.position + side * right - SHOULDER_DOWN_M * DVec3::Y + SHOULDER_BACK_M * back
}

/// The grip pose of a bare hand: the palm, with the axes of something that the hand would hold. OpenXR has x through the
/// palm, out of the left and into the right one, and −z from the little finger to the thumb.
pub(super) fn grip(joints: &HandJoints, hand: usize) -> Pose {
    // The palm's own axes are: −z to the fingers, y out of the back of the hand.
    let Pose { position, orientation } = joints[joint::PALM].stage_from_joint;
    let side = if hand == 0 { -1.0 } else { 1.0 };
    let palm_from_grip = DMat3::from_cols(side * DVec3::Y, DVec3::Z, side * DVec3::X);
    Pose { position, orientation: (orientation * DQuat::from_mat3(&palm_from_grip)).normalize() }
}

/// True if the palm of a hand with this grip pose faces the head.
pub(super) fn faces(stage_from_grip: &Pose, stage_from_head: &Pose, hand: usize) -> bool {
    let out_of_palm = stage_from_grip.orientation * if hand == 0 { DVec3::X } else { DVec3::NEG_X };
    let to_head = (stage_from_head.position - stage_from_grip.position).normalize_or_zero();
    out_of_palm.dot(to_head) > FACING_COS
}

fn place(joints: &HandJoints, joint: usize) -> DVec3 {
    joints[joint].stage_from_joint.position
}

/// What a pinch is for, which is decided as it begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pinch {
    /// It selects.
    Select,
    /// It is the menu button that a bare hand lacks: the palm faced the eyes.
    Menu,
}

impl Pinch {
    /// The pinch of this frame, after the one of the frame before.
    pub fn next(before: Option<Self>, is_pinched: bool, faces_head: bool) -> Option<Self> {
        let begins = if faces_head { Self::Menu } else { Self::Select };
        is_pinched.then(|| before.unwrap_or(begins))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::headset::Joint;
    use proptest::prelude::*;

    fn at(position: DVec3) -> Joint {
        Joint { stage_from_joint: Pose { position, orientation: DQuat::IDENTITY }, radius_m: 0.008 }
    }

    /// A flat hand with its palm down, at the origin, that points along −z; tips 90 mm from the palm.
    fn flat() -> HandJoints {
        let mut joints = [at(DVec3::ZERO); 26];
        joints[joint::INDEX_PROXIMAL] = at(DVec3::new(-0.02, 0.0, -0.04));
        joints[joint::THUMB_TIP] = at(DVec3::new(-0.06, 0.0, -0.04));
        for (tip, x) in [
            (joint::INDEX_TIP, -0.02),
            (joint::MIDDLE_TIP, 0.0),
            (joint::RING_TIP, 0.02),
            (joint::LITTLE_TIP, 0.04),
        ] {
            joints[tip] = at(DVec3::new(x, 0.0, -0.09));
        }
        joints
    }

    #[test]
    fn a_pinch_begins_close_and_ends_farther_apart() {
        let with_gap = |gap_m: f64| {
            let mut joints = flat();
            let tip = joints[joint::INDEX_TIP].stage_from_joint.position;
            joints[joint::THUMB_TIP] = at(tip + DVec3::Y * gap_m);
            joints
        };
        for (gap_m, begins, goes_on) in
            [(0.014, true, true), (0.016, false, true), (0.024, false, true), (0.026, false, false)]
        {
            assert_eq!(pinched(false, &with_gap(gap_m)), begins, "{gap_m}");
            assert_eq!(pinched(true, &with_gap(gap_m)), goes_on, "{gap_m}");
        }
    }

    #[test]
    fn a_fist_takes_all_four_fingers() {
        assert!(!fist(false, &flat()));
        let curled = |distance_m: f64| {
            let mut joints = flat();
            for tip in [joint::INDEX_TIP, joint::MIDDLE_TIP, joint::RING_TIP, joint::LITTLE_TIP] {
                joints[tip] = at(DVec3::new(0.0, -distance_m, 0.0));
            }
            joints
        };
        assert!(fist(false, &curled(0.05)));
        assert!(!fist(false, &curled(0.06)) && fist(true, &curled(0.06)));
        assert!(!fist(true, &curled(0.08)));
        let mut pointing = curled(0.03);
        pointing[joint::INDEX_TIP] = flat()[joint::INDEX_TIP];
        assert!(!fist(false, &pointing) && !fist(true, &pointing));
    }

    #[test]
    fn a_squeeze_has_two_limits_and_nonsense_lets_go() {
        assert!(!squeezed(false, 0.5) && squeezed(true, 0.5));
        assert!(squeezed(false, 0.7) && !squeezed(true, 0.3));
        assert!(!squeezed(true, f32::NAN));
    }

    #[test]
    fn a_hand_points_away_from_its_shoulder() {
        let head = Pose { position: DVec3::new(0.0, 1.6, 0.0), orientation: DQuat::IDENTITY };
        for hand in [0, 1] {
            let side = [-1.0, 1.0][hand];
            let shoulder = DVec3::new(side * 0.17, 1.35, 0.08);
            let mut joints = flat();
            let knuckle = shoulder + 0.5 * DVec3::new(0.6 * side, 0.0, -0.8);
            joints[joint::INDEX_PROXIMAL] = at(knuckle);
            let aim = aim(&joints, &head, hand);
            assert_eq!(aim.position, knuckle);
            let ray = aim.orientation * DVec3::NEG_Z;
            assert!((ray - DVec3::new(0.6 * side, 0.0, -0.8)).length() < 1e-9, "{ray}");
            assert!((aim.orientation * DVec3::Y - DVec3::Y).length() < 1e-9);
        }
        // Looking down does not move the shoulders; looking left takes them along.
        let turned = |orientation| shoulder(&Pose { orientation, ..head }, 1);
        let wanted = DVec3::new(0.17, 1.35, 0.08);
        for pitch in [-1.5, -0.5, 0.0, 1.5] {
            assert!((turned(DQuat::from_rotation_x(pitch)) - wanted).length() < 1e-9, "{pitch}");
        }
        let left = turned(DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2));
        assert!((left - DVec3::new(0.08, 1.35, -0.17)).length() < 1e-9, "{left}");
    }

    #[test]
    fn the_grip_has_the_axes_that_openxr_says() {
        // The palm is down, and the fingers point along −z: the thumb of the left hand is on the right.
        let [left, right] = [0, 1].map(|hand| grip(&flat(), hand).orientation);
        let near = |a: DVec3, b: DVec3| (a - b).length() < 1e-9;
        assert!(near(left * DVec3::X, DVec3::NEG_Y) && near(left * DVec3::NEG_Z, DVec3::X));
        assert!(near(right * DVec3::X, DVec3::Y) && near(right * DVec3::NEG_Z, DVec3::NEG_X));
        assert!(near(left * DVec3::Y, DVec3::Z) && near(right * DVec3::Y, DVec3::Z));
    }

    #[test]
    fn a_palm_faces_the_head_or_does_not() {
        let head = |y| Pose { position: DVec3::new(0.0, y, 0.0), orientation: DQuat::IDENTITY };
        for hand in [0, 1] {
            // The palm is down: it faces a head below it.
            assert!(!faces(&grip(&flat(), hand), &head(0.5), hand));
            assert!(faces(&grip(&flat(), hand), &head(-0.5), hand));
            assert!(!faces(&grip(&flat(), hand), &head(0.0), hand), "no direction");
        }
    }

    #[test]
    fn a_pinch_stays_what_it_began_as() {
        let begun = Pinch::next(None, true, true);
        assert_eq!(begun, Some(Pinch::Menu));
        assert_eq!(Pinch::next(begun, true, false), Some(Pinch::Menu));
        assert_eq!(Pinch::next(begun, false, false), None);
        assert_eq!(Pinch::next(None, true, false), Some(Pinch::Select));
    }

    proptest! {
        /// Whatever the head and the hand do, the ray has a direction.
        #[test]
        fn a_ray_is_always_a_rotation(turn in prop::array::uniform3(-4.0..4.0_f64), place in prop::array::uniform3(-2.0..2.0_f64)) {
            let orientation = DQuat::from_scaled_axis(turn.into());
            let mut joints = flat();
            joints[joint::INDEX_PROXIMAL] = at(place.into());
            for hand in [0, 1] {
                let aim = aim(&joints, &Pose { position: DVec3::ZERO, orientation }, hand);
                prop_assert!((aim.orientation.length() - 1.0).abs() < 1e-9);
            }
        }
    }
}

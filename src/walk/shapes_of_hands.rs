//! The user's hands as simple shapes: a handle with a ring for a controller, bones for a bare hand; and a short ray in the
//! direction that it points in.

use super::scenery::SeenHands;
use base::space::Pose;
use glam::DVec3;
use render::scenery::Shapes;
use xr::{HandJoints, joint};

/// Color of hands, linear light and how much it covers.
const SKIN: [f32; 4] = [0.42, 0.44, 0.48, 1.0];
/// Color of a hand that holds something.
const HOLDING: [f32; 4] = [0.15, 0.5, 0.85, 1.0];
/// Length of a handle from the hand's middle to its ends, meters, below and above.
const HANDLE_M: [f64; 2] = [0.06, 0.045];
/// Radii of a handle at its ends.
const HANDLE_RADII_M: [f64; 2] = [0.014, 0.019];
/// Radii of the ring at a handle's upper end.
const RING_M: [f64; 2] = [0.026, 0.034];
/// Length and width of the ray, meters.
const RAY_M: [f64; 2] = [0.25, 0.004];
/// First joints of the thumb and the fingers, and how many each has.
const FINGERS: [(usize, usize); 5] = [(2, 4), (6, 5), (11, 5), (16, 5), (21, 5)];

/// Lays out both hands. `head` is in the stage.
pub(super) fn lay(shapes: &mut Shapes, hands: &SeenHands, head: DVec3) {
    for (input, joints) in hands.controllers.hands.iter().zip(&hands.joints) {
        let color = if input.grab || input.select { HOLDING } else { SKIN };
        match (joints, &input.stage_from_grip) {
            (Some(joints), _) => bones(shapes, joints, color),
            (None, Some(stage_from_grip)) => handle(shapes, stage_from_grip, color),
            (None, None) => {}
        }
        if let Some(stage_from_aim) = &input.stage_from_aim {
            let [length, width] = RAY_M;
            let from = stage_from_aim.position;
            let to = from + stage_from_aim.orientation * DVec3::NEG_Z * length;
            let [r, g, b, _] = color;
            shapes.band([from, to], width, head, [[r, g, b, 0.8], [r, g, b, 0.0]]);
        }
    }
}

/// A controller: OpenXR's grip has its −z axis along the handle, from the little finger to the thumb.
fn handle(shapes: &mut Shapes, stage_from_grip: &Pose, color: [f32; 4]) {
    let along = stage_from_grip.orientation * DVec3::NEG_Z;
    let [below, above] = HANDLE_M;
    let ends = [stage_from_grip.position - below * along, stage_from_grip.position + above * along];
    shapes.tube(ends, HANDLE_RADII_M, color);
    shapes.ring(ends[1], along, RING_M, color);
}

fn bones(shapes: &mut Shapes, joints: &HandJoints, color: [f32; 4]) {
    let mut bone = |a: usize, b: usize| {
        let ends = [a, b].map(|i| joints[i].stage_from_joint.position);
        shapes.tube(ends, [a, b].map(|i| joints[i].radius_m), color);
    };
    bone(joint::WRIST, joint::PALM);
    for (first, num) in FINGERS {
        bone(joint::WRIST, first);
        (first..first + num - 1).for_each(|i| bone(i, i + 1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use render::scenery::MOST_CORNERS;
    use xr::{ControllerInput, HandInput, Joint};

    fn num_corners(hands: &SeenHands) -> usize {
        let mut shapes = Shapes::default();
        lay(&mut shapes, hands, DVec3::new(0.0, 1.7, 0.0));
        shapes.corners().len()
    }

    #[test]
    fn hands_are_drawn_where_they_are_known() {
        assert_eq!(num_corners(&SeenHands::default()), 0);
        let pose = Some(Pose { position: DVec3::new(0.2, 1.2, -0.3), ..Pose::IDENTITY });
        let held = HandInput { stage_from_aim: pose, stage_from_grip: pose, ..HandInput::default() };
        let one = SeenHands {
            controllers: ControllerInput { hands: [held, HandInput::default()] },
            ..SeenHands::default()
        };
        assert!(num_corners(&one) > 100);
        // Both bare hands leave room for other shapes.
        let bare = SeenHands { joints: [Some([Joint::default(); 26]); 2], ..SeenHands::default() };
        let num = num_corners(&bare);
        assert!(num > num_corners(&one) && num < MOST_CORNERS / 4, "{num}");
    }
}

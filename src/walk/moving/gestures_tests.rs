//! Gestures: presses short and long, sticks pushed, turned, pulled back and let go, in frames of a ninetieth of a second.

use super::*;
use base::space::Pose;
use glam::DQuat;

const FRAME_S: f64 = 1.0 / 90.0;

fn at_rest() -> HandInput {
    HandInput { stage_from_aim: Some(Pose::IDENTITY), ..HandInput::default() }
}

fn right(hand: HandInput) -> ControllerInput {
    ControllerInput { hands: [at_rest(), hand] }
}

fn stick(x: f32, y: f32) -> ControllerInput {
    right(HandInput { stick: [x, y], ..at_rest() })
}

/// All that hands ask for within some seconds of the same input.
fn held(gestures: &mut Gestures, input: ControllerInput, seconds: f64) -> Vec<Intents> {
    (0..(seconds / FRAME_S).round() as usize).map(|_| gestures.advance(&input, FRAME_S)).collect()
}

fn new() -> Gestures {
    Gestures::new(0, Turn::Snap)
}

#[test]
fn a_stick_pushed_forward_aims_until_it_is_let_go() {
    let mut gestures = new();
    assert!(held(&mut gestures, stick(0.0, 0.6), 0.5).iter().all(|intents| intents.aim.is_none()));
    let aiming = held(&mut gestures, stick(0.0, 0.9), 0.5);
    assert!(aiming[0].began && aiming[1..].iter().all(|intents| !intents.began));
    assert!(aiming.iter().all(|intents| intents.aim.is_some_and(|aim| aim.hand == 1 && aim.twist == 0.0)));
    let after = held(&mut gestures, stick(0.0, 0.0), 0.3);
    assert_eq!(after.iter().filter(|intents| intents.go == Some(1)).count(), 1);
    assert!(after.iter().all(|intents| intents.cancelled.is_none()));
    assert!(after.last().unwrap().aim.is_none());
    // The stick's way back through the middle goes nowhere.
    held(&mut gestures, stick(0.0, 0.9), 0.2);
    let back =
        [held(&mut gestures, stick(0.0, 0.0), 0.03), held(&mut gestures, stick(0.1, -0.9), 0.2)].concat();
    assert!(back.iter().all(|intents| intents.go.is_none()));
    assert_eq!(back.iter().filter(|intents| intents.cancelled == Some(1)).count(), 1);
    // It does not aim again before it was in its middle.
    assert!(held(&mut gestures, stick(0.0, 0.9), 0.2).iter().all(|intents| intents.aim.is_none()));
    held(&mut gestures, stick(0.0, 0.0), 0.1);
    assert!(held(&mut gestures, stick(0.0, 0.9), 0.2)[0].began);
}

#[test]
fn the_stick_of_the_other_hand_aims_where_the_right_one_moves() {
    let mut gestures = Gestures::new(1, Turn::Snap);
    let moved = held(&mut gestures, stick(0.0, 0.9), 0.1);
    assert!(moved.iter().all(|intents| intents.aim.is_none() && intents.stride.y > 0.8));
    let left = ControllerInput { hands: [HandInput { stick: [0.0, 0.9], ..at_rest() }, at_rest()] };
    let aimed = held(&mut gestures, left, 0.1);
    assert!(aimed.iter().all(|intents| intents.aim.is_some_and(|aim| aim.hand == 0)));
}

#[test]
fn a_long_press_aims_and_a_short_one_turns_only_without_sticks() {
    let press = right(HandInput { select: true, ..at_rest() });
    let mut gestures = new();
    let snaps = |all: &[Intents]| all.iter().map(|intents| intents.snaps[1]).sum::<i32>();
    let mut pressed = held(&mut gestures, press, 0.2);
    pressed.extend(held(&mut gestures, right(at_rest()), 0.2));
    assert!(snaps(&pressed) == 1 && pressed.iter().all(|intents| intents.aim.is_none()));
    let left = ControllerInput { hands: [HandInput { select: true, ..at_rest() }, at_rest()] };
    held(&mut gestures, left, 0.1);
    assert_eq!(gestures.advance(&right(at_rest()), FRAME_S).snaps, [-1, 0]);
    let long = held(&mut gestures, press, 0.6);
    assert_eq!(long.iter().filter(|intents| intents.began).count(), 1);
    assert!(long.last().unwrap().aim.is_some_and(|aim| aim.by == AimedBy::Select));
    let after = held(&mut gestures, right(at_rest()), 0.1);
    assert!(after[0].go == Some(1) && snaps(&after) == 0);
    // Once a stick has moved, triggers turn no more.
    held(&mut gestures, stick(0.4, 0.0), 0.1);
    held(&mut gestures, press, 0.1);
    assert_eq!(snaps(&held(&mut gestures, right(at_rest()), 0.1)), 0);
}

#[test]
fn grabbing_gives_up_the_aim_and_the_trigger_does_not_aim_at_once_again() {
    let mut gestures = new();
    let press = HandInput { select: true, ..at_rest() };
    held(&mut gestures, right(press), 0.5);
    let both = right(HandInput { grab: true, ..press });
    let grabbing = held(&mut gestures, both, 0.5);
    assert_eq!(grabbing[0].cancelled, Some(1));
    assert!(grabbing.iter().all(|intents| intents.aim.is_none() && intents.go.is_none()));
    assert!(grabbing[0].grab == [false, true]);
    let after = held(&mut gestures, right(press), 1.0);
    assert!(after.iter().all(|intents| intents.aim.is_none()), "the trigger has to be let go first");
    let let_go = held(&mut gestures, right(at_rest()), 0.1);
    assert!(let_go.iter().all(|intents| intents.snaps == [0; 2] && intents.go.is_none()));
    // Nobody strides who holds the world.
    let hands = [HandInput { stick: [0.0, 1.0], ..at_rest() }, HandInput { grab: true, ..at_rest() }];
    assert_eq!(gestures.advance(&ControllerInput { hands }, FRAME_S).stride, DVec2::ZERO);
}

#[test]
fn wrist_and_stick_turn_the_landing() {
    let twist =
        |gestures: &mut Gestures, input| held(gestures, input, 0.1).last().unwrap().aim.unwrap().twist;
    let mut gestures = new();
    held(&mut gestures, stick(0.0, 0.9), 0.1);
    assert_eq!(twist(&mut gestures, stick(0.2, 0.9)), 0.0, "not yet");
    let right_of = twist(&mut gestures, stick(0.95, 0.0));
    assert!(right_of < -1.2 && right_of > -PI / 2.0, "{right_of}");
    assert!((twist(&mut gestures, stick(-0.95, 0.0)) + right_of).abs() < 1e-6);
    // The ray may point anywhere: the roll is about it.
    for pitch in [-0.8, 0.0, 0.6] {
        let mut gestures = new();
        let rolled = |roll: f64| {
            let orientation =
                DQuat::from_rotation_y(0.7) * DQuat::from_rotation_x(pitch) * DQuat::from_rotation_z(roll);
            let aim = Pose { position: DVec3::Y, orientation };
            right(HandInput { select: true, stage_from_aim: Some(aim), ..at_rest() })
        };
        held(&mut gestures, rolled(0.4), 0.5);
        assert_eq!(twist(&mut gestures, rolled(0.5)), 0.0);
        let left = twist(&mut gestures, rolled(0.4 + 0.8));
        assert!(left > 0.6 && left < 1.4, "a roll to the left turns to the left: {left}");
        assert!(twist(&mut gestures, rolled(0.4 - 0.8)) < -0.6);
    }
}

#[test]
fn turns_are_steps_or_smooth() {
    let mut gestures = new();
    let pushed = held(&mut gestures, stick(0.9, 0.1), 0.5);
    assert_eq!(pushed.iter().map(|intents| intents.snaps[1]).sum::<i32>(), 1, "once a push");
    held(&mut gestures, stick(0.4, 0.0), 0.1);
    assert!(held(&mut gestures, stick(0.9, 0.0), 0.1).iter().all(|intents| intents.snaps == [0; 2]));
    held(&mut gestures, stick(0.0, 0.0), 0.1);
    assert_eq!(held(&mut gestures, stick(-0.9, 0.0), 0.1)[0].snaps, [0, -1]);
    let mut gestures = Gestures::new(0, Turn::Smooth);
    let smooth = held(&mut gestures, stick(1.0, 0.2), 0.1);
    assert!(smooth.iter().all(|intents| intents.turn == 1.0 && intents.snaps == [0; 2]));
    assert!(held(&mut gestures, stick(0.1, 0.0), 0.1).iter().all(|intents| intents.turn == 0.0));
}

#[test]
fn the_way_back_needs_a_press_that_is_held() {
    let reset = right(HandInput { reset: true, ..at_rest() });
    let mut gestures = new();
    assert!(held(&mut gestures, reset, 0.7).iter().all(|intents| !intents.reset));
    held(&mut gestures, right(at_rest()), 0.1);
    let long = held(&mut gestures, reset, 2.0);
    assert_eq!(long.iter().filter(|intents| intents.reset).count(), 1, "once a press");
    assert!(long[..70].iter().all(|intents| !intents.reset));
}

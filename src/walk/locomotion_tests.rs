//! Getting about as a whole: what hands, keys and mouse do to the head, with floors and without.

use super::*;
use crate::walk::moving::floors::made_up::MadeScan;
use crate::walk::moving::options::Turn;
use base::space::{Bounds, Eye, Fov, View};
use std::f64::consts::PI;
use std::sync::Arc;
use xr::{HandInput, StageEye};

const FRAME_S: f64 = 1.0 / 90.0;
const UTM: DVec3 = DVec3::new(5e5, 4e6, 100.0);

fn start() -> Start {
    Start {
        kind: ScanKind::Outdoors,
        standpoint: Standpoint { floor_in_world: UTM, yaw: 0.0, scale: 1.0 },
        walks: false,
        units_per_m: 1.0,
        extent_m: 20.0,
        overview: Standpoint { floor_in_world: UTM + DVec3::new(0.0, -50.0, 20.0), yaw: 0.0, scale: 1.0 },
        bounds: Bounds { min: UTM - DVec3::new(10.0, 10.0, 0.0), max: UTM + DVec3::new(10.0, 10.0, 3.0) },
    }
}

fn eyes() -> [StageEye; 2] {
    let eye = |x| StageEye {
        stage_from_view: Pose { position: DVec3::new(x, 1.7, 0.0), orientation: DQuat::IDENTITY },
        fov: Fov::symmetric(1.5, 1.0),
        gaze_in_view: None,
    };
    [eye(-0.03), eye(0.03)]
}

fn with(options: LocomotionOptions, start: Start, floors: FloorsCell) -> Locomotion {
    let mut walk =
        Locomotion::new(options, start, StartsCell::default(), floors, Vec::new(), &head_of(&eyes()));
    walk.set_may_pitch(true);
    walk
}

fn walk() -> Locomotion {
    with(LocomotionOptions::sample(), start(), FloorsCell::default())
}

/// A room of 20 by 20 meters about the start, whose floor is at its height, with a platform a step and a half high.
fn room() -> FloorsCell {
    let mut made = MadeScan::new(UTM - DVec3::new(10.0, 10.0, 0.0), 1.0);
    made.level([0.0, 0.0], [20.0, 20.0], 0.0, 0.04);
    made.level([8.0, 12.0], [12.0, 14.0], 0.2, 0.04);
    made.walls([0.0, 0.0], [20.0, 20.0], [0.0, 3.0], 0.04);
    let cell = FloorsCell::default();
    cell.set(made.floors()).expect("an empty cell");
    cell
}

fn inside() -> Start {
    Start { kind: ScanKind::Interior, walks: true, ..start() }
}

fn seen(walk: &Locomotion, eyes: &[StageEye; 2]) -> View {
    walk.stage().view(&walk.world_from_head(&head_of(eyes)), eyes, [[100, 100]; 2], 0.05)
}

fn stick(hand: usize, stick: [f32; 2]) -> ControllerInput {
    let mut input = ControllerInput::default();
    input.hands[hand].stick = stick;
    input
}

fn head(x: f64, z: f64, yaw: f64) -> Pose {
    Pose { position: DVec3::new(x, 1.6, z), orientation: DQuat::from_rotation_y(yaw) }
}

/// Lets some time pass with the same input.
fn pass(walk: &mut Locomotion, seconds: f64, input: &ControllerInput, head: &Pose) {
    for _ in 0..(seconds / FRAME_S).round() as usize {
        walk.advance(FRAME_S, 1.0, input, head);
    }
}

#[test]
fn stands_on_the_floor_looking_north_with_the_left_eye_in_the_west() {
    let view = seen(&walk(), &eyes());
    let [left, right] = [0, 1].map(|i| view.eyes[i].world_from_view);
    assert!((left.position - DVec3::new(5e5 - 0.03, 4e6, 101.7)).length() < 1e-9);
    assert!((right.position - DVec3::new(5e5 + 0.03, 4e6, 101.7)).length() < 1e-9);
    assert!((left.orientation * DVec3::NEG_Z - DVec3::Y).length() < 1e-12);
    assert!((left.orientation * DVec3::Y - DVec3::Z).length() < 1e-12);
}

#[test]
fn eyes_look_where_they_are_seen_to_look_or_ahead() {
    let [mut left, right] = eyes();
    let aside = DVec3::new(0.6, 0.0, -0.8);
    left.gaze_in_view = Some(aside);
    let view = seen(&walk(), &[left, right]);
    assert_eq!([0, 1].map(|i| view.eyes[i].gaze_in_view), [aside, Eye::AHEAD]);
}

#[test]
fn units_scale_the_viewer_not_the_scan() {
    let feet = Start { units_per_m: 1.0 / 0.3048, ..start() };
    let walk = with(LocomotionOptions::sample(), feet, FloorsCell::default());
    let view = seen(&walk, &eyes());
    let gap = view.eyes[1].world_from_view.position.x - view.eyes[0].world_from_view.position.x;
    assert!((gap - 0.06 / 0.3048).abs() < 1e-9 && (view.near - 0.05 / 0.3048).abs() < 1e-9);
}

#[test]
fn the_left_stick_flies_where_the_head_looks() {
    let mut walk = walk();
    // The head looks left (west) and up by 45 degrees.
    let orientation = DQuat::from_rotation_y(FRAC_PI_2) * DQuat::from_rotation_x(FRAC_PI_2 / 2.0);
    walk.advance(0.1, 1.0, &stick(0, [0.0, 1.0]), &Pose { position: DVec3::ZERO, orientation });
    let moved = walk.place.floor_in_world - UTM;
    let step = 0.1 * walk.speed();
    assert!((moved - DVec3::new(-step / 2f64.sqrt(), 0.0, step / 2f64.sqrt())).length() < 1e-9, "{moved}");
    assert!(walk.guides().vignette > 0.0);
}

#[test]
fn one_walks_inside_on_the_floor_and_over_steps() {
    let mut walk = with(LocomotionOptions::sample(), inside(), room());
    assert!(walk.stance().is_walking);
    // The head looks down and forward, off the stage's middle.
    let looks_down = Pose { position: DVec3::new(0.4, 1.6, 0.3), orientation: DQuat::from_rotation_x(-0.9) };
    pass(&mut walk, 1.0, &stick(0, [0.0, 0.7]), &looks_down);
    let feet = walk.feet_in_world() - UTM;
    assert!(feet.y > 0.8 && feet.z.abs() < 0.005, "{feet}");
    pass(&mut walk, 1.0, &stick(0, [0.0, 1.0]), &looks_down);
    let feet = walk.feet_in_world() - UTM;
    assert!((2.1..3.9).contains(&feet.y) && (feet.z - 0.2).abs() < 0.005, "on the platform: {feet}");
    // Diagonals are no faster, and nothing moves that nobody moves.
    let before = walk.place;
    pass(&mut walk, 1.0, &ControllerInput::default(), &looks_down);
    assert_eq!(walk.place, before);
    walk.advance(0.1, 1.0, &stick(0, [1.0, 1.0]), &looks_down);
    let moved = (walk.place.floor_in_world - before.floor_in_world).truncate();
    assert!((moved.length() - 0.1 * walk.speed()).abs() < 1e-9);
    walk.apply(Action::ToggleWalking);
    pass(&mut walk, 0.5, &stick(0, [0.0, 1.0]), &looks_down);
    assert!(walk.feet_in_world().z < UTM.z - 0.2, "one flies downwards");
}

#[test]
fn the_right_stick_turns_once_a_push_or_smoothly() {
    let mut walk = walk();
    let push = stick(1, [1.0, 0.0]);
    pass(&mut walk, 0.1, &push, &Pose::IDENTITY);
    assert!((walk.place.yaw + 30f64.to_radians()).abs() < 1e-12, "one snap to the right");
    walk.advance(0.01, 1.0, &ControllerInput::default(), &Pose::IDENTITY);
    walk.advance(0.01, 1.0, &push, &Pose::IDENTITY);
    assert!((walk.place.yaw + 60f64.to_radians()).abs() < 1e-12);
    assert_eq!(walk.guides().events, [None, Some(Event::Snap)]);
    let smooth = LocomotionOptions { turn: Turn::Smooth, ..LocomotionOptions::sample() };
    let mut walk = with(smooth, start(), FloorsCell::default());
    pass(&mut walk, 1.0, &push, &Pose::IDENTITY);
    assert!((walk.place.yaw + PI / 2.0).abs() < 1e-9, "{}", walk.place.yaw);
}

#[test]
fn the_way_back_leads_the_head_to_the_start_from_anywhere() {
    let mut walk = walk();
    let head = head(1.2, -0.7, 2.0);
    pass(&mut walk, 1.0, &stick(0, [0.3, 1.0]), &head);
    let mut reset = ControllerInput::default();
    reset.hands[1].reset = true;
    let before = walk.place;
    pass(&mut walk, 0.5, &reset, &head);
    assert_eq!(walk.place, before, "not yet");
    pass(&mut walk, 0.5, &reset, &head);
    let stands = walk.standpoint();
    assert!((stands.floor_in_world - UTM).length() < 1e-6 && stands.yaw.abs() < 1e-9);
    let begun = Locomotion::new(
        LocomotionOptions::sample(),
        start(),
        StartsCell::default(),
        FloorsCell::default(),
        Vec::new(),
        &head,
    );
    assert!((begun.world_from_head(&head).position - UTM - DVec3::Z * 1.6).length() < 1e-6);
    walk.apply(Action::WholeView);
    assert!((walk.standpoint().floor_in_world - start().overview.floor_in_world).length() < 1e-6);
}

#[test]
fn a_teleport_takes_the_head_where_the_arc_ended_and_turns_nothing_else() {
    let mut walk = with(LocomotionOptions::sample(), inside(), room());
    let head = head(0.5, 0.2, 0.4);
    let mut aims = stick(1, [0.0, 0.9]);
    let ray = DQuat::from_rotation_y(-0.5) * DQuat::from_rotation_x(-0.3);
    aims.hands[1].stage_from_aim = Some(Pose { position: DVec3::new(0.7, 1.2, -0.1), orientation: ray });
    walk.advance(FRAME_S, 1.0, &aims, &head);
    assert_eq!(walk.guides().events, [None, Some(Event::Aim)]);
    pass(&mut walk, 0.3, &aims, &head);
    let landing = walk.guides().arc.expect("an arc").landing.expect("a landing");
    assert!((landing.floor_in_world.z - UTM.z - 0.2).abs() < 0.01, "on the platform");
    assert!((landing.floor_in_world - UTM).truncate().length() > 2.0);
    assert!((landing.yaw - 0.4).abs() < 1e-9, "without a twist the user faces as before");
    let before = walk.facing();
    let with_stick = |stick: [f32; 2]| {
        let mut input = aims;
        input.hands[1].stick = stick;
        input
    };
    let let_go = with_stick([0.0; 2]);
    pass(&mut walk, 0.2, &let_go, &head);
    let stands = walk.standpoint();
    assert!((stands.floor_in_world - landing.floor_in_world).length() < 1e-6, "{stands:?}");
    assert!((stands.yaw - before).abs() < 1e-9 && walk.guides().arc.is_none());
    // Pulling the stick back changes nothing.
    pass(&mut walk, 0.2, &aims, &head);
    assert!(walk.guides().arc.is_some());
    walk.advance(FRAME_S, 1.0, &with_stick([0.0, -0.9]), &head);
    assert!(walk.guides().events[1] == Some(Event::Cancel) && walk.guides().arc.is_none());
    pass(&mut walk, 0.2, &let_go, &head);
    assert_eq!(walk.standpoint(), stands);
    // A hand that nobody sees aims nowhere.
    pass(&mut walk, 0.2, &stick(1, [0.0, 0.9]), &head);
    assert!(walk.guides().arc.is_none());
    pass(&mut walk, 0.2, &ControllerInput::default(), &head);
    assert_eq!(walk.standpoint(), stands);
}

#[test]
fn a_model_is_looked_at_and_entered() {
    let mut walk = with(LocomotionOptions::sample(), inside(), room());
    let head = head(0.3, 0.1, 0.0);
    pass(&mut walk, 0.1, &ControllerInput::default(), &head);
    walk.apply(Action::ShowModel);
    assert!((walk.place.scale - 0.1).abs() < 1e-9);
    let center = walk.start.bounds.center().with_z(UTM.z);
    let table = (center - walk.place.floor_in_world) / walk.place.units_per_m();
    assert!((table.z - 0.75).abs() < 1e-6);
    // A hand points at a place of the model, three meters east and two north of its middle.
    let aimed = center + DVec3::new(3.0, 2.0, 0.0);
    let hand = DVec3::new(0.4, 1.3, -0.2);
    let to = (aimed - walk.place.p_in_world(hand)).normalize();
    let to_in_stage = walk.place.world_from_stage_axes().inverse() * to;
    let orientation = DQuat::from_rotation_arc(DVec3::NEG_Z, to_in_stage);
    let mut input = ControllerInput::default();
    input.hands[1].stage_from_aim = Some(Pose { position: hand, orientation });
    walk.advance(FRAME_S, 1.0, &input, &head);
    walk.apply(Action::LifeSize);
    let stands = walk.standpoint();
    assert!(
        stands.scale == 1.0 && (stands.floor_in_world - aimed).length() < 0.1,
        "{}",
        stands.floor_in_world - aimed
    );
    // Whoever points nowhere comes back to where they were.
    let before = walk.standpoint();
    walk.apply(Action::ShowModel);
    let up = DQuat::from_rotation_x(1.5);
    input.hands[1].stage_from_aim = Some(Pose { position: hand, orientation: up });
    walk.advance(FRAME_S, 1.0, &input, &head);
    walk.apply(Action::LifeSize);
    assert!((walk.standpoint().floor_in_world - before.floor_in_world).length() < 1e-6);
    assert!((walk.standpoint().yaw - before.yaw).abs() < 1e-9);
}

#[test]
fn hands_move_and_scale_the_world_and_say_so() {
    let mut walk = walk();
    let grabbing = |apart: f64| {
        let hand = |side: f64| HandInput {
            grab: true,
            stage_from_grip: Some(Pose {
                position: DVec3::new(side * apart, 1.2, -0.4),
                orientation: DQuat::IDENTITY,
            }),
            ..HandInput::default()
        };
        ControllerInput { hands: [hand(-0.5), hand(0.5)] }
    };
    let head = head(0.0, 0.0, 0.0);
    walk.advance(FRAME_S, 1.0, &grabbing(0.8), &head);
    assert_eq!(walk.guides().events, [Some(Event::Hold); 2]);
    pass(&mut walk, 0.1, &grabbing(0.4), &head);
    pass(&mut walk, 0.1, &grabbing(0.3), &head);
    assert!(walk.place.scale < 0.9 && walk.guides().scale == Some(walk.place.scale), "{}", walk.place.scale);
    walk.advance(FRAME_S, 1.0, &ControllerInput::default(), &head);
    assert_eq!(walk.guides().scale, None);
    walk.apply(Action::Reset);
    assert_eq!(walk.place.scale, 1.0);
}

#[test]
fn places_are_kept_and_users_raised() {
    let mut walk = walk();
    let head = head(0.3, -0.8, 1.0);
    pass(&mut walk, 0.1, &ControllerInput::default(), &head);
    walk.apply(Action::SavePlace);
    let first = walk.standpoint();
    let floor = UTM + DVec3::new(3.0, 4.0, 0.5);
    walk.apply(Action::TeleportTo { floor_in_world: floor, yaw: 0.5 });
    assert!((walk.standpoint().floor_in_world - floor).length() < 1e-6);
    walk.apply(Action::Raise(0.3));
    assert!((walk.standpoint().floor_in_world - floor).length() < 1e-6, "the floor stays below");
    assert!((walk.world_from_head(&head).position.z - floor.z - 1.9).abs() < 1e-6);
    walk.apply(Action::SavePlace);
    walk.apply(Action::NextPlace);
    assert!((walk.standpoint().floor_in_world - first.floor_in_world).length() < 1e-6);
    walk.apply(Action::PreviousPlace);
    assert!((walk.standpoint().floor_in_world - floor).length() < 1e-6);
    walk.apply(Action::Raise(-0.3));
    walk.apply(Action::ToggleSeated);
    assert!((walk.world_from_head(&head).position.z - floor.z - STANDING_EYE_M).abs() < 1e-6);
    walk.apply(Action::ToggleSeated);
    assert!((walk.world_from_head(&head).position.z - floor.z - 1.6).abs() < 1e-6);
    walk.apply(Action::Raise(f32::NAN));
    assert!(walk.place.floor_in_world.is_finite());
}

#[test]
fn turning_leaves_the_head_where_it_is() {
    let mut walk = walk();
    let mut off_center = eyes();
    for eye in &mut off_center {
        eye.stage_from_view.position += DVec3::new(0.8, 0.0, -1.2);
    }
    walk.advance(0.01, 1.0, &ControllerInput::default(), &head_of(&off_center));
    let before = seen(&walk, &off_center).head_in_world();
    walk.apply(Action::Snap(3));
    let after = seen(&walk, &off_center);
    assert!((after.head_in_world() - before).length() < 1e-8);
    let forward = after.eyes[0].world_from_view.orientation * DVec3::NEG_Z;
    assert!((forward - DVec3::X).length() < 1e-9, "three times 30 degrees to the right: east");
}

#[test]
fn the_mouse_never_pitches_a_real_head() {
    let mut walk = walk();
    walk.apply(Action::Look { delta_px: [0.0, -100.0] });
    walk.set_may_pitch(false);
    walk.apply(Action::Look { delta_px: [0.0, -200.0] });
    let view = seen(&walk, &eyes());
    assert!((view.eyes[0].world_from_view.orientation * DVec3::NEG_Z).z.abs() < 1e-12);
}

#[test]
fn noise_of_a_stick_and_a_hitch_do_nothing_bad() {
    let mut walk = walk();
    walk.advance(0.1, 1.0, &stick(0, [0.1, -0.1]), &Pose::IDENTITY);
    assert_eq!(walk.place.floor_in_world, UTM);
    walk.apply(Action::Move { direction: [0.0, 0.0, 1.0], fast: true });
    walk.advance(60.0, 1.0, &ControllerInput::default(), &Pose::IDENTITY);
    let moved = (walk.place.floor_in_world - UTM).length();
    assert!((moved - 0.1 * 4.0 * walk.speed()).abs() < 1e-6, "a tenth of a second at most");
    assert_eq!(walk.guides().vignette, 0.0, "keys darken nothing");
}

#[test]
fn looking_up_turns_the_eyes_about_the_head() {
    let mut walk = walk();
    walk.apply(Action::Look { delta_px: [0.0, -200.0] });
    let view = seen(&walk, &eyes());
    assert!((view.head_in_world() - DVec3::new(5e5, 4e6, 101.7)).length() < 1e-9);
    let forward = view.eyes[0].world_from_view.orientation * DVec3::NEG_Z;
    assert!((forward.z - 30f64.to_radians().sin()).abs() < 1e-9, "{forward}");
}

#[test]
fn the_same_input_leads_to_the_same_place() {
    let floors = room();
    let went = || {
        let mut walk = with(LocomotionOptions::sample(), inside(), Arc::clone(&floors));
        for frame in 0..300 {
            let angle = f64::from(frame) * 0.05;
            let mut input = stick(0, [angle.sin() as f32, angle.cos() as f32]);
            input.hands[1].stick = [0.0, if frame % 100 < 40 { 0.9 } else { 0.0 }];
            input.hands[1].stage_from_aim =
                Some(Pose { position: DVec3::Y, orientation: DQuat::from_rotation_y(angle) });
            walk.advance(FRAME_S, 1.0, &input, &head(0.1 * angle.sin(), 0.0, 0.3 * angle));
        }
        walk.place
    };
    assert_eq!(went(), went());
}

#[test]
fn a_short_press_moves_however_slow_the_frames_are() {
    let mut walk = walk();
    let [go, rest] = [1.0, 0.0].map(|forward| Action::Move { direction: [0.0, 0.0, forward], fast: false });
    // The key goes down and up between two frames.
    walk.apply(go);
    walk.apply(rest);
    pass(&mut walk, FRAME_S, &ControllerInput::default(), &head(0.0, 0.0, 0.0));
    let moved = walk.place.floor_in_world - UTM;
    assert!((moved - DVec3::Y * FRAME_S * walk.speed()).length() < 1e-9, "{moved}");
    pass(&mut walk, 1.0, &ControllerInput::default(), &head(0.0, 0.0, 0.0));
    assert_eq!(walk.place.floor_in_world - UTM, moved, "once");
}

#[test]
fn a_click_on_the_floor_leads_there_to_the_centimeter() {
    let mut walk = with(LocomotionOptions::sample(), inside(), room());
    let view = seen(&walk, &eyes());
    let eye = &view.eyes[0];
    // A place on the floor, five meters ahead and two to the right, by its pixel.
    let aimed = UTM + DVec3::new(2.0, 5.0, 0.0);
    let rows = eye.pixel_from_head(view.head_in_world());
    let q = (aimed - view.head_in_world()).extend(1.0);
    let [x, y, w] = rows.map(|row| glam::DVec4::from_array(row).dot(q));
    let [width, height] = eye.size_px.map(f64::from);
    let at = [x / w / width, y / w / height];
    assert!(walk.go_where_pointed(eye.world_from_view.position, eye.along_in_world(at)));
    assert!((walk.feet_in_world() - aimed).length() < 0.01, "{}", walk.feet_in_world() - UTM);
    assert!(!walk.go_where_pointed(aimed + DVec3::Z * 1.7, DVec3::Z), "the sky is no floor");
    // A model becomes as large as life where it was clicked.
    walk.apply(Action::ShowModel);
    let from = aimed + DVec3::Z * 30.0;
    assert!(walk.stance().scale < 0.5 && walk.go_where_pointed(from, DVec3::NEG_Z));
    assert!(walk.stance().scale == 1.0 && (walk.feet_in_world() - aimed).length() < 0.01);
}

#[test]
fn the_scan_is_gone_round_and_looked_down_upon() {
    let mut walk = walk();
    let pivot = start().bounds.center();
    walk.apply(Action::WholeView);
    let head = head_of(&eyes());
    // Where the scan's middle is in sight, in view space.
    let in_sight = |walk: &Locomotion| {
        let Pose { position, orientation } = walk.world_from_head(&head);
        orientation.inverse() * (pivot - position)
    };
    let before = in_sight(&walk);
    let from = walk.world_from_head(&head).position;
    walk.apply(Action::Orbit { delta_px: [200.0, 0.0] });
    walk.apply(Action::Orbit { delta_px: [0.0, 100.0] });
    assert!((in_sight(&walk) - before).length() < 1e-6, "{}", in_sight(&walk));
    let to = walk.world_from_head(&head).position;
    assert!((to - from).length() > 10.0 && to.z > from.z, "dragging down lifts the viewer: {}", to - from);
    walk.apply(Action::TopView);
    let seen = in_sight(&walk);
    assert!(seen.truncate().length() < 1e-6 && seen.z < 0.0, "it is right below: {seen}");
    // A head that pitches itself is only moved level.
    walk.set_may_pitch(false);
    walk.apply(Action::TopView);
    assert_eq!(walk.world_from_head(&head).orientation, walk.stage().pose_in_world(&head).orientation);
}

#[test]
fn one_comes_down_to_the_ground_of_a_landscape_wherever_one_looks() {
    let overview = start().overview;
    let begun = |kind| Start { kind, standpoint: overview, ..start() };
    let head = head_of(&eyes());
    let comes_down = |kind| {
        let mut walk = with(LocomotionOptions::sample(), begun(kind), room());
        walk.begin_with(&head);
        walk.apply(Action::ShowModel);
        // The eyes look past the model.
        walk.pitch = 1.2;
        walk.apply(Action::LifeSize);
        walk.standpoint()
    };
    let stands = comes_down(ScanKind::Landscape);
    assert!(stands.scale == 1.0 && (stands.floor_in_world - UTM).length() < 0.1, "{stands:?}");
    // Whoever stood somewhere comes back there.
    let stands = comes_down(ScanKind::Outdoors);
    assert!((stands.floor_in_world - overview.floor_in_world).length() < 1e-6, "{stands:?}");
}

#[test]
fn a_landscape_that_is_there_before_the_head_is_known_is_looked_down_at() {
    let start = Start { kind: ScanKind::Landscape, ..start() };
    let (starts, floors) = (StartsCell::default(), FloorsCell::default());
    let mut walk =
        Locomotion::new(LocomotionOptions::sample(), start, starts, floors, Vec::new(), &Pose::IDENTITY);
    walk.set_may_pitch(true);
    let head = head_of(&eyes());
    walk.begin_with(&head);
    let Pose { position, orientation } = walk.world_from_head(&head);
    let middle = orientation.inverse() * (start.bounds.center() - position);
    assert!(middle.truncate().length() < 1e-6 && middle.z < 0.0, "{middle}");
    assert!((orientation * DVec3::NEG_Z).z < -0.2, "one looks down at a table");
    // What is drawn beside the scan is seen from the same eyes.
    let (eyes, view) = (walk.pitched(&eyes()), seen(&walk, &eyes()));
    for (eye, seen) in eyes.iter().zip(&view.eyes) {
        let in_world = walk.stage().pose_in_world(&eye.stage_from_view);
        assert!((in_world.position - seen.world_from_view.position).length() < 1e-6);
        assert!(in_world.orientation.angle_between(seen.world_from_view.orientation) < 1e-6);
    }
}

//! Hands arrive as the device has them: poses, what each kind of controller has pressed, joints, bare hands.

use crate::probe::{Job, ProbeFrame, ProbeHand, StagePose, frame, last, settle};
use glam::{DQuat, DVec3};
use kit::xr::poses::{Packet, Remote, RemoteHand, RemotePose};
use kit::xr::{Finished, Running, RuntimeSlot, TestRuntime};
use xr::joint;

/// Frames, of which the null compositor shows 20 a second, until a job ends by itself.
const LONG: u64 = 160;

/// A hand at a place of its own, turned about all three axes.
fn turned(position: [f32; 3], turn: f32) -> RemotePose {
    let orientation =
        DQuat::from_rotation_y(f64::from(turn)) * DQuat::from_rotation_x(-0.4) * DQuat::from_rotation_z(0.2);
    RemotePose { orientation: orientation.as_quat().to_array(), position }
}

/// A probe with the validation layers on that ends by itself, and the device that it sees.
fn start(runtime: TestRuntime, job: &Job) -> (Running, Remote) {
    let mut run = Job { exit_after: LONG, ..job.clone() }.start(&runtime.validate());
    let remote = run.remote();
    (run, remote)
}

/// Waits for the end and looks at what the layers say.
fn finish(run: Running) -> Finished {
    let done = run.finish();
    done.assert_ok();
    done.assert_valid();
    done
}

/// The distance of two poses in meters and in radians.
fn apart(pose: Option<StagePose>, wanted: &RemotePose) -> (f64, f64) {
    let (position, orientation) = pose.expect("a pose");
    let at = DVec3::from(position) - DVec3::from(wanted.position.map(f64::from));
    let turn = DQuat::from_array(orientation);
    (at.length(), turn.angle_between(DQuat::from_array(wanted.orientation.map(f64::from))))
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn both_hands_are_where_the_device_says() {
    let lab = RuntimeSlot::enter();
    let (mut run, mut remote) = start(lab.runtime(), &Job::default());
    let mut packet = Packet {
        left: RemoteHand { pose: turned([-0.3, 1.1, -0.4], 0.9), ..RemoteHand::default() },
        right: RemoteHand { pose: turned([0.25, 1.3, -0.6], -0.7), ..RemoteHand::default() },
        ..Packet::default()
    };
    let is_there = |hand: &ProbeHand, x: f32| {
        hand.aim.is_some_and(|(position, _)| (position[0] - f64::from(x)).abs() < 1e-4)
    };
    let frame = settle(&mut run, &mut remote, &packet, |frame| {
        is_there(&frame.hands[0], -0.3) && is_there(&frame.hands[1], 0.25)
    });
    for (hand, sent) in frame.hands.iter().zip([packet.left, packet.right]) {
        for pose in [hand.aim, hand.grip] {
            let (meters, radians) = apart(pose, &sent.pose);
            assert!(meters < 1e-4 && radians < 1e-3, "{hand:?}");
        }
        assert!(hand.has_stick);
    }
    // The comparison can fail: the hands are not taken for each other.
    let (meters, _) = apart(frame.hands[0].grip, &packet.right.pose);
    assert!(meters > 0.5, "{meters}");

    // A lost hand has no pose and rests; the other goes on.
    packet.left = RemoteHand { stick: [0.5, 0.5], trigger: 1.0, squeeze_force: 1.0, ..packet.left };
    let frame = settle(&mut run, &mut remote, &packet, |frame| frame.hands[0].stick == [0.5, 0.5]);
    assert!(frame.hands[0].select && frame.hands[0].grab);
    packet.left = RemoteHand { active: false, seen: false, ..packet.left };
    let frame = settle(&mut run, &mut remote, &packet, |frame| frame.hands[0].aim.is_none());
    let [left, right] = &frame.hands;
    assert!(left.grip.is_none() && left.stick == [0.0; 2] && !left.has_stick);
    assert!(!(left.select || left.grab || left.menu || left.reset), "{left:?}");
    assert!(right.aim.is_some() && right.has_stick);
    finish(run);
}

/// A button: its name, the hand that is asked, how to press it, and whether it is read as pressed.
type Button = (&'static str, usize, fn(&mut RemoteHand), fn(&ProbeHand) -> bool);

/// Presses one button after the other and looks that each is read as what it is for, by its hand alone.
fn press_all(run: &mut Running, remote: &mut Remote, buttons: &[Button]) {
    let all = |hand: &ProbeHand| [hand.select, hand.grab, hand.menu, hand.reset];
    settle(run, remote, &Packet::default(), |frame| frame.hands.iter().all(|hand| hand.aim.is_some()));
    for (name, number, press, is_read) in buttons {
        let mut packet = Packet::default();
        press(if *number == 0 { &mut packet.left } else { &mut packet.right });
        let frame = settle(run, remote, &packet, |frame| is_read(&frame.hands[*number]));
        let (hand, other) = (&frame.hands[*number], &frame.hands[1 - *number]);
        assert_eq!(all(hand).iter().filter(|held| **held).count(), 1, "{name}, hand {number}: {hand:?}");
        assert_eq!(all(other), [false; 4], "{name}, hand {number}: {other:?}");
        // It is read for as long as it is held.
        let held = settle(run, remote, &packet, |later| later.frame >= frame.frame + 2);
        assert!(is_read(&held.hands[*number]), "{name}, hand {number}: {held:?}");
        settle(run, remote, &Packet::default(), |frame| all(&frame.hands[*number]) == [false; 4]);
    }
}

/// The kinds that the runtime was told of, and what it said.
fn told(done: &Finished) -> Vec<(String, String)> {
    let words = |line: &str| {
        let mut words = line.strip_prefix("faultlayer: bindings ")?.split(' ').map(str::to_owned);
        Some((words.next()?, words.next()?))
    };
    done.stderr.lines().filter_map(words).collect()
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn index_controllers_do_what_the_table_says() {
    let lab = RuntimeSlot::enter();
    // The layer tells what the runtime says of the bindings.
    let (mut run, mut remote) = start(lab.runtime().fault("none"), &Job::default());
    press_all(
        &mut run,
        &mut remote,
        &[
            ("trigger", 0, |hand| hand.trigger = 1.0, |hand| hand.select),
            ("trigger", 1, |hand| hand.trigger = 1.0, |hand| hand.select),
            ("force", 0, |hand| hand.squeeze_force = 0.8, |hand| hand.grab),
            ("b", 0, |hand| hand.b_pressed = true, |hand| hand.menu),
            ("b", 1, |hand| hand.b_pressed = true, |hand| hand.menu),
            ("stick", 0, |hand| hand.stick_pressed = true, |hand| hand.reset),
            ("a", 1, |hand| hand.a_pressed = true, |hand| hand.reset),
        ],
    );
    // A hand that merely lies round the controller grabs nothing, and the left a is free.
    let mut packet = Packet::default();
    packet.left = RemoteHand { squeeze: 1.0, a_pressed: true, stick: [0.25, 0.75], ..packet.left };
    let frame = settle(&mut run, &mut remote, &packet, |frame| frame.hands[0].stick == [0.25, 0.75]);
    assert!(!frame.hands[0].grab && !frame.hands[0].reset);
    assert_eq!(frame.hands[1].stick, [0.0; 2]);
    let done = finish(run);
    // A misspelled path would be refused like a kind that is not known.
    let told = told(&done);
    let refused: Vec<_> = told.iter().filter(|(_, result)| result != "SUCCESS").collect();
    assert!(refused.is_empty(), "{refused:?}");
    assert!(told.len() >= 6, "{told:?}");
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn touch_controllers_do_what_the_table_says() {
    let lab = RuntimeSlot::enter();
    // A runtime that does not know a kind of controller takes the next one that fits.
    let (mut run, mut remote) = start(lab.runtime().fault("no-index_controller"), &Job::default());
    press_all(
        &mut run,
        &mut remote,
        &[
            ("trigger", 0, |hand| hand.trigger = 1.0, |hand| hand.select),
            ("squeeze", 1, |hand| hand.squeeze = 0.8, |hand| hand.grab),
            ("menu", 0, |hand| hand.system_pressed = true, |hand| hand.menu),
            ("y", 0, |hand| hand.b_pressed = true, |hand| hand.menu),
            ("b", 1, |hand| hand.b_pressed = true, |hand| hand.menu),
            ("stick", 1, |hand| hand.stick_pressed = true, |hand| hand.reset),
        ],
    );
    let mut packet = Packet::default();
    packet.right = RemoteHand { stick: [-1.0, 0.5], squeeze_force: 1.0, ..packet.right };
    let frame = settle(&mut run, &mut remote, &packet, |frame| frame.hands[1].stick == [-1.0, 0.5]);
    assert!(!frame.hands[1].grab);
    let told = told(&finish(run));
    let refused: Vec<_> = told.iter().filter(|(_, result)| result != "SUCCESS").collect();
    assert_eq!(refused.len(), 1, "{refused:?}");
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn the_simplest_controllers_select_and_have_a_menu() {
    let lab = RuntimeSlot::enter();
    let runtime = lab.runtime().fault("no-index_controller,no-touch_controller");
    let (mut run, mut remote) = start(runtime, &Job::default());
    press_all(
        &mut run,
        &mut remote,
        &[
            ("trigger", 0, |hand| hand.trigger = 1.0, |hand| hand.select),
            ("trigger", 1, |hand| hand.trigger = 1.0, |hand| hand.select),
            ("b", 0, |hand| hand.b_pressed = true, |hand| hand.menu),
            ("b", 1, |hand| hand.b_pressed = true, |hand| hand.menu),
        ],
    );
    let mut packet = Packet::default();
    packet.right = RemoteHand { stick: [-1.0, 0.5], b_pressed: true, ..packet.right };
    let frame = settle(&mut run, &mut remote, &packet, |frame| frame.hands[1].menu);
    assert!(!frame.hands[1].has_stick && frame.hands[1].stick == [0.0; 2]);
    finish(run);
}

/// Joints of a hand: positions.
fn positions(hand: &ProbeHand) -> Vec<DVec3> {
    hand.joints.as_deref().expect("joints").iter().map(|((position, _), _)| (*position).into()).collect()
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn joints_arrive_and_go_with_the_hand() {
    let lab = RuntimeSlot::enter();
    let (mut run, mut remote) = start(lab.runtime(), &Job { joints: true, ..Job::default() });
    let mut packet = Packet {
        left: RemoteHand { pose: turned([-0.3, 1.1, -0.4], 0.9), ..RemoteHand::default() },
        right: RemoteHand { pose: turned([0.25, 1.3, -0.6], -0.7), ..RemoteHand::default() },
        ..Packet::default()
    };
    let near = |hand: &ProbeHand, sent: &RemoteHand| {
        hand.joints.is_some()
            && positions(hand)[joint::PALM].distance(DVec3::from(sent.pose.position.map(f64::from))) < 0.15
    };
    let frame = settle(&mut run, &mut remote, &packet, |frame| {
        near(&frame.hands[0], &packet.left) && near(&frame.hands[1], &packet.right)
    });
    for hand in &frame.hands {
        let joints = hand.joints.as_ref().unwrap();
        assert_eq!(joints.len(), 26);
        assert!(joints.iter().all(|(_, radius_m)| (0.001..0.05).contains(radius_m)), "{joints:?}");
        let at = positions(hand);
        // The fingers are stretched.
        assert!((0.05..0.2).contains(&at[joint::PALM].distance(at[joint::MIDDLE_TIP])), "{at:?}");
        // A hand with a controller is read by its buttons.
        assert!(hand.has_stick && !hand.grab);
    }
    packet.right.seen = false;
    let frame = settle(&mut run, &mut remote, &packet, |frame| frame.hands[1].joints.is_none());
    assert!(frame.hands[0].joints.is_some() && frame.hands[1].aim.is_some());
    let done = finish(run);
    assert_eq!(last(&done.lines, "offers_hands").unwrap(), true);
}

/// The layer takes the controllers away, so that only joints are left.
#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn bare_hands_point_grab_pinch_and_rest() {
    let lab = RuntimeSlot::enter();
    let (mut run, mut remote) = start(lab.runtime().fault("bare"), &Job { joints: true, ..Job::default() });
    let mut packet = Packet {
        right: RemoteHand { pose: RemotePose::at([0.25, 1.2, -0.4]), trigger: 1.0, ..RemoteHand::default() },
        ..Packet::default()
    };
    let frame = settle(&mut run, &mut remote, &packet, |frame| {
        frame.hands[1].joints.is_some() && frame.hands[1].aim.is_some_and(|(at, _)| at[0] > 0.1)
    });
    let hand = &frame.hands[1];
    let at = positions(hand);
    let (from, orientation) = hand.aim.unwrap();
    assert!(DVec3::from(from).distance(at[joint::INDEX_PROXIMAL]) < 1e-6);
    // The head is at its own place, 1.6 m above the floor.
    let shoulder = DVec3::new(0.17, 1.35, 0.08);
    let ray = DQuat::from_array(orientation) * DVec3::NEG_Z;
    assert!((ray - (at[joint::INDEX_PROXIMAL] - shoulder).normalize()).length() < 1e-3, "{ray}");
    assert!(DVec3::from(hand.grip.unwrap().0).distance(at[joint::PALM]) < 1e-6);
    assert!(!hand.select && !hand.grab && !hand.has_stick, "an open hand, and no trigger: {hand:?}");

    packet.right.curl = [1.0; 5];
    let frame = settle(&mut run, &mut remote, &packet, |frame| frame.hands[1].grab);
    assert!(!frame.hands[1].select, "{:?}", frame.hands[1]);
    packet.right.curl = [0.0; 5];
    settle(&mut run, &mut remote, &packet, |frame| !frame.hands[1].grab);

    // With index finger and thumb bent so far, their tips are 9, 16 and 38 mm apart.
    let [near, between, far] = [1.0, 0.8, 0.5].map(|bent| [0.0, 0.0, 0.0, bent, bent]);
    let mut later = |packet: &Packet| {
        let frame = settle(&mut run, &mut remote, packet, |_| true).frame;
        run.wait_for("a later frame", |line| super::probe::frame(line).filter(|f| f.frame >= frame + 4))
    };
    let mut held = Vec::new();
    for curl in [between, near, between, far, between] {
        packet.right.curl = curl;
        let frame = later(&packet);
        assert!(!frame.hands[1].grab && !frame.hands[1].menu, "{:?}", frame.hands[1]);
        held.push(frame.hands[1].select);
    }
    assert_eq!(held, [false, true, true, false, false]);
    // The runtime's hand has its palm at −y; turned to the eyes, a pinch is the menu button.
    packet.right.curl = far;
    let to_head = DVec3::new(-0.25, 0.4, 0.4).normalize();
    let turned = DQuat::from_rotation_arc(DVec3::NEG_Y, to_head);
    packet.right.pose.orientation = turned.as_quat().to_array();
    later(&packet);
    packet.right.curl = near;
    let frame = later(&packet);
    assert!(frame.hands[1].menu && !frame.hands[1].select, "{:?}", frame.hands[1]);

    packet.right.curl = far;
    later(&packet);
    packet.right.seen = false;
    let frame = settle(&mut run, &mut remote, &packet, |frame| frame.hands[1].joints.is_none());
    assert!(frame.hands[1].aim.is_none());
    finish(run);
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn bare_hands_are_not_followed_where_the_user_says_so() {
    let lab = RuntimeSlot::enter();
    let job = Job { exit_after: 20, joints: true, no_hands: true, ..Job::default() };
    let done = job.run(&lab.runtime().fault("bare").validate());
    done.assert_ok();
    done.assert_valid();
    let frames: Vec<ProbeFrame> = done.lines.iter().filter_map(|line| frame(line)).collect();
    assert!(frames.iter().flat_map(|frame| &frame.hands).all(|hand| hand.joints.is_none()));
    assert!(frames.iter().flat_map(|frame| &frame.hands).all(|hand| hand.aim.is_none()));
    let told = told(&done);
    assert!(!told.iter().any(|(profile, _)| profile.contains("hand_interaction")), "{told:?}");
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn vibrations_reach_the_runtime() {
    let lab = RuntimeSlot::enter();
    let job = Job { exit_after: 40, vibrate_from: 20, ..Job::default() };
    let done = job.run(&lab.runtime().fault("none").validate());
    done.assert_ok();
    done.assert_valid();
    let felt: Vec<&str> =
        done.stderr.lines().filter_map(|line| line.strip_prefix("faultlayer: vibration ")).collect();
    assert!((10..=30).contains(&felt.len()), "{felt:?}");
    assert!(felt.iter().all(|line| *line == "/user/hand/right 0.5 20000000"), "{felt:?}");
}

/// What fails with hands costs the frame's input, and is told once by the name of the call.
#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn failures_with_hands_cost_a_frame() {
    let lab = RuntimeSlot::enter();
    for (fault, call) in [
        ("handerr:25:3", "xrLocateSpace: ERROR_TIME_INVALID"),
        ("jointserr:25:3", "xrLocateHandJointsEXT: ERROR_TIME_INVALID"),
        ("shakeerr:25:3", "xrApplyHapticFeedback: ERROR_RUNTIME_FAILURE"),
        ("syncerr:25:3", "xrSyncActions: ERROR_RUNTIME_FAILURE"),
    ] {
        let job = Job { exit_after: 40, joints: true, vibrate_from: 1, ..Job::default() };
        let done = job.run(&lab.runtime().fault(fault).validate());
        done.assert_ok();
        done.assert_valid();
        let told = done.stderr.matches(&format!("failed in a frame ({call})")).count();
        assert_eq!(told, 1, "{fault}: {}", done.stderr);
        let frames: Vec<ProbeFrame> = done.lines.iter().filter_map(|line| frame(line)).collect();
        assert!(frames.len() >= 40, "{fault}: {}", frames.len());
        let at_rest = |frame: &ProbeFrame| frame.hands[1].aim.is_none();
        let without_joints = |frame: &ProbeFrame| frame.hands[1].joints.is_none();
        let late = || frames.iter().filter(|frame| (20..36).contains(&frame.frame));
        match &fault[..4] {
            "hand" | "sync" => assert!(late().any(at_rest), "{fault}"),
            "join" => assert!(late().any(without_joints) && !late().any(at_rest), "{fault}"),
            _ => assert!(!late().any(at_rest), "{fault}"),
        }
        assert!(!at_rest(frames.last().unwrap()), "{fault}");
    }
}

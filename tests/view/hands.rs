//! Hands in the walk: they are seen, their buttons are labeled for half a minute, one of them aims an arc at the floor, and the user is where it landed; the menu opens
//! by one, and the other chooses in it.

use crate::PROGRAM;
use crate::scene::{ViewedScans, num_whole};
use base::space::Pose;
use glam::DVec3;
use kit::picture::Picture;
use kit::rows::LogRows;
use kit::wait::wait_for;
use kit::xr::poses::{Packet, RemoteEye, RemoteHand, RemotePose};
use kit::xr::{Compositor, Running, RuntimeSlot};
use std::path::Path;

/// Width of an eye's part of the compositor's screen, pixels.
const EYE_PX: usize = 960;
/// Half angle of the eyes' field of view, radians.
const HALF_FOV: f32 = 0.75;

fn eyes() -> [RemoteEye; 2] {
    [-0.0315, 0.0315].map(|x| RemoteEye {
        fov: [-HALF_FOV, HALF_FOV, HALF_FOV, -HALF_FOV],
        head_from_eye: RemotePose::at([x, 0.0, 0.0]),
    })
}

/// A head that looks down a little, and both hands before it, pointing down as much.
fn packet(right: RemoteHand) -> Packet {
    let (sin, cos) = (-0.2f32).sin_cos();
    let down = [sin, 0.0, 0.0, cos];
    let hand = |x: f32| RemotePose { orientation: down, position: [x, 1.2, -0.4] };
    Packet {
        head: RemotePose { orientation: down, position: [0.0, 1.6, 0.0] },
        eyes: Some(eyes()),
        left: RemoteHand { pose: hand(-0.25), ..RemoteHand::default() },
        // It points past the column that stands there.
        right: RemoteHand { pose: hand(0.55), ..right },
    }
}

/// Pixels that are bluer than in the picture before, as under arcs that land: they let the ground through.
fn num_of_arc(image: &Picture, before: &Picture) -> usize {
    let blue = |[r, _, b]: &[u8; 3]| i32::from(*b) - i32::from(*r);
    image.pixels.iter().zip(&before.pixels).filter(|(now, then)| blue(now) - blue(then) > 40).count()
}

/// Distance in meters between where the head was when the scan came and where it is now.
fn moved_m(log: &Path) -> Option<f64> {
    let rows = LogRows::so_far(log)?;
    let along = |column: &str| -> Vec<f64> {
        rows.column(column).iter().filter_map(|cell| cell.parse().ok()).collect()
    };
    let (x, y) = (along("head_x"), along("head_y"));
    Some((x.last()? - x.first()?).hypot(y.last()? - y.first()?))
}

/// Pixels of the color of the menu and of labels, as dark as nothing else and as little colored over so much of the sight.
fn num_dark(image: &Picture) -> usize {
    let is_dark = |[r, g, b]: &&[u8; 3]| *r < 45 && *g < 45 && *b < 50 && r.abs_diff(*g) < 8;
    image.pixels.iter().filter(is_dark).count()
}

/// A walk through the courtyard in the compositor's headset, which writes this log.
fn walk(lab: &RuntimeSlot, log: &Path, labels: &str) -> Running {
    let courtyard = &ViewedScans::get().courtyard;
    let [courtyard, log] = [courtyard, log].map(|path| path.to_str().expect("a UTF-8 path"));
    let args = ["view", courtyard, "--headset", "require", "--window", "off", "--log", log, "-v"];
    let plain = ["--set", "governor.enabled=false", "--set", "headset.resolution_scale=0.5", "--set", labels];
    let runtime = lab.runtime().compositor(Compositor::Xcb).validate().timeout_s(240);
    runtime.start(Path::new(PROGRAM), &[&args[..], &plain].concat())
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn a_hand_aims_at_the_floor_and_the_user_is_there() {
    let lab = RuntimeSlot::enter();
    let log = ViewedScans::get().file("hands.csv");
    let mut run = walk(&lab, &log, "locomotion.labels=true");
    let mut remote = run.remote();
    remote.send(&packet(RemoteHand::default()));
    run.wait_until_said("headset session: FOCUSED", 1);
    // Waits until the left eye sees something, and keeps that.
    let seen = |what: &str, is_there: &dyn Fn(&Picture) -> bool| {
        let eye = wait_for(what, || Some(run.screen().columns(0, EYE_PX)).filter(is_there));
        eye.keep(&format!("hands-{what}"));
        eye
    };
    // The scan is there when the eye is filled.
    let is_bright = |[r, g, b]: &&[u8; 3]| *r > 90 || *g > 90 || *b > 90;
    seen("scan", &|eye| eye.pixels.iter().filter(is_bright).count() >= EYE_PX * 300);
    wait_for("the whole scan", || (num_whole(&log) >= 3).then_some(()));
    // The labels of both controllers come, and go.
    let most_dark = std::cell::Cell::new(0);
    let at_rest = seen("labels", &|eye| {
        most_dark.set(most_dark.get().max(num_dark(eye)));
        num_dark(eye) + 15_000 < most_dark.get()
    });
    remote.send(&packet(RemoteHand { stick: [0.0, 1.0], ..RemoteHand::default() }));
    assert!(num_of_arc(&at_rest, &at_rest) == 0);
    seen("arc", &|eye| num_of_arc(eye, &at_rest) >= 300);
    remote.send(&packet(RemoteHand::default()));
    wait_for("the arrival", || moved_m(&log).filter(|far| *far > 1.0));
    run.screen().columns(0, EYE_PX).keep("hands-arrival");
    run.ask_to_end();
    let done = run.finish();
    done.assert_ok();
    assert!(done.vulkan_complaints().is_empty(), "{:?}", done.vulkan_complaints());
    let rows = LogRows::read(&log);
    let along = |column: &str| -> Vec<f64> {
        rows.column(column).iter().filter_map(|cell| cell.parse().ok()).collect()
    };
    let (x, y, z) = (along("head_x"), along("head_y"), along("head_z"));
    let far = (x.last().unwrap() - x[0]).hypot(y.last().unwrap() - y[0]);
    assert!((1.0..12.0).contains(&far), "{far} m away");
    // One stands on the floor there, as high as before above it: the courtyard's floor is level to some centimeters.
    let rise = z.last().unwrap() - z[0];
    assert!(rise.abs() < 0.6, "{rise} m higher");
}

/// A hand somewhere, whose ray goes through a place.
fn aimed(from: DVec3, at: DVec3) -> RemotePose {
    let orientation = Pose::look_at(from, at, DVec3::Y).orientation.as_quat().to_array();
    RemotePose { orientation, position: from.as_vec3().to_array() }
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn the_menu_opens_by_one_hand_and_the_other_chooses_in_it() {
    let lab = RuntimeSlot::enter();
    let log = ViewedScans::get().file("menu.csv");
    let mut run = walk(&lab, &log, "locomotion.labels=false");
    let mut remote = run.remote();
    // The right hand opens the menu; the left one waits aside, pointing away.
    let right = DVec3::new(0.1, 1.25, -0.45);
    let away = aimed(DVec3::new(-0.3, 1.1, -0.2), DVec3::new(-3.0, 0.5, -2.0));
    let packet = |left: RemoteHand, menu: bool| Packet {
        head: RemotePose::at([0.0, 1.6, 0.0]),
        eyes: Some(eyes()),
        left,
        right: RemoteHand {
            pose: RemotePose::at(right.as_vec3().to_array()),
            b_pressed: menu,
            ..RemoteHand::default()
        },
    };
    let aside = RemoteHand { pose: away, ..RemoteHand::default() };
    remote.send(&packet(aside, false));
    run.wait_until_said("headset session: FOCUSED", 1);
    let eye = || run.screen().columns(0, EYE_PX);
    // What is seen stays once all points have come.
    wait_for("the whole scan", || (num_whole(&log) >= 3).then_some(()));
    remote.send(&packet(aside, true));
    let before = num_dark(&eye());
    let opened = wait_for("the menu", || Some(eye()).filter(|eye| num_dark(eye) > before + 12_000));
    opened.keep("hands-menu");
    remote.send(&packet(aside, false));
    // The last button, at the bottom right, leaves. The menu stands above the hand and faces the head.
    let middle = right + DVec3::Y * 0.235;
    let menu = Pose::look_at(middle, middle + (middle - DVec3::new(0.0, 1.6, 0.0)), DVec3::Y);
    let button = middle + menu.orientation * DVec3::new(0.05, -0.168, 0.0);
    let pose = aimed(DVec3::new(-0.15, 1.35, -0.1), button);
    let pointing = RemoteHand { pose, ..RemoteHand::default() };
    remote.send(&packet(pointing, false));
    // The ray of a hand that points at the menu is blue all the way.
    let is_ray = |[r, _, b]: &&[u8; 3]| i32::from(*b) - i32::from(*r) > 60 && *b > 150;
    let num_ray = |picture: &Picture| picture.pixels.iter().filter(is_ray).count();
    let seen = wait_for("the ray", || Some(eye()).filter(|eye| num_ray(eye) > num_ray(&opened) + 100));
    seen.keep("hands-menu-ray");
    // The trigger is pulled for some frames, and let go; frames are counted by the log. A frame may come late.
    let num_frames = || LogRows::so_far(&log).map_or(0, |rows| rows.column("frame").len());
    let has_left = || run.said().contains("; ended ");
    for trigger in [0.0, 1.0].into_iter().cycle().take(20) {
        remote.send(&packet(RemoteHand { trigger, ..pointing }, false));
        let from = num_frames();
        wait_for("further frames", || (num_frames() >= from + 4 || has_left()).then_some(()));
        if has_left() {
            break;
        }
    }
    let done = run.finish();
    done.assert_ok();
    assert!(done.vulkan_complaints().is_empty(), "{:?}", done.vulkan_complaints());
}

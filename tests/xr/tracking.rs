//! Poses and fields of view of the eyes arrive as the device has them.

use crate::probe::{Job, ProbeFrame, settle};
use glam::{DQuat, DVec3};
use kit::xr::RuntimeSlot;
use kit::xr::poses::{Packet, RemoteEye, RemotePose};

fn position(frame: &ProbeFrame, eye: usize) -> DVec3 {
    frame.eyes[eye].0.into()
}

/// The point between the eyes.
fn head(frame: &ProbeFrame) -> DVec3 {
    0.5 * (position(frame, 0) + position(frame, 1))
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn the_head_is_where_the_device_says() {
    let lab = RuntimeSlot::enter();
    let mut run = Job { exit_after: 0, ..Job::default() }.start(&lab.runtime());
    let mut remote = run.remote();
    // A turn of 90° to the left with a pitch is not enough to tell signs, so all three axes differ here.
    let turned = DQuat::from_rotation_y(0.9) * DQuat::from_rotation_x(-0.4) * DQuat::from_rotation_z(0.2);
    let packet = Packet {
        head: RemotePose { orientation: turned.as_quat().to_array(), position: [0.25, 1.5, -0.75] },
        ..Packet::default()
    };
    let wanted = DVec3::new(0.25, 1.5, -0.75);
    let frame = settle(&mut run, &mut remote, &packet, |frame| (head(frame) - wanted).length() < 1e-4);
    for (_, orientation, _) in frame.eyes {
        let angle = DQuat::from_array(orientation).angle_between(turned);
        assert!(angle < 1e-3, "{angle}");
    }
    // The left eye lies to the left: the order of the eyes is right.
    let right_of_head = turned * DVec3::X;
    let apart = (position(&frame, 1) - position(&frame, 0)).dot(right_of_head);
    assert!((0.05..0.08).contains(&apart), "{apart}");

    // The comparison can fail: another pose is not taken for this one.
    let elsewhere = settle(&mut run, &mut remote, &Packet::default(), |frame| head(frame).z.abs() < 1e-4);
    assert!((head(&elsewhere) - wanted).length() > 0.5);
    assert!((head(&elsewhere) - DVec3::new(0.0, 1.6, 0.0)).length() < 1e-4, "{}", head(&elsewhere));
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn asymmetric_and_canted_eyes_arrive() {
    let lab = RuntimeSlot::enter();
    let mut run = Job { exit_after: 0, ..Job::default() }.start(&lab.runtime());
    let mut remote = run.remote();
    let cant = DQuat::from_rotation_y(0.0873);
    let eye = |fov, x, orientation: DQuat| RemoteEye {
        fov,
        head_from_eye: RemotePose { orientation: orientation.as_quat().to_array(), position: [x, 0.0, 0.01] },
    };
    let fovs = [[-0.9_f32, 0.7, 0.8, -0.85], [-0.7, 0.9, 0.8, -0.85]];
    let eyes = [eye(fovs[0], -0.033, cant), eye(fovs[1], 0.033, cant.inverse())];
    let packet = Packet { eyes: Some(eyes), ..Packet::default() };
    let shown = |frame: &ProbeFrame| (frame.eyes[0].2[0] - f64::from(-0.9_f32).tan()).abs() < 1e-5;
    let frame = settle(&mut run, &mut remote, &packet, shown);
    for (eye, fov) in fovs.iter().enumerate() {
        for (tangent, angle) in frame.eyes[eye].2.iter().zip(fov) {
            assert!((tangent - f64::from(*angle).tan()).abs() < 1e-5, "eye {eye}: {tangent} {angle}");
        }
        let wanted = if eye == 0 { cant } else { cant.inverse() };
        assert!(DQuat::from_array(frame.eyes[eye].1).angle_between(wanted) < 1e-3);
        let x = if eye == 0 { -0.033 } else { 0.033 };
        let offset = position(&frame, eye) - DVec3::new(x, 1.6, 0.01);
        assert!(offset.length() < 1e-4, "eye {eye}: {offset}");
    }
    // Each eye looks outwards.
    let forward = |eye: usize| DQuat::from_array(frame.eyes[eye].1) * DVec3::NEG_Z;
    assert!(forward(0).x < -0.05 && forward(1).x > 0.05);
}

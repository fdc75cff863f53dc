//! The worst frames, and the way back to them.

use super::{log_of, row_of, wave_ms};
use base::output::{Output, OutputKind};
use lab::report::{HOLD_S, worst, worst_poses};
use timing::pose_path::PosePath;
use timing::{FrameLog, RunFacts, read};

#[test]
fn one_hitch_is_one_worst_frame() {
    // There is a hitch of 20 frames, and a lone long frame that is shorter than any of them.
    let log = log_of(9000, |frame| match frame {
        4000..4020 => 40.0 + (frame - 4000) as f64,
        7000 => 30.0,
        _ => wave_ms(frame),
    });
    let worst = worst(&log);
    assert_eq!(worst.len(), 20);
    assert_eq!([worst[0].frame, worst[1].frame], [4019, 7000]);
    assert!(worst.windows(2).all(|pair| pair[0].gpu_ms >= pair[1].gpu_ms));
    assert!(lab::report::worst(&log_of(0, wave_ms)).is_empty());
}

/// Poses go from the frame thread's row to the path that `view --pose-path` replays.
#[test]
fn a_replay_sees_what_the_worst_frames_saw() {
    let spiky =
        |frame: u64| if [200, 700].contains(&frame) { 50.0 + frame as f64 / 100.0 } else { wave_ms(frame) };
    let logged = log_of(1000, spiky);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("frames.csv");
    let log =
        FrameLog::start(&Output::new(&file, OutputKind::FrameLog).unwrap(), &RunFacts::default()).unwrap();
    for frame in &logged.frames {
        log.push(row_of(frame));
    }
    assert_eq!(log.finish().num_rows, 1000);

    let path = folder.path().join("worst.poses");
    std::fs::write(&path, worst_poses(&read(&file).unwrap()).expect("poses").to_string()).unwrap();
    let replayed = PosePath::read(&path).unwrap();
    for (at, frame) in [700, 200].into_iter().enumerate() {
        let seen = logged.frames[frame].world_from_head.unwrap();
        let pose = replayed.at(at as f64 * HOLD_S);
        assert_eq!(pose.position, seen.position, "to the last bit");
        assert!((pose.orientation.dot(seen.orientation).abs() - 1.0).abs() < 1e-15);
        let other = logged.frames[frame + 1].world_from_head.unwrap();
        assert_ne!(pose.position, other.position, "the comparison can fail");
    }
}

#[test]
fn without_poses_or_times_there_is_no_path() {
    let mut log = log_of(100, wave_ms);
    log.frames.iter_mut().for_each(|frame| frame.gpu_ms = f64::NAN);
    assert_eq!(worst_poses(&log), None);
    let mut log = log_of(100, wave_ms);
    log.frames.iter_mut().for_each(|frame| frame.world_from_head = None);
    assert_eq!(worst_poses(&log), None);
}

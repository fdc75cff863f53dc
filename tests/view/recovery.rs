//! The walk outlives its headset: whatever a runtime does, the scan, the place, the window and the log are kept, and the
//! headset is taken again when it answers. One bad call costs a frame.

use crate::PROGRAM;
use crate::scene::ViewedScans;
use kit::rows::LogRows;
use kit::wait::retry;
use kit::xr::{Finished, Running, RuntimeSlot, TestRuntime};
use std::path::{Path, PathBuf};

/// What is said when a headset is taken again.
pub const TAKEN: &str = "is used from now on";

/// What is said when a headset is lost.
pub const GOES_ON: &str = "the walk goes on without a headset";

/// A walk through the courtyard without a window, which writes this log.
fn start(runtime: &TestRuntime, headset: &str, log: &Path) -> Running {
    start_with(&ViewedScans::get().courtyard, runtime, headset, log)
}

/// A walk through a scan without a window, which writes this log.
pub fn start_with(scan: &Path, runtime: &TestRuntime, headset: &str, log: &Path) -> Running {
    let [scan, log] = [scan, log].map(|path| path.to_str().expect("a UTF-8 path"));
    let args = ["view", scan, "--headset", headset, "--window", "off", "--log", log, "-v"];
    // Small images, for a software driver.
    let small = ["--set", "headset.resolution_scale=0.3", "--set", "simulated.size_px=[96,96]"];
    runtime.start(Path::new(PROGRAM), &[&args[..], &small].concat())
}

/// A log of this test's own: tests run beside each other, and two may ask for the same fault.
pub fn log_file(test: &str, fault: &str) -> PathBuf {
    ViewedScans::get().file(&format!("{test}-{fault}.csv").replace(':', "-"))
}

/// Waits until the log that a walk writes has rows of these sessions, one after the other, and the last of them shows the
/// scan from somewhere.
pub fn wait_for_rows(run: &Running, log: &Path, sessions: &[&str]) {
    let (last, before) = sessions.split_last().expect("a session");
    let found = retry(60.0, || {
        let rows = LogRows::so_far(log).ok_or(())?;
        let (session, resident, head) =
            (rows.column("session"), rows.numbers("points_resident"), rows.column("head_x"));
        let mut left = 0..session.len();
        let has_all = before.iter().all(|wanted| left.any(|row| session[row] == *wanted));
        let shows_scan = |row: usize| session[row] == *last && resident[row] > 0.0 && !head[row].is_empty();
        if has_all && left.any(shows_scan) { Ok(()) } else { Err(()) }
    });
    if found.is_err() {
        let text = std::fs::read_to_string(log).unwrap_or_default();
        let last: Vec<&str> = text.lines().rev().take(3).collect();
        panic!("no rows of {sessions:?}; the last: {last:#?}; said:\n{}", run.said());
    }
}

/// Asks a walk to end, and checks that it ends well. The script that runs it ends one that is late, with a code of its own.
pub fn end(run: Running) -> Finished {
    run.ask_to_end();
    let done = run.finish();
    done.assert_ok();
    done
}

/// Checks that a log goes from the headset to the simulated one and back, and that the viewer has stayed where they were.
pub fn assert_place_is_kept(log: &Path) {
    let rows = LogRows::read(log);
    let frames = rows.numbers("frame");
    assert!(frames.windows(2).all(|pair| pair[1] == pair[0] + 1.0), "no frame is lost or counted twice");
    let resident = rows.numbers("points_resident");
    let first = resident.iter().position(|points| *points > 0.0).expect("a frame of the scan");
    let place = |column: &str| -> Vec<f64> {
        rows.column(column)[first..].iter().filter_map(|cell| cell.parse().ok()).collect()
    };
    let (x, y) = (place("head_x"), place("head_y"));
    for along in [&x, &y] {
        // Heads of different headsets are at most some centimeters from the middle of the stage.
        let (low, high) =
            along.iter().fold((f64::MAX, f64::MIN), |(low, high), &v| (low.min(v), high.max(v)));
        assert!(high - low < 0.5, "from {low} to {high}");
    }
}

/// Faults that take the headset away, and the words by which the user is told.
pub const LOSSES: [(&str, &str); 9] = [
    ("sessionlost:20", "xrWaitFrame: ERROR_SESSION_LOST"),
    ("losspending:20", "LOSS_PENDING"),
    ("exiting:20", "EXITING"),
    ("exit:20", "EXITING"),
    ("acqlost:20", "xrAcquireSwapchainImage: ERROR_SESSION_LOST"),
    ("locatelost:20", "xrLocateViews: ERROR_SESSION_LOST"),
    ("endlost:20", "xrEndFrame: ERROR_SESSION_LOST"),
    ("instancelost:20", "xrWaitFrame: ERROR_INSTANCE_LOST"),
    ("instloss:20", "INSTANCE_LOSS_PENDING"),
];

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn a_lost_headset_is_taken_again() {
    let lab = RuntimeSlot::enter();
    for (fault, words) in LOSSES {
        let log = log_file("retaken", fault);
        let run = start(&lab.runtime().fault(fault).timeout_s(90), "auto", &log);
        run.wait_until_said(words, 1);
        run.wait_until_said(TAKEN, 1);
        run.wait_until_said("headset session: FOCUSED", 2);
        wait_for_rows(&run, &log, &["simulated", "FOCUSED"]);
        let done = end(run);
        assert!(done.stderr.contains(GOES_ON), "{fault}: {}", done.stderr);
        assert_place_is_kept(&log);
    }
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn a_required_headset_that_is_lost_ends_the_walk_with_the_reason() {
    let lab = RuntimeSlot::enter();
    for (fault, words) in [LOSSES[0], LOSSES[2], LOSSES[7]] {
        let done = start(&lab.runtime().fault(fault).timeout_s(90), "require", &log_file("required", fault))
            .finish();
        assert_eq!(done.code, Some(1), "{fault}: {}", done.stderr);
        let said = "scanwalk: --headset require: ";
        assert!(done.stderr.contains(said) && done.stderr.contains(words), "{fault}: {}", done.stderr);
    }
}

/// Faults of single calls, how often they happen, and the words in the log.
pub const HITCHES: [(&str, &str); 11] = [
    ("waiterr:20:5", "xrWaitFrame: ERROR_RUNTIME_FAILURE"),
    ("waitnotrunning:20:5", "xrWaitFrame: ERROR_SESSION_NOT_RUNNING"),
    ("beginerr:20:5", "xrBeginFrame: ERROR_RUNTIME_FAILURE"),
    ("discard:20:5", "xrBeginFrame: FRAME_DISCARDED"),
    ("acqerr:20:5", "xrAcquireSwapchainImage: ERROR_RUNTIME_FAILURE"),
    ("imgtimeout:20:5", "xrWaitSwapchainImage: TIMEOUT_EXPIRED"),
    ("relerr:20:5", "xrReleaseSwapchainImage: ERROR_RUNTIME_FAILURE"),
    ("locateerr:20:5", "xrLocateViews: ERROR_TIME_INVALID"),
    ("syncerr:20:5", "xrSyncActions: ERROR_RUNTIME_FAILURE"),
    ("badtime:20:5", "xrEndFrame: ERROR_TIME_INVALID"),
    ("badpose:20:5", "xrLocateViews: ERROR_POSE_INVALID"),
];

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn one_bad_call_costs_a_frame() {
    let lab = RuntimeSlot::enter();
    for (fault, words) in HITCHES {
        let log = log_file("hitch", fault);
        // Frames go on: the layer tells of one that comes twenty frames after the first fault.
        let faults = format!("{fault},watch:40");
        let run = start(&lab.runtime().validate().fault(&faults).timeout_s(90), "auto", &log);
        let name = fault.split(':').next().expect("a name");
        run.wait_until_said(&format!("faultlayer: {name}"), 5);
        run.wait_until_said("faultlayer: watch", 1);
        let done = end(run);
        assert_eq!(done.stderr.matches(words).count(), 1, "{fault}: {}", done.stderr);
        assert!(!done.stderr.contains(GOES_ON), "{fault}: {}", done.stderr);
        assert!(!done.stderr.contains("was not waited for"), "{fault}: {}", done.stderr);
        done.assert_valid();
    }
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn a_session_that_only_fails_is_lost() {
    let lab = RuntimeSlot::enter();
    let log = log_file("fails-only", "enderr");
    let run = start(&lab.runtime().fault("enderr:20:200").timeout_s(90), "auto", &log);
    run.wait_until_said("the headset was lost (xrEndFrame: ERROR_RUNTIME_FAILURE)", 1);
    run.wait_until_said(TAKEN, 1);
    end(run);
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn a_runtime_that_is_killed_and_started_again_is_taken_again() {
    let lab = RuntimeSlot::enter();
    let log = log_file("killed", "none");
    let run = start(&lab.runtime().timeout_s(120), "auto", &log);
    wait_for_rows(&run, &log, &["FOCUSED"]);
    run.kill_runtime();
    run.wait_until_said("the headset's software stopped", 1);
    wait_for_rows(&run, &log, &["FOCUSED", "simulated"]);
    run.start_runtime();
    run.wait_until_said(TAKEN, 1);
    run.wait_until_said("headset session: FOCUSED", 2);
    wait_for_rows(&run, &log, &["FOCUSED", "simulated", "FOCUSED"]);
    end(run);
    assert_place_is_kept(&log);
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn a_runtime_that_is_started_later_is_found() {
    let lab = RuntimeSlot::enter();
    let log = log_file("later", "none");
    let run = start(&lab.runtime().later().timeout_s(120), "auto", &log);
    run.wait_until_said("no headset, so a simulated one is used until one answers", 1);
    wait_for_rows(&run, &log, &["simulated"]);
    run.start_runtime();
    run.wait_until_said(TAKEN, 1);
    run.wait_until_said("headset session: FOCUSED", 1);
    wait_for_rows(&run, &log, &["simulated", "FOCUSED"]);
    end(run);
    assert_place_is_kept(&log);
}

/// The call that hangs never returns: only a program that waits for it no longer can end.
#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn nobody_waits_for_a_runtime_that_does_not_answer() {
    let lab = RuntimeSlot::enter();
    for fault in ["hang:20", "hangbegin:20"] {
        let log = log_file("hangs", fault);
        let run = start(&lab.runtime().fault(fault).timeout_s(90), "auto", &log);
        run.wait_until_said(&format!("faultlayer: {}", fault.trim_end_matches(":20")), 1);
        let done = end(run);
        assert!(done.stderr.contains("left without waiting"), "{fault}: {}", done.stderr);
        // The log is whole.
        assert!(timing::read(&log).expect("a log").frames.len() > 10, "{fault}");
    }
}

/// How many faults happen at random; the environment may say it (SCANWALK_FAULTS).
const NUM_FAULTS: usize = 6;
/// Longest time that a fault and the way back from it take, seconds.
const FAULT_S: usize = 20;

/// The faults that the layer tells of, each by its name alone; it tells of bindings and the like in several words.
fn fired(said: &str) -> Vec<&str> {
    let told = said.lines().filter_map(|line| line.strip_prefix("faultlayer: "));
    told.filter(|told| !told.contains(' ')).collect()
}

/// Whatever happens, in whatever order: the scan is walked at the end, and no frame is lost from the log.
#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn the_scan_is_still_walked_after_faults_at_random() {
    let lab = RuntimeSlot::enter();
    let asked = std::env::var("SCANWALK_FAULTS").ok().and_then(|number| number.parse().ok());
    let num_faults: usize = asked.unwrap_or(NUM_FAULTS);
    let log = log_file("walked", "random");
    let limit_s = num_faults * FAULT_S + 60;
    let runtime = lab.runtime().fault("random:7:25").timeout_s(limit_s as u32);
    let run = start(&runtime, "auto", &log);
    run.wait_until_said("headset session: FOCUSED", 1);
    let happened = retry(limit_s as f64, || {
        let num = fired(&run.said()).len();
        if num >= num_faults { Ok(()) } else { Err(num) }
    });
    assert_eq!(happened, Ok(()), "{}", run.said());
    let done = end(run);
    assert_place_is_kept(&log);
    let rows = LogRows::read(&log);
    let (phases, read) = (rows.column("phase"), rows.numbers("points_read"));
    let last = phases.iter().rposition(|phase| *phase == "walking").expect("frames of the walk");
    assert!(read[last] > 0.0 && last + 40 > phases.len(), "{last} of {}", phases.len());
    let fired = fired(&done.stderr);
    let taken = done.stderr.matches(TAKEN).count();
    eprintln!("{} faults, the headset was taken again {taken} times: {fired:?}", fired.len());
    assert!(taken >= 1, "{}", done.stderr);
    assert!(!done.stderr.contains("not waited for"), "{}", done.stderr);
}

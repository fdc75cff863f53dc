//! Whatever goes wrong ends with a plain sentence: no crash, no hang, nothing left behind.

use crate::probe::{JOB, Job, PROBE_ARGS, last};
use kit::program::{self, this_program};
use kit::xr::{Finished, RuntimeSlot};
use std::os::unix::fs::PermissionsExt;

/// Runs the probe, which does not end by itself, with a fault.
fn run_with_fault(lab: &RuntimeSlot, fault: &str) -> Finished {
    let done = Job::default().run(&lab.runtime().validate().fault(fault));
    done.assert_ok();
    done
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn the_runtime_ends_the_session() {
    let lab = RuntimeSlot::enter();
    let done = run_with_fault(&lab, "exit:20");
    done.assert_valid();
    assert_eq!(last(&done.lines, "ended").unwrap(), "the headset's software ended the session (EXITING)");
    assert!(last(&done.lines, "frame").unwrap().as_u64().unwrap() >= 10);
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn losses_end_with_a_sentence() {
    let lab = RuntimeSlot::enter();
    for (fault, word) in [
        ("losspending:20", "headset was lost"),
        ("sessionlost:20", "headset was lost"),
        ("instloss:20", "software stopped"),
        ("instancelost:20", "software stopped"),
    ] {
        let done = run_with_fault(&lab, fault);
        let ended = last(&done.lines, "ended").unwrap_or_default();
        assert!(ended.as_str().is_some_and(|sentence| sentence.contains(word)), "{fault}: {ended}");
    }
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn a_killed_runtime_ends_the_walk() {
    let lab = RuntimeSlot::enter();
    let mut run = Job::default().start(&lab.runtime().timeout_s(30));
    run.wait_for("frame", |line| line.contains("\"frame\":20").then_some(()));
    run.kill_runtime();
    let done = run.finish();
    done.assert_ok();
    let ended = last(&done.lines, "ended").unwrap();
    assert!(ended.as_str().unwrap().contains("software stopped"), "{ended}");
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn what_is_missing_is_told_and_leaves_nothing_behind() {
    let lab = RuntimeSlot::enter();
    for (fault, words) in [
        ("noheadset", ["finds no headset", "Monado"]),
        // These faults come when the Vulkan device, and the left eye's images, are already made.
        ("nosession", ["refused the session", "xrCreateSession: ERROR_LIMIT_REACHED"]),
        ("noimages", ["refused the session", "xrCreateSwapchain: ERROR_OUT_OF_MEMORY"]),
    ] {
        let runtime = lab.runtime().validate().fault(fault);
        let done = Job::default().run(&runtime);
        done.assert_ok();
        let missing = last(&done.lines, "missing").unwrap_or_default();
        for word in words {
            assert!(
                missing.as_str().is_some_and(|m| m.contains(word)),
                "{fault}: {missing}\n{}",
                done.stderr
            );
        }
        if fault != "noheadset" {
            done.assert_valid();
        }
    }
}

/// Runs the probe with one variable changed after the runtime has set its own.
fn run_with_variable(lab: &RuntimeSlot, assignment: &str) -> String {
    let script = tempfile::Builder::new().suffix(".sh").tempfile().unwrap();
    std::fs::write(script.path(), format!("#!/bin/sh\nexec env {assignment} \"$XR_LD\" \"$@\"\n")).unwrap();
    std::fs::set_permissions(script.path(), std::fs::Permissions::from_mode(0o755)).unwrap();
    // The file is closed, because a file that is open for writing cannot be run.
    let script = script.into_temp_path();
    let program = this_program();
    let mut args = vec![program.to_str().unwrap()];
    args.extend(PROBE_ARGS);
    let job = serde_json::to_string(&Job::default()).unwrap();
    let done = lab.runtime().variable(JOB, job).run(&script, &args);
    done.assert_ok();
    last(&done.lines, "missing").unwrap_or_default().to_string()
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn no_runtime_and_a_silent_one_are_told_apart() {
    let lab = RuntimeSlot::enter();
    let missing = run_with_variable(&lab, "XR_RUNTIME_JSON=/nonexistent/runtime.json");
    assert!(missing.contains("no OpenXR runtime is set up"), "{missing}");
    let missing = run_with_variable(&lab, "XDG_RUNTIME_DIR=/nonexistent");
    assert!(missing.contains("does not work (xrCreateInstance: ERROR_RUNTIME_FAILURE)"), "{missing}");
}

#[test]
fn no_loader_is_told() {
    // A file of that name that is no library hides an installed loader.
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("libopenxr_loader.so.1"), "not a library").unwrap();
    let output = program::run(Job::default().bare().env("LD_LIBRARY_PATH", folder.path())).ok();
    let lines: Vec<String> = output.text().lines().map(str::to_string).collect();
    let missing = last(&lines, "missing").unwrap();
    assert!(missing.as_str().unwrap().contains("no OpenXR loader found: install it"), "{missing}");
}

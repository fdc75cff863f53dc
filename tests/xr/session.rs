//! Sessions that go well.

use crate::probe::{Job, frame, last};
use kit::xr::{Compositor, HeadsetDevice, RuntimeSlot};

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn frames_flow_in_focus_until_we_ask_to_leave() {
    let lab = RuntimeSlot::enter();
    let done = Job { exit_after: 80, ..Job::default() }.run(&lab.runtime().validate());
    done.assert_ok();
    done.assert_valid();
    let frames: Vec<_> = done.lines.iter().filter_map(|line| frame(line)).collect();
    assert!(frames.iter().filter(|frame| frame.state == "FOCUSED").count() >= 60, "{}", frames.len());
    // Frames go on after the request until the runtime says stop, so there may be more than asked for.
    assert!(frames.len() >= 80 && frames.last().unwrap().frame as usize == frames.len());
    assert_eq!(last(&done.lines, "ended").unwrap(), "the walk was ended");
    assert_eq!(last(&done.lines, "reached_focus").unwrap(), true);
    let runtime = last(&done.lines, "runtime").unwrap();
    assert!(runtime.as_str().unwrap().starts_with("Monado"), "{runtime}");
    assert!(
        last(&done.lines, "hidden_frame").is_some(),
        "a frame that is not to be rendered was lived through"
    );
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn another_thread_may_submit_all_the_while() {
    let lab = RuntimeSlot::enter();
    let job = Job { exit_after: 60, busy_thread: true, ..Job::default() };
    let done = job.run(&lab.runtime().validate().device(HeadsetDevice::Simulated));
    done.assert_ok();
    done.assert_valid();
    assert!(last(&done.lines, "busy_submits").unwrap().as_u64().unwrap() > 100);
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn the_images_follow_the_scale_and_odd_sizes_work() {
    let lab = RuntimeSlot::enter();
    let runtime = lab.runtime().validate();
    let plain = last(&Job { exit_after: 5, ..Job::default() }.run(&runtime).lines, "sizes").unwrap();
    let done = Job { exit_after: 5, resolution_scale: 0.51, ..Job::default() }.run(&runtime);
    done.assert_ok();
    done.assert_valid();
    let scaled = last(&done.lines, "sizes").unwrap();
    for (eye, axis) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let expected = (plain[eye][axis].as_f64().unwrap() * 0.51).round();
        assert_eq!(scaled[eye][axis].as_f64().unwrap(), expected, "{plain} {scaled}");
    }
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn the_displays_rate_is_known() {
    let lab = RuntimeSlot::enter();
    let runtime =
        lab.runtime().compositor(Compositor::Xcb).variable("XRT_COMPOSITOR_DEFAULT_FRAMERATE", "72");
    let done = Job { exit_after: 5, ..Job::default() }.run(&runtime);
    done.assert_ok();
    let hz = last(&done.lines, "hz").unwrap().as_f64().unwrap();
    assert!((hz - 72.0).abs() < 0.5, "{hz}");
}

/// Images that the GPU has no room for are as large as it allows, in their shape, and the setting for it is named.
#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn images_that_are_too_large_are_made_smaller() {
    let lab = RuntimeSlot::enter();
    for (fault, wanted) in [("bigsizes", [3840.0, 3744.0]), ("hugesizes", [20_000.0, 20_000.0])] {
        let done = Job { exit_after: 2, ..Job::default() }.run(&lab.runtime().fault(fault));
        done.assert_ok();
        let sizes = last(&done.lines, "sizes").unwrap_or_default();
        let [width, height] = [0, 1].map(|axis: usize| sizes[0][axis].as_f64().expect("a size"));
        // The software driver binds 128 MiB at once: 16 bytes for each of 8 million pixels.
        assert!(width < wanted[0] && (8.0e6..8.4e6).contains(&(width * height)), "{fault}: {sizes}");
        assert!((width / height - wanted[0] / wanted[1]).abs() < 0.001, "{fault}: {sizes}");
    }
}

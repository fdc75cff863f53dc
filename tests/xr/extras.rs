//! What a runtime may offer beyond the frame: it takes depth beside the images, and tells what the lenses hide and
//! where the user looks.

use crate::probe::{Job, last};
use kit::xr::{Finished, RuntimeSlot};

/// What was submitted for each eye, as the API layer between us and the runtime saw it: the image's size, and if
/// there was depth its size and minDepth, maxDepth, nearZ, farZ.
fn submitted_views(done: &Finished) -> Vec<&str> {
    done.stderr.lines().filter_map(|line| line.strip_prefix("faultlayer: view ")).collect()
}

/// Width and height of the left eye's image.
fn eye_size(done: &Finished) -> [usize; 2] {
    let sizes = last(&done.lines, "sizes").unwrap();
    [0, 1].map(|axis: usize| sizes[0][axis].as_u64().unwrap() as usize)
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn depth_goes_to_the_runtime_in_its_own_terms() {
    let lab = RuntimeSlot::enter();
    let runtime = lab.runtime().validate().fault("watch:10");
    let done = Job { exit_after: 30, near_m: 0.125, ..Job::default() }.run(&runtime);
    done.assert_ok();
    done.assert_valid();
    assert_eq!(last(&done.lines, "offers_depth").unwrap(), true);
    assert_eq!(last(&done.lines, "depth_format").unwrap(), "Depth32Float");
    let [width, height] = eye_size(&done);
    let (far, near) = (f32::MAX, 0.125);
    let wanted = format!("{width}x{height} depth {width}x{height} 0 1 {far:e} {near}");
    assert_eq!(submitted_views(&done), [&wanted, &wanted]);
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn what_is_switched_off_is_not_used() {
    let lab = RuntimeSlot::enter();
    let runtime = lab.runtime().validate().fault("watch:10");
    let done = Job { exit_after: 30, plain: true, ..Job::default() }.run(&runtime);
    done.assert_ok();
    done.assert_valid();
    assert!(last(&done.lines, "depth_format").unwrap().is_null());
    assert!(last(&done.lines, "hidden_triangles").is_none());
    let [width, height] = eye_size(&done);
    assert_eq!(submitted_views(&done), [format!("{width}x{height}"), format!("{width}x{height}")]);
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn the_walk_goes_on_without_either() {
    let lab = RuntimeSlot::enter();
    for (fault, missing) in [("nodepth", "depth_format"), ("nomask", "hidden_triangles")] {
        let done = Job { exit_after: 10, ..Job::default() }.run(&lab.runtime().validate().fault(fault));
        done.assert_ok();
        done.assert_valid();
        assert!(last(&done.lines, missing).is_none_or(|value| value.is_null()), "{fault}");
        assert_eq!(last(&done.lines, "ended").unwrap(), "the walk was ended", "{fault}");
    }
}

/// The test runtime hides a triangle in each corner: an eighth of the width by an eighth of the height.
#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn the_lenses_hide_the_corners() {
    let lab = RuntimeSlot::enter();
    let done = Job { exit_after: 10, dump_hidden: true, ..Job::default() }.run(&lab.runtime().validate());
    done.assert_ok();
    done.assert_valid();
    assert_eq!(last(&done.lines, "hidden_triangles").unwrap(), serde_json::json!([4, 4]));
    let [width, height] = eye_size(&done);
    let words: Vec<u32> =
        bytemuck::pod_collect_to_vec(&std::fs::read(done.folder().join("hidden.bits")).unwrap());
    let words_per_row = width.div_ceil(32);
    assert_eq!(words.len(), words_per_row * height);
    let mut num_hidden = 0;
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let hidden = words[y * words_per_row + x / 32] >> (x % 32) & 1 == 1;
        num_hidden += usize::from(hidden);
        // Lengths are in eighths of the image from the nearest corner, at the pixel's inner corner.
        let from_corner = |at: usize, size: usize| 8.0 * (at.min(size - 1 - at) + 1) as f64 / size as f64;
        let inside = from_corner(x, width) + from_corner(y, height);
        if (inside - 1.0).abs() > 0.01 {
            assert_eq!(hidden, inside < 1.0, "{x}, {y}");
        }
    }
    assert!(num_hidden > width * height / 40, "{num_hidden}");
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn a_new_mask_is_told_once() {
    let lab = RuntimeSlot::enter();
    let done = Job { exit_after: 40, ..Job::default() }.run(&lab.runtime().validate().fault("newmask:20"));
    done.assert_ok();
    done.assert_valid();
    let told: Vec<u64> = done
        .lines
        .iter()
        .filter_map(|line| last(std::slice::from_ref(line), "hidden_at_frame")?.as_u64())
        .collect();
    assert!(matches!(told[..], [1, second] if (15..30).contains(&second)), "{told:?}");
}

/// Both eyes' gaze in the last frame.
fn gaze(done: &Finished) -> [Option<glam::DVec3>; 2] {
    serde_json::from_value(last(&done.lines, "gaze").unwrap()).unwrap()
}

/// The test runtime knows the extension and has no eye tracker: the layer plays the part of one.
#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn the_gaze_arrives_where_eyes_are_tracked() {
    let lab = RuntimeSlot::enter();
    let run = |runtime: kit::xr::TestRuntime| {
        let done = Job { exit_after: 30, ..Job::default() }.run(&runtime);
        done.assert_ok();
        done.assert_valid();
        gaze(&done)
    };
    assert_eq!(run(lab.runtime().validate()), [None; 2], "no tracker");
    let turned = run(lab.runtime().validate().fault("gaze"));
    let wanted = glam::DVec3::new(-(0.3_f64.sin()), 0.0, -(0.3_f64.cos()));
    for eye in turned {
        assert!(eye.is_some_and(|gaze| (gaze - wanted).length() < 1e-5), "{eye:?}");
    }
    assert_eq!(run(lab.runtime().validate().fault("nogaze")), [None; 2], "a tracker that fails");
}

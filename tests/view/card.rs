//! The card in the headset: why there is no scan can be read there too, for as long as somebody needs.

use crate::PROGRAM;
use crate::scene::ViewedScans;
use kit::picture::Picture;
use kit::wait::wait_for;
use kit::xr::{Compositor, RuntimeSlot};
use std::path::Path;

/// Width of an eye's part of the compositor's screen, pixels.
const EYE_PX: usize = 960;

/// Pixels of the color that headings of failures have, nearly: text has soft edges.
fn num_of_heading(image: &Picture) -> usize {
    image.pixels.iter().filter(|[r, g, b]| *r > 200 && (80..150).contains(g) && (60..140).contains(b)).count()
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn a_scan_that_cannot_be_read_is_told_of_in_the_headset() {
    let lab = RuntimeSlot::enter();
    let broken = ViewedScans::get().file("broken.las");
    std::fs::write(&broken, b"LASF and nothing else").expect("a file");
    let runtime = lab.runtime().compositor(Compositor::Xcb).validate().timeout_s(120);
    let broken = broken.to_str().expect("a UTF-8 path");
    let args = ["view", broken, "--headset", "require", "--window", "off", "-v"];
    let run = runtime.start(Path::new(PROGRAM), &args);
    run.wait_until_said("headset session: FOCUSED", 1);
    let eyes = wait_for("the heading in both eyes", || {
        let screen = run.screen();
        let eyes = [0, EYE_PX].map(|x| screen.columns(x, EYE_PX));
        eyes.iter().all(|eye| num_of_heading(eye) > 200).then_some(eyes)
    });
    for (eye, name) in eyes.iter().zip(["left", "right"]) {
        eye.keep(&format!("card-failed-{name}"));
    }
    // Without a window nobody can close the card: the walk ends by itself.
    let done = run.finish();
    assert_eq!(done.code, Some(1), "{}", done.stderr);
    assert!(done.stderr.contains("broken.las: ends at byte"), "{}", done.stderr);
    done.assert_valid();
}

//! The compositor shows what was submitted, each eye on its own side.

use crate::probe::Job;
use kit::picture::Picture;
use kit::wait::retry;
use kit::xr::poses::Packet;
use kit::xr::{Compositor, RuntimeSlot};

/// Pixels of an eye on the virtual screen, which shows both side by side.
const EYE: [usize; 2] = [960, 1080];

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn the_screen_shows_each_eyes_image_bit_for_bit() {
    let lab = RuntimeSlot::enter();
    let runtime = lab.runtime().compositor(Compositor::Xcb).validate();
    let mut run = Job { dump_frame: 30, exit_after: 150, ..Job::default() }.start(&runtime);
    run.remote().send(&Packet::default());
    run.wait_for("picture", |line| line.contains("dumped").then_some(()));
    let read = |name: &str| std::fs::read(run.folder().join(name)).unwrap();
    let left = Picture::from_rgba(EYE, &read("left.rgba"));
    let right = Picture::from_rgba(EYE, &read("right.rgba"));

    // The screen lags a few frames behind.
    let shown = retry(30.0, || {
        let shown = run.screen();
        assert_eq!([shown.width, shown.height], [1920, 1080]);
        let differences =
            [left.differences(&shown.columns(0, 960)), right.differences(&shown.columns(960, 960))];
        if differences == [(0, None), (0, None)] { Ok(()) } else { Err(differences) }
    });
    assert_eq!(shown, Ok(()));

    let done = run.finish();
    done.assert_ok();
    done.assert_valid();
    for (image, bright, dark) in [(&left, 0, 1), (&right, 1, 0)] {
        assert_eq!(image.at(0, 0), [255; 3], "the marked corner is top left");
        for (x, y) in [(959, 0), (0, 1079), (959, 1079), (480, 540)] {
            let pixel = image.at(x, y);
            assert!(pixel[bright] > 180 && pixel[dark] < 140, "{x}, {y}: {pixel:?}");
        }
    }
    // The comparison can fail: the eyes' images are not interchangeable.
    let (count, first) = left.differences(&right);
    assert!(count > EYE[0] * EYE[1] * 9 / 10 && first.is_some(), "{count}");
}

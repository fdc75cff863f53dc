//! The compositor shows what was submitted, each eye on its own side.

use crate::probe::Job;
use kit::xr::poses::Packet;
use kit::xr::screen::{Difference, Image};
use kit::xr::{Compositor, RuntimeSlot};
use std::time::{Duration, Instant};

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
    let left = Image::from_rgba(EYE, &read("left.rgba"));
    let right = Image::from_rgba(EYE, &read("right.rgba"));

    // The screen lags a few frames behind.
    let until = Instant::now() + Duration::from_secs(5);
    let differences = loop {
        let shown = run.screen();
        assert_eq!(shown.size, [1920, 1080]);
        let differences =
            [left.differences(&shown.columns(0, 960)), right.differences(&shown.columns(960, 960))];
        if differences.iter().all(|(count, _)| *count == 0) || Instant::now() > until {
            break differences;
        }
        std::thread::sleep(Duration::from_millis(50));
    };
    assert_eq!(differences, [(0, None), (0, None)]);

    let done = run.finish();
    done.assert_ok();
    done.assert_valid();
    for (image, bright, dark) in [(&left, 0, 1), (&right, 1, 0)] {
        assert_eq!(image.pixel(0, 0), [255; 3], "the marked corner is top left");
        for (x, y) in [(959, 0), (0, 1079), (959, 1079), (480, 540)] {
            let pixel = image.pixel(x, y);
            assert!(pixel[bright] > 180 && pixel[dark] < 140, "{x}, {y}: {pixel:?}");
        }
    }
    // The comparison can fail: the eyes' images are not interchangeable.
    let (count, first) = left.differences(&right);
    assert!(count > EYE[0] * EYE[1] * 9 / 10 && first.is_some(), "{count}");
}

#[test]
fn a_single_changed_bit_is_found() {
    let image = Image::from_rgba([3, 2], &[7; 24]);
    assert_eq!(image.differences(&image), (0, None));
    let mut changed = image.clone();
    changed.pixels[4][1] ^= 1;
    assert_eq!(
        image.differences(&changed),
        (1, Some(Difference { at: [1, 1], here: [7, 7, 7], there: [7, 6, 7] }))
    );
}

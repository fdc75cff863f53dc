//! `view` with a window: the scan and the panel are in it, keys move the viewer, and it mirrors a headset.

use crate::PROGRAM;
use crate::scene::{ViewedScans, num_whole};
use kit::picture::Picture;
use kit::program::{self, Program};
use kit::screen::Screen;
use kit::wait::wait_for;
use kit::xr::RuntimeSlot;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Returns the program's window on a screen, once it is there and has the keyboard.
fn window(screen: &Screen) -> String {
    let window = screen.wait_for_window("scanwalk");
    screen.xdotool(&["windowfocus", "--sync", &window]);
    window
}

/// Number of pixels right of the panel that show a point: neither background nor the window's own gray.
fn lit(picture: &Picture) -> usize {
    let pixels = picture.pixels.iter().enumerate().filter(|(i, _)| i % picture.width > picture.width / 2);
    pixels.filter(|(_, [r, g, b])| r.abs_diff(*b) > 12 || g.abs_diff(*b) > 12).count()
}

fn wait_lit(screen: &Screen, window: &str) -> Picture {
    wait_for("the scan in the window", || {
        let picture = screen.picture(window);
        (lit(&picture) > 2000).then_some(picture)
    })
}

/// Returns the window's picture once further frames of the whole scan show nothing else.
fn still(screen: &Screen, window: &str, log: &Path) -> Picture {
    let further = |before| {
        // The frame that has just ended may not be in the window yet.
        wait_for("further frames", || (num_whole(log) >= before + 3).then_some(()));
        (num_whole(log), screen.picture(window))
    };
    let (mut num_before, mut before) = further(0);
    wait_for("a picture that stays", || {
        let (num_now, now) = further(num_before);
        let stays = now == before;
        (num_before, before) = (num_now, now);
        stays.then(|| before.clone())
    })
}

#[test]
fn the_window_shows_the_scan_and_the_panel_and_follows_the_keys() {
    let screen = Screen::start();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let viewer = start(&screen, folder.path());
    let window = window(&screen);
    let start = wait_lit(&screen, &window);
    start.keep("view-start");

    // The panel comes and goes with its key.
    screen.xdotool(&["key", "Tab"]);
    let panel = |picture: &Picture| {
        let differing = picture.pixels.iter().zip(&start.pixels).enumerate();
        differing.filter(|(i, (a, b))| i % start.width < 250 && a != b).count()
    };
    let without = wait_for("the panel to go", || {
        let picture = screen.picture(&window);
        (panel(&picture) > 20_000).then_some(picture)
    });
    // Walking changes what is seen.
    screen.xdotool(&["keydown", "w"]);
    wait_for("another view", || {
        let picture = screen.picture(&window);
        (picture.num_different(&without) > without.pixels.len() / 20).then_some(())
    });
    screen.xdotool(&["keyup", "w"]);
    // The scan fills the window again in another size and shape.
    screen.xdotool(&["windowsize", "--sync", &window, "900", "411"]);
    let small = wait_for("the new size", || {
        let picture = screen.picture(&window);
        ((picture.width, picture.height) == (900, 411) && lit(&picture) > 1000).then_some(picture)
    });
    small.keep("view-resized");
    screen.ask_to_close(&window);
    viewer.end().ok();
}

/// Starts the program on the courtyard with small eyes; its screenshots come into `folder`.
fn start(screen: &Screen, folder: &Path) -> Program {
    Program::start(&mut command(screen, folder, &ViewedScans::get().courtyard, "on"))
}

fn command(screen: &Screen, folder: &Path, scan: &Path, when: &str) -> Command {
    let mut command = program::command(PROGRAM);
    command
        .arg("view")
        .arg(scan)
        .args(["--headset", "off", "--window", when, "--set", "simulated.size_px=[320,360]"])
        // The governor gives up the quality that counts points where the GPU is slow.
        .args(["--set", "governor.enabled=false"])
        .current_dir(folder)
        .env("DISPLAY", &screen.display)
        .env("XDG_STATE_HOME", folder);
    command
}

/// A session that has ended, or a container, leaves names in the environment where nothing answers.
#[test]
fn a_stale_wayland_display_beside_x11_opens_the_window_there() {
    let screen = Screen::start();
    let folder = tempfile::tempdir().expect("a temporary folder");
    drop(std::os::unix::net::UnixListener::bind(folder.path().join("wayland-dead")).expect("a socket"));
    for (when, name, runtime_dir) in [
        ("on", "wayland-dead", Some(folder.path())),
        ("auto", "wayland-none", Some(folder.path())),
        ("on", "wayland-none", None),
    ] {
        let mut command = command(&screen, folder.path(), &ViewedScans::get().courtyard, when);
        command.env("WAYLAND_DISPLAY", name).env_remove("XDG_RUNTIME_DIR");
        command.envs(runtime_dir.map(|folder| ("XDG_RUNTIME_DIR", folder)));
        let viewer = Program::start(&mut command);
        let window = window(&screen);
        wait_lit(&screen, &window);
        screen.ask_to_close(&window);
        let output = viewer.end().ok();
        assert_eq!(output.for_good(), "", "--window {when}, {name}");
    }
}

/// The reason why there is no scan is to be read: the window stays until it is closed, or the program is asked to
/// end. A user who set a limit, or has no window, is not waited for.
#[test]
fn a_failure_to_load_stays_in_the_window_until_that_is_closed() {
    let screen = Screen::start();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let broken = folder.path().join("broken.las");
    std::fs::write(&broken, [b"LASF".as_slice(), &[0; 96]].concat()).expect("a file");
    let start = |when, limit: &[&str]| {
        let mut command = command(&screen, folder.path(), &broken, when);
        Program::start(command.args(limit))
    };
    let assert_failed = |viewer: Program| {
        let output = viewer.end();
        let said = output.for_good();
        assert!(said.lines().last().is_some_and(|reason| reason.contains("broken.las")), "{said}");
        assert_eq!(output.code, Some(1));
    };
    // The card's heading has a color that nothing else has.
    let written = |picture: &Picture| {
        let red = |[r, g, b]: [u8; 3]| r > 200 && g.abs_diff(110) < 30 && b.abs_diff(96) < 30;
        picture.pixels.iter().filter(|pixel| red(**pixel)).count()
    };
    for close in [true, false] {
        let mut viewer = start("on", &[]);
        let window = window(&screen);
        let card = wait_for("the reason", || {
            let picture = screen.picture(&window);
            (written(&picture) > 100).then_some(picture)
        });
        card.keep("view-failed");
        assert!(viewer.is_running(), "it stays");
        if close {
            screen.ask_to_close(&window);
        } else {
            viewer.interrupt();
        }
        assert_failed(viewer);
    }
    assert_failed(start("on", &["--frames", "3"]));
    assert_failed(start("off", &[]));
}

/// Pictures that have been written so far, by what follows the date in their names.
fn screenshots(folder: &Path) -> BTreeMap<String, PathBuf> {
    let paths = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let names = paths.filter_map(|path| {
        let name = path.file_name()?.to_str()?.strip_prefix("scanwalk-")?;
        Some((name.split_once('.')?.1.to_string(), path.clone()))
    });
    names.collect()
}

#[test]
fn overlays_are_shown_in_the_window_and_saved_beside_the_eyes_images() {
    let screen = Screen::start();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let log = folder.path().join("frames.csv");
    let mut command = command(&screen, folder.path(), &ViewedScans::get().courtyard, "on");
    command.arg("--log").arg(&log);
    // Eyes are smaller still: the notice is there for some seconds alone, in which the window has to come to draw it.
    command.args(["--set", "simulated.size_px=[160,180]"]);
    let viewer = Program::start(&mut command);
    let window = window(&screen);
    wait_lit(&screen, &window);
    // The picture is without the panel, which changes by itself, and is taken once the octree is there.
    screen.xdotool(&["key", "Tab"]);
    let plain = still(&screen, &window, &log);
    let mut before = plain.clone();
    for name in ["rings", "nodes", "overdraw", "depth", "precision"] {
        screen.xdotool(&["key", "o"]);
        let with = wait_for(name, || {
            let picture = screen.picture(&window);
            [&plain, &before].iter().all(|other| picture.num_different(other) > 2000).then_some(picture)
        });
        with.keep(&format!("overlay-{name}"));
        before = with;
    }
    // The fifth overlay is on: there are four pictures, of which two are what the headset gets.
    screen.xdotool(&["key", "F12"]);
    let names = ["left.png", "left.precision.png", "right.png", "right.precision.png"];
    // The notice of them goes by itself after some seconds.
    let mut is_told = false;
    let pictures = wait_for("four pictures and the notice", || {
        let shown = screen.picture(&window);
        if !is_told && shown.num_different(&before) > 1000 {
            shown.keep("screenshot-notice");
            is_told = true;
        }
        let paths = screenshots(folder.path());
        // A picture is not whole while it is being written.
        let pictures: Option<Vec<_>> =
            names.iter().map(|&name| Picture::read(paths.get(name)?).ok()).collect();
        pictures.filter(|_| is_told)
    });
    assert!(pictures.iter().all(|picture| [picture.width, picture.height] == [160, 180]));
    for pair in pictures.chunks_exact(2) {
        let [plain, with] = [0, 1].map(|at| pair[at].pixels.as_flattened());
        let differing = plain.iter().zip(with).filter(|(a, b)| a != b).count();
        assert!((100..plain.len() / 2).contains(&differing), "{differing} differ");
    }
    // No overlay follows the last.
    screen.xdotool(&["key", "o"]);
    wait_for("no overlay", || (screen.picture(&window).num_different(&plain) < 200).then_some(()));
    screen.ask_to_close(&window);
    viewer.end().ok();
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn the_window_mirrors_the_headset_and_validation_is_silent() {
    let lab = RuntimeSlot::enter();
    let screen = Screen::start();
    let courtyard = ViewedScans::get().courtyard.to_str().expect("a UTF-8 path");
    let runtime = lab.runtime().validate().variable("DISPLAY", screen.display.clone()).timeout_s(120);
    for overlay in ["none", "nodes", "overdraw"] {
        let overlay_set = format!("window.overlay={overlay}");
        let args = ["view", courtyard, "--headset", "require", "--window", "on", "--frames", "100"];
        let sets = ["--set", &overlay_set, "--set", "governor.enabled=false", "--set", "window.recent=false"];
        let args = [&args[..], &sets].concat();
        let run = runtime.start(Path::new(PROGRAM), &args);
        let window = window(&screen);
        wait_lit(&screen, &window).keep(&format!("view-mirror-{overlay}"));
        let done = run.finish();
        done.assert_ok();
        done.assert_valid();
    }
}

//! With a window: the scan and the panel are in it, keys move the viewer, and it mirrors a headset.

use crate::scene::Scene;
use crate::screen::{Picture, Screen, wait_for};
use crate::xr_support::Lab;
use std::path::Path;
use std::process::{Child, Command, Stdio};

const PROGRAM: &str = env!("CARGO_BIN_EXE_scanwalk");

/// The program's window on a screen, once it is there and has the keyboard.
fn window(screen: &Screen) -> String {
    let window = wait_for("the window", 30.0, || {
        let found = screen.try_xdotool(&["search", "--onlyvisible", "--name", "scanwalk"])?;
        found.lines().next().map(str::to_string)
    });
    screen.xdotool(&["windowfocus", "--sync", &window]);
    window
}

/// Pixels right of the panel that show a point: neither background nor the window's own grey.
fn lit(picture: &Picture) -> usize {
    let pixels = picture.pixels.iter().enumerate().filter(|(i, _)| i % picture.width > picture.width / 2);
    pixels.filter(|(_, [r, g, b])| r.abs_diff(*b) > 12 || g.abs_diff(*b) > 12).count()
}

fn wait_lit(screen: &Screen, window: &str) -> Picture {
    wait_for("the scan in the window", 60.0, || {
        let picture = screen.picture(window);
        (lit(&picture) > 2000).then_some(picture)
    })
}

/// Ends the program if the test fails.
struct Viewer(Child);

impl Drop for Viewer {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn the_window_shows_the_scan_and_the_panel_and_follows_the_keys() {
    let screen = Screen::start();
    let child = Command::new(PROGRAM)
        .arg("view")
        .arg(&Scene::get().courtyard)
        .args(["--headset", "off", "--window", "on", "--set", "simulated.size_px=[320,360]"])
        .env("DISPLAY", &screen.display)
        .env_remove("WAYLAND_DISPLAY")
        .stderr(Stdio::null())
        .spawn()
        .expect("view starts");
    let mut viewer = Viewer(child);
    let window = window(&screen);
    let start = wait_lit(&screen, &window);
    start.keep("view-start");

    // The panel comes and goes with its key.
    screen.xdotool(&["key", "Tab"]);
    let panel = |picture: &Picture| {
        let differing = picture.pixels.iter().zip(&start.pixels).enumerate();
        differing.filter(|(i, (a, b))| i % start.width < 250 && a != b).count()
    };
    let without = wait_for("the panel to go", 10.0, || {
        let picture = screen.picture(&window);
        (panel(&picture) > 20_000).then_some(picture)
    });
    // Walking changes what is seen.
    screen.xdotool(&["keydown", "w"]);
    wait_for("another view", 20.0, || {
        let picture = screen.picture(&window);
        (picture.num_different(&without) > without.pixels.len() / 20).then_some(())
    });
    screen.xdotool(&["keyup", "w"]);
    // Another size, another shape: the scan fills it again.
    screen.xdotool(&["windowsize", "--sync", &window, "900", "411"]);
    let small = wait_for("the new size", 20.0, || {
        let picture = screen.picture(&window);
        ((picture.width, picture.height) == (900, 411) && lit(&picture) > 1000).then_some(picture)
    });
    small.keep("view-resized");
    screen.ask_to_close(&window);
    let status = wait_for("the end", 20.0, || viewer.0.try_wait().expect("a child of ours"));
    assert_eq!(status.code(), Some(0));
}

#[test]
fn the_window_mirrors_the_headset_and_validation_is_silent() {
    let Some(lab) = Lab::enter() else { return };
    let screen = Screen::start();
    let courtyard = Scene::get().courtyard.to_str().expect("a UTF-8 path");
    let runtime = lab.runtime().validate().variable("DISPLAY", screen.display.clone()).timeout_s(120);
    let args = ["view", courtyard, "--headset", "require", "--window", "on", "--frames", "150"];
    let run = runtime.start(Path::new(PROGRAM), &args);
    let window = window(&screen);
    wait_lit(&screen, &window).keep("view-mirror");
    let done = run.finish();
    done.assert_ok();
    done.assert_valid();
}

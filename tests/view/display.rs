//! Display servers that keep silent, as a session that hangs does: it takes connections and says nothing.

use crate::PROGRAM;
use crate::scene::ViewedScans;
use kit::program::{self, Program};
use kit::screen::Screen;
use kit::wait::wait_for;
use std::os::unix::net::UnixListener;
use std::path::Path;

/// Starts the program with `args` in a folder that holds a silent compositor's socket, and on an X server, if there
/// is one.
fn start(folder: &Path, args: &[&str], display: Option<&str>) -> Program {
    let mut command = program::command(PROGRAM);
    command.args(args).current_dir(folder).env("WAYLAND_DISPLAY", "wayland-0").env("XDG_RUNTIME_DIR", folder);
    command.env("XDG_STATE_HOME", folder);
    command.envs(display.map(|name| ("DISPLAY", name)));
    Program::start(&mut command)
}

/// Nobody waits for a silent compositor: neither the window nor a library that looks for GPUs or a clipboard, and
/// least of all a user who asks the program to end.
#[test]
fn a_compositor_that_keeps_silent_is_given_up() {
    let screen = Screen::start();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let silent = UnixListener::bind(folder.path().join("wayland-0")).expect("a socket");
    let scan = ViewedScans::get().courtyard.to_str().expect("a UTF-8 path").to_owned();
    let view = ["view", &scan, "--headset", "off", "--window", "on", "--set", "simulated.size_px=[320,360]"];

    let run = start(folder.path(), &view, Some(&screen.display));
    let window = screen.wait_for_window("scanwalk");
    wait_for("something in it", || {
        let picture = screen.picture(&window);
        picture.pixels.iter().any(|pixel| *pixel != picture.pixels[0]).then_some(())
    });
    screen.ask_to_close(&window);
    assert_eq!(run.end().ok().for_good(), "");

    let output = start(folder.path(), &view, None).end();
    let said = output.for_good();
    assert!(output.code == Some(1) && said.lines().count() == 1, "{said}");
    assert!(said.contains("wayland-0, where a compositor listens, but does not answer"), "{said}");

    // The program is asked to end while it waits for the compositor; by itself it would end with a failure.
    silent.set_nonblocking(true).expect("a socket's option");
    while silent.accept().is_ok() {}
    silent.set_nonblocking(false).expect("a socket's option");
    let run = start(folder.path(), &view, None);
    let _asked = silent.accept().expect("whoever asks");
    run.interrupt();
    let said = run.end().ok().err;
    assert!(said.contains("stopping"), "{said}");

    let render = ["render", &scan, "-o", "picture.png", "--size", "64x48"];
    assert_eq!(start(folder.path(), &render, None).end().ok().for_good(), "");
}

/// winit's words about an X server that is not there begin with a place in its source.
#[test]
fn a_display_that_is_not_there_is_told_of_in_words() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut command = program::command(PROGRAM);
    command.args(["view", "a.las", "--headset", "off", "--window", "on"]).current_dir(folder.path());
    let output = program::run(command.env("DISPLAY", ":98765"));
    let said = output.err;
    assert_eq!(output.code, Some(1), "{said}");
    assert!(said.contains("no window can be opened") && said.contains("--window off"), "{said}");
    assert!(!said.contains(".rs") && !said.contains("registry"), "{said}");
}

//! A virtual screen: Xvfb on a free display, its pixels, and xdotool for hands.

use crate::picture::Picture;
use crate::wait::wait_for;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use x11rb::protocol::xproto::{ClientMessageEvent, ConnectionExt as _, EventMask, InputFocus};

/// A screen of 1600 × 1000 pixels; it is gone when dropped.
pub struct Screen {
    server: Child,
    /// Name of the display, such as ":99".
    pub display: String,
    folder: tempfile::TempDir,
}

/// Place and size of a window on the screen. It has no decorations, since there is no window manager.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WindowArea {
    pub x: usize,
    pub y: usize,
    pub width: usize,
    pub height: usize,
}

impl Screen {
    pub fn start() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let mut server = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-screen",
                "0",
                "1600x1000x24",
                "-nolisten",
                "tcp",
                "-noreset",
                "-fbdir",
            ])
            .arg(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap_or_else(|e| panic!("Xvfb cannot be started ({e}): apt install xvfb"));
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        let display = format!(":{}", number.trim());
        assert!(display.len() > 1, "Xvfb found no free display");
        Self { server, display, folder }
    }

    /// Runs xdotool and returns what it prints; `None` if it fails (as for a window that is not there yet).
    pub fn try_xdotool(&self, arguments: &[&str]) -> Option<String> {
        let output = Command::new("xdotool")
            .args(arguments)
            .env("DISPLAY", &self.display)
            .output()
            .unwrap_or_else(|e| panic!("xdotool cannot be started ({e}): apt install xdotool"));
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_string())
    }

    pub fn xdotool(&self, arguments: &[&str]) -> String {
        self.try_xdotool(arguments).unwrap_or_else(|| panic!("xdotool {arguments:?} failed"))
    }

    /// X11's number of the window whose title matches, once it is there.
    pub fn wait_for_window(&self, title: &str) -> String {
        wait_for("the window", || {
            let found = self.try_xdotool(&["search", "--onlyvisible", "--name", title])?;
            found.lines().next().map(str::to_string)
        })
    }

    pub fn geometry(&self, window: &str) -> WindowArea {
        let text = self.xdotool(&["getwindowgeometry", "--shell", window]);
        let value = |name: &str| {
            let line = text.lines().find_map(|l| l.strip_prefix(name)?.strip_prefix('='));
            line.and_then(|v| v.parse().ok()).unwrap_or_else(|| panic!("{name} in {text}"))
        };
        WindowArea { x: value("X"), y: value("Y"), width: value("WIDTH"), height: value("HEIGHT") }
    }

    /// Asks a window to close as a desktop's close button does.
    pub fn ask_to_close(&self, window: &str) {
        let (connection, _) = x11rb::connect(Some(&self.display)).unwrap();
        let atom = |name: &[u8]| connection.intern_atom(false, name).unwrap().reply().unwrap().atom;
        let (protocols, delete) = (atom(b"WM_PROTOCOLS"), atom(b"WM_DELETE_WINDOW"));
        let window = window.parse().unwrap();
        let message = ClientMessageEvent::new(32, window, protocols, [delete, 0, 0, 0, 0]);
        connection.send_event(false, window, EventMask::NO_EVENT, message).unwrap().check().unwrap();
    }

    /// Takes the keyboard away from every window.
    pub fn take_keyboard(&self) {
        let (connection, _) = x11rb::connect(Some(&self.display)).unwrap();
        let nobody = x11rb::NONE;
        connection.set_input_focus(InputFocus::NONE, nobody, x11rb::CURRENT_TIME).unwrap().check().unwrap();
    }

    /// The pixels of a window.
    pub fn picture(&self, window: &str) -> Picture {
        let g = self.geometry(window);
        let screen = crate::xwd::read(&self.folder.path().join("Xvfb_screen0")).unwrap();
        screen.part([g.x, g.y], [g.width, g.height])
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

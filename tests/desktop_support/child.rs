//! The window's program as a child process, its lines, and the validation layer that watches it.

use kit::picture::{Picture, Rgb};
use kit::program::{Program, command, this_program};
use kit::screen::Screen;
use kit::wait::{LONGEST_S, retry, wait_for};
use std::path::PathBuf;
use std::process::Command;

/// The environment variable that makes this test program the window's program, and says its role.
pub const ROLE: &str = "SCANWALK_DESKTOP_TEST_ROLE";

/// A running child, which is killed when dropped.
pub struct ChildWindow<'a> {
    program: Program,
    screen: Option<&'a Screen>,
    /// X11's number of the window.
    pub id: String,
    validation: Validation,
}

/// The folder that the validation layer writes to.
struct Validation {
    folder: tempfile::TempDir,
}

impl Validation {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let settings = format!(
            "khronos_validation.debug_action = VK_DBG_LAYER_ACTION_LOG_MSG\n\
             khronos_validation.report_flags = error,warn\n\
             khronos_validation.enables = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT\n\
             khronos_validation.log_filename = {}\n",
            folder.path().join("log").display()
        );
        std::fs::write(folder.path().join("vk_layer_settings.txt"), settings).unwrap();
        Self { folder }
    }

    fn watch(&self, command: &mut Command) {
        command
            .env("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation")
            .env("VK_LAYER_SETTINGS_PATH", self.folder.path())
            // Mesa prints an error where this variable is not set.
            .env("XDG_RUNTIME_DIR", self.folder.path())
            .env("VK_LAYER_ENABLES", "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT")
            // wgpu's own messenger would take the messages away from the layer's log.
            .env("WGPU_VALIDATION", "0")
            // Debug shaders name WGSL as their source language, which older layers take for an error.
            .env("WGPU_DEBUG", "0");
    }

    fn log(&self) -> String {
        let path: PathBuf = self.folder.path().join("log");
        std::fs::read_to_string(path).unwrap_or_default()
    }
}

/// Starts the child in `role`, on `screen` or on none.
fn spawn<'a>(role: &str, screen: Option<&'a Screen>) -> ChildWindow<'a> {
    let validation = Validation::new();
    let mut command = command(this_program());
    command.env(ROLE, role);
    if let Some(screen) = screen {
        command.env("DISPLAY", &screen.display);
    }
    validation.watch(&mut command);
    ChildWindow { program: Program::start(&mut command), screen, id: String::new(), validation }
}

impl<'a> ChildWindow<'a> {
    /// Opens the window on `screen`, waits until it is drawn, gives it the keyboard.
    pub fn open(role: &str, screen: &'a Screen) -> Self {
        let mut window = spawn(role, Some(screen));
        window.id = wait_for("the window", || {
            if let Some(ended) = window.ended() {
                panic!("the window's program {ended}");
            }
            screen.try_xdotool(&["search", "--onlyvisible", "--name", "^hall.laz "])
        });
        wait_for("a first picture", || {
            let picture = window.picture();
            (picture.pixels.iter().any(|p| *p != picture.pixels[0])).then_some(())
        });
        screen.xdotool(&["windowfocus", "--sync", &window.id]);
        window
    }

    /// Runs `role` without any display (or, as "hazard", without a window).
    pub fn without_display(role: &str) -> Self {
        spawn(role, None)
    }

    fn screen(&self) -> &'a Screen {
        self.screen.expect("a child with a screen")
    }

    pub fn xdotool(&self, arguments: &[&str]) {
        self.screen().xdotool(arguments);
    }

    /// Lets the event of the child's role happen.
    pub fn cue(&self) {
        self.xdotool(&["key", "Home"]);
    }

    pub fn ask_to_close(&self) {
        self.screen().ask_to_close(&self.id);
    }

    pub fn picture(&self) -> Picture {
        self.screen().picture(&self.id)
    }

    /// Commands that the stand-in has printed so far.
    pub fn commands(&self) -> Vec<String> {
        let printed = self.program.printed();
        printed.lines().filter_map(|line| line.strip_prefix("command ")).map(str::to_owned).collect()
    }

    /// Waits for a command that comes after the first `already` commands.
    pub fn wait_command(&self, wanted: &str, already: usize) {
        wait_for(wanted, || {
            let commands = self.commands();
            commands[already.min(commands.len())..].iter().any(|c| c == wanted).then_some(())
        });
    }

    /// Waits until a pixel has its color.
    pub fn wait_pixel(&self, x: usize, y: usize, wanted: Rgb) {
        let seen = retry(LONGEST_S, || {
            let picture = self.picture();
            let is_inside = x < picture.width && y < picture.height;
            match is_inside.then(|| picture.at(x, y)) {
                Some(color) if color == wanted => Ok(()),
                other => Err(other),
            }
        });
        if let Err(seen) = seen {
            self.picture().keep("failed");
            panic!("pixel {x}, {y} is {seen:?}, not {wanted:?} (kept where SCANWALK_TEST_PICTURES says)");
        }
    }

    fn ended(&self) -> Option<String> {
        self.program.printed().lines().find(|line| line.starts_with("ended")).map(str::to_owned)
    }

    /// Waits until the program has ended; returns its last line and what the validation layer wrote.
    pub fn wait_end(self) -> (String, String) {
        let output = self.program.end().ok();
        let line = output.text().lines().find(|line| line.starts_with("ended")).expect("its last line");
        (line.to_owned(), self.validation.log())
    }
}

//! A run of the program, which is ended if the test fails.

use kit::wait::wait_for;
use std::io::Read;
use std::process::{Child, Command};

pub struct Program(pub Child);

impl Program {
    pub fn start(command: &mut Command) -> Self {
        Self(command.spawn().expect("the program starts"))
    }

    /// Asks the program to end, as Ctrl-C does.
    pub fn interrupt(&self) {
        let id = self.0.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().expect("kill").success());
    }

    /// Returns the exit code, and what the program said for good, if that was piped.
    pub fn end(mut self) -> (Option<i32>, String) {
        let status = wait_for("the end", 60.0, || self.0.try_wait().expect("a child of ours"));
        let mut said = String::new();
        if let Some(stderr) = &mut self.0.stderr {
            stderr.read_to_string(&mut said).expect("text");
        }
        (status.code(), for_good(&said))
    }
}

/// What the program said, without what it says on a slow machine alone: how far it is, every few seconds, and that it left
/// without waiting for a thread.
pub fn for_good(said: &str) -> String {
    let is_progress = |line: &str| !line.starts_with("scanwalk: ") && line.contains(" %, ");
    let lines = said.split_inclusive('\n');
    lines.filter(|line| !is_progress(line) && !line.starts_with("scanwalk: left without waiting")).collect()
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

//! A run of the program, which is ended if the test fails.

use kit::screen::wait_for;
use std::io::Read;
use std::process::{Child, Command};

pub struct Program(pub Child);

impl Program {
    pub fn start(command: &mut Command) -> Self {
        Self(command.spawn().expect("the program starts"))
    }

    /// Returns the exit code, and what the program said, if that was piped.
    pub fn end(mut self) -> (Option<i32>, String) {
        let status = wait_for("the end", 60.0, || self.0.try_wait().expect("a child of ours"));
        let mut said = String::new();
        if let Some(stderr) = &mut self.0.stderr {
            stderr.read_to_string(&mut said).expect("text");
        }
        (status.code(), said)
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

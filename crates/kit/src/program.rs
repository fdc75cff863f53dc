//! Runs a program beside its test: one way to start it, to hear what it says, and to wait for its end.

use crate::wait::{LONGEST_S, retry};
use std::ffi::OsStr;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};

/// A command that starts a program without input, and without what the tests' own environment says of displays and
/// logs.
pub fn command(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    command.stdin(Stdio::null());
    for name in ["RUST_LOG", "DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(name);
    }
    command
}

/// Runs a command to its end.
pub fn run(command: &mut Command) -> RunOutput {
    Program::start(command).end()
}

/// The path of the test program that asks. (`current_exe` is the loader where a program was started with one.)
pub fn this_program() -> PathBuf {
    let name = std::env::args_os().next().expect("a program's first argument is its name");
    std::fs::canonicalize(name).expect("the program's file")
}

/// Makes a named pipe in a folder.
pub fn named_pipe(folder: &Path, name: &str) -> PathBuf {
    let pipe = folder.join(name);
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    pipe
}

/// Sends a signal to a process, such as "INT"; one that has ended does not hear it.
pub fn signal(name: &str, pid: &str) {
    let _ = Command::new("kill").args(["-s", name, pid]).stderr(Stdio::null()).status();
}

/// A program that runs. It is killed when dropped.
pub struct Program {
    child: Child,
    heard: Arc<Heard>,
}

/// What a program has written so far.
#[derive(Default)]
pub struct Said {
    /// On stdout, unless that went elsewhere.
    pub out: Vec<u8>,
    /// On stderr.
    pub err: Vec<u8>,
    /// Streams on which it may write more.
    num_open: usize,
}

impl Said {
    /// All of stderr so far.
    pub fn err_text(&self) -> String {
        String::from_utf8_lossy(&self.err).into_owned()
    }
}

#[derive(Default)]
struct Heard {
    said: Mutex<Said>,
    changed: Condvar,
}

impl Heard {
    /// Reads a stream to its end on a thread of its own.
    fn listen(self: &Arc<Self>, mut stream: impl Read + Send + 'static, to: fn(&mut Said) -> &mut Vec<u8>) {
        self.said.lock().expect("no panic").num_open += 1;
        let heard = Arc::clone(self);
        std::thread::spawn(move || {
            let mut bytes = [0; 4096];
            loop {
                let num = stream.read(&mut bytes).unwrap_or(0);
                let mut said = heard.said.lock().expect("no panic");
                to(&mut said).extend(&bytes[..num]);
                said.num_open -= usize::from(num == 0);
                heard.changed.notify_all();
                if num == 0 {
                    return;
                }
            }
        });
    }
}

impl Program {
    /// Starts a command, and listens to both of its streams.
    pub fn start(command: &mut Command) -> Self {
        Self::start_into(command, Stdio::piped())
    }

    /// Starts a command whose stdout goes elsewhere.
    pub fn start_into(command: &mut Command, stdout: impl Into<Stdio>) -> Self {
        let spawned = command.stdout(stdout).stderr(Stdio::piped()).spawn();
        let mut child = spawned.unwrap_or_else(|error| panic!("{command:?} does not start: {error}"));
        let heard = Arc::<Heard>::default();
        if let Some(stdout) = child.stdout.take() {
            heard.listen(stdout, |said| &mut said.out);
        }
        if let Some(stderr) = child.stderr.take() {
            heard.listen(stderr, |said| &mut said.err);
        }
        Self { child, heard }
    }

    /// Number of the process.
    pub fn pid(&self) -> String {
        self.child.id().to_string()
    }

    /// True until the program has ended.
    pub fn is_running(&mut self) -> bool {
        self.child.try_wait().expect("a child of ours").is_none()
    }

    /// Asks the program to end, as Ctrl-C does.
    pub fn interrupt(&self) {
        signal("INT", &self.pid());
    }

    /// All that the program has said on stderr so far.
    pub fn said(&self) -> String {
        self.heard.said.lock().expect("no panic").err_text()
    }

    /// All that the program has printed on stdout so far.
    pub fn printed(&self) -> String {
        String::from_utf8_lossy(&self.heard.said.lock().expect("no panic").out).into_owned()
    }

    /// Looks at what the program says until something is found; `None` if it is silent for good, or after `seconds`.
    pub fn find<T>(&self, seconds: f64, mut found: impl FnMut(&Said) -> Option<T>) -> Option<T> {
        let until = Instant::now() + Duration::from_secs_f64(seconds);
        let mut said = self.heard.said.lock().expect("no panic");
        loop {
            let left = until.saturating_duration_since(Instant::now());
            let value = found(&said);
            if value.is_some() || said.num_open == 0 || left.is_zero() {
                return value;
            }
            said = self.heard.changed.wait_timeout(said, left).expect("no panic").0;
        }
    }

    /// Waits until the program has said on stderr, `times` times by now, something that contains `words`.
    ///
    /// # Panics
    /// If it does not.
    pub fn wait_until_said(&self, words: &str, times: usize) {
        let is_said = |said: &Said| (said.err_text().matches(words).count() >= times).then_some(());
        if self.find(LONGEST_S, is_said).is_none() {
            panic!("'{words}' was not said {times} times:\n{}", self.said());
        }
    }

    /// Waits for the program's end, so that it is no longer there afterwards.
    pub fn end(mut self) -> RunOutput {
        self.end_within(LONGEST_S)
    }

    /// Waits for the program's end, for so many seconds at most. One that is late is ended when this is dropped.
    pub fn end_within(&mut self, seconds: f64) -> RunOutput {
        let until = Instant::now() + Duration::from_secs_f64(seconds);
        self.find(seconds, |_| None::<()>);
        let left = until.saturating_duration_since(Instant::now());
        let ended = retry(left.as_secs_f64(), || self.child.try_wait().expect("a child of ours").ok_or(()));
        let said = std::mem::take(&mut *self.heard.said.lock().expect("no panic"));
        let mut err = said.err_text();
        if ended.is_err() {
            err += &format!("(the test waited {seconds} s for its end)\n");
        }
        RunOutput { code: ended.ok().and_then(|status| status.code()), out: said.out, err }
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// What came of a run.
pub struct RunOutput {
    /// Exit code; none if a signal ended the program, or the test did.
    pub code: Option<i32>,
    /// What it wrote on stdout.
    pub out: Vec<u8>,
    /// What it wrote on stderr.
    pub err: String,
}

impl RunOutput {
    /// Its stdout, which must be text.
    pub fn text(&self) -> &str {
        std::str::from_utf8(&self.out).expect("text")
    }

    /// Its stdout, which must be JSON.
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.out).unwrap_or_else(|error| panic!("{error}: {}", self.err))
    }

    /// What it said for good: stderr without what is said on a slow machine alone, how far long work is, every few
    /// seconds, and that a thread was not waited for.
    pub fn for_good(&self) -> String {
        let is_progress = |line: &str| !line.starts_with("scanwalk: ") && line.contains(" %, ");
        let lines = self.err.split_inclusive('\n');
        lines
            .filter(|line| !is_progress(line) && !line.starts_with("scanwalk: left without waiting"))
            .collect()
    }

    /// True if a line on stderr holds all of these words, in any case.
    pub fn says(&self, words: &[&str]) -> bool {
        let mut lines = self.err.lines().map(str::to_lowercase);
        lines.any(|line| words.iter().all(|word| line.contains(&word.to_lowercase())))
    }

    /// The outcome in a line.
    pub fn in_words(&self) -> String {
        let code = self.code.map_or("none".to_owned(), |code| code.to_string());
        let words = self.err.trim().replace('\n', " | ");
        format!("exit {code}: {}", if words.is_empty() { "no word" } else { &words })
    }

    /// Itself.
    ///
    /// # Panics
    /// If the program failed, with what it said.
    pub fn ok(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.err);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell(line: &str) -> Command {
        let mut command = command("sh");
        command.args(["-c", line]);
        command
    }

    #[test]
    fn a_run_tells_its_code_and_both_streams() {
        let output = run(&mut shell("echo out; echo err >&2; exit 3"));
        assert_eq!((output.code, output.text(), &*output.err), (Some(3), "out\n", "err\n"));
        assert!(!run(&mut shell("env")).text().contains("RUST_LOG="));
    }

    /// A program that hangs is ended, and fails its test.
    #[test]
    fn a_program_that_hangs_is_ended() {
        let output = Program::start(&mut shell("echo begun >&2; exec sleep 1000")).end_within(0.1);
        assert!(output.code.is_none() && output.err.contains("the test waited"), "{}", output.err);
    }

    #[test]
    fn words_are_found_as_they_come_and_not_after_the_end() {
        let mut program = Program::start(&mut shell("echo one >&2; exec sleep 1000"));
        program.wait_until_said("one", 1);
        assert!(program.is_running());
        program.interrupt();
        let program = Program::start(&mut shell("exit 0"));
        assert_eq!(program.find(LONGEST_S, |said| (!said.err.is_empty()).then_some(())), None);
    }
}

//! Runs programs against a real OpenXR runtime without a headset (`scripts/headless-runtime`), steers its
//! device and reads what its compositor shows.
//!
//! ```text
//! let slot = RuntimeSlot::enter();
//! let mut run = slot.runtime().compositor(Compositor::Xcb).validate().start(program, &["view", …]);
//! run.remote().send(&Packet::default());
//! let shown = run.screen();
//! let done = run.finish();
//! ```

pub mod poses;

use crate::picture::Picture;
use crate::program::{self, Program, signal};
use crate::wait::{LONGEST_S, retry};
use std::fs::{self, File, TryLockError};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Folder of the checkout.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A folder that outlives a run of the tests.
fn target_tmp() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let folder = target.join("tmp");
    std::fs::create_dir_all(&folder).expect("a folder in target");
    folder
}

fn script() -> PathBuf {
    root().join("scripts/headless-runtime")
}

/// Runtimes that a machine runs at a time. They share its cores and want a steady beat, but wait for it most of the
/// time.
const PLACES: usize = 2;

/// Seconds that a test may wait for its turn: as long as all tests of a program take.
const QUEUE_S: f64 = 3600.0;

/// The right to run a runtime, of which a machine runs few at a time.
pub struct RuntimeSlot {
    _place: File,
}

impl RuntimeSlot {
    /// Prepares the runtime and waits for its turn.
    ///
    /// # Panics
    /// If it cannot be had here: tests that need it are ignored unless the feature `with-runtime` says that it can.
    pub fn enter() -> Self {
        prepare();
        let folder = target_tmp();
        let place = |number| File::create(folder.join(format!("xr-{number}.lock"))).expect("target/tmp");
        let is_free = |place: &File| match place.try_lock() {
            Ok(()) => true,
            Err(TryLockError::WouldBlock) => false,
            Err(TryLockError::Error(error)) => panic!("a lock file cannot be locked: {error}"),
        };
        // Those before it may have long tests.
        let turn = retry(QUEUE_S, || (0..PLACES).map(place).find(is_free).ok_or(()));
        Self { _place: turn.expect("a turn") }
    }

    /// A runtime that shows nothing, with the remote device.
    pub fn runtime(&self) -> TestRuntime {
        TestRuntime::default()
    }
}

/// Prepares the runtime, once.
fn prepare() {
    static PREPARED: OnceLock<Result<(), String>> = OnceLock::new();
    let prepared = PREPARED.get_or_init(|| {
        let output = Command::new(script()).arg("prepare").output().map_err(|e| e.to_string())?;
        let said = String::from_utf8_lossy(&output.stderr).trim().to_string();
        if output.status.success() { Ok(()) } else { Err(said) }
    });
    if let Err(reason) = prepared {
        panic!("no OpenXR runtime: {reason}");
    }
}

/// Where the compositor shows its images.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Compositor {
    /// Nowhere; 320 × 240 pixels an eye, 20 Hz.
    Null,
    /// On a virtual screen of 1920 × 1080 pixels: 960 × 1080 an eye, unscaled and undistorted.
    Xcb,
    /// There is no compositor, and no runtime.
    None,
}

/// The device that plays the headset.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum HeadsetDevice {
    /// Poses and buttons as sent by [`poses::Remote`].
    Remote,
    /// A head that sways by 5 cm, no hands.
    Simulated,
}

/// How to run a program.
#[derive(Clone)]
pub struct TestRuntime {
    variables: Vec<(String, String)>,
    timeout_s: u32,
    validate: bool,
}

impl Default for TestRuntime {
    fn default() -> Self {
        Self { variables: Vec::new(), timeout_s: 60, validate: false }
    }
}

impl TestRuntime {
    /// The runtime's Vulkan driver and layers alone, for programs that open no headset and so wait for no turn.
    ///
    /// # Panics
    /// Those of [`RuntimeSlot::enter`].
    pub fn drivers() -> Self {
        prepare();
        Self::default().compositor(Compositor::None)
    }

    /// Sets an environment variable for the runtime and the program.
    pub fn variable(mut self, name: &str, value: impl Into<String>) -> Self {
        self.variables.push((name.to_string(), value.into()));
        self
    }

    pub fn compositor(self, compositor: Compositor) -> Self {
        let name = match compositor {
            Compositor::Null => "null",
            Compositor::Xcb => "xcb",
            Compositor::None => "none",
        };
        self.variable("XR_COMPOSITOR", name)
    }

    pub fn device(self, device: HeadsetDevice) -> Self {
        self.variable("XR_DEVICE", if device == HeadsetDevice::Remote { "remote" } else { "simulated" })
    }

    /// Turns on OpenXR validation, and Vulkan validation with synchronization validation; see
    /// [`Finished::assert_valid`].
    pub fn validate(mut self) -> Self {
        self.validate = true;
        self.variable("XR_VALIDATE", "1").variable("VK_LAYER_VALIDATE_SYNC", "1")
    }

    /// Makes something go wrong; `what` as in `tests/faultlayer`.
    pub fn fault(self, what: &str) -> Self {
        let layers = fault_layer();
        self.variable("XRFAULT", what)
            .variable("XR_API_LAYER_PATH", layers.to_str().expect("a UTF-8 path"))
            .variable("XR_ENABLE_API_LAYERS", "XR_APILAYER_TEST_fault")
            .variable("VK_ADD_LAYER_PATH", layers.join("vulkan").to_str().expect("a UTF-8 path"))
            .variable("VK_INSTANCE_LAYERS", "VK_LAYER_TEST_fault")
    }

    /// What goes wrong waits for [`Running::let_fault_happen`]; frames are counted from then on.
    pub fn fault_waits(self) -> Self {
        self.variable("XRFAULT_WAITS", "1")
    }

    /// Starts the runtime not before [`Running::start_runtime`].
    pub fn later(self) -> Self {
        self.variable("XR_SERVICE", "later")
    }

    /// Sets the seconds until the program is stopped.
    pub fn timeout_s(mut self, seconds: u32) -> Self {
        self.timeout_s = seconds;
        self
    }

    /// Starts the runtime and in it the program.
    pub fn start(&self, program: &Path, args: &[&str]) -> Running {
        // The folder is under /tmp, since the path of the runtime's socket must be short.
        let folder = tempfile::Builder::new().prefix("xr").tempdir_in("/tmp").expect("a temporary folder");
        let port = free_port();
        let mut command = program::command(script());
        command
            .arg("run")
            .arg(program)
            .args(args)
            .env("XR_RUN", folder.path())
            .env("XR_REMOTE_PORT", port.to_string())
            .env("XR_TIMEOUT", self.timeout_s.to_string())
            .envs(self.variables.iter().map(|(name, value)| (name, value)));
        Running {
            script: Program::start(&mut command),
            port,
            num_read: 0,
            folder: Some(folder),
            validate: self.validate,
            deadline: Instant::now() + Duration::from_secs(u64::from(self.timeout_s) + 30),
        }
    }

    /// Starts a program and waits for its end.
    pub fn run(&self, program: &Path, args: &[&str]) -> Finished {
        self.start(program, args).finish()
    }
}

/// A port that nobody listens on now.
fn free_port() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    listener.local_addr().expect("a bound address").port()
}

/// Builds the fault layer and returns the folder of its manifest.
fn fault_layer() -> &'static Path {
    static LAYERS: OnceLock<PathBuf> = OnceLock::new();
    LAYERS.get_or_init(|| {
        let root = root().join("tests/faultlayer/Cargo.toml");
        let target = target_tmp().join("faultlayer");
        let built = Command::new(env!("CARGO"))
            .args(["build", "--quiet", "--locked", "--manifest-path"])
            .arg(root)
            .arg("--target-dir")
            .arg(&target)
            .env_remove("CARGO_BUILD_TARGET")
            .output()
            .expect("cargo starts");
        assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
        let library = target.join("debug/libfaultlayer.so");
        let manifest = serde_json::json!({
            "file_format_version": "1.0.0",
            "api_layer": {
                "name": "XR_APILAYER_TEST_fault",
                "library_path": library,
                "api_version": "1.0",
                "implementation_version": "1",
                "description": "makes things go wrong",
            },
        });
        fs::write(target.join("faultlayer.json"), manifest.to_string()).expect("the manifest can be written");
        // The same library is a layer of Vulkan's.
        let manifest = serde_json::json!({
            "file_format_version": "1.2.0",
            "layer": {
                "name": "VK_LAYER_TEST_fault",
                "type": "GLOBAL",
                "library_path": library,
                "api_version": "1.3.0",
                "implementation_version": "1",
                "description": "loses the GPU",
            },
        });
        let folder = target.join("vulkan");
        fs::create_dir_all(&folder).expect("a folder in target");
        fs::write(folder.join("faultlayer.json"), manifest.to_string()).expect("the manifest can be written");
        target
    })
}

/// A program that runs in a runtime. Dropping it stops both.
pub struct Running {
    script: Program,
    port: u16,
    /// Bytes of the program's output that have been read.
    num_read: usize,
    folder: Option<tempfile::TempDir>,
    validate: bool,
    deadline: Instant,
}

impl Running {
    /// Folder of the runtime's sockets and logs; the program sees it as `XR_RUN`.
    pub fn folder(&self) -> &Path {
        self.folder.as_ref().expect("kept until the end").path()
    }

    /// Connects to the remote device, as soon as it listens.
    pub fn remote(&mut self) -> poses::Remote {
        retry(self.seconds_left(), || poses::Remote::connect(self.port))
            .unwrap_or_else(|error| panic!("the remote device: {error}"))
    }

    /// The picture that the compositor shows now ([`Compositor::Xcb`]).
    pub fn screen(&self) -> Picture {
        // The screen may be there before its picture is.
        retry(self.seconds_left(), || crate::xwd::read(&self.folder().join("fb/Xvfb_screen0")))
            .expect("the virtual screen")
    }

    /// Waits for a further line of the program's output for which `found` has a value.
    ///
    /// # Panics
    /// If there is none before the program ends or is late.
    pub fn wait_for<T>(&mut self, what: &str, mut found: impl FnMut(&str) -> Option<T>) -> T {
        let (num_read, mut last) = (&mut self.num_read, String::new());
        let value = self.script.find(LONGEST_S, |said| {
            while let Some(length) = said.out[*num_read..].iter().position(|byte| *byte == b'\n') {
                last = String::from_utf8_lossy(&said.out[*num_read..][..length]).into_owned();
                *num_read += length + 1;
                if let Some(value) = found(&last) {
                    return Some(value);
                }
            }
            None
        });
        value.unwrap_or_else(|| panic!("no {what}; last: {last}\n{}", self.script.said()))
    }

    /// Waits until the program has said on stderr, `times` times by now, something that contains `words`.
    ///
    /// # Panics
    /// If it does not.
    pub fn wait_until_said(&self, words: &str, times: usize) {
        self.script.wait_until_said(words, times);
    }

    /// All that the program has said on stderr so far.
    pub fn said(&self) -> String {
        self.script.said()
    }

    /// Seconds until the program is late.
    fn seconds_left(&self) -> f64 {
        self.deadline.saturating_duration_since(Instant::now()).as_secs_f64()
    }

    /// Lets happen what [`TestRuntime::fault_waits`] holds back.
    pub fn let_fault_happen(&self) {
        fs::write(self.folder().join("fault"), "").expect("the runtime's folder");
    }

    /// Kills the runtime, not the program.
    pub fn kill_runtime(&self) {
        self.signal("KILL", "service.pid");
    }

    /// Starts the runtime again after [`Self::kill_runtime`], or at last after [`TestRuntime::later`].
    pub fn start_runtime(&self) {
        signal("USR1", &self.script.pid());
    }

    /// Asks the program to end, as a user would.
    pub fn ask_to_end(&self) {
        self.signal("TERM", "program.pid");
    }

    fn signal(&self, name: &str, pid_file: &str) {
        let pid = fs::read_to_string(self.folder().join(pid_file)).expect("a process that was started");
        signal(name, pid.trim());
    }

    /// Waits for the program's end.
    pub fn finish(mut self) -> Finished {
        let output = self.script.end_within(self.seconds_left());
        let lines = String::from_utf8_lossy(&output.out).lines().map(str::to_owned).collect();
        let folder = self.folder.take().expect("kept until the end");
        Finished { code: output.code, lines, stderr: output.err, folder, validated: self.validate }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if self.script.is_running() {
            // TERM, unlike KILL, lets the script stop what it started.
            signal("TERM", &self.script.pid());
            self.script.end_within(LONGEST_S);
        }
    }
}

/// The result of a program's run.
pub struct Finished {
    /// Exit code; 96 if validation found errors, 124 if it was stopped for taking too long.
    pub code: Option<i32>,
    /// Its standard output.
    pub lines: Vec<String>,
    /// Its (and the script's) standard error.
    pub stderr: String,
    folder: tempfile::TempDir,
    validated: bool,
}

impl Finished {
    /// Folder of the runtime's logs, and of what the program wrote to `XR_RUN`.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Everything that the validation layers reported; empty if all is well.
    pub fn complaints(&self) -> Vec<String> {
        assert!(self.validated, "the run was made without validate()");
        let read = |name: &str| fs::read_to_string(self.folder().join(name)).unwrap_or_default();
        let openxr = read("xr_validation.txt");
        // The layer writes a line when an instance comes and one when it goes; without them the layer was not there.
        let greetings = openxr.lines().filter(|line| line.contains("VALID_DEBUG")).count();
        let mut complaints = self.vulkan_complaints();
        let of_openxr =
            openxr.lines().filter(|line| !line.contains("VALID_DEBUG") && !line.trim().is_empty());
        complaints.extend(of_openxr.map(str::to_string));
        if greetings != 2 {
            complaints.push(format!("OpenXR validation greeted {greetings} times, not twice: {openxr}"));
        }
        complaints
    }

    /// Everything that Vulkan's layer alone reported, for programs that use no OpenXR.
    pub fn vulkan_complaints(&self) -> Vec<String> {
        assert!(self.validated, "the run was made without validate()");
        match fs::read_to_string(self.folder().join("vk_validation.txt")) {
            Ok(text) => text.lines().filter(|line| !line.trim().is_empty()).map(str::to_string).collect(),
            Err(_) => vec!["Vulkan validation was not on".into()],
        }
    }

    /// Panics if a validation layer complained.
    pub fn assert_valid(&self) {
        let complaints = self.complaints();
        assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    }

    /// Panics unless the program ended by itself with code 0.
    pub fn assert_ok(&self) {
        let last = self.lines.iter().rev().take(5).rev().cloned().collect::<Vec<_>>().join("\n");
        assert_eq!(self.code, Some(0), "stderr: {}\nlast lines:\n{last}", self.stderr);
    }
}

//! What is to happen, and when: the environment says it.

use openxr_sys as xr;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

/// Calls of xrEndFrame since faults may happen.
static FRAMES: AtomicU64 = AtomicU64::new(0);

/// Calls that fail: the fault, the call, its result.
pub const FAILURES: [(&str, &str, xr::Result); 20] = [
    ("waiterr", "xrWaitFrame", xr::Result::ERROR_RUNTIME_FAILURE),
    ("waitnotrunning", "xrWaitFrame", xr::Result::ERROR_SESSION_NOT_RUNNING),
    ("sessionlost", "xrWaitFrame", xr::Result::ERROR_SESSION_LOST),
    ("instancelost", "xrWaitFrame", xr::Result::ERROR_INSTANCE_LOST),
    ("beginerr", "xrBeginFrame", xr::Result::ERROR_RUNTIME_FAILURE),
    ("acqerr", "xrAcquireSwapchainImage", xr::Result::ERROR_RUNTIME_FAILURE),
    ("acqlost", "xrAcquireSwapchainImage", xr::Result::ERROR_SESSION_LOST),
    ("imgtimeout", "xrWaitSwapchainImage", xr::Result::TIMEOUT_EXPIRED),
    ("imglost", "xrWaitSwapchainImage", xr::Result::ERROR_SESSION_LOST),
    ("relerr", "xrReleaseSwapchainImage", xr::Result::ERROR_RUNTIME_FAILURE),
    ("locateerr", "xrLocateViews", xr::Result::ERROR_TIME_INVALID),
    ("locatelost", "xrLocateViews", xr::Result::ERROR_SESSION_LOST),
    ("syncerr", "xrSyncActions", xr::Result::ERROR_RUNTIME_FAILURE),
    ("handerr", "xrLocateSpace", xr::Result::ERROR_TIME_INVALID),
    ("jointserr", "xrLocateHandJointsEXT", xr::Result::ERROR_TIME_INVALID),
    ("shakeerr", "xrApplyHapticFeedback", xr::Result::ERROR_RUNTIME_FAILURE),
    ("badend", "xrEndFrame", xr::Result::ERROR_LAYER_INVALID),
    ("enderr", "xrEndFrame", xr::Result::ERROR_RUNTIME_FAILURE),
    ("endlost", "xrEndFrame", xr::Result::ERROR_SESSION_LOST),
    ("badtime", "xrEndFrame", xr::Result::ERROR_TIME_INVALID),
];

/// Faults that happen at random: all failures, and these.
const OTHERS: [&str; 9] =
    ["discard", "exit", "losspending", "exiting", "instloss", "norender", "newmask", "badpose", "devicelost"];
/// The fault of `random` that happens next.
static ARMED: Mutex<Option<&str>> = Mutex::new(None);

/// What is to happen.
struct Fault {
    what: String,
    /// After this many frames.
    frames: u64,
    /// For this many calls.
    calls: u64,
    /// How often it has happened.
    fired: AtomicU64,
}

impl Fault {
    /// Of `WHAT:N:M`.
    fn of(text: &str) -> Self {
        let mut parts = text.split(':');
        let what = parts.next().unwrap_or_default().to_string();
        let mut number = |default| parts.next().and_then(|part| part.parse().ok()).unwrap_or(default);
        Self { what, frames: number(30), calls: number(1), fired: AtomicU64::new(0) }
    }
}

fn plan(what: &str) -> Option<&'static Fault> {
    static PLANS: OnceLock<Vec<Fault>> = OnceLock::new();
    let plans = PLANS.get_or_init(|| {
        let text = std::env::var("XRFAULT").unwrap_or_default();
        text.split(',').map(Fault::of).collect()
    });
    plans.iter().find(|plan| plan.what == what)
}

/// Whether `what` is planned, whenever.
pub fn planned(what: &str) -> bool {
    plan(what).is_some()
}

/// The first number of `what`, if that is planned.
pub fn number(what: &str) -> Option<u64> {
    plan(what).map(|plan| plan.frames)
}

/// True once faults may happen: at once, or when the test asks for them.
fn may_happen() -> bool {
    static ASKED_FOR: OnceLock<()> = OnceLock::new();
    static FILE: OnceLock<Option<PathBuf>> = OnceLock::new();
    let file = FILE.get_or_init(|| {
        let waits = std::env::var_os("XRFAULT_WAITS").is_some();
        waits.then(|| PathBuf::from(std::env::var_os("XR_RUN").unwrap_or_default()).join("fault"))
    });
    if ASKED_FOR.get().is_none() && file.as_ref().is_none_or(|file| file.exists()) {
        let _ = ASKED_FOR.set(());
    }
    ASKED_FOR.get().is_some()
}

/// Counts a call of xrEndFrame; chooses a fault at random if it is time for one.
pub fn count_frame() {
    if !may_happen() {
        return;
    }
    let frames = FRAMES.fetch_add(1, Ordering::SeqCst) + 1;
    // `random:SEED:EVERY`
    let Some(random) = plan("random").filter(|random| frames.is_multiple_of(random.calls)) else { return };
    // The finalizer of splitmix64.
    let mut bits = random.frames.wrapping_add(frames.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    bits = (bits ^ bits >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    let number = ((bits ^ bits >> 31) % (FAILURES.len() + OTHERS.len()) as u64) as usize;
    let what = FAILURES.get(number).map_or_else(|| OTHERS[number - FAILURES.len()], |(what, ..)| what);
    *ARMED.lock().unwrap_or_else(PoisonError::into_inner) = Some(what);
}

/// Whether `what` was chosen at random and has not happened yet.
fn fires_at_random(what: &str) -> bool {
    let mut armed = ARMED.lock().unwrap_or_else(PoisonError::into_inner);
    armed.take_if(|armed| *armed == what).is_some()
}

/// Whether `what` is planned, due, and has not happened often enough yet.
pub fn fires(what: &str) -> bool {
    let due = plan(what).filter(|plan| may_happen() && FRAMES.load(Ordering::SeqCst) >= plan.frames);
    let fires = due.is_some_and(|plan| plan.fired.fetch_add(1, Ordering::SeqCst) < plan.calls)
        || fires_at_random(what);
    if fires {
        eprintln!("faultlayer: {what}");
    }
    fires
}

/// The failure of a call that is planned and due.
pub fn failure(call: &str) -> Option<xr::Result> {
    let mut failures = FAILURES.iter().filter(|(_, of, _)| *of == call);
    failures.find(|(what, ..)| fires(what)).map(|(.., result)| *result)
}

/// Does not return if `what` is planned and due.
pub fn hang(what: &str) {
    if fires(what) {
        loop {
            std::thread::park();
        }
    }
}

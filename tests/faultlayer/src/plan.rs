//! What is to happen, and when: the environment says it.

use openxr_sys as xr;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Calls of xrEndFrame so far.
pub static FRAMES: AtomicU64 = AtomicU64::new(0);
static FIRED: AtomicU64 = AtomicU64::new(0);

/// Calls that fail: the fault, the call, its result.
pub const FAILURES: [(&str, &str, xr::Result); 17] = [
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
    ("badend", "xrEndFrame", xr::Result::ERROR_LAYER_INVALID),
    ("enderr", "xrEndFrame", xr::Result::ERROR_RUNTIME_FAILURE),
    ("endlost", "xrEndFrame", xr::Result::ERROR_SESSION_LOST),
    ("badtime", "xrEndFrame", xr::Result::ERROR_TIME_INVALID),
];

/// What is to happen.
pub struct Plan {
    pub what: String,
    /// After this many frames.
    frames: u64,
    /// For this many calls.
    calls: u64,
}

pub fn plan() -> &'static Plan {
    static PLAN: OnceLock<Plan> = OnceLock::new();
    PLAN.get_or_init(|| {
        let text = std::env::var("XRFAULT").unwrap_or_default();
        let mut parts = text.split(':');
        let what = parts.next().unwrap_or_default().to_string();
        let mut number = |default| parts.next().and_then(|part| part.parse().ok()).unwrap_or(default);
        Plan { what, frames: number(30), calls: number(1) }
    })
}

/// Whether `what` is planned, due, and has not happened often enough yet.
pub fn fires(what: &str) -> bool {
    let plan = plan();
    let due = plan.what == what && FRAMES.load(Ordering::SeqCst) >= plan.frames;
    let fires = due && FIRED.fetch_add(1, Ordering::SeqCst) < plan.calls;
    if fires {
        eprintln!("faultlayer: {what}");
    }
    fires
}

/// The failure of a call that is planned and due.
pub fn failure(call: &str) -> Option<xr::Result> {
    let planned = FAILURES.iter().find(|(what, of, _)| *of == call && *what == plan().what);
    planned.filter(|(what, ..)| fires(what)).map(|(.., result)| *result)
}

/// Does not return if `what` is planned and due.
pub fn hang(what: &str) {
    while fires(what) {
        std::thread::sleep(Duration::from_secs(3600));
    }
}

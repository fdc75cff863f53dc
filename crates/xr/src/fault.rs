//! What can go wrong with a headset while it is in use, and why its session is over.

use openxr::SessionState;
use std::fmt;

/// What told that a headset can no longer be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// An OpenXR call, with its result.
    Call {
        /// Name of the call.
        call: &'static str,
        /// What it said.
        result: openxr::sys::Result,
    },
    /// A state that the runtime announced.
    State(SessionState),
    /// The event that the instance will be lost.
    InstanceLossPending,
}

/// A call of several that failed.
#[derive(Clone, Copy, Debug)]
pub(super) struct FailedCall {
    pub call: &'static str,
    pub result: openxr::sys::Result,
}

impl FailedCall {
    /// For `map_err`: the failure of `call`.
    pub fn of(call: &'static str) -> impl Fn(openxr::sys::Result) -> Self {
        move |result| Self { call, result }
    }
}

/// Why a session is over.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// The user ended the walk, or a limit did.
    ByUser,
    /// The headset's software ended the session, as when the user leaves from its menu.
    ByRuntime,
    /// The headset is gone, or its software has let go of it. The software may offer a new session.
    SessionLost(Cause),
    /// The headset's software is gone.
    RuntimeLost(Cause),
    /// Nothing can be drawn for it; with the reason.
    Unusable(String),
    /// The GPU is gone, and all that was on it; with the driver's words.
    DeviceLost(String),
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Call { call, result } => write!(f, "{call}: {result:?}"),
            Self::State(state) => write!(f, "{state:?}"),
            Self::InstanceLossPending => f.write_str("INSTANCE_LOSS_PENDING"),
        }
    }
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ByUser => f.write_str("the walk was ended"),
            Self::ByRuntime => f.write_str("the headset's software ended the session (EXITING)"),
            Self::SessionLost(cause) => write!(
                f,
                "the headset was lost ({cause}): it was unplugged or switched off, or its software let go of it"
            ),
            Self::RuntimeLost(cause) => write!(f, "the headset's software stopped ({cause})"),
            Self::Unusable(why) => write!(f, "the headset cannot be used: {why}"),
            Self::DeviceLost(why) => {
                write!(f, "the GPU was lost ({why}); if it happens again, update its driver")
            }
        }
    }
}

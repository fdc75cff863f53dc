//! What can go wrong with a headset while it is in use, and why a session is over.

use std::fmt;

/// Why a call to a headset gave nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// The GPU is gone, and all that was on it.
    #[error("the GPU was lost ({0}): restart the program; if it happens again, update the driver")]
    DeviceLost(String),
    /// The runtime gave up on a call, but has not said that the session is over.
    #[error("the headset's OpenXR runtime failed ({call}: {result:?}): restart it and start again")]
    Call {
        /// The OpenXR call that failed.
        call: &'static str,
        /// Its result.
        result: openxr::sys::Result,
    },
    /// A frame's calls came in another order than [`crate::Headset`] says: a mistake in the program.
    #[error("the headset was asked in the wrong order: {0}")]
    Order(&'static str),
}

/// Why a session is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The user ended the walk, or a limit did.
    ByUser,
    /// The headset's software ended the session.
    ByRuntime,
    /// The headset is gone, or its software has let go of it.
    SessionLost,
    /// The headset's software is gone.
    RuntimeLost,
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ByUser => "the walk was ended",
            Self::ByRuntime => "the headset's software ended the session",
            Self::SessionLost => {
                "the headset was lost (unplugged, switched off, or its software stopped); connect it and start again"
            }
            Self::RuntimeLost => "the headset's software stopped; start it and then this program again",
        })
    }
}

//! The session's state machine: what the runtime's events ask of us. It knows no OpenXR object, so it is tested without
//! a runtime.
//!
//! ```text
//! IDLE ─▶ READY ─begin▶ SYNCHRONIZED ⇄ VISIBLE ⇄ FOCUSED
//!  ▲                          │
//!  └──────end── STOPPING ◀────┘        EXITING, LOSS_PENDING: over
//! ```

use crate::fault::{End, Fault};
use openxr as xr;
use openxr::SessionState;
use std::time::{Duration, Instant};

/// How long a runtime may take to wind a session down before we leave on our own.
const EXIT_PATIENCE: Duration = Duration::from_secs(3);

/// What to do about a new state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Duty {
    /// Call xrBeginSession.
    Begin,
    /// Call xrEndSession.
    End,
}

/// Where the session is in its life.
#[derive(Debug)]
pub(super) struct Lifecycle {
    state: SessionState,
    running: bool,
    reached_focus: bool,
    exit_asked: Option<Instant>,
    ended: Option<End>,
}

impl Lifecycle {
    pub fn new() -> Self {
        Self {
            state: SessionState::UNKNOWN,
            running: false,
            reached_focus: false,
            exit_asked: None,
            ended: None,
        }
    }

    /// The state that the runtime last announced.
    pub fn state(&self) -> SessionState {
        self.state
    }

    /// True if the user ever had the session in focus.
    pub fn reached_focus(&self) -> bool {
        self.reached_focus
    }

    /// True between xrBeginSession and xrEndSession: frames are to be made.
    pub fn running(&self) -> bool {
        self.running && self.ended.is_none()
    }

    /// Why the session is over, once it is.
    pub fn ended(&self) -> Option<End> {
        self.ended
    }

    /// Takes in a state that the runtime announced.
    pub fn enter(&mut self, state: SessionState) -> Option<Duty> {
        self.state = state;
        match state {
            SessionState::READY if !self.running => {
                self.running = true;
                return Some(Duty::Begin);
            }
            SessionState::STOPPING if self.running => {
                self.running = false;
                return Some(Duty::End);
            }
            SessionState::FOCUSED => self.reached_focus = true,
            SessionState::EXITING => {
                self.end(if self.exit_asked.is_some() { End::ByUser } else { End::ByRuntime });
            }
            SessionState::LOSS_PENDING => self.end(End::SessionLost),
            _ => {}
        }
        None
    }

    /// Ends the session. The first reason is the one that is told.
    pub fn end(&mut self, reason: End) {
        self.ended.get_or_insert(reason);
        self.running = false;
    }

    /// Takes in a call's result. A loss ends the session and yields `None`; other failures are errors.
    pub fn survive<T>(&mut self, call: &'static str, result: xr::Result<T>) -> Result<Option<T>, Fault> {
        match result {
            Ok(value) => Ok(Some(value)),
            Err(xr::sys::Result::ERROR_SESSION_LOST) => {
                self.end(End::SessionLost);
                Ok(None)
            }
            Err(xr::sys::Result::ERROR_INSTANCE_LOST) => {
                self.end(End::RuntimeLost);
                Ok(None)
            }
            Err(result) => Err(Fault::Call { call, result }),
        }
    }

    /// Takes in that the user asked to leave at `now`. True if the runtime is to be told; false if it has been, or if
    /// there is no running session to end.
    pub fn ask_exit(&mut self, now: Instant) -> bool {
        if !self.running() {
            self.end(End::ByUser);
            return false;
        }
        self.exit_asked.replace(now).is_none()
    }

    /// Leaves anyway if the runtime has not let us go in time.
    pub fn lose_patience(&mut self, now: Instant) {
        if self.exit_asked.is_some_and(|asked| now.saturating_duration_since(asked) > EXIT_PATIENCE) {
            self.end(End::ByUser);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A session in focus.
    fn focused() -> Lifecycle {
        let mut life = Lifecycle::new();
        assert_eq!(life.enter(SessionState::IDLE), None);
        assert!(!life.running());
        assert_eq!(life.enter(SessionState::READY), Some(Duty::Begin));
        for state in [SessionState::SYNCHRONIZED, SessionState::VISIBLE] {
            assert_eq!(life.enter(state), None);
            assert!(life.running() && !life.reached_focus());
        }
        assert_eq!(life.enter(SessionState::FOCUSED), None);
        assert!(life.running() && life.reached_focus());
        life
    }

    #[test]
    fn exit_on_request_passes_through_stopping() {
        let mut life = focused();
        assert!(life.ask_exit(Instant::now()));
        assert!(!life.ask_exit(Instant::now()), "the runtime is told once");
        assert!(life.running(), "frames go on until the runtime says stop");
        assert_eq!(life.enter(SessionState::STOPPING), Some(Duty::End));
        assert!(!life.running() && life.ended().is_none());
        life.enter(SessionState::IDLE);
        life.enter(SessionState::EXITING);
        assert_eq!(life.ended(), Some(End::ByUser));
    }

    #[test]
    fn the_runtime_may_end_it() {
        let mut life = focused();
        life.enter(SessionState::STOPPING);
        life.enter(SessionState::EXITING);
        assert_eq!(life.ended(), Some(End::ByRuntime));
    }

    #[test]
    fn a_headset_taken_off_can_be_put_on_again() {
        let mut life = focused();
        assert_eq!(life.enter(SessionState::STOPPING), Some(Duty::End));
        life.enter(SessionState::IDLE);
        assert!(life.ended().is_none());
        assert_eq!(life.enter(SessionState::READY), Some(Duty::Begin));
        assert!(life.running());
    }

    #[test]
    fn loss_ends_it_and_the_first_reason_stays() {
        let mut life = focused();
        life.enter(SessionState::LOSS_PENDING);
        life.end(End::RuntimeLost);
        assert_eq!(life.ended(), Some(End::SessionLost));
        assert!(!life.running());
    }

    #[test]
    fn lost_calls_end_it_and_failed_calls_are_errors() {
        use xr::sys::Result as Code;
        for (code, reason) in
            [(Code::ERROR_SESSION_LOST, End::SessionLost), (Code::ERROR_INSTANCE_LOST, End::RuntimeLost)]
        {
            let mut life = focused();
            assert!(life.survive::<()>("xrWaitFrame", Err(code)).unwrap().is_none());
            assert_eq!(life.ended(), Some(reason));
        }
        let mut life = focused();
        assert_eq!(life.survive("xrWaitFrame", Ok(7)).unwrap(), Some(7));
        let error = life.survive::<()>("xrEndFrame", Err(Code::ERROR_POSE_INVALID)).unwrap_err();
        assert!(error.to_string().contains("xrEndFrame: ERROR_POSE_INVALID"), "{error}");
        assert!(life.running());
    }

    #[test]
    fn leaving_before_the_session_runs_ends_at_once() {
        let mut life = Lifecycle::new();
        assert!(!life.ask_exit(Instant::now()));
        assert_eq!(life.ended(), Some(End::ByUser));
    }

    #[test]
    fn a_runtime_that_does_not_answer_is_left() {
        let (mut life, start) = (focused(), Instant::now());
        life.ask_exit(start);
        life.lose_patience(start + EXIT_PATIENCE / 2);
        assert_eq!(life.ended(), None);
        life.lose_patience(start + EXIT_PATIENCE * 2);
        assert_eq!(life.ended(), Some(End::ByUser));
    }
}

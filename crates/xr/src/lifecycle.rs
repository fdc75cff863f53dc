//! The session's state machine: what the runtime's events ask of us. It knows no OpenXR object, so it is tested without
//! a runtime.
//!
//! ```text
//! IDLE ─▶ READY ─begin▶ SYNCHRONIZED ⇄ VISIBLE ⇄ FOCUSED
//!  ▲                          │
//!  └──────end── STOPPING ◀────┘        EXITING, LOSS_PENDING: over
//! ```

use crate::fault::{Cause, End};
use openxr as xr;
use openxr::SessionState;
use std::time::{Duration, Instant};

/// How long a runtime may take to wind a session down before we leave on our own.
const EXIT_PATIENCE: Duration = Duration::from_millis(1200);
/// How long calls may fail, with no frame ended in between, until the session counts as lost.
const ERROR_PATIENCE: Duration = Duration::from_secs(3);

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
    /// The first failure since a frame was last ended, and when it was.
    failing: Option<(Cause, Instant)>,
    /// Failures that the log has.
    told: Vec<Cause>,
    ended: Option<End>,
}

impl Lifecycle {
    pub fn new() -> Self {
        Self {
            state: SessionState::UNKNOWN,
            running: false,
            reached_focus: false,
            exit_asked: None,
            failing: None,
            told: Vec::new(),
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
    pub fn ended(&self) -> Option<&End> {
        self.ended.as_ref()
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
            SessionState::LOSS_PENDING => self.end(End::SessionLost(Cause::State(state))),
            _ => {}
        }
        None
    }

    /// Ends the session. The first reason is the one that is told.
    pub fn end(&mut self, reason: End) {
        self.ended.get_or_insert(reason);
        self.running = false;
    }

    /// Takes in a call's result at `now`. A loss ends the session. Any other failure costs a frame; the log has each
    /// kind of it once.
    pub fn survive<T>(&mut self, call: &'static str, result: xr::Result<T>, now: Instant) -> Option<T> {
        let cause = match result {
            Ok(value) => return Some(value),
            Err(result) => Cause::Call { call, result },
        };
        match cause {
            Cause::Call { result: xr::sys::Result::ERROR_SESSION_LOST, .. } => {
                self.end(End::SessionLost(cause));
            }
            Cause::Call { result: xr::sys::Result::ERROR_INSTANCE_LOST, .. } => {
                self.end(End::RuntimeLost(cause));
            }
            _ => {
                self.failing.get_or_insert((cause, now));
                self.tell(cause);
            }
        }
        None
    }

    /// Logs what costs a frame, once.
    pub fn tell(&mut self, cause: Cause) {
        if !self.told.contains(&cause) {
            tracing::warn!("the headset's software failed in a frame ({cause}); the walk goes on");
            self.told.push(cause);
        }
    }

    /// Takes in that a frame was ended well.
    pub fn frame_ended(&mut self) {
        self.failing = None;
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

    /// Ends a session whose runtime has not let us go in time, or fails and fails.
    pub fn lose_patience(&mut self, now: Instant) {
        if self.exit_asked.is_some_and(|asked| now.saturating_duration_since(asked) > EXIT_PATIENCE) {
            self.end(End::ByUser);
        }
        if let Some((cause, since)) = self.failing
            && now.saturating_duration_since(since) > ERROR_PATIENCE
        {
            self.end(End::SessionLost(cause));
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
        assert_eq!(life.ended(), Some(&End::ByUser));
    }

    #[test]
    fn the_runtime_may_end_it() {
        let mut life = focused();
        life.enter(SessionState::STOPPING);
        life.enter(SessionState::EXITING);
        assert_eq!(life.ended(), Some(&End::ByRuntime));
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
        life.end(End::ByUser);
        let cause = Cause::State(SessionState::LOSS_PENDING);
        assert_eq!(life.ended(), Some(&End::SessionLost(cause)));
        assert!(!life.running());
    }

    #[test]
    fn lost_calls_end_it_and_failed_calls_cost_a_frame() {
        use xr::sys::Result as Code;
        let now = Instant::now();
        let cause = |result| Cause::Call { call: "xrWaitFrame", result };
        for (code, reason) in [
            (Code::ERROR_SESSION_LOST, End::SessionLost(cause(Code::ERROR_SESSION_LOST))),
            (Code::ERROR_INSTANCE_LOST, End::RuntimeLost(cause(Code::ERROR_INSTANCE_LOST))),
        ] {
            let mut life = focused();
            assert!(life.survive::<()>("xrWaitFrame", Err(code), now).is_none());
            assert_eq!(life.ended(), Some(&reason));
        }
        let mut life = focused();
        assert_eq!(life.survive("xrWaitFrame", Ok(7), now), Some(7));
        assert_eq!(life.survive::<()>("xrWaitFrame", Err(Code::ERROR_TIME_INVALID), now), None);
        assert!(life.running());
        assert_eq!(life.told, [cause(Code::ERROR_TIME_INVALID)]);
        life.survive::<()>("xrWaitFrame", Err(Code::ERROR_TIME_INVALID), now);
        assert_eq!(life.told.len(), 1, "each failure is told once");
    }

    #[test]
    fn a_session_that_only_fails_is_lost() {
        use xr::sys::Result as Code;
        let (mut life, start) = (focused(), Instant::now());
        let fail = |life: &mut Lifecycle, seconds: f64, code| {
            let now = start + Duration::from_secs_f64(seconds);
            life.survive::<()>("xrEndFrame", Err(code), now);
            life.lose_patience(now);
        };
        fail(&mut life, 0.0, Code::ERROR_TIME_INVALID);
        fail(&mut life, 2.9, Code::ERROR_TIME_INVALID);
        life.frame_ended();
        fail(&mut life, 4.0, Code::ERROR_POSE_INVALID);
        fail(&mut life, 6.9, Code::ERROR_TIME_INVALID);
        assert_eq!(life.ended(), None, "a frame came through in between");
        fail(&mut life, 7.1, Code::ERROR_TIME_INVALID);
        let cause = Cause::Call { call: "xrEndFrame", result: Code::ERROR_POSE_INVALID };
        assert_eq!(life.ended(), Some(&End::SessionLost(cause)));
    }

    #[test]
    fn leaving_before_the_session_runs_ends_at_once() {
        let mut life = Lifecycle::new();
        assert!(!life.ask_exit(Instant::now()));
        assert_eq!(life.ended(), Some(&End::ByUser));
    }

    #[test]
    fn a_runtime_that_does_not_answer_is_left() {
        let (mut life, start) = (focused(), Instant::now());
        life.ask_exit(start);
        life.lose_patience(start + EXIT_PATIENCE / 2);
        assert_eq!(life.ended(), None);
        life.lose_patience(start + EXIT_PATIENCE * 2);
        assert_eq!(life.ended(), Some(&End::ByUser));
    }
}

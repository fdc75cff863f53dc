//! Why work of several threads ends. A failure of one thread stops the others, so the first failure is the reason,
//! and failures that follow from it are not.

use crate::failure::Failure;
use base::task::CancelToken;
use std::sync::{Mutex, PoisonError};

/// The reason for an end that several threads may have, shared by them.
#[derive(Debug)]
pub struct Ending {
    stop: CancelToken,
    reason: Mutex<Option<Failure>>,
}

impl Ending {
    /// The ending of work that looks at `stop`.
    #[must_use]
    pub fn new(stop: &CancelToken) -> Self {
        Self { stop: stop.clone(), reason: Mutex::new(None) }
    }

    /// Ends the work with this reason, unless there is one already.
    pub fn fail(&self, error: Failure) {
        // The reason is set before the others are stopped, so that what they then fail with comes second.
        self.fail_later(error);
        self.stop.cancel();
    }

    /// Sets the reason as [`Ending::fail`] does, but does not tell the others to stop: somebody is to read it first.
    pub fn fail_later(&self, error: Failure) {
        self.reason.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    }

    /// Takes back a reason that stopped nobody: what failed is tried again in another way.
    pub fn forgive(&self) {
        if !self.stop.is_cancelled() {
            *self.reason.lock().unwrap_or_else(PoisonError::into_inner) = None;
        }
    }

    /// True once there is a reason.
    #[must_use]
    pub fn has_failed(&self) -> bool {
        self.reason.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// A guard for each thread to hold: it stops the others if this thread panics, for they would go on without it.
    #[must_use]
    pub fn guard(&self) -> impl Drop + use<> {
        StopOnPanic(self.stop.clone())
    }

    /// Takes the outcome, once all threads have ended or are left behind.
    ///
    /// # Errors
    /// The first failure.
    pub fn take_result(&self) -> Result<(), Failure> {
        self.reason.lock().unwrap_or_else(PoisonError::into_inner).take().map_or(Ok(()), Err)
    }
}

struct StopOnPanic(CancelToken);

impl Drop for StopOnPanic {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.cancel();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_failure_is_the_reason() {
        let stop = CancelToken::default();
        let ending = Ending::new(&stop);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                while !stop.is_cancelled() {
                    std::thread::yield_now();
                }
                ending.fail(Failure::Usage("stopped before the end".into()));
            });
            scope.spawn(|| ending.fail(Failure::Usage("no display".into())));
        });
        assert_eq!(ending.take_result().unwrap_err().to_string(), "no display");
        assert!(Ending::new(&CancelToken::default()).take_result().is_ok());
    }

    #[test]
    fn a_reason_that_is_to_be_read_stops_nobody() {
        let stop = CancelToken::default();
        let ending = Ending::new(&stop);
        assert!(!ending.has_failed());
        ending.fail_later(Failure::Usage("no file".into()));
        ending.forgive();
        assert!(!ending.has_failed(), "another was opened");
        ending.fail_later(Failure::Usage("no scan".into()));
        assert!(ending.has_failed() && !stop.is_cancelled());
        ending.fail(Failure::Usage("and then no display".into()));
        assert!(stop.is_cancelled());
        ending.forgive();
        assert_eq!(ending.take_result().unwrap_err().to_string(), "no scan");
    }

    #[test]
    fn a_panic_stops_the_others() {
        let stop = CancelToken::default();
        let ending = Ending::new(&stop);
        drop(ending.guard());
        assert!(!stop.is_cancelled(), "a thread that ends well stops nobody");
        let panicked = std::thread::scope(|scope| {
            let thread = scope.spawn(|| {
                let _guard = ending.guard();
                panic!("on purpose");
            });
            thread.join().is_err()
        });
        assert!(panicked && stop.is_cancelled());
    }
}

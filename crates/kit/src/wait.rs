//! Waiting for a condition that comes in its own time. The limit is far beyond that, and the same for all.

use std::time::{Duration, Instant};

/// Seconds that nothing takes by far, on the slowest of machines: what is not there by then never comes.
pub const LONGEST_S: f64 = 600.0;
/// Longest pause between two looks.
const LONGEST_PAUSE: Duration = Duration::from_millis(50);

/// Asks again and again until there is an answer.
///
/// # Errors
/// After `seconds`, what was got instead of an answer last.
pub fn retry<T, E>(seconds: f64, mut ask: impl FnMut() -> Result<T, E>) -> Result<T, E> {
    let until = Instant::now() + Duration::from_secs_f64(seconds);
    let mut pause = Duration::from_millis(5);
    loop {
        let answer = ask();
        if answer.is_ok() || Instant::now() > until {
            return answer;
        }
        std::thread::sleep(pause);
        pause = (2 * pause).min(LONGEST_PAUSE);
    }
}

/// Asks again and again until there is an answer; panics after [`LONGEST_S`].
pub fn wait_for<T>(what: &str, mut ask: impl FnMut() -> Option<T>) -> T {
    let answer = retry(LONGEST_S, || ask().ok_or(()));
    answer.unwrap_or_else(|()| panic!("waited {LONGEST_S} s for {what}"))
}

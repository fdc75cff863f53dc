//! How the program ends: errors as one line for people, exit codes, signals; and what it says meanwhile.

use crate::config::ConfigError;
use crate::failure::Failure;
use crate::view::Threads;
use base::output::Partials;
use base::task::CancelToken;
use std::error::Error;
use std::io::{self, Write};
use std::iter::successors;
use std::process::ExitCode;
use tracing_subscriber::EnvFilter;

const DONE: u8 = 0;
const FAILED: u8 = 1;
const WRONG_USAGE: u8 = 2;
/// What shells report of a program that SIGINT ended: 128 + 2.
const INTERRUPTED: i32 = 130;

impl From<ConfigError> for Failure {
    fn from(error: ConfigError) -> Self {
        if error.is_usage() { Self::Usage(error.to_string()) } else { Self::Input(error.to_string()) }
    }
}

/// Tells what has become of the work, and ends the program.
pub(super) fn end((threads, result): (Threads, Result<(), Failure>), partials: &Partials) -> ExitCode {
    let code = code(result);
    // A thread that is left behind may have begun a file.
    partials.discard();
    match threads {
        Threads::Ended => ExitCode::from(code),
        Threads::LeftBehind => {
            let _ = io::stdout().flush();
            raw::environment::end_at_once(code)
        }
    }
}

/// Prints a failure and chooses the exit code.
fn code(result: Result<(), Failure>) -> u8 {
    let Err(failure) = result else { return DONE };
    if failure.is_closed_pipe() {
        return DONE;
    }
    // The exit code has to do if stderr is gone too.
    let _ = writeln!(io::stderr(), "scanwalk: {}", one_line(&failure));
    if failure.is_usage() { WRONG_USAGE } else { FAILED }
}

/// The error and its causes, "what: why: why", without those that the sentence before already quotes.
fn one_line(error: &dyn Error) -> String {
    let mut line = String::new();
    for cause in successors(Some(error), |&error| error.source()) {
        let cause = cause.to_string();
        if line.is_empty() {
            line = cause;
        } else if !line.contains(&cause) {
            line = format!("{line}: {cause}");
        }
    }
    line.lines().map(str::trim).filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ")
}

/// Ctrl-C and SIGTERM ask the work to end; a second one ends the program at once, and its partial files with it.
pub(super) fn stop_on_signals(partials: &Partials) -> CancelToken {
    let stop = CancelToken::default();
    let (asked, partials) = (stop.clone(), partials.clone());
    let mut signaled = false;
    let installed = ctrlc::set_handler(move || {
        if std::mem::replace(&mut signaled, true) {
            partials.discard();
            std::process::exit(INTERRUPTED);
        }
        asked.cancel();
        let _ = writeln!(io::stderr(), "scanwalk: stopping; once more to stop at once");
    });
    if let Err(error) = installed {
        tracing::warn!("Ctrl-C will end the program without a clean exit: {error}");
    }
    stop
}

/// Messages go to stderr: our warnings and the libraries' errors, with `-v` what scanwalk does, with `-vv` what the
/// libraries do.
pub(super) fn start_tracing(verbose: u8) {
    let default = match verbose {
        0 => "error,scanwalk=warn",
        1 => "error,scanwalk=info",
        _ => "info,scanwalk=debug",
    };
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(default));
    let colors = io::IsTerminal::is_terminal(&io::stderr());
    // This fails only if somebody else has set up tracing, which then stays.
    let _ = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(io::stderr)
        .with_ansi(colors)
        .with_target(verbose > 1)
        .without_time()
        .try_init();
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step that failed, and why.
    #[derive(Debug, thiserror::Error)]
    #[error("{0}")]
    struct Failed(&'static str, #[source] io::Error);

    #[test]
    fn wrong_settings_are_wrong_usage() {
        let failure = |sets: &[&str], file| {
            let sets: Vec<_> = sets.iter().map(ToString::to_string).collect();
            Failure::from(crate::config::load(&[], file, &sets).unwrap_err())
        };
        assert!(failure(&["frame.x=1"], None).is_usage());
        assert!(!failure(&[], Some(std::path::Path::new("no such file"))).is_usage());
    }

    #[test]
    fn failures_are_one_line() {
        let error = Failed("the scan cannot be read", io::Error::other("line one\n  line two\n"));
        assert_eq!(one_line(&error), "the scan cannot be read: line one line two");
        let quoted = Failed("x.laz: bad block", io::Error::other("bad block"));
        assert_eq!(one_line(&quoted), "x.laz: bad block");
    }
}

//! How the program ends: errors as one line for people, exit codes, signals; and what it says meanwhile.

use crate::config::ConfigError;
use anyhow::Error;
use base::output::{OutputError, Partials};
use base::task::CancelToken;
use lab::synth::SynthError;
use std::io::{self, Write};
use std::process::ExitCode;
use tracing_subscriber::EnvFilter;

/// The command line asks for something that makes no sense or does not exist: exit code 2.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Usage(pub String);

const FAILED: u8 = 1;
const WRONG_USAGE: u8 = 2;
/// What shells report of a program that SIGINT ended: 128 + 2.
const INTERRUPTED: i32 = 130;

/// Prints a failure and chooses the exit code.
pub(super) fn code(result: Result<(), Error>) -> ExitCode {
    let Err(error) = result else { return ExitCode::SUCCESS };
    if is_closed_pipe(&error) {
        return ExitCode::SUCCESS;
    }
    // The exit code has to do if stderr is gone too.
    let _ = writeln!(io::stderr(), "scanwalk: {}", one_line(&error));
    ExitCode::from(if is_usage(&error) { WRONG_USAGE } else { FAILED })
}

fn is_usage(error: &Error) -> bool {
    error.chain().any(|cause| {
        cause.is::<Usage>()
            || cause.downcast_ref::<ConfigError>().is_some_and(ConfigError::is_usage)
            || cause.downcast_ref::<OutputError>().is_some_and(OutputError::is_usage)
            || cause.downcast_ref::<SynthError>().is_some_and(SynthError::is_usage)
    })
}

/// The reader of our output has read enough (`scanwalk … | head`): that is no failure.
fn is_closed_pipe(error: &Error) -> bool {
    let kind =
        |cause: &(dyn std::error::Error + 'static)| cause.downcast_ref::<io::Error>().map(io::Error::kind);
    error.chain().any(|cause| kind(cause) == Some(io::ErrorKind::BrokenPipe))
}

/// The error and its causes, "what: why: why", without those that the sentence before already quotes.
fn one_line(error: &Error) -> String {
    let mut line = String::new();
    for cause in error.chain() {
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
    let mut signalled = false;
    let installed = ctrlc::set_handler(move || {
        if std::mem::replace(&mut signalled, true) {
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
    use anyhow::Context;

    fn failed(source: impl std::error::Error + Send + Sync + 'static) -> Error {
        Err::<(), _>(source).context("the scan cannot be read").unwrap_err()
    }

    #[test]
    fn failures_are_one_line() {
        let error = failed(io::Error::other("line one\n  line two\n")).context("walk");
        assert_eq!(one_line(&error), "walk: the scan cannot be read: line one line two");
        let quoted = Err::<(), _>(io::Error::other("bad block")).context("x.laz: bad block").unwrap_err();
        assert_eq!(one_line(&quoted), "x.laz: bad block");
    }

    #[test]
    fn exit_codes_follow_the_cause() {
        let misuse = || failed(Usage("no".into()));
        let config = || crate::config::load(&[], None, &["frame.x=1".into()]).unwrap_err();
        assert!(is_usage(&misuse()) && is_usage(&failed(config())));
        assert!(!is_usage(&failed(io::Error::other("x"))));
        assert!(is_closed_pipe(&failed(io::Error::from(io::ErrorKind::BrokenPipe))));
        assert!(!is_closed_pipe(&misuse()));
    }
}

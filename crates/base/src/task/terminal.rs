//! The terminal's look at a count: a bar that is drawn over and over, or, where stderr is no terminal, a line every few
//! seconds. It looks by itself, from a thread of its own, so that counting costs the workers nothing.

use super::{Count, Done, Watch};
use indicatif::{HumanCount, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// Time between two looks of a bar.
const LOOK_EVERY: Duration = Duration::from_millis(100);
/// Time between two lines in a log.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Shows a count until it is dropped.
#[derive(Debug)]
pub(super) struct Terminal {
    /// Sender that is dropped to end the thread.
    end: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Terminal {
    /// Begins to show a count. `None` if the system has no thread for it: the work goes on unseen.
    pub(super) fn show(count: Arc<Count>) -> Option<Self> {
        let (end, ended) = channel::<()>();
        let looking = move || {
            let bar = std::io::stderr().is_terminal().then(|| bar(&count.now()));
            let pause = if bar.is_some() { LOOK_EVERY } else { LINE_EVERY };
            while ended.recv_timeout(pause) == Err(RecvTimeoutError::Timeout) {
                match &bar {
                    Some(bar) => bar.set_position(count.now().done),
                    None => eprintln!("{}", line(&count.now())),
                }
            }
            if let Some(bar) = bar {
                bar.finish_and_clear();
            }
        };
        let thread = std::thread::Builder::new().name("progress".into()).spawn(looking).ok()?;
        Some(Self { end: Some(end), thread: Some(thread) })
    }
}

impl Watch for Terminal {}

impl Drop for Terminal {
    fn drop(&mut self) {
        self.end = None;
        // A panic of the thread has been told. The join makes sure that the bar is gone before anything else is on
        // stderr.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

fn bar(now: &Done) -> ProgressBar {
    let unit = now.unit;
    let style =
        format!("{{prefix:>9}} [{{bar:40}}] {{percent:>3}}% {{human_pos}} of {{human_len}} {unit} {{eta}}");
    let bar = ProgressBar::with_draw_target(Some(now.total), ProgressDrawTarget::stderr_with_hz(10));
    // The template is a constant of ours: a mistake in it shows at the first start.
    bar.set_style(ProgressStyle::with_template(&style).expect("progress template").progress_chars("=> "));
    bar.with_prefix(now.what)
}

/// A line such as "reading: 40 %, 400,000 of 1,000,000 points".
fn line(now: &Done) -> String {
    let Done { what, unit, done, total } = *now;
    let percent = (100.0 * now.fraction()) as u64;
    format!("{what}: {percent} %, {} of {} {unit}", HumanCount(done), HumanCount(total))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_the_numbers() {
        let now = Done { what: "reading", unit: "points", done: 400_000, total: 1_000_000 };
        assert_eq!(line(&now), "reading: 40 %, 400,000 of 1,000,000 points");
        let more = Done { done: 2_000_000, ..now };
        assert_eq!(line(&more), "reading: 100 %, 2,000,000 of 1,000,000 points");
    }
}

//! Progress of long work: a bar on a terminal, lines in a log otherwise; and the wish to stop.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Set when the user asked to stop (Ctrl-C, window closed); long work looks at it often.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Asks everything that shares this to end.
    pub fn request(&self) {
        self.0.store(true, Ordering::Release);
    }

    /// True once asked.
    #[must_use]
    pub fn requested(&self) -> bool {
        self.0.load(Ordering::Acquire)
    }
}

/// Shared by worker threads; cheap to call often.
#[derive(Debug)]
pub struct Progress {
    what: &'static str,
    done: AtomicU64,
    total: AtomicU64,
    bar: Option<ProgressBar>,
    last_line: Mutex<Instant>,
    stop: Stop,
}

impl Progress {
    /// `what` in a word or two ("reading"), `unit` of the count ("points", "bytes").
    #[must_use]
    pub fn new(what: &'static str, unit: &'static str, total: u64, stop: &Stop) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = format!(
                "{{prefix:>9}} [{{bar:40}}] {{percent:>3}}% {{human_pos}} of {{human_len}} {unit} {{eta}}"
            );
            let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr_with_hz(10));
            // The template is a constant of ours: a mistake in it shows at the first start.
            bar.set_style(
                ProgressStyle::with_template(&style).expect("progress template").progress_chars("=> "),
            );
            bar.with_prefix(what)
        });
        Self {
            what,
            done: AtomicU64::new(0),
            total: AtomicU64::new(total),
            bar,
            last_line: Mutex::new(Instant::now()),
            stop: stop.clone(),
        }
    }

    /// One that shows nothing and never stops; for tests and short work.
    #[must_use]
    pub fn hidden() -> Self {
        Self::silent(&Stop::default())
    }

    /// One that shows nothing; for work whose progress another shows.
    #[must_use]
    pub fn silent(stop: &Stop) -> Self {
        Self {
            what: "",
            done: AtomicU64::new(0),
            total: AtomicU64::new(u64::MAX),
            bar: None,
            last_line: Mutex::new(Instant::now() + Duration::from_secs(1 << 30)),
            stop: stop.clone(),
        }
    }

    /// `count` more are done.
    pub fn add(&self, count: u64) {
        let done = self.done.fetch_add(count, Ordering::Relaxed) + count;
        if let Some(bar) = &self.bar {
            bar.set_position(done);
        } else if let Ok(mut last) = self.last_line.try_lock()
            && Instant::now().saturating_duration_since(*last) > Duration::from_secs(5)
        {
            *last = Instant::now();
            let total = self.total.load(Ordering::Relaxed).max(1);
            eprintln!("{}: {}%", self.what, 100 * done.min(total) / total);
        }
    }

    /// How many are done.
    #[must_use]
    pub fn done(&self) -> u64 {
        self.done.load(Ordering::Relaxed)
    }

    /// Part of the whole that is done, 0 to 1.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        let total = self.total.load(Ordering::Relaxed).max(1);
        (self.done() as f64 / total as f64).min(1.0)
    }

    /// True once the user asked to stop; the work then returns early.
    #[must_use]
    pub fn stopped(&self) -> bool {
        self.stop.requested()
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

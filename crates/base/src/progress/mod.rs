//! Long work, seen from outside: a counter, those who look at it, and the wish to stop.
//!
//! Who does the work counts ([`Progress::add`]) and knows nobody who looks: a terminal's bar (or lines in a log) by
//! itself, a window, a headset, all by the same [`Count`]. Who starts the work says in a [`Job`] how it is told to stop
//! and who else looks on.

mod terminal;

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use terminal::Terminal;

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

/// What long work is given by whoever starts it. A plain [`Stop`] is one that only the terminal looks at.
#[derive(Clone)]
pub struct Job {
    stop: Stop,
    observer: Option<Observer>,
}

/// Is told of each piece of work as it begins, and may look at its count from then on.
type Observer = Arc<dyn Fn(&Arc<Count>) + Send + Sync>;

impl Job {
    /// Work that `observer` looks at, too.
    #[must_use]
    pub fn observed(stop: &Stop, observer: impl Fn(&Arc<Count>) + Send + Sync + 'static) -> Self {
        Self { stop: stop.clone(), observer: Some(Arc::new(observer)) }
    }

    /// How it is told to stop.
    #[must_use]
    pub fn stop(&self) -> &Stop {
        &self.stop
    }
}

impl From<&Stop> for Job {
    fn from(stop: &Stop) -> Self {
        Self { stop: stop.clone(), observer: None }
    }
}

impl From<&Job> for Job {
    fn from(job: &Job) -> Self {
        job.clone()
    }
}

impl fmt::Debug for Job {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { stop, observer } = self;
        f.debug_struct("Job").field("stop", stop).field("is_observed", &observer.is_some()).finish()
    }
}

/// How far a piece of work is; anybody may look at any time.
#[derive(Debug)]
pub struct Count {
    what: &'static str,
    unit: &'static str,
    done: AtomicU64,
    total: u64,
}

impl Count {
    /// Of work whose parts nobody counts.
    #[must_use]
    pub fn uncounted(what: &'static str) -> Self {
        Self { what, unit: "", done: AtomicU64::new(0), total: 0 }
    }

    /// As it is now.
    #[must_use]
    pub fn now(&self) -> Done {
        let Self { what, unit, total, .. } = *self;
        Done { what, unit, done: self.done.load(Ordering::Relaxed), total }
    }
}

/// How far a piece of work was at some moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Done {
    /// In a word or two: "reading".
    pub what: &'static str,
    /// What is counted: "points", "bytes".
    pub unit: &'static str,
    /// How many are done.
    pub done: u64,
    /// Of how many, as far as was known before; 0: nobody counts.
    pub total: u64,
}

impl Done {
    /// Part of the whole that is done, 0 to 1.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        (self.done as f64 / self.total.max(1) as f64).min(1.0)
    }
}

/// The worker's side: counts, and asks whether to stop. Shared by worker threads; cheap to call often.
#[derive(Debug)]
pub struct Progress {
    count: Arc<Count>,
    stop: Stop,
    /// Looks at the count until the work is done.
    _terminal: Option<Terminal>,
}

impl Progress {
    /// `what` in a word or two ("reading"), `unit` of the count ("points", "bytes").
    #[must_use]
    pub fn new(what: &'static str, unit: &'static str, total: u64, job: impl Into<Job>) -> Self {
        let Job { stop, observer } = job.into();
        let count = Arc::new(Count { what, unit, done: AtomicU64::new(0), total });
        if let Some(observer) = observer {
            observer(&count);
        }
        let terminal = Terminal::show(Arc::clone(&count));
        Self { count, stop, _terminal: terminal }
    }

    /// One that nobody looks at and nobody stops; for tests and short work.
    #[must_use]
    pub fn hidden() -> Self {
        Self::silent(&Stop::default())
    }

    /// One that nobody looks at; for work whose progress another shows.
    #[must_use]
    pub fn silent(stop: &Stop) -> Self {
        let count = Count { what: "", unit: "", done: AtomicU64::new(0), total: u64::MAX };
        Self { count: Arc::new(count), stop: stop.clone(), _terminal: None }
    }

    /// `count` more are done.
    pub fn add(&self, count: u64) {
        self.count.done.fetch_add(count, Ordering::Relaxed);
    }

    /// How many are done.
    #[must_use]
    pub fn done(&self) -> u64 {
        self.count.now().done
    }

    /// Part of the whole that is done, 0 to 1.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        self.count.now().fraction()
    }

    /// True once the user asked to stop; the work then returns early.
    #[must_use]
    pub fn stopped(&self) -> bool {
        self.stop.requested()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn whoever_looks_sees_the_same_count() {
        let seen: Arc<Mutex<Vec<Arc<Count>>>> = Arc::default();
        let (stop, observed) = (Stop::default(), Arc::clone(&seen));
        let job = Job::observed(&stop, move |count| observed.lock().unwrap().push(Arc::clone(count)));
        let reading = Progress::new("reading", "points", 200, &job);
        reading.add(50);
        let count = Arc::clone(&seen.lock().unwrap()[0]);
        assert_eq!(count.now(), Done { what: "reading", unit: "points", done: 50, total: 200 });
        assert_eq!((count.now().fraction(), reading.fraction()), (0.25, 0.25));
        // A header that claims too little, or nothing.
        reading.add(1000);
        assert_eq!(count.now().fraction(), 1.0);
        drop(Progress::new("sorting", "points", 0, &job));
        let sorting = Arc::clone(&seen.lock().unwrap()[1]);
        assert_eq!((sorting.now().what, sorting.now().fraction()), ("sorting", 0.0));
        assert!(!reading.stopped());
        stop.request();
        assert!(reading.stopped() && job.stop().requested());
        // Without an observer nobody is told.
        drop(Progress::new("reading", "points", 1, &stop));
        assert_eq!(seen.lock().unwrap().len(), 2);
    }
}

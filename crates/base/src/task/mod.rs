//! Long work as seen from outside: what cancels it, what it counts, and who looks at the count.
//!
//! Whoever starts work makes a [`Task`]: it can be cancelled, and observers look at it (a terminal, a window, later a
//! headset). The code that does the work begins a piece of it, counts ([`Progress::add`]), and knows none of the
//! observers.

mod terminal;

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// A flag that is set when the user asked to stop (Ctrl-C, window closed); long work looks at it often.
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<Flag>);

#[derive(Debug, Default)]
struct Flag {
    is_set: AtomicBool,
    parent: Option<CancelToken>,
}

impl CancelToken {
    /// A token for a part of the work: it is cancelled with the whole, or alone.
    #[must_use]
    pub fn child(&self) -> Self {
        Self(Arc::new(Flag { is_set: AtomicBool::new(false), parent: Some(self.clone()) }))
    }

    /// Asks everything that shares this to end.
    pub fn cancel(&self) {
        self.0.is_set.store(true, Ordering::Release);
    }

    /// True once somebody asked to end.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.is_set.load(Ordering::Acquire) || self.0.parent.as_ref().is_some_and(Self::is_cancelled)
    }
}

/// The work ended because somebody asked for it, and for no reason of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, thiserror::Error)]
#[error("stopped before the end")]
pub struct Cancelled;

/// Is called with the count of each piece of work as it begins, and may look at it from then on. What it returns is
/// dropped when the piece ends.
type Observer = Arc<dyn Fn(&Arc<Count>) -> Option<Box<dyn Watch>> + Send + Sync>;

/// What an observer keeps while a piece of work goes on.
trait Watch: fmt::Debug + Send + Sync {}

/// Long work as whoever starts it sees it.
#[derive(Clone)]
pub struct Task {
    cancel: CancelToken,
    observers: Vec<Observer>,
}

impl Task {
    /// Work that nobody looks at.
    #[must_use]
    pub fn new(cancel: &CancelToken) -> Self {
        Self { cancel: cancel.clone(), observers: Vec::new() }
    }

    /// Work that the terminal shows: as a bar, or, where stderr is no terminal, by a line every few seconds.
    #[must_use]
    pub fn in_terminal(cancel: &CancelToken) -> Self {
        let terminal: Observer = Arc::new(|count| {
            terminal::Terminal::show(Arc::clone(count)).map(|terminal| Box::new(terminal) as Box<dyn Watch>)
        });
        Self { cancel: cancel.clone(), observers: vec![terminal] }
    }

    /// The same work, which `observer` looks at, too.
    #[must_use]
    pub fn observed(mut self, observer: impl Fn(&Arc<Count>) + Send + Sync + 'static) -> Self {
        self.observers.push(Arc::new(move |count| {
            observer(count);
            None
        }));
        self
    }

    /// The token that cancels the work.
    #[must_use]
    pub fn cancel_token(&self) -> &CancelToken {
        &self.cancel
    }

    /// Begins a piece of the work: `what` in a word or two ("reading"), `unit` of the count ("points", "bytes").
    #[must_use]
    pub fn begin(&self, what: &'static str, unit: &'static str, total: u64) -> Progress {
        let count = Arc::new(Count { what, unit, done: AtomicU64::new(0), total });
        let watches = self.observers.iter().filter_map(|observer| observer(&count)).collect();
        Progress { count, cancel: self.cancel.clone(), _watches: watches }
    }
}

/// A task that nobody looks at.
impl From<&CancelToken> for Task {
    fn from(cancel: &CancelToken) -> Self {
        Self::new(cancel)
    }
}

impl From<&Task> for Task {
    fn from(task: &Task) -> Self {
        task.clone()
    }
}

impl fmt::Debug for Task {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { cancel, observers } = self;
        f.debug_struct("Task").field("cancel", cancel).field("num_observers", &observers.len()).finish()
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
    /// The count as it is now.
    #[must_use]
    pub fn now(&self) -> Done {
        let Self { what, unit, total, .. } = *self;
        Done { what, unit, done: self.done.load(Ordering::Relaxed), total }
    }
}

/// How far a piece of work was at some moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Done {
    /// Name of the work in a word or two: "reading".
    pub what: &'static str,
    /// What is counted: "points", "bytes".
    pub unit: &'static str,
    /// How many are done.
    pub done: u64,
    /// How many there are in all, as far as was known before; 0: unknown.
    pub total: u64,
}

impl Done {
    /// Part of the whole that is done, 0 to 1.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        (self.done as f64 / self.total.max(1) as f64).min(1.0)
    }
}

/// The worker's side of a piece of work: counts, and asks whether to go on. Shared by worker threads; cheap to call
/// often.
#[derive(Debug)]
pub struct Progress {
    count: Arc<Count>,
    cancel: CancelToken,
    /// Observers' values, kept until the work is done.
    _watches: Vec<Box<dyn Watch>>,
}

impl Progress {
    /// A progress that nobody looks at and nobody cancels; for tests and short work.
    #[must_use]
    pub fn hidden() -> Self {
        Self::silent(&CancelToken::default())
    }

    /// A progress that nobody looks at; for work whose progress another shows.
    #[must_use]
    pub fn silent(cancel: &CancelToken) -> Self {
        Task::new(cancel).begin("", "", u64::MAX)
    }

    /// Counts `count` more as done.
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

    /// True once the user asked to stop.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.cancel.is_cancelled()
    }

    /// Tells whether to go on.
    ///
    /// # Errors
    /// If the user asked to stop; the work then returns early.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn a_part_ends_with_the_whole_or_alone() {
        let whole = CancelToken::default();
        let [first, second] = [whole.child(), whole.child()];
        first.cancel();
        assert!(first.is_cancelled() && !second.is_cancelled() && !whole.is_cancelled());
        whole.cancel();
        assert!(second.is_cancelled() && second.child().is_cancelled());
    }

    #[test]
    fn whoever_looks_sees_the_same_count() {
        let seen: Arc<Mutex<Vec<Arc<Count>>>> = Arc::default();
        let (cancel, observed) = (CancelToken::default(), Arc::clone(&seen));
        let task = Task::new(&cancel).observed(move |count| observed.lock().unwrap().push(Arc::clone(count)));
        let reading = task.begin("reading", "points", 200);
        reading.add(50);
        let count = Arc::clone(&seen.lock().unwrap()[0]);
        assert_eq!(count.now(), Done { what: "reading", unit: "points", done: 50, total: 200 });
        assert_eq!((count.now().fraction(), reading.fraction()), (0.25, 0.25));
        // A header may claim too few points, or none.
        reading.add(1000);
        assert_eq!(count.now().fraction(), 1.0);
        drop(task.begin("sorting", "points", 0));
        let sorting = Arc::clone(&seen.lock().unwrap()[1]);
        assert_eq!((sorting.now().what, sorting.now().fraction()), ("sorting", 0.0));
        assert_eq!(reading.check(), Ok(()));
        cancel.cancel();
        assert_eq!(reading.check(), Err(Cancelled));
        assert!(task.cancel_token().is_cancelled());
        // Without an observer nobody is told.
        drop(Task::new(&cancel).begin("reading", "points", 1));
        assert_eq!(seen.lock().unwrap().len(), 2);
    }
}

//! Which headset a walk has: a real one where one answers, else the simulated one, until a real one answers.
//!
//! ```text
//!            session lost: same GPU          runtime answers
//!   real ───────────────────────▶ simulated ───────────────▶ real
//!        runtime lost: GPU stays            same GPU if its runtime has never gone, else another
//!        GPU lost: another GPU
//! ```
//!
//! A [`Seeker`] looks for a headset from a thread of its own, since a runtime may take its time to answer. All else
//! happens on the frame thread, between two frames.

use super::filling::{Filler, Loaded, ScanRequest};
use super::link::WalkEnd;
use super::simulated::{SimulatedHeadset, SimulatedOptions};
use crate::draw::no_gpu;
use render::gpu::{Gpu, GpuError};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};
use xr::{Connection, End, Headset, XrHeadset, XrMissing, XrOptions};

/// Time between two looks for a headset.
const LOOK_EVERY: Duration = Duration::from_secs(2);
/// Longest time between two looks for a headset that is lost as soon as it is there.
const LOOK_AT_LEAST_EVERY: Duration = Duration::from_secs(16);
/// A session that lasted this long was none that is lost as soon as it is there.
const LASTING: Duration = Duration::from_secs(10);

/// Use of something that may be absent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Use it if it is there.
    Auto,
    /// Fail without it.
    On,
    /// Do not use it.
    Off,
}

/// Where a walk gets its headsets from.
pub trait Headsets {
    /// The headset that there is, and the GPU that its images live on.
    fn current(&mut self) -> (Arc<Gpu>, &mut dyn Headset);
    /// The scan on its way to the current GPU: once for each GPU, and for each scan that was opened.
    fn take_filling(&mut self) -> Option<Receiver<Loaded>>;
    /// Has another scan brought to the current GPU.
    fn open_scan(&mut self, scan: Arc<ScanRequest>);
    /// True if another headset has come; the walk leaves the current one for it. It waits for nobody.
    fn has_another(&mut self) -> bool;
    /// Looks for a headset at once, if one is looked for. It waits for nobody.
    fn look_now(&mut self);
    /// Puts another headset in the place of the current one, which has ended for this reason, or which another has come
    /// for. False if the walk ends with it.
    ///
    /// # Errors
    /// The walk cannot go on without it.
    fn replace(&mut self, end: Option<&End>) -> Result<bool, CannotGoOn>;
}

/// Why a walk cannot go on without its headset.
#[derive(Debug, thiserror::Error)]
pub enum CannotGoOn {
    /// The headset that is required is gone.
    #[error("--headset require: {0}")]
    Required(End),
    /// The GPU is lost, and no other can be opened.
    #[error("{end}; no other can be opened: {}", no_gpu(source))]
    NoGpu {
        /// The loss.
        end: End,
        /// Why there is no other.
        source: Box<GpuError>,
    },
}

/// Why there is no headset to begin a walk with.
#[derive(Debug, thiserror::Error)]
pub enum NoHeadset {
    /// A real one is required.
    #[error("--headset require")]
    Required(#[source] XrMissing),
    /// There is no GPU to simulate one on.
    #[error("{}", no_gpu(.0))]
    Gpu(#[from] GpuError),
}

/// What is asked of headsets.
#[derive(Clone, Debug)]
pub struct HeadsetOptions {
    /// Whether to use a real one.
    pub wish: Wish,
    /// What its runtime is asked for.
    pub real: XrOptions,
    /// What the simulated one is like.
    pub simulated: SimulatedOptions,
    /// Part of the name of the GPU to open where no runtime chooses it.
    pub adapter: String,
}

/// The headset of a walk, real while it can be.
pub struct SoughtHeadsets {
    options: HeadsetOptions,
    link: WalkEnd,
    filler: Filler,
    /// `None` only while it is replaced.
    current: Option<Current>,
    filling: Option<Receiver<Loaded>>,
    /// Looks for a real headset while the current one is simulated, if one is wished for.
    seeker: Option<Seeker>,
    found: Option<Connection>,
    /// True once nothing could be drawn for a headset that was found: it would be found again.
    is_unusable: bool,
    since: Instant,
    pause: Duration,
}

enum Current {
    Real(Box<XrHeadset>),
    Simulated(Arc<Gpu>, Box<SimulatedHeadset>),
}

impl Current {
    fn gpu(&self) -> &Arc<Gpu> {
        match self {
            Self::Real(headset) => headset.gpu(),
            Self::Simulated(gpu, _) => gpu,
        }
    }
}

impl SoughtHeadsets {
    /// Opens the headset that is wished for, and has `filler` bring the scan to its GPU.
    ///
    /// # Errors
    /// See [`NoHeadset`].
    pub fn open(options: HeadsetOptions, link: WalkEnd, filler: Filler) -> Result<Self, NoHeadset> {
        let real = match options.wish {
            Wish::Off => None,
            wish => match Connection::new().and_then(|connection| connection.open(&options.real)) {
                Ok(headset) => Some(headset),
                Err(missing) if wish == Wish::On => return Err(NoHeadset::Required(missing)),
                Err(missing) => {
                    eprintln!(
                        "scanwalk: no headset, so a simulated one is used until one answers: {missing}"
                    );
                    None
                }
            },
        };
        let current = match real {
            Some(headset) => Current::Real(Box::new(headset)),
            None => simulated(Arc::new(Gpu::open(Some(&options.adapter))?), &options),
        };
        let mut headsets = Self {
            options,
            link,
            filler,
            current: None,
            filling: None,
            seeker: None,
            found: None,
            is_unusable: false,
            since: Instant::now(),
            pause: LOOK_EVERY,
        };
        headsets.set(current, None);
        Ok(headsets)
    }

    /// Makes a headset the current one; a simulated one has a seeker, which begins with `kept`.
    fn set(&mut self, current: Current, kept: Option<Connection>) {
        let is_new = self.link.set_gpu(current.gpu());
        if is_new {
            self.filling = Some(self.filler.fill(current.gpu()));
        }
        let seeks = self.options.wish != Wish::Off && !self.is_unusable;
        self.seeker = match current {
            Current::Simulated(..) if seeks => Some(Seeker::start(kept, self.pause)),
            _ => None,
        };
        self.since = Instant::now();
        self.current = Some(current);
        let runtime = self.current().1.runtime();
        let is_sought = self.seeker.is_some();
        self.link.update_headset(|headset| (headset.runtime, headset.is_sought) = (runtime, is_sought));
    }

    /// The current headset is simulated from now on, on its own GPU if it can be.
    fn simulate(&mut self, end: &End) -> Result<(), CannotGoOn> {
        self.pause = if self.since.elapsed() < LASTING {
            (2 * self.pause).min(LOOK_AT_LEAST_EVERY)
        } else {
            LOOK_EVERY
        };
        self.is_unusable |= matches!(end, End::Unusable(_));
        let current = self.current.take();
        if let End::DeviceLost(_) = end {
            // All of it goes before another GPU is opened: nothing on it can be used any more.
            drop(current);
            let opened = Gpu::open(Some(&self.options.adapter));
            let gpu =
                opened.map_err(|source| CannotGoOn::NoGpu { end: end.clone(), source: Box::new(source) })?;
            self.set(simulated(Arc::new(gpu), &self.options), None);
            return Ok(());
        }
        let Some(current) = current else { return Ok(()) };
        let gpu = Arc::clone(current.gpu());
        let kept = match (current, end) {
            (Current::Real(headset), End::ByRuntime | End::SessionLost(_)) => Some(headset.into_connection()),
            _ => None,
        };
        self.set(simulated(gpu, &self.options), kept);
        Ok(())
    }

    /// Opens the headset that was found; if that fails, the current one stays.
    fn take_found(&mut self) {
        let Some(found) = self.found.take() else { return };
        match found.open(&self.options.real) {
            Ok(headset) => {
                let name = headset.name().to_owned();
                self.set(Current::Real(Box::new(headset)), None);
                self.say(None, &format!("the headset '{name}' is used from now on"));
            }
            Err(missing) => {
                self.pause = (2 * self.pause).min(LOOK_AT_LEAST_EVERY);
                tracing::warn!("a headset answers, but cannot be used: {missing}");
                if let Some(current) = self.current.take() {
                    self.set(current, None);
                }
            }
        }
    }

    /// Tells the user, in the terminal and in the window; `waiting_because` stays in the window.
    fn say(&self, waiting_because: Option<String>, text: &str) {
        eprintln!("scanwalk: {text}");
        self.link.update_headset(|headset| headset.waiting_because = waiting_because);
        self.link.set_notice(text.to_owned());
    }
}

impl Headsets for SoughtHeadsets {
    fn current(&mut self) -> (Arc<Gpu>, &mut dyn Headset) {
        // Only `simulate` and `take_found` take it, and put another in its place; if the first fails, the walk is over.
        match self.current.as_mut().expect("there is always a headset while a walk goes on") {
            Current::Real(headset) => (Arc::clone(headset.gpu()), &mut **headset),
            Current::Simulated(gpu, headset) => (Arc::clone(gpu), &mut **headset),
        }
    }

    fn take_filling(&mut self) -> Option<Receiver<Loaded>> {
        self.filling.take()
    }

    fn open_scan(&mut self, scan: Arc<ScanRequest>) {
        self.filler.want(scan);
        if let Some(current) = &self.current {
            self.filling = Some(self.filler.fill(current.gpu()));
        }
    }

    fn has_another(&mut self) -> bool {
        if let Some(found) = self.seeker.as_ref().and_then(Seeker::found) {
            self.found = Some(found);
        }
        self.found.is_some()
    }

    fn look_now(&mut self) {
        if let Some(seeker) = &self.seeker {
            // Sending fails if it has just found one.
            let _ = seeker.wake.send(());
        }
    }

    fn replace(&mut self, end: Option<&End>) -> Result<bool, CannotGoOn> {
        let Some(end) = end else {
            self.take_found();
            return Ok(true);
        };
        let was_real = matches!(self.current, Some(Current::Real(_)));
        match end {
            End::ByUser => return Ok(false),
            end if self.options.wish == Wish::On && was_real => {
                return Err(CannotGoOn::Required(end.clone()));
            }
            end => self.simulate(end)?,
        }
        let awaited = self.seeker.is_some();
        let then = if awaited {
            "; the walk goes on without a headset until one answers"
        } else {
            "; the walk goes on"
        };
        self.say(awaited.then(|| end.to_string()), &format!("{end}{then}"));
        Ok(true)
    }
}

fn simulated(gpu: Arc<Gpu>, options: &HeadsetOptions) -> Current {
    let headset = Box::new(SimulatedHeadset::new(&gpu, options.simulated));
    Current::Simulated(gpu, headset)
}

/// Looks for a headset until it finds one or is dropped.
struct Seeker {
    found: Receiver<Connection>,
    /// Has the thread look at once, or end when it is dropped.
    wake: Sender<()>,
}

impl Seeker {
    /// Begins to look after a pause, by `kept` as long as that answers.
    fn start(kept: Option<Connection>, pause: Duration) -> Self {
        let (wake, woken) = channel();
        let (sender, found) = channel();
        // Without a thread the walk goes on, and finds no headset.
        let _ = std::thread::Builder::new().name("headset".into()).spawn(move || {
            let mut kept = kept;
            while woken.recv_timeout(pause) != Err(RecvTimeoutError::Disconnected) {
                let answers = kept.take().filter(|kept| kept.check().is_ok());
                if let Some(connection) = answers.or_else(|| Connection::new().ok()) {
                    // Sending fails if nobody waits any more.
                    let _ = sender.send(connection);
                    return;
                }
            }
        });
        Self { found, wake }
    }

    fn found(&self) -> Option<Connection> {
        self.found.try_recv().ok()
    }
}

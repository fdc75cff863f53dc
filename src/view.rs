//! The main job: walk through a scan, in a headset, in a window, or with nobody looking.
//!
//! These are its threads: the loader reads the scan and sends it to the GPU, node by node ([`crate::loader`]); the frame
//! thread draws ([`crate::walk`]); one paints the card ([`crate::desktop::card`]), one the menu ([`crate::desktop::menu`]); the main thread runs the window, if there
//! is one.

use crate::desktop::{self, Display};
use crate::ending::Ending;
use crate::failure::Failure;
use crate::loader::Loader;
use crate::resolve::Plan;
use crate::walk::Walk;
use crate::walk::filling::{Filler, ScanRequest};
use crate::walk::headsets::{Headsets, SoughtHeadsets, Wish};
use crate::walk::link;
use base::output::Output;
use base::task::CancelToken;
use base::words::counted;
use render::gpu::Gpu;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use timing::RunFacts;
use timing::log::FrameLog;
use timing::pose_path::PosePath;
use xr::Headset;

/// How long a headset without a window shows why the scan could not be loaded.
const ERROR_STAYS: Duration = Duration::from_secs(10);
/// How long the end of a walk waits for a runtime or a driver that does not answer. A user waits for two seconds at most,
/// of which the rest of the end has what is left.
const LEAVE_WITHIN: Duration = Duration::from_millis(1500);
/// Time between two looks whether a thread has ended.
const LOOK_EVERY: Duration = Duration::from_millis(10);

/// How to walk.
#[derive(Clone, Debug)]
pub struct ViewOptions {
    /// Files, shown as one cloud; none if they are chosen in the window.
    pub scans: Vec<PathBuf>,
    /// Whether to use a headset.
    pub headset: Wish,
    /// Whether to open a window.
    pub window: Wish,
    /// Frame log to write.
    pub log: Option<Output>,
    /// Stop after this many frames that showed the scan.
    pub frames: Option<u64>,
    /// Stop this many seconds after the scan was first shown.
    pub seconds: Option<f64>,
    /// Head path to replay.
    pub pose_path: Option<PathBuf>,
}

/// What has become of a walk's threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Threads {
    /// All have ended.
    Ended,
    /// A runtime or a driver keeps one, which goes on while the program ends.
    LeftBehind,
}

impl ViewOptions {
    /// True if a limit ends the walk: whoever sets one may not be there at the end.
    fn ends_by_itself(&self) -> bool {
        self.frames.is_some() || self.seconds.is_some()
    }
}

/// Walks until the user or a limit ends it. `threads` says afterwards whether all have ended.
///
/// # Errors
/// Unreadable scan, no usable GPU, a headset or window that was required and is missing, a frame log that cannot
/// be begun, a device that fails and cannot be replaced.
pub fn run(
    options: &ViewOptions,
    plan: &Plan,
    stop: &CancelToken,
    threads: &mut Threads,
) -> Result<(), Failure> {
    let pose_path = options.pose_path.as_deref().map(PosePath::read).transpose()?;
    let display = open_display(options.window, stop)?;
    if stop.is_cancelled() {
        return Ok(());
    }
    if options.scans.is_empty() && display.is_none() {
        let what_to_do = "name a scan, as in `scanwalk view castle.laz`; only a window lets one choose";
        return Err(Failure::Usage(format!("no scan: {what_to_do}")));
    }
    let at_start = plan.state_at_start().snapshot();
    let (link, actions, viewer) = link::link(at_start);
    let request = ScanRequest { files: options.scans.clone(), read: plan.read.clone(), kind: plan.kind };
    let (filler, fillings) = Filler::new(Arc::new(request), stop);
    let mut headsets = SoughtHeadsets::open(plan.headsets(options.headset), link.clone(), filler)?;
    let (gpu, headset) = headsets.current();
    let facts = facts(options, plan, &gpu, headset);
    let log = options.log.as_ref().map(|output| FrameLog::start(output, &facts)).transpose()?.map(Arc::new);
    let ending = Arc::new(Ending::new(stop));

    // The threads borrow nothing, for they may have to be left behind.
    let loader = Loader { options: plan.cloud, link: link.clone(), stop: stop.clone() };
    // A window stays until the user has read the error and closes it, unless nobody may be there. Who wears a headset
    // without a window reads it for some seconds, for a script may wait for the end.
    let error_stays = match &display {
        _ if options.ends_by_itself() => Duration::ZERO,
        Some(_) => Duration::MAX,
        None if headset.is_simulated() => Duration::ZERO,
        None => ERROR_STAYS,
    };
    let loader = thread(&ending, move |ending| {
        // What failed before is of no account once another scan is wanted.
        loader.run(
            &fillings,
            || ending.forgive(),
            |error| {
                if error_stays.is_zero() {
                    ending.fail(error.into());
                } else {
                    // Whoever looks at the terminal need not wait for the end.
                    tracing::warn!("the scan could not be loaded: {error}");
                    ending.fail_later(error.into());
                }
            },
        );
    });
    let paint_end = link.paint_end();
    let walk = Walk {
        draw: plan.draw,
        options: plan.walk,
        actions,
        link,
        mirrored: display.is_some(),
        log: log.clone(),
        pose_path,
        max_frames: options.frames,
        max_time: options.seconds.map(Duration::from_secs_f64),
        error_stays,
        stop: stop.clone(),
    };
    let (walk_stop, has_window) = (stop.clone(), display.is_some());
    let frames = thread(&ending, move |ending| {
        let summary = walk.run(&mut headsets).map_err(|error| ending.fail(error.into())).ok();
        // The end of the walk ends the others too, except a window that still shows what has failed.
        if !ending.has_failed() || !has_window {
            walk_stop.cancel();
        }
        summary
    });
    let (card_stop, menu_stop, menu_end) = (stop.clone(), stop.clone(), paint_end.clone());
    let card = thread(&ending, move |_| desktop::card::paint(&paint_end, &card_stop));
    let menu_actions = viewer.actions.clone();
    let menu = thread(&ending, move |_| desktop::menu::paint(&menu_end, &menu_actions, &menu_stop));
    if let Some(display) = display {
        match display.run(viewer, plan.window.clone(), stop.clone()) {
            Err(error) if options.window == Wish::Auto => eprintln!("scanwalk: no window: {error}"),
            Err(error) => ending.fail(error.into()),
            Ok(()) => {}
        }
    }
    let mut leaving = Leaving { stop, since: None, threads };
    let summary = leaving.join(frames).flatten();
    leaving.join(loader);
    leaving.join(card);
    leaving.join(menu);
    // After a failure, a log without a frame of the scan is dropped, so that an older log stays.
    ending.take_result()?;
    finish_log(log.as_deref(), options);
    if let Some(summary) = summary {
        tracing::info!(
            "{}, {} of the scan; ended {}",
            counted(summary.frames, "frame"),
            summary.scan_frames,
            summary.ended
        );
    }
    Ok(())
}

/// Starts a thread that stops the others if it panics.
fn thread<T: Send + 'static>(
    ending: &Arc<Ending>,
    work: impl FnOnce(&Ending) -> T + Send + 'static,
) -> JoinHandle<T> {
    let ending = Arc::clone(ending);
    std::thread::spawn(move || {
        let _guard = ending.guard();
        work(&ending)
    })
}

/// How long the end of a walk waits for its threads.
struct Leaving<'a> {
    stop: &'a CancelToken,
    /// When the end was first seen to be asked for.
    since: Option<Instant>,
    threads: &'a mut Threads,
}

impl Leaving<'_> {
    /// Waits for a thread's end. `None` if it does not end in time after `stop` was requested: a runtime or a driver keeps
    /// it, and the user is not to wait for them.
    fn join<T>(&mut self, thread: JoinHandle<T>) -> Option<T> {
        while !thread.is_finished() {
            if self.stop.is_cancelled()
                && self.since.get_or_insert_with(Instant::now).elapsed() > LEAVE_WITHIN
            {
                if *self.threads != Threads::LeftBehind {
                    eprintln!(
                        "scanwalk: left without waiting for the headset's software or the GPU's driver, which does not \
                         answer"
                    );
                }
                *self.threads = Threads::LeftBehind;
                return None;
            }
            std::thread::sleep(LOOK_EVERY);
        }
        // A panic is a mistake of ours: let it show as one.
        Some(thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    }
}

/// Opens the display that was wished for, before anything else is opened or read.
fn open_display(wish: Wish, stop: &CancelToken) -> Result<Option<Display>, Failure> {
    if wish == Wish::Off || wish == Wish::Auto && !desktop::is_named() {
        return Ok(None);
    }
    match Display::open(stop) {
        Ok(display) => Ok(Some(display)),
        // The user waits no longer for a display that keeps silent.
        Err(_) if stop.is_cancelled() => Ok(None),
        Err(error) if wish == Wish::On => Err(Failure::Window(error)),
        Err(error) => {
            eprintln!("scanwalk: no window: {error}");
            Ok(None)
        }
    }
}

fn facts(options: &ViewOptions, plan: &Plan, gpu: &Gpu, headset: &dyn Headset) -> RunFacts {
    let files: Vec<String> = options.scans.iter().map(|p| p.display().to_string()).collect();
    let [left, right] = headset.eye_sizes();
    let size = |[width, height]: [u32; 2]| format!("{width}x{height}");
    RunFacts {
        scan: files.join(" "),
        device: gpu.name(),
        driver: gpu.driver(),
        runtime: headset.runtime(),
        resolution: if left == right { size(left) } else { format!("{} {}", size(left), size(right)) },
        config_digest: plan.digest.clone(),
    }
}

fn finish_log(log: Option<&FrameLog>, options: &ViewOptions) {
    if let (Some(log), Some(output)) = (log, &options.log) {
        let summary = log.finish();
        if summary.error.is_some() {
            // The failure was reported when it happened.
            return;
        }
        eprintln!(
            "scanwalk: frame log: {} ({})",
            output.path().display(),
            counted(summary.num_rows, "frame")
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;

    /// Threads are held for as long as the test likes, so that only one that waits no longer comes back.
    #[test]
    fn nobody_waits_for_threads_that_are_held_once_the_end_is_asked_for() {
        assert!(LEAVE_WITHIN < Duration::from_secs(2));
        let (stop, mut threads) = (CancelToken::default(), Threads::Ended);
        let mut leaving = Leaving { stop: &stop, since: None, threads: &mut threads };
        let held = || {
            let (release, wait) = channel::<()>();
            (release, std::thread::spawn(move || wait.recv().is_ok()))
        };
        // A thread that ends is waited for, before the end is asked for and after.
        for is_asked in [false, true] {
            let (release, thread) = held();
            if is_asked {
                stop.cancel();
            }
            release.send(()).expect("the thread waits");
            assert_eq!(leaving.join(thread), Some(true));
        }
        // The second is held as long as the first: the time that is waited is for both.
        let [(first, one), (second, other)] = [held(), held()];
        assert_eq!(leaving.join(one), None);
        let since = leaving.since.expect("the end was seen");
        assert_eq!(leaving.join(other), None);
        assert_eq!((leaving.since, threads), (Some(since), Threads::LeftBehind));
        assert!(first.send(()).is_ok() && second.send(()).is_ok(), "both are still there");
    }
}

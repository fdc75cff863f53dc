//! The main job: walk through a scan, in a headset, in a window, or with nobody looking.
//!
//! There are three threads: the loader reads the scan and sends it to the GPU, node by node ([`crate::loader`]); the
//! frame thread draws ([`crate::walk`]); the main thread runs the window, if there is one.

use crate::desktop::{self, Display};
use crate::ending::Ending;
use crate::failure::Failure;
use crate::loader::Loader;
use crate::resolve::Plan;
use crate::walk::Walk;
use crate::walk::link;
use crate::walk::simulated::SimulatedHeadset;
use base::output::Output;
use base::task::CancelToken;
use base::words::counted;
use render::gpu::Gpu;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use timing::RunFacts;
use timing::log::FrameLog;
use timing::pose_path::PosePath;
use xr::Headset;

/// Use of something that may be absent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Wish {
    /// Use it if it is there.
    #[default]
    Auto,
    /// Fail without it.
    On,
    /// Do not use it.
    Off,
}

/// How to walk.
#[derive(Clone, Debug)]
pub struct ViewOptions {
    /// Files, shown as one cloud.
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

impl ViewOptions {
    /// True if a limit ends the walk: whoever sets one may not be there at the end.
    fn ends_by_itself(&self) -> bool {
        self.frames.is_some() || self.seconds.is_some()
    }
}

/// Walks until the user, the runtime or a limit ends it.
///
/// # Errors
/// Unreadable scan, no usable GPU, a headset or window that was required and is missing, a frame log that cannot
/// be begun, a runtime or device that fails.
pub fn run(options: &ViewOptions, plan: &Plan, stop: &CancelToken) -> Result<(), Failure> {
    let pose_path = options.pose_path.as_deref().map(PosePath::read).transpose()?;
    let display = open_display(options.window, stop)?;
    if stop.is_cancelled() {
        return Ok(());
    }
    let (gpu, mut headset) = open_headset(options.headset, plan)?;
    let facts = facts(options, plan, &gpu, &*headset);
    let log = options.log.as_ref().map(|output| FrameLog::start(output, &facts)).transpose()?;
    let (link, actions, viewer) = link::link();
    let windowed = display.is_some();
    let ending = Ending::new(stop);
    let (loaded_sender, loaded) = std::sync::mpsc::channel();

    let summary = std::thread::scope(|scope| {
        let ending = &ending;
        let _guard = ending.guard();
        let loader = scope.spawn({
            let (gpu, link) = (Arc::clone(&gpu), link.clone());
            move || {
                let _guard = ending.guard();
                let loader = Loader { options: &plan.cloud, gpu: &gpu, link: &link, loaded: &loaded_sender };
                let result = loader.load(&options.scans, &plan.read, stop);
                // The walk takes this for the sign that all has come.
                drop(loaded_sender);
                // No work goes on any more, however loading ended.
                link.set_doing(None);
                match result {
                    // Whoever asked for the end has the reason.
                    Err(error) if error.is_cancelled() => {}
                    Err(error) => {
                        link.update_load(|load| load.error = Some(error.to_string()));
                        // A window stays until the user has read the error and closes it, unless nobody may be there.
                        if windowed && !options.ends_by_itself() && !error.is_lost() {
                            ending.fail_later(error.into());
                        } else {
                            ending.fail(error.into());
                        }
                    }
                    Ok(()) => {}
                }
            }
        });
        let walk = Walk {
            gpu: Arc::clone(&gpu),
            draw: plan.draw,
            options: plan.walk,
            loaded,
            actions,
            link,
            mirrored: windowed,
            log: log.as_ref(),
            pose_path: pose_path.as_ref(),
            max_frames: options.frames,
            max_time: options.seconds.map(Duration::from_secs_f64),
            stop: stop.clone(),
        };
        let frames = scope.spawn(move || {
            let _guard = ending.guard();
            let summary = walk.run(&mut *headset).map_err(|error| ending.fail(error.into())).ok();
            // The end of the walk ends the window and the loader too, unless something has failed: then the failure
            // has decided.
            if !ending.has_failed() {
                stop.cancel();
            }
            summary
        });
        if let Some(display) = display {
            let facts = window_facts(options, &facts);
            let shown = display.run(Arc::clone(&gpu), viewer, facts, plan.window.clone(), stop.clone());
            match shown {
                Err(error) if options.window == Wish::Auto => eprintln!("scanwalk: no window: {error}"),
                Err(error) => ending.fail(error.into()),
                Ok(()) => {}
            }
        }
        let summary = join(frames);
        join(loader);
        summary
    });
    // After a failure, a log without a frame of the scan is dropped, so that an older log stays.
    ending.into_result()?;
    finish_log(log, options);
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

/// Opens the headset that was wished for, and the GPU that it lives on.
fn open_headset(wish: Wish, plan: &Plan) -> Result<(Arc<Gpu>, Box<dyn Headset>), Failure> {
    if wish != Wish::Off {
        match xr::open(&plan.headset) {
            Ok((gpu, headset)) => return Ok((gpu, Box::new(headset))),
            Err(missing) if wish == Wish::On => return Err(Failure::Headset(missing)),
            Err(missing) => eprintln!("scanwalk: no headset, so a simulated one is used: {missing}"),
        }
    }
    let gpu = Arc::new(Gpu::open(Some(&plan.adapter))?);
    let headset = SimulatedHeadset::new(&gpu, plan.simulated);
    Ok((gpu, Box::new(headset)))
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

/// What the window says of the walk.
fn window_facts(options: &ViewOptions, facts: &RunFacts) -> desktop::WindowFacts {
    let names = options.scans.iter().filter_map(|p| Some(p.file_name()?.display().to_string()));
    desktop::WindowFacts {
        scan: names.collect::<Vec<_>>().join(" "),
        device: facts.device.clone(),
        runtime: facts.runtime.clone(),
    }
}

fn join<T>(thread: std::thread::ScopedJoinHandle<'_, T>) -> T {
    // A panic is a mistake of ours: let it show as one.
    thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

fn finish_log(log: Option<FrameLog>, options: &ViewOptions) {
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

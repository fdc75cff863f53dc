//! The main job: walk through a scan, in a headset, in a window, or with nobody looking.
//!
//! Three threads: the loader reads the scan and sends it to the GPU; the frame thread draws ([`crate::walk`]);
//! the main thread runs the window, if there is one.

use crate::cloud::octree::build_octree;
use crate::cloud::spt::build_spt;
use crate::cloud::{self, BuildError};
use crate::config::{Config, LodMethod};
use crate::desktop;
use crate::gpu::Gpu;
use crate::progress::{Progress, Stop};
use crate::render::{CloudBuffers, CloudUpload, UploadError};
use crate::scan;
use crate::timing::RunFacts;
use crate::timing::log::FrameLog;
use crate::walk::link::{self, WalkEnd};
use crate::walk::pose_path::PosePath;
use crate::walk::simulated::SimulatedHeadset;
use crate::walk::start::start;
use crate::walk::{Headset, Loaded, Walk};
use crate::xr;
use anyhow::Context;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender};
use std::time::Duration;

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
    /// The headset.
    pub headset: Wish,
    /// The window.
    pub window: Wish,
    /// Frame log to write.
    pub log: Option<PathBuf>,
    /// Stop after so many frames that showed the scan.
    pub frames: Option<u64>,
    /// Stop so many seconds after the scan was first shown.
    pub seconds: Option<f64>,
    /// Head path to replay.
    pub pose_path: Option<PathBuf>,
}

/// Walks until the user, the runtime or a limit ends it.
///
/// # Errors
/// Unreadable scan, no usable GPU, a headset or window that was required and is missing, a frame log that cannot
/// be begun, a runtime or device that fails.
pub fn run(options: &ViewOptions, config: &Config, stop: &Stop) -> anyhow::Result<()> {
    let pose_path = options.pose_path.as_deref().map(PosePath::read).transpose()?;
    let (gpu, mut headset) = open_headset(options.headset, config)?;
    let facts = facts(options, config, &gpu, &*headset);
    let log = options.log.as_deref().map(|path| FrameLog::start(path, &facts)).transpose()?;
    let (link, commands, viewer) = link::link();
    let windowed = match options.window {
        Wish::Off => false,
        Wish::On => true,
        Wish::Auto => desktop::display_available(),
    };
    let (loaded_sender, loaded) = std::sync::mpsc::channel();
    let (retired, retired_receiver) = std::sync::mpsc::channel();

    let (summary, load, window) = std::thread::scope(|scope| {
        let loader = scope.spawn({
            let (gpu, link) = (Arc::clone(&gpu), link.clone());
            move || {
                let shelf = Shelf { loaded: loaded_sender, retired: retired_receiver };
                let result = load(options, config, &gpu, &link, stop, &shelf);
                if let Err(error) = &result {
                    link.update_load(|load| load.error = Some(format!("{error:#}")));
                    stop.request();
                }
                result
            }
        });
        let walk = Walk {
            gpu: Arc::clone(&gpu),
            config,
            loaded,
            retired,
            commands,
            link,
            mirrored: windowed,
            log: log.as_ref(),
            pose_path: pose_path.as_ref(),
            max_frames: options.frames,
            max_time: options.seconds.map(Duration::from_secs_f64),
            stop: stop.clone(),
        };
        let frames = scope.spawn(move || {
            let summary = walk.run(&mut *headset);
            // Whatever ended the walk ends the window and the loader too.
            stop.request();
            summary
        });
        let window = if windowed { show_window(options, config, &gpu, viewer, &facts, stop) } else { Ok(()) };
        (join(frames), join(loader), window)
    });
    finish_log(log, options);
    load?;
    window?;
    let summary = summary?;
    tracing::info!("{} frames, {} of the scan; ended {}", summary.frames, summary.scan_frames, summary.ended);
    Ok(())
}

/// The headset that was wished for, and the GPU that it lives on.
fn open_headset(wish: Wish, config: &Config) -> anyhow::Result<(Arc<Gpu>, Box<dyn Headset>)> {
    if wish != Wish::Off {
        match xr::open(config) {
            Ok((gpu, headset)) => return Ok((gpu, Box::new(headset))),
            Err(missing) if wish == Wish::On => return Err(missing).context("--headset require"),
            Err(missing) => eprintln!("scanwalk: no headset, so a simulated one is used: {missing}"),
        }
    }
    let gpu = Arc::new(Gpu::open(Some(&config.gpu.adapter))?);
    let headset = SimulatedHeadset::new(&gpu, &config.simulated);
    Ok((gpu, Box::new(headset)))
}

fn facts(options: &ViewOptions, config: &Config, gpu: &Gpu, headset: &dyn Headset) -> RunFacts {
    let files: Vec<String> = options.scans.iter().map(|p| p.display().to_string()).collect();
    let [left, right] = headset.eye_sizes();
    let size = |[width, height]: [u32; 2]| format!("{width}x{height}");
    RunFacts {
        scan: files.join(" "),
        device: gpu.name(),
        driver: gpu.driver(),
        runtime: headset.runtime(),
        resolution: if left == right { size(left) } else { format!("{} {}", size(left), size(right)) },
        config_digest: config.digest(),
    }
}

/// Where the loader puts clouds for the frame thread, and takes those back that it shows no more.
struct Shelf {
    loaded: Sender<Loaded>,
    retired: Receiver<CloudBuffers>,
}

/// The loader's thread: files to points, points to a flat cloud, which is shown at once, and to an octree or a point
/// tree, which takes its place.
fn load(
    options: &ViewOptions,
    config: &Config,
    gpu: &Gpu,
    link: &WalkEnd,
    stop: &Stop,
    shelf: &Shelf,
) -> anyhow::Result<()> {
    let step = |name: &str, fraction: f32| {
        link.update_load(|load| (load.step, load.fraction) = (name.to_string(), fraction));
    };
    step("reading", 0.0);
    let scan = scan::read(&options.scans, &config.cloud.read_options(), stop)?;
    for warning in &scan.warnings {
        eprintln!("scanwalk: warning: {warning}");
    }
    let unit_m = scan.unit_m.unwrap_or(1.0);
    link.update_load(|load| {
        load.facts = scan_facts(&scan);
        load.warnings.clone_from(&scan.warnings);
    });
    let chunk_limit = u64::from(config.gpu.chunk_mib) << 20;
    let num_points = scan.num_points() as u64;
    step("sorting", 0.2);
    let sorting = Progress::new("sorting", "points", num_points, stop);
    let cloud = cloud::build(&scan, config.cloud.order, &sorting)?;
    drop(sorting);
    step("sending to the GPU", 0.35);
    let sending = Progress::new("sending", "bytes", 16 * num_points, stop);
    let buffers = CloudBuffers::upload(gpu, &cloud, chunk_limit, &sending)?;
    drop(sending);
    let flat_bytes = buffers.bytes;
    // The walk may have ended meanwhile: then nobody waits for the cloud.
    let _ = shelf.loaded.send(Loaded { cloud: buffers, start: Some(start(&cloud, unit_m)) });
    drop(cloud);
    let mut bytes = flat_bytes;
    if config.lod.enabled {
        let detailed = match config.lod.method {
            LodMethod::Octree => {
                step("building the octree", 0.4);
                layered(gpu, scan, chunk_limit, stop).map_err(Into::into)
            }
            LodMethod::Spt => {
                step("building the point tree", 0.4);
                sequential(gpu, scan, chunk_limit, config.lod.cull_backfaces, stop)
            }
        };
        match detailed {
            Ok(buffers) => {
                bytes = buffers.bytes;
                let _ = shelf.loaded.send(Loaded { cloud: buffers, start: None });
                // Once it is shown, the flat cloud comes back; if none does, the walk has ended.
                if let Ok(flat) = shelf.retired.recv() {
                    flat.free(gpu);
                }
            }
            // The walk ended before it stood: nobody misses it.
            Err(error) if has_stopped(&error) => return Ok(()),
            Err(error) if is_too_large(&error) => {
                eprintln!("scanwalk: warning: without level of detail, every point is drawn always: {error}");
            }
            Err(error) => return Err(error),
        }
    }
    link.update_load(|load| {
        load.facts.push(("GPU memory".into(), format!("{:.1} MiB", bytes as f64 / (1 << 20) as f64)));
        (load.step, load.fraction) = (String::new(), 1.0);
    });
    Ok(())
}

/// Builds the octree of a scan and sends its nodes to the GPU as they come.
fn layered(gpu: &Gpu, scan: scan::Scan, chunk_limit: u64, stop: &Stop) -> Result<CloudBuffers, UploadError> {
    let building = Progress::new("building the octree", "points", 2 * scan.num_points() as u64, stop);
    let sending = Progress::silent(stop);
    let mut upload: Option<Result<CloudUpload, UploadError>> = None;
    let built = build_octree(&scan, &building, &mut |octree, nodes| {
        let begun = upload.take().unwrap_or_else(|| CloudUpload::layered(gpu, octree, chunk_limit, &sending));
        upload = Some(begun.and_then(|mut upload| upload.write_nodes(octree, nodes).map(|()| upload)));
    });
    match (built, upload) {
        (Err(BuildError::Stopped), _) => Err(UploadError::Stopped),
        // Whatever else is wrong with a scan, the flat cloud would have told before.
        (_, Some(upload)) => Ok(upload?.finish()),
        (_, None) => Err(UploadError::Stopped),
    }
}

/// Builds the sequential point tree of a scan and sends it to the GPU.
fn sequential(
    gpu: &Gpu,
    scan: scan::Scan,
    chunk_limit: u64,
    cull_backfaces: bool,
    stop: &Stop,
) -> anyhow::Result<CloudBuffers> {
    // Points are counted twice, discs once.
    let building = Progress::new("building the point tree", "points", 7 * scan.num_points() as u64 / 2, stop);
    let spt = build_spt(&scan, cull_backfaces, &building)?;
    drop((scan, building));
    Ok(CloudBuffers::upload_sequential(gpu, &spt, chunk_limit, &Progress::silent(stop))?)
}

fn has_stopped(error: &anyhow::Error) -> bool {
    matches!(error.downcast_ref(), Some(UploadError::Stopped))
        || matches!(error.downcast_ref(), Some(BuildError::Stopped))
}

fn is_too_large(error: &anyhow::Error) -> bool {
    matches!(error.downcast_ref(), Some(UploadError::OutOfMemory { .. }))
        || matches!(
            error.downcast_ref(),
            Some(BuildError::TooManyDiscs(_) | BuildError::TooManyTriangles { .. })
        )
}

/// What the window's panel says of the scan.
fn scan_facts(scan: &scan::Scan) -> Vec<(String, String)> {
    let size = scan.bounds().size();
    let mut facts = vec![("points".to_string(), scan::info::grouped(scan.num_points()))];
    facts.push(("size".into(), format!("{:.2} × {:.2} × {:.2}", size.x, size.y, size.z)));
    if let Some(file) = scan.files.first() {
        facts.push(("format".into(), file.format.clone()));
    }
    if scan.files.len() > 1 {
        facts.push(("files".into(), scan.files.len().to_string()));
    }
    if let Some(crs) = &scan.crs {
        facts.push(("CRS".into(), crs.clone()));
    }
    facts
}

/// Runs the window on this thread until it is closed or the walk ends.
fn show_window(
    options: &ViewOptions,
    config: &Config,
    gpu: &Arc<Gpu>,
    viewer: link::ViewerEnd,
    facts: &RunFacts,
    stop: &Stop,
) -> anyhow::Result<()> {
    let window_facts = desktop::WindowFacts {
        scan: options
            .scans
            .iter()
            .filter_map(|p| Some(p.file_name()?.display().to_string()))
            .collect::<Vec<_>>()
            .join(" "),
        device: facts.device.clone(),
        runtime: facts.runtime.clone(),
    };
    match desktop::run(Arc::clone(gpu), viewer, window_facts, config, stop.clone()) {
        Err(error) if options.window == Wish::Auto => {
            eprintln!("scanwalk: no window: {error}");
            Ok(())
        }
        Err(error) => {
            stop.request();
            Err(error.into())
        }
        Ok(()) => Ok(()),
    }
}

fn join<T>(thread: std::thread::ScopedJoinHandle<'_, anyhow::Result<T>>) -> anyhow::Result<T> {
    // A panic is a mistake of ours: let it show as one.
    thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

fn finish_log(log: Option<FrameLog>, options: &ViewOptions) {
    if let (Some(log), Some(path)) = (log, &options.log) {
        let summary = log.finish();
        if summary.error.is_some() {
            // Said when it happened.
            return;
        }
        eprintln!("scanwalk: frame log: {} ({} frames)", path.display(), summary.num_rows);
    }
}

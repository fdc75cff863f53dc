//! The main job: walk through a scan, in a headset, in a window, or with nobody looking.
//!
//! There are three threads: the loader reads the scan and sends it to the GPU, node by node; the frame thread draws
//! ([`crate::walk`]); the main thread runs the window, if there is one.

use crate::desktop::{self, Display};
use crate::ending::Ending;
use crate::failure::Failure;
use crate::nodes::{self, CloudOptions, LodMethod};
use crate::resolve::Plan;
use crate::walk::link::{self, WalkEnd};
use crate::walk::simulated::SimulatedHeadset;
use crate::walk::start::start;
use crate::walk::{Loaded, Walk};
use base::output::Output;
use base::task::{CancelToken, Task};
use base::words::{self, counted};
use cloud::spt::build_spt;
use cloud::{self, BuildError};
use lab::technique::tree;
use points::{self, ReadOptions, Scan, ScanError, Scene};
use render::gpu::Gpu;
use render::{CloudBuffers, UploadError};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::Sender;
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

/// The loader's thread: it makes points of files and an octree of points, whose nodes are drawn as they come, the
/// root first.
struct Loader<'a> {
    options: &'a CloudOptions,
    gpu: &'a Gpu,
    link: &'a WalkEnd,
    loaded: &'a Sender<Loaded>,
}

impl Loader<'_> {
    fn load(&self, scans: &[PathBuf], read: &ReadOptions, stop: &CancelToken) -> Result<(), LoadError> {
        let watching = self.link.clone();
        let task = Task::in_terminal(stop).observed(move |count| watching.set_doing(Some(Arc::clone(count))));
        let scan = points::read(scans, read, &task)?;
        for warning in &scan.warnings {
            eprintln!("scanwalk: warning: {warning}");
        }
        self.link.update_load(|load| {
            load.facts = scan_facts(&scan);
            load.warnings.clone_from(&scan.warnings);
        });
        let bytes = self.send(scan, &task)?;
        self.link.update_load(|load| {
            load.facts.push(("GPU memory".into(), format!("{:.1} MiB", bytes as f64 / (1 << 20) as f64)));
        });
        Ok(())
    }

    /// Sends a scan to the GPU, in the form that the settings ask for; returns its bytes there.
    fn send(&self, scan: Scan, task: &Task) -> Result<u64, LoadError> {
        match self.options.lod {
            None => return self.flat(&scan, task),
            Some(LodMethod::Spt) => return self.sequential(&scan, task),
            Some(LodMethod::Octree) => {}
        }
        match self.layered(&scan, task) {
            Ok(bytes) => Ok(bytes),
            Err(error) => {
                stay_flat(error, self.link)?;
                self.flat(&scan, task)
            }
        }
    }

    /// Sends a cloud without level of detail, of which every point is always drawn.
    fn flat(&self, scan: &Scan, task: &Task) -> Result<u64, LoadError> {
        let num_points = scan.num_points() as u64;
        let sorting = task.begin("sorting", "points", num_points);
        let cloud = cloud::build(scan, self.options.order, &sorting)?;
        drop(sorting);
        let sending = task.begin("sending to the GPU", "bytes", 16 * num_points);
        let buffers = CloudBuffers::upload(self.gpu, &cloud, self.options.chunk_limit, &sending)?;
        Ok(self.show(buffers, &cloud.scene, scan))
    }

    /// Builds the octree of a scan and sends its nodes to the GPU as they come. The walk begins with the root.
    fn layered(&self, scan: &Scan, task: &Task) -> Result<u64, LoadError> {
        let mut bytes = 0;
        nodes::send(self.gpu, scan, self.options.chunk_limit, task, |cloud, hierarchy| {
            bytes = self.show(cloud, &hierarchy.scene, scan);
        })
        .map(|()| bytes)
    }

    /// Builds the sequential point tree of a scan and sends it to the GPU.
    fn sequential(&self, scan: &Scan, task: &Task) -> Result<u64, LoadError> {
        // Points are counted twice, discs once.
        let building = task.begin("building the point tree", nodes::PASSES, 7 * scan.num_points() as u64 / 2);
        let spt = build_spt(scan, self.options.cull_backfaces, &building)?;
        drop(building);
        // The bytes are those of three planes, colors and shapes.
        let num_bytes = 5 * size_of_val(&spt.cloud.planes[0][..]) as u64;
        let sending = task.begin("sending to the GPU", "bytes", num_bytes);
        let buffers = tree::upload(self.gpu, &spt, self.options.chunk_limit, &sending)?;
        Ok(self.show(buffers, &spt.cloud.scene, scan))
    }

    /// Hands a cloud to the walk; returns its bytes.
    fn show(&self, cloud: CloudBuffers, scene: &Scene, scan: &Scan) -> u64 {
        let unit_m = scan.unit_m.unwrap_or(1.0);
        let start = start(scene, unit_m);
        if start.magnified > 1.0 {
            let (size, times) = (scene.bounds.edge() * unit_m, start.magnified);
            eprintln!("scanwalk: the scan is {size:.1e} m long: it is shown {times:.0} times as large");
        }
        let bytes = cloud.bytes;
        // The walk may have ended meanwhile: then nobody waits for the cloud.
        let _ = self.loaded.send(Loaded { cloud, start });
        bytes
    }
}

/// Tells the user that a scan gets no level of detail; the walk is through all points then.
///
/// # Errors
/// Somebody asked for an end, or the GPU is lost, and with it the walk.
fn stay_flat(error: LoadError, link: &WalkEnd) -> Result<(), LoadError> {
    if error.is_cancelled() || error.is_lost() {
        return Err(error);
    }
    let warning = format!("without level of detail, every point is drawn always: {error}");
    eprintln!("scanwalk: warning: {warning}");
    link.update_load(|load| load.warnings.push(warning));
    Ok(())
}

/// Why nothing, or nothing more, of a scan is shown.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The scan cannot be read.
    #[error(transparent)]
    Read(#[from] ScanError),
    /// No cloud comes of the scan.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The cloud cannot be sent to the GPU.
    #[error(transparent)]
    Upload(#[from] UploadError),
}

impl LoadError {
    /// True if the GPU is lost, and with it all that it shows.
    fn is_lost(&self) -> bool {
        matches!(self, Self::Upload(UploadError::Lost(_)))
    }

    /// True if somebody asked for an end, who has the reason.
    fn is_cancelled(&self) -> bool {
        matches!(
            self,
            Self::Read(ScanError::Cancelled(_))
                | Self::Build(BuildError::Cancelled(_))
                | Self::Upload(UploadError::Cancelled(_))
        )
    }
}

/// What the window's panel says of the scan.
fn scan_facts(scan: &points::Scan) -> Vec<(String, String)> {
    let size = scan.bounds_in_file().size();
    let mut facts = vec![("points".to_string(), words::grouped(scan.num_points()))];
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

#[cfg(test)]
mod tests {
    use super::*;
    use base::task::Cancelled;
    use cloud::Order;

    /// The panel says what keeps a scan from getting its octree, and the walk goes on.
    #[test]
    fn a_scan_without_level_of_detail_says_why() {
        let errors: [LoadError; 4] = [
            BuildError::TooMany(3_000_000_000).into(),
            BuildError::Empty.into(),
            BuildError::TooManyDiscs(2_000_000_000).into(),
            UploadError::OutOfMemory {
                points: 5,
                bytes: 80,
                source: wgpu::Error::Internal { source: "full".into(), description: "full".into() },
            }
            .into(),
        ];
        for error in errors {
            let (link, _actions, viewer) = link::link();
            let reason = error.to_string();
            stay_flat(error, &link).expect("the walk goes on");
            let [warning] = &viewer.load().warnings[..] else { panic!("{reason}") };
            assert!(
                warning.contains("every point is drawn always") && warning.contains(&reason),
                "{warning}"
            );
        }
        for stopped in [BuildError::from(Cancelled).into(), UploadError::Cancelled(Cancelled).into()] {
            let (link, _actions, viewer) = link::link();
            stay_flat(stopped, &link).expect_err("nothing more is wanted");
            assert!(viewer.load().warnings.is_empty());
        }
        let (link, _actions, viewer) = link::link();
        stay_flat(UploadError::Lost(wgpu::PollError::Timeout).into(), &link)
            .expect_err("there is no GPU any more");
        assert!(viewer.load().warnings.is_empty());
    }

    /// The walk begins with the root alone, and all that follows is drawn from the same buffers.
    #[test]
    fn the_walk_begins_with_the_root() {
        let gpu = Gpu::open(None).unwrap();
        let xyz: Vec<[i32; 3]> = (0..300_000).map(|i| [i * 37 % 1000, i * 91 % 1000, i / 300]).collect();
        let num_points = xyz.len() as u64;
        let rgb = vec![[100; 3]; xyz.len()];
        let made = points::ScanBuilder::new(points::Grid::default(), xyz).rgb(rgb);
        let scan = made.color(points::ColorSource::default()).scan();
        let (link, _actions, _viewer) = link::link();
        let (sender, loaded) = std::sync::mpsc::channel();
        let options = CloudOptions {
            lod: Some(LodMethod::Octree),
            order: Order::Morton,
            cull_backfaces: false,
            chunk_limit: 0,
        };
        // `counts` has what has come when the walk is told, observed on the loader's own thread between two runs of
        // nodes.
        let counts = Arc::new(std::sync::Mutex::new(Vec::new()));
        let seen = Arc::clone(&counts);
        let task = Task::new(&CancelToken::default())
            .observed(move |count| seen.lock().unwrap().push(Arc::clone(count)));
        let loader = Loader { options: &options, gpu: &gpu, link: &link, loaded: &sender };
        let first = std::thread::scope(|scope| {
            let loading = scope.spawn(|| loader.send(scan, &task).expect("a cloud"));
            let Loaded { cloud, .. } = loaded.recv().expect("a cloud");
            let first = cloud.num_resident();
            loading.join().unwrap();
            assert_eq!((cloud.num_points, cloud.num_resident()), (num_points, num_points));
            first
        });
        assert!(first > 0 && loaded.try_recv().is_err(), "one cloud, once");
        let done: Vec<_> = counts.lock().unwrap().iter().map(|count| count.now()).collect();
        let [building] = &done[..] else { panic!("{done:?}") };
        assert!(building.what == "building the octree" && building.done >= building.total, "{done:?}");
    }
}

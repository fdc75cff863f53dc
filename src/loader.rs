//! The walk's loader: it makes points of files, keeps them, and brings an octree of them to each GPU that the walk gets,
//! whose nodes are drawn as they come, the root first.

use crate::nodes::{self, CloudOptions};
use crate::walk::filling::{Filling, Loaded, ScanRequest};
use crate::walk::kind::ScanKind;
use crate::walk::link::{LoadState, WalkEnd};
use crate::walk::moving::floors::{Floors, FloorsCell};
use crate::walk::start::{StartsCell, start, stations};
use base::task::{CancelToken, Progress, Task};
use base::words;
use cloud::BuildError;
use points::{self, Scan, ScanError, Scene};
use render::{CloudBuffers, UploadError};
use std::sync::Arc;
use std::sync::mpsc::Receiver;

/// Name of the fact that tells how much of the GPU's memory the scan takes.
const GPU_MEMORY: &str = "GPU memory";

/// What the loader goes by, and whom it tells.
#[derive(Debug)]
pub struct Loader {
    /// How a scan is kept on the GPU.
    pub options: CloudOptions,
    /// Whom the window hears of loading from.
    pub link: WalkEnd,
    /// Set when the walk ends.
    pub stop: CancelToken,
}

/// A scan that was read, and what has been found out about it.
struct LoadedScan {
    request: Arc<ScanRequest>,
    scan: Scan,
    /// Where one would stand if the scan were of another kind.
    starts: StartsCell,
    /// Where one can walk.
    floors: FloorsCell,
}

impl Loader {
    /// Reads scans, and brings their points to each GPU of `fillings`, until the walk ends. `another` is called as
    /// another scan begins, `failed` with the reason why a scan cannot be shown.
    pub fn run(&self, fillings: &Receiver<Filling>, another: impl Fn(), failed: impl Fn(LoadError)) {
        let mut kept: Option<LoadedScan> = None;
        // A GPU that was lost meanwhile, or that no scan is wanted on yet: the walk takes it for filled when this goes, so it
        // goes when another comes.
        let mut unfilled: Option<Filling> = None;
        while let Ok(first) = fillings.recv() {
            drop(unfilled.take());
            // Only the newest counts.
            let filling = fillings.try_iter().last().unwrap_or(first);
            if kept.as_ref().is_none_or(|kept| !Arc::ptr_eq(&kept.request, &filling.scan)) {
                another();
                // The memory of the one before goes before this one takes as much.
                kept = None;
            }
            if filling.scan.files.is_empty() {
                self.link.update_load(|load| load.scan = Some(Arc::clone(&filling.scan)));
                unfilled = Some(filling);
                continue;
            }
            let filled = self.fill(&filling, &mut kept);
            // No work goes on any more, however loading ended.
            self.link.set_doing(None);
            match filled {
                Ok(()) => {}
                // Whoever asked for the end has the reason.
                Err(error) if error.is_cancelled() && self.stop.is_cancelled() => return,
                // The walk is about to have another GPU, or wants another scan.
                Err(error) if error.is_lost() || error.is_cancelled() => unfilled = Some(filling),
                Err(error) => {
                    self.link.update_load(|load| load.error = Some(error.to_string()));
                    failed(error);
                }
            }
        }
    }

    /// Brings the scan that is wanted to a GPU, and finds out about it what takes time. The walk goes on meanwhile.
    fn fill(&self, filling: &Filling, kept: &mut Option<LoadedScan>) -> Result<(), LoadError> {
        let kept = match kept {
            Some(kept) => kept,
            none => none.insert(self.read(filling)?),
        };
        let bytes = self.send(kept, filling)?;
        self.link.update_load(|load| {
            let size = format!("{:.1} MiB", bytes as f64 / (1 << 20) as f64);
            load.facts.retain(|(name, _)| name != GPU_MEMORY);
            load.facts.push((GPU_MEMORY.into(), size));
        });
        self.link.set_doing(None);
        kept.find_starts();
        kept.find_floors(&filling.unwanted);
        Ok(())
    }

    /// Reads a scan.
    fn read(&self, filling: &Filling) -> Result<LoadedScan, LoadError> {
        let request = Arc::clone(&filling.scan);
        self.link.update_load(|load| {
            *load = LoadState { scan: Some(Arc::clone(&request)), ..LoadState::default() }
        });
        let scan = points::read(&request.files, &request.read, self.task(&filling.unwanted))?;
        for warning in &scan.warnings {
            eprintln!("scanwalk: warning: {warning}");
        }
        self.link.update_load(|load| {
            load.facts = scan_facts(&scan);
            load.warnings.clone_from(&scan.warnings);
        });
        Ok(LoadedScan { request, scan, starts: StartsCell::default(), floors: FloorsCell::default() })
    }

    /// Work that the terminal and the window show.
    fn task(&self, stop: &CancelToken) -> Task {
        let watching = self.link.clone();
        Task::in_terminal(stop).observed(move |count| {
            tracing::info!("{} begins", count.now().what);
            watching.set_doing(Some(Arc::clone(count)));
        })
    }

    /// Sends a scan to the GPU in the form that the settings ask for; returns its bytes there.
    fn send(&self, kept: &LoadedScan, filling: &Filling) -> Result<u64, LoadError> {
        let sent = self.send_as(&self.options, kept, filling, &self.task(&filling.stop));
        sent.map_err(|error| if self.options.is_octree() { error.of_octree() } else { error })
    }

    /// Sends a scan to the GPU in this form. The walk begins as soon as something of it can be drawn.
    fn send_as(
        &self,
        options: &CloudOptions,
        kept: &LoadedScan,
        filling: &Filling,
        task: &Task,
    ) -> Result<u64, LoadError> {
        let mut bytes = 0;
        nodes::send(&filling.gpu, &kept.scan, options, task, |cloud, scene| {
            bytes = self.show(filling, cloud, scene, kept);
        })
        .map(|()| bytes)
    }

    /// Hands a cloud to the walk; returns its bytes.
    fn show(&self, filling: &Filling, cloud: CloudBuffers, scene: &Scene, kept: &LoadedScan) -> u64 {
        let unit_m = kept.unit_m();
        let start = start(scene, unit_m, kept.request.kind);
        if start.standpoint.scale > 1.0 {
            let (size, times) = (scene.bounds.edge() * unit_m, start.standpoint.scale);
            eprintln!("scanwalk: the scan is {size:.1e} m long: it is shown {times:.0} times as large");
        }
        let bytes = cloud.bytes;
        // The walk may have ended meanwhile: then nobody waits for the cloud.
        let _ = filling.loaded.send(Loaded {
            cloud,
            start,
            starts: Arc::clone(&kept.starts),
            floors: Arc::clone(&kept.floors),
            stations: stations(scene, unit_m),
        });
        bytes
    }
}

impl LoadedScan {
    /// Meters of a world unit.
    fn unit_m(&self) -> f64 {
        self.scan.unit_m.unwrap_or(1.0)
    }

    /// Finds the starts, if nobody has.
    fn find_starts(&self) {
        self.starts
            .get_or_init(|| ScanKind::ALL.map(|kind| start(&self.scan.scene, self.unit_m(), Some(kind))));
    }

    /// Makes the floors, if nobody has.
    fn find_floors(&self, unwanted: &CancelToken) {
        if self.floors.get().is_some() {
            return;
        }
        // Whoever asked for an end has no use for floors.
        if let Ok(floors) = Floors::of(&self.scan, 1.0 / self.unit_m(), &Progress::silent(unwanted)) {
            let _ = self.floors.set(floors);
        }
    }
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
    /// There is no octree of the scan; without one it takes less.
    #[error("{0}; --set lod.enabled=false takes 16 bytes a point for 20, and draws every point always")]
    Octree(Box<LoadError>),
}

impl LoadError {
    /// The same failure of an octree, unless it would fail without one too.
    fn of_octree(self) -> Self {
        let is_other =
            self.is_cancelled() || self.is_lost() || matches!(self, Self::Build(BuildError::Empty));
        if is_other { self } else { Self::Octree(Box::new(self)) }
    }

    /// True if the GPU is lost, and with it all that it shows.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        matches!(self, Self::Upload(UploadError::Lost(_)))
    }

    /// True if somebody asked for an end, who has the reason.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
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
    facts.extend(points::info::placing_words(scan).map(|(name, words)| (name.to_string(), words)));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walk::filling::Filler;
    use crate::walk::link;
    use crate::walk::state::Snapshot;
    use base::task::Cancelled;
    use lab::synth::{self, SynthKind, SynthOptions};
    use points::ReadOptions;
    use render::gpu::Gpu;
    use render::gpu::PollError;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Who has too small a GPU for an octree is told what takes less.
    #[test]
    fn a_scan_without_an_octree_says_why_and_what_to_do() {
        let full = UploadError::OutOfMemory {
            points: 5,
            bytes: 80,
            source: wgpu::Error::Internal { source: "full".into(), description: "full".into() },
        };
        for error in [LoadError::from(BuildError::TooMany(3_000_000_000)), full.into()] {
            let reason = error.to_string();
            let told = error.of_octree().to_string();
            assert!(told.contains("lod.enabled=false") && told.contains(&reason), "{told}");
        }
        for stopped in [BuildError::from(Cancelled).into(), UploadError::Cancelled(Cancelled).into()] {
            assert!(LoadError::of_octree(stopped).is_cancelled());
        }
        let lost = UploadError::Lost(PollError::Wait(wgpu::PollError::Timeout));
        assert!(LoadError::from(lost).of_octree().is_lost());
    }

    /// A scan that cannot be read keeps nobody from opening another.
    #[test]
    fn a_failure_is_followed_by_another_scan() {
        let gpu = Arc::new(Gpu::open(None).unwrap());
        let folder = tempfile::tempdir().unwrap();
        let [broken, good] = ["broken.las", "good.las"].map(|name| folder.path().join(name));
        std::fs::write(&broken, b"LASF").unwrap();
        let (kind, points, seed) = (SynthKind::Photogrammetry, 20_000, 1);
        let out = base::output::Output::new(&good, synth::SCAN).unwrap();
        synth::write(&SynthOptions { kind, out, points, seed }, &CancelToken::default()).unwrap();
        let request =
            |file| Arc::new(ScanRequest { files: vec![file], read: ReadOptions::AS_FILES_SAY, kind: None });
        let (link, _actions, viewer) = link::link(Snapshot::sample());
        let (mut filler, fillings) = Filler::new(request(broken), &CancelToken::default());
        let options = CloudOptions { lab: None, chunk_limit: 0 };
        let loader = Loader { options, link, stop: CancelToken::default() };
        let (begun, failed) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let count = |number: &AtomicUsize| _ = number.fetch_add(1, Ordering::SeqCst);
        std::thread::scope(|scope| {
            let in_vain = filler.fill(&gpu);
            let (loader, count, begun, failed) = (&loader, &count, &begun, &failed);
            scope.spawn(move || loader.run(&fillings, || count(begun), |_| count(failed)));
            assert!(in_vain.recv().is_err());
            filler.want(request(good));
            let loaded = filler.fill(&gpu);
            let Loaded { cloud, .. } = loaded.recv().expect("a cloud");
            assert!(loaded.recv().is_err(), "one cloud");
            assert_eq!(cloud.num_resident(), points);
            drop(filler);
        });
        assert_eq!([begun, failed].map(AtomicUsize::into_inner), [2, 1]);
        let load = viewer.load();
        assert_eq!((load.error.as_ref(), load.names().as_str()), (None, "good.las"));
    }

    /// The walk begins with the root alone, and all that follows is drawn from the same buffers.
    #[test]
    fn the_walk_begins_with_the_root() {
        let gpu = Arc::new(Gpu::open(None).unwrap());
        let xyz: Vec<[i32; 3]> = (0..300_000).map(|i| [i * 37 % 1000, i * 91 % 1000, i / 300]).collect();
        let num_points = xyz.len() as u64;
        let rgb = vec![[100; 3]; xyz.len()];
        let made = points::ScanBuilder::new(points::Grid::default(), xyz).rgb(rgb);
        let scan = made.color(points::ColorSource::default()).scan();
        let (link, _actions, _viewer) = link::link(Snapshot::sample());
        let request = Arc::new(ScanRequest { files: vec![], read: ReadOptions::AS_FILES_SAY, kind: None });
        let (mut filler, fillings) = Filler::new(Arc::clone(&request), &CancelToken::default());
        let loaded = filler.fill(&gpu);
        let filling = fillings.recv().unwrap();
        let options = CloudOptions { lab: None, chunk_limit: 0 };
        // `counts` has what has come when the walk is told, observed on the loader's own thread between two runs of
        // nodes.
        let counts = Arc::new(std::sync::Mutex::new(Vec::new()));
        let seen = Arc::clone(&counts);
        let task = Task::new(&CancelToken::default())
            .observed(move |count| seen.lock().unwrap().push(Arc::clone(count)));
        let loader = Loader { options, link, stop: CancelToken::default() };
        let kept = LoadedScan { request, scan, starts: StartsCell::default(), floors: FloorsCell::default() };
        let first = std::thread::scope(|scope| {
            let loading =
                scope.spawn(|| loader.send_as(&loader.options, &kept, &filling, &task).expect("a cloud"));
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

//! A scan on its way to a GPU: the walk asks for it with each GPU that it gets, and with each scan that the user wants to
//! see, and the loader brings it.

use super::kind::ScanKind;
use super::locomotion::{Start, StartsCell};
use super::moving::Standpoint;
use super::moving::floors::FloorsCell;
use base::task::CancelToken;
use points::ReadOptions;
use render::CloudBuffers;
use render::gpu::Gpu;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

/// What is to be shown.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanRequest {
    /// Files, which are one scan; none while there is nothing to show yet.
    pub files: Vec<PathBuf>,
    /// How they are read.
    pub read: ReadOptions,
    /// What the user says that the scan is of.
    pub kind: Option<ScanKind>,
}

impl ScanRequest {
    /// Names of the files, for people.
    #[must_use]
    pub fn names(&self) -> String {
        names(&self.files)
    }
}

/// Names of a scan's files, for people.
#[must_use]
pub fn names(files: &[PathBuf]) -> String {
    let names = files.iter().filter_map(|path| Some(path.file_name()?.display().to_string()));
    names.collect::<Vec<_>>().join(" ")
}

/// A scan, ready to be shown; sent by the loader's thread.
#[derive(Debug)]
pub struct Loaded {
    /// The scan on the GPU.
    pub cloud: CloudBuffers,
    /// Where to stand.
    pub start: Start,
    /// Where one would stand if the scan were of another kind, once that is known.
    pub starts: StartsCell,
    /// Where one can walk, once that is known: the same for each GPU.
    pub floors: FloorsCell,
    /// Where the scan was measured and photographed from.
    pub stations: Vec<Standpoint>,
}

/// A GPU that a scan is to be brought to.
#[derive(Debug)]
pub struct Filling {
    /// The scan: the same as the one before, or another.
    pub scan: Arc<ScanRequest>,
    /// Set when the walk ends, or another scan is wanted: nothing more of this one needs to be read.
    pub unwanted: CancelToken,
    /// The GPU.
    pub gpu: Arc<Gpu>,
    /// Takes the scan as soon as something of it can be drawn; the loader lets go of it when all of it can.
    pub loaded: Sender<Loaded>,
    /// Set when the walk ends, has another GPU, or wants another scan.
    pub stop: CancelToken,
}

/// Asks the loader for scans.
#[derive(Debug)]
pub struct Filler {
    fillings: Sender<Filling>,
    stop: CancelToken,
    scan: Arc<ScanRequest>,
    /// Cancels the reading of [`Self::scan`].
    unwanted: CancelToken,
    /// Cancels the filling of the GPU before.
    last: CancelToken,
}

impl Filler {
    /// Asks whoever has the receiver for `scan`, until `stop` is requested.
    #[must_use]
    pub fn new(scan: Arc<ScanRequest>, stop: &CancelToken) -> (Self, Receiver<Filling>) {
        let (fillings, receiver) = channel();
        (Self { fillings, stop: stop.clone(), scan, unwanted: stop.child(), last: stop.child() }, receiver)
    }

    /// Asks for another scan from now on.
    pub fn want(&mut self, scan: Arc<ScanRequest>) {
        self.unwanted.cancel();
        (self.unwanted, self.scan) = (self.stop.child(), scan);
    }

    /// Asks for the scan on `gpu`, and on no other any more.
    pub fn fill(&mut self, gpu: &Arc<Gpu>) -> Receiver<Loaded> {
        self.last.cancel();
        self.last = self.stop.child();
        let (loaded, receiver) = channel();
        let filling = Filling {
            scan: Arc::clone(&self.scan),
            unwanted: self.unwanted.clone(),
            gpu: Arc::clone(gpu),
            loaded,
            stop: self.last.clone(),
        };
        // Sending fails if the loader has failed, which ends the walk.
        let _ = self.fillings.send(filling);
        receiver
    }
}

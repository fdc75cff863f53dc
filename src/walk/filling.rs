//! A scan on its way to a GPU: the walk asks for it with each GPU that it gets, and the loader brings it.

use super::locomotion::Start;
use super::moving::floors::FloorsCell;
use base::task::CancelToken;
use render::CloudBuffers;
use render::gpu::Gpu;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

/// A scan, ready to be shown; sent by the loader's thread.
#[derive(Debug)]
pub struct Loaded {
    /// The scan on the GPU.
    pub cloud: CloudBuffers,
    /// Where to stand.
    pub start: Start,
    /// Where one can walk, once that is known: the same for each GPU.
    pub floors: FloorsCell,
}

/// A GPU that the scan is to be brought to.
#[derive(Debug)]
pub struct Filling {
    /// The GPU.
    pub gpu: Arc<Gpu>,
    /// Takes the scan as soon as something of it can be drawn; the loader lets go of it when all of it can.
    pub loaded: Sender<Loaded>,
    /// Set when the walk ends, or has another GPU.
    pub stop: CancelToken,
}

/// Asks the loader for the scan.
#[derive(Debug)]
pub struct Filler {
    fillings: Sender<Filling>,
    stop: CancelToken,
    /// Cancels the filling of the GPU before.
    last: CancelToken,
}

impl Filler {
    /// Asks whoever has the receiver, until `stop` is requested.
    #[must_use]
    pub fn new(stop: &CancelToken) -> (Self, Receiver<Filling>) {
        let (fillings, receiver) = channel();
        (Self { fillings, stop: stop.clone(), last: stop.child() }, receiver)
    }

    /// Asks for the scan on `gpu`, and on no other any more.
    pub fn fill(&mut self, gpu: &Arc<Gpu>) -> Receiver<Loaded> {
        self.last.cancel();
        self.last = self.stop.child();
        let (loaded, receiver) = channel();
        let filling = Filling { gpu: Arc::clone(gpu), loaded, stop: self.last.clone() };
        // Sending fails if the loader has failed, which ends the walk.
        let _ = self.fillings.send(filling);
        receiver
    }
}

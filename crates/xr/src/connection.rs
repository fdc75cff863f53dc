//! A runtime that has a headset, and the GPU that drives it: what stays while sessions come and go.

use crate::missing::{self, XrMissing};
use crate::runtime::Runtime;
use crate::session::XrSession;
use crate::{XrHeadset, XrOptions};
use raw::device::{DeviceRequest, RuntimeGpu, Wrapped};
use render::gpu::{Gpu, instance_flags, required_features};
use std::sync::Arc;

/// A connection to a runtime. A process has one at a time.
pub struct Connection {
    runtime: Runtime,
    /// The device that the runtime made, once a session was wanted.
    device: Option<(RuntimeGpu, Arc<Gpu>)>,
}

impl Connection {
    /// Connects to the runtime that is set up on this machine, if it has a headset.
    ///
    /// # Errors
    /// What is missing, in a sentence for people.
    pub fn new() -> Result<Self, XrMissing> {
        Ok(Self { runtime: Runtime::connect()?, device: None })
    }

    /// Names of the runtime and of the headset.
    #[must_use]
    pub fn names(&self) -> (&str, &str) {
        (&self.runtime.name, &self.runtime.headset)
    }

    /// Asks whether the runtime still has a headset.
    ///
    /// # Errors
    /// What is missing; the connection is of no use then.
    pub fn check(&self) -> Result<(), XrMissing> {
        self.runtime.system().map(|_| ())
    }

    /// Opens a session, on the GPU of the session before if there was one, else on a GPU of the runtime's choice: the one
    /// that the headset is connected to.
    ///
    /// # Errors
    /// What is missing, in a sentence for people.
    pub fn open(mut self, options: &XrOptions) -> Result<XrHeadset, XrMissing> {
        let (runtime_gpu, gpu) = match self.device.take() {
            Some(device) => device,
            None => open_gpu(&self.runtime)?,
        };
        let session = XrSession::open(&self.runtime, &runtime_gpu, &gpu, options)?;
        tracing::info!("headset '{}' on {}, GPU {}", self.runtime.headset, self.runtime.name, gpu.name());
        Ok(XrHeadset {
            session: Some(session),
            gpu: Arc::clone(&gpu),
            runtime: self.runtime.name.clone(),
            headset: self.runtime.headset.clone(),
            offers: self.runtime.offers,
            connection: Some(Self { device: Some((runtime_gpu, gpu)), ..self }),
        })
    }
}

/// Has the runtime make the device, with what every frame needs.
fn open_gpu(runtime: &Runtime) -> Result<(RuntimeGpu, Arc<Gpu>), XrMissing> {
    let features = |name: &str, features, limits: &_| {
        required_features(name, features, limits).map_err(missing::lacking)
    };
    let wanted = DeviceRequest { flags: instance_flags(), features: &features };
    let (runtime_gpu, wrapped) = RuntimeGpu::open(&runtime.xr, runtime.system, &wanted)?;
    let Wrapped { instance, adapter, device, queue } = wrapped;
    Ok((runtime_gpu, Arc::new(Gpu::new(instance, adapter, device, queue))))
}

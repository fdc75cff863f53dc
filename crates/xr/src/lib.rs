//! Headsets: what a frame loop asks of one ([`Headset`]), and OpenXR behind it ([`open`]).
//!
//! The runtime makes the Vulkan device and wgpu wraps it (`raw::device`); the session (`session`) follows the
//! runtime's states (`lifecycle`) and hands the frame thread images (`swapchain`), poses (`eyes`), what the lenses
//! hide (`mask`) and controllers
//! (`input`). The four OpenXR calls that may use the Vulkan queue are reachable only with a
//! [`render::gpu::QueueGuard`], since the window presents on the same queue.

mod eyes;
mod fault;
mod frames;
mod gaze;
mod headset;
pub mod hidden_area;
mod input;
mod lifecycle;
mod mask;
mod missing;
mod runtime;
mod session;
mod swapchain;

pub use fault::{End, Fault};
pub use headset::{ControllerInput, EyeImages, FrameState, Headset, StageEye};
pub use missing::XrMissing;
pub use openxr::SessionState;
pub use runtime::Offers;

use hidden_area::HiddenArea;
use raw::device::{RuntimeGpu, Wanted};
use render::gpu::{Gpu, instance_flags, required_features};
use runtime::Runtime;
use session::XrSession;
use std::sync::Arc;
use std::time::Duration;

/// How long to wait for the GPU's last frame when the session is closed.
const DRAIN_TIME: Duration = Duration::from_secs(5);

/// What a user may choose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct XrOptions {
    /// Factor on the width and height that the runtime recommends.
    pub resolution_scale: f64,
    /// True to hand depth to the runtime for its reprojection, if it takes depth.
    pub depth_layer: bool,
    /// True to ask the runtime what the lenses hide, if it tells.
    pub visibility_mask: bool,
    /// The frame's near plane, which depth images are relative to, meters.
    pub near_m: f64,
}

/// Opens the headset and the GPU that drives it.
///
/// The GPU is chosen by the runtime: the one that the headset is connected to.
///
/// # Errors
/// What is missing, in a sentence for people.
pub fn open(options: &XrOptions) -> Result<(Arc<Gpu>, XrHeadset), XrMissing> {
    let runtime = Runtime::connect()?;
    let (runtime_gpu, gpu) = open_gpu(&runtime)?;
    let session = XrSession::open(&runtime, &runtime_gpu, &gpu, options)?;
    tracing::info!("headset '{}' on {}, GPU {}", runtime.headset, runtime.name, gpu.name());
    let headset = XrHeadset {
        session: Some(session),
        gpu: Arc::clone(&gpu),
        runtime: runtime.name,
        headset: runtime.headset,
        offers: runtime.offers,
    };
    Ok((gpu, headset))
}

/// Has the runtime make the device, with what every frame needs.
fn open_gpu(runtime: &Runtime) -> Result<(RuntimeGpu, Arc<Gpu>), XrMissing> {
    let features = |name: &str, features, limits: &_| {
        required_features(name, features, limits).map_err(missing::lacking)
    };
    let wanted = Wanted { flags: instance_flags(), features: &features };
    let (runtime_gpu, wrapped) = RuntimeGpu::open(&runtime.xr, runtime.system, &wanted)?;
    let raw::device::Wrapped { instance, adapter, device, queue } = wrapped;
    Ok((runtime_gpu, Arc::new(Gpu::new(instance, adapter, device, queue))))
}

/// Names of the runtime and of the headset that is connected, without opening either: a look for
/// `scanwalk doctor`.
///
/// # Errors
/// What is missing, in a sentence for people.
pub fn probe() -> Result<(String, String), XrMissing> {
    Runtime::connect().map(|runtime| (runtime.name, runtime.headset))
}

/// A real headset. Dropping it closes the session; the GPU lives on.
pub struct XrHeadset {
    /// `None` only while being dropped.
    session: Option<XrSession>,
    gpu: Arc<Gpu>,
    runtime: String,
    headset: String,
    offers: Offers,
}

impl XrHeadset {
    /// What the runtime last said of the session; FOCUSED while the user looks at it and has the controllers.
    #[must_use]
    pub fn state(&self) -> SessionState {
        self.session().life.state()
    }

    /// True if the session has been in focus at any time.
    #[must_use]
    pub fn reached_focus(&self) -> bool {
        self.session().life.reached_focus()
    }

    /// The headset, as its runtime calls it.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.headset
    }

    /// What the runtime offers beyond the needs of a frame.
    #[must_use]
    pub fn offers(&self) -> Offers {
        self.offers
    }

    fn session(&self) -> &XrSession {
        // Only `drop` takes the session.
        self.session.as_ref().expect("the session is there until the headset is dropped")
    }

    fn session_mut(&mut self) -> &mut XrSession {
        // Only `drop` takes the session.
        self.session.as_mut().expect("the session is there until the headset is dropped")
    }
}

impl Headset for XrHeadset {
    fn runtime(&self) -> String {
        self.runtime.clone()
    }

    fn eye_sizes(&self) -> [[u32; 2]; 2] {
        self.session().eye_sizes()
    }

    fn refresh_hz(&self) -> f64 {
        self.session().refresh_hz
    }

    fn image_format(&self) -> wgpu::TextureFormat {
        self.session().format
    }

    fn set_drawn_px(&mut self, drawn_px: [[u32; 2]; 2]) {
        self.session_mut().set_drawn_px(drawn_px);
    }

    fn depth_format(&self) -> Option<wgpu::TextureFormat> {
        self.session().depth_format()
    }

    fn hidden_area(&mut self) -> Option<[HiddenArea; 2]> {
        self.session_mut().hidden_area()
    }

    fn wait(&mut self) -> Result<FrameState, Fault> {
        self.session_mut().wait()
    }

    fn input(&mut self) -> Result<ControllerInput, Fault> {
        self.session_mut().input()
    }

    fn acquire(&mut self) -> Result<EyeImages, Fault> {
        self.session_mut().acquire()
    }

    fn locate(&mut self) -> Result<[StageEye; 2], Fault> {
        self.session_mut().locate()
    }

    fn submit(&mut self, commands: Option<wgpu::CommandEncoder>) -> Result<(), Fault> {
        self.session_mut().submit(commands)
    }

    fn request_exit(&mut self) {
        self.session_mut().request_exit();
    }
}

impl Drop for XrHeadset {
    fn drop(&mut self) {
        // The swapchains' images must be idle, and wgpu must have let go of its views of them.
        let drained = wgpu::PollType::Wait { submission_index: None, timeout: Some(DRAIN_TIME) };
        if let Err(error) = self.gpu.device.poll(drained) {
            tracing::warn!("closing the headset's session while the GPU is busy: {error}");
        }
        // Runtimes may wait for the whole device, its queue included, when they destroy images and sessions.
        let _queue = self.gpu.queue.lock();
        self.session = None;
    }
}

#[cfg(test)]
mod tests {
    /// The headset is opened on the main thread and used on the frame thread.
    #[test]
    fn a_headset_can_be_sent_to_the_frame_thread() {
        fn is_send<T: Send>() {}
        is_send::<super::XrHeadset>();
    }
}

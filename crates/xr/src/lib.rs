//! Headsets: what a frame loop asks of one ([`Headset`]), and OpenXR behind it ([`Connection`]).
//!
//! The runtime makes the Vulkan device and wgpu wraps it (`raw::device`); the session (`session`) follows the
//! runtime's states (`lifecycle`) and hands the frame thread images (`swapchain`), poses (`eyes`), what the lenses
//! hide (`mask`), controllers (`input`, with the bindings of `controllers`) and bare hands (`hands`, `gestures`). The four OpenXR calls that may use the Vulkan queue are reachable only with a
//! [`render::gpu::QueueGuard`], since the window presents on the same queue.

mod connection;
pub mod controllers;
mod eyes;
mod fault;
mod frames;
mod gaze;
mod gestures;
mod hands;
mod headset;
pub mod hidden_area;
mod input;
mod lifecycle;
mod mask;
mod missing;
mod panel;
mod pose;
mod refresh;
mod runtime;
mod session;
mod swapchain;

pub use connection::Connection;
pub use fault::{Cause, End};
pub use headset::{
    ControllerInput, EyeImages, FrameState, HandInput, HandJoints, Headset, Joint, Panel, StageEye, joint,
};
pub use missing::XrMissing;
pub use openxr::SessionState;
pub use runtime::Offers;

use hidden_area::HiddenArea;
use session::XrSession;
use std::sync::Arc;
use std::time::Duration;
use timing::CallTimes;

/// How long to wait for the GPU's last frame when the session is closed.
const DRAIN_TIME: Duration = Duration::from_secs(1);

/// What a user may choose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct XrOptions {
    /// Factor on the width and height that the runtime recommends.
    pub resolution_scale: f64,
    /// Images a second that the headset is to show; `None`: as many as its runtime chooses.
    pub refresh_hz: Option<f64>,
    /// True to hand depth to the runtime for its reprojection, if it takes depth.
    pub depth_layer: bool,
    /// True to ask the runtime what the lenses hide, if it tells.
    pub visibility_mask: bool,
    /// True to follow hands without controllers, if the runtime tracks them.
    pub hands: bool,
    /// The frame's near plane, which depth images are relative to, meters.
    pub near_m: f64,
}

/// A real headset. Dropping it closes the session; the GPU lives on.
pub struct XrHeadset {
    /// `None` only while being dropped.
    session: Option<XrSession>,
    /// `None` only while being dropped.
    connection: Option<Connection>,
    gpu: Arc<render::gpu::Gpu>,
    runtime: String,
    headset: String,
    offers: Offers,
}

impl XrHeadset {
    /// What the runtime last said of the session; FOCUSED while the user looks at it and has the controllers.
    #[must_use]
    pub fn state(&self) -> SessionState {
        self.open_session().life.state()
    }

    /// True if the session has been in focus at any time.
    #[must_use]
    pub fn reached_focus(&self) -> bool {
        self.open_session().life.reached_focus()
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

    /// The GPU that drives it.
    #[must_use]
    pub fn gpu(&self) -> &Arc<render::gpu::Gpu> {
        &self.gpu
    }

    /// Closes the session, and keeps the runtime's connection and the GPU, for another session.
    #[must_use]
    pub fn into_connection(mut self) -> Connection {
        self.close();
        // Only this function and `drop` take the connection, and this one consumes the headset.
        self.connection.take().expect("the connection is there until the headset is dropped")
    }

    fn close(&mut self) {
        if self.session.is_none() {
            return;
        }
        // The swapchains' images must be idle, and wgpu must have let go of its views of them.
        let drained = wgpu::PollType::Wait { submission_index: None, timeout: Some(DRAIN_TIME) };
        if let Err(error) = self.gpu.poll(drained) {
            tracing::warn!("closing the headset's session while the GPU is busy: {error}");
        }
        // Runtimes may wait for the whole device, its queue included, when they destroy images and sessions.
        let _queue = self.gpu.queue.lock();
        self.session = None;
    }

    fn open_session(&self) -> &XrSession {
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
        self.open_session().eye_sizes()
    }

    fn refresh_hz(&self) -> f64 {
        self.open_session().refresh_hz
    }

    fn image_format(&self) -> wgpu::TextureFormat {
        self.open_session().format
    }

    fn set_drawn_px(&mut self, drawn_px: [[u32; 2]; 2]) {
        self.session_mut().set_drawn_px(drawn_px);
    }

    fn depth_format(&self) -> Option<wgpu::TextureFormat> {
        self.open_session().depth_format()
    }

    fn hidden_area(&mut self) -> Option<[HiddenArea; 2]> {
        self.session_mut().hidden_area()
    }

    fn wait(&mut self) -> FrameState {
        self.session_mut().wait()
    }

    fn input(&mut self) -> ControllerInput {
        self.session_mut().input()
    }

    fn hands(&self) -> [Option<HandJoints>; 2] {
        self.open_session().hands
    }

    fn vibrate(&mut self, hand: usize, strength: f32, seconds: f32) {
        self.session_mut().vibrate(hand, strength, seconds);
    }

    fn show_panel(&mut self, panel: Option<&Panel>) -> bool {
        self.session_mut().show_panel(panel)
    }

    fn acquire(&mut self) -> Option<EyeImages> {
        self.session_mut().acquire()
    }

    fn locate(&mut self) -> [StageEye; 2] {
        self.session_mut().locate()
    }

    fn submit(&mut self, commands: Option<wgpu::CommandEncoder>) {
        self.session_mut().submit(commands);
    }

    fn call_times(&self) -> CallTimes {
        self.open_session().call_times
    }

    fn session(&self) -> &'static str {
        name_of(self.state())
    }

    fn request_exit(&mut self) {
        self.session_mut().request_exit();
    }
}

/// The state's name in the specification.
fn name_of(state: SessionState) -> &'static str {
    match state {
        SessionState::IDLE => "IDLE",
        SessionState::READY => "READY",
        SessionState::SYNCHRONIZED => "SYNCHRONIZED",
        SessionState::VISIBLE => "VISIBLE",
        SessionState::FOCUSED => "FOCUSED",
        SessionState::STOPPING => "STOPPING",
        SessionState::LOSS_PENDING => "LOSS_PENDING",
        SessionState::EXITING => "EXITING",
        _ => "UNKNOWN",
    }
}

impl Drop for XrHeadset {
    fn drop(&mut self) {
        self.close();
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

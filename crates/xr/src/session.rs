//! A session: events, frames, images and input together, as the frame thread uses them.

use super::eyes::{EYE_HEIGHT_M, Eyes};
use super::fault::{End, Fault};
use super::frames::{FrameCalls, locate};
use super::input::Input;
use super::lifecycle::{Duty, Lifecycle};
use super::mask::VisibilityMask;
use super::missing::XrMissing;
use super::runtime::{Runtime, STEREO, scaled_size};
use super::swapchain::{EyeSwapchains, ImageFormat};
use crate::hidden_area::HiddenArea;
use crate::{ControllerInput, EyeImages, FrameState, StageEye, XrOptions};
use openxr as xr;
use raw::device::RuntimeGpu;
use render::gpu::Gpu;
use std::sync::Arc;
use std::time::Instant;

/// Refresh rate that is assumed until the runtime has told its display's.
const DEFAULT_REFRESH_HZ: f64 = 90.0;

/// A frame between `wait` and `submit`.
struct OpenFrame {
    display_time: xr::Time,
    located: bool,
}

/// An open session.
pub(super) struct XrSession {
    images: EyeSwapchains,
    stage: xr::Space,
    stage_kind: xr::ReferenceSpaceType,
    input: Input,
    frames: FrameCalls,
    session: xr::Session<xr::Vulkan>,
    xr: xr::Instance,
    gpu: Arc<Gpu>,
    pub format: wgpu::TextureFormat,
    pub refresh_hz: f64,
    pub life: Lifecycle,
    mask: Option<VisibilityMask>,
    /// The near plane that depth images are relative to, meters.
    near_m: f32,
    eyes: Eyes,
    frame: Option<OpenFrame>,
}

impl XrSession {
    /// Opens a session, with what the runtime offers and the settings want.
    ///
    /// # Errors
    /// The runtime refuses.
    pub fn open(
        runtime: &Runtime,
        runtime_gpu: &RuntimeGpu,
        gpu: &Arc<Gpu>,
        options: &XrOptions,
    ) -> Result<Self, XrMissing> {
        let refused = |call: &'static str| {
            let runtime = runtime.name.clone();
            move |result| XrMissing::SessionRefused { runtime, call, result }
        };
        let blend_mode = runtime.blend_mode()?;
        let scale = options.resolution_scale;
        let sizes_px = runtime.eye_images()?.map(|view| scaled_size(&view, scale));
        let (session, waiter, stream) =
            runtime_gpu.create_session(Box::new(Arc::clone(gpu))).map_err(refused("xrCreateSession"))?;
        let offered =
            session.enumerate_swapchain_formats().map_err(refused("xrEnumerateSwapchainFormats"))?;
        let format = ImageFormat::color(&offered)
            .ok_or_else(|| XrMissing::NoImageFormat { runtime: runtime.name.clone() })?;
        let mut images =
            EyeSwapchains::new(&session, gpu, format, sizes_px).map_err(refused("xrCreateSwapchain"))?;
        if runtime.offers.depth_layer && options.depth_layer {
            add_depth(&mut images, &session, gpu, &offered);
        }
        let (stage, stage_kind) = stage_space(&session).map_err(refused("xrCreateReferenceSpace"))?;
        let input = Input::new(&runtime.xr, &session, runtime.offers.eye_gaze)
            .map_err(refused("xrAttachSessionActionSets"))?;
        let told_hz =
            if runtime.offers.refresh_rate { session.get_display_refresh_rate().ok() } else { None };
        Ok(Self {
            images,
            stage,
            stage_kind,
            input,
            frames: FrameCalls::new(waiter, stream, blend_mode),
            session,
            xr: runtime.xr.clone(),
            gpu: Arc::clone(gpu),
            format: format.wgpu,
            refresh_hz: told_hz.map(f64::from).filter(|hz| *hz > 0.0).unwrap_or(DEFAULT_REFRESH_HZ),
            life: Lifecycle::new(),
            mask: (runtime.offers.visibility_mask && options.visibility_mask).then(VisibilityMask::default),
            near_m: options.near_m as f32,
            eyes: Eyes::standing(),
            frame: None,
        })
    }

    pub fn eye_sizes(&self) -> [[u32; 2]; 2] {
        self.images.sizes_px()
    }

    /// Sets the part of each eye's image that the next layers show.
    pub fn set_drawn_px(&mut self, drawn_px: [[u32; 2]; 2]) {
        self.images.set_drawn_px(drawn_px);
    }

    pub fn depth_format(&self) -> Option<wgpu::TextureFormat> {
        self.images.depth_format()
    }

    /// What the lenses hide, if that is new.
    pub fn hidden_area(&mut self) -> Option<[HiddenArea; 2]> {
        self.mask.as_mut()?.take_new(&self.session)
    }

    /// Handles events, then waits for the next frame's time and begins it.
    pub fn wait(&mut self) -> Result<FrameState, Fault> {
        if self.frame.is_some() {
            return Err(Fault::Order("the frame before this one was not submitted"));
        }
        self.handle_events()?;
        self.life.lose_patience(Instant::now());
        if !self.life.running() {
            return Ok(self.life.ended().map_or(FrameState::Idle, FrameState::Ended));
        }
        let waited = self.frames.wait();
        let Some(state) = self.life.survive("xrWaitFrame", waited)? else {
            return Ok(self.ended_state());
        };
        let begun = self.frames.begin(&self.gpu.queue.lock());
        if self.life.survive("xrBeginFrame", begun)?.is_none() {
            return Ok(self.ended_state());
        }
        self.frame = Some(OpenFrame { display_time: state.predicted_display_time, located: false });
        Ok(FrameState::Frame {
            predicted_display_ns: state.predicted_display_time.as_nanos(),
            period_ns: state.predicted_display_period.as_nanos(),
            should_render: state.should_render,
        })
    }

    /// What `wait` says after a loss.
    fn ended_state(&self) -> FrameState {
        FrameState::Ended(self.life.ended().unwrap_or(End::SessionLost))
    }

    fn handle_events(&mut self) -> Result<(), Fault> {
        let mut storage = xr::EventDataBuffer::new();
        while self.life.ended().is_none() {
            let polled = self.xr.poll_event(&mut storage);
            let Some(Some(event)) = self.life.survive("xrPollEvent", polled)? else { break };
            match event {
                xr::Event::SessionStateChanged(event) => self.enter(event.state())?,
                xr::Event::InstanceLossPending(_) => self.life.end(End::RuntimeLost),
                xr::Event::ReferenceSpaceChangePending(event) => {
                    // The user has recentered the space. The runtime moves it under us at the change time; all that we
                    // remember in it is the last good pose, which the next `locate` replaces.
                    let ours = event.reference_space_type() == self.stage_kind;
                    tracing::info!(
                        "the headset's {:?} space moves (in use: {ours})",
                        event.reference_space_type()
                    );
                }
                xr::Event::DisplayRefreshRateChangedFB(event) => {
                    self.refresh_hz = event.to_display_refresh_rate().into();
                    tracing::info!("images that the headset shows a second: {}", self.refresh_hz);
                }
                xr::Event::VisibilityMaskChangedKHR(_) => {
                    if let Some(mask) = &mut self.mask {
                        mask.changed();
                    }
                }
                xr::Event::EventsLost(event) => {
                    tracing::warn!("the headset's runtime dropped {} events", event.lost_event_count());
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn enter(&mut self, state: xr::SessionState) -> Result<(), Fault> {
        tracing::info!("headset session: {state:?}");
        let (call, result) = match self.life.enter(state) {
            Some(Duty::Begin) => ("xrBeginSession", self.session.begin(STEREO)),
            Some(Duty::End) => ("xrEndSession", self.session.end()),
            None => return Ok(()),
        };
        self.life.survive(call, result)?;
        Ok(())
    }

    /// Input of the controllers; at rest after a loss.
    pub fn input(&mut self) -> Result<ControllerInput, Fault> {
        let read = self.input.read(&self.session);
        Ok(self.life.survive("xrSyncActions", read)?.unwrap_or_default())
    }

    /// The images to draw into.
    pub fn acquire(&mut self) -> Result<EyeImages, Fault> {
        let acquired = self.images.acquire(&self.gpu.queue);
        self.life.survive("xrAcquireSwapchainImage", acquired)?;
        Ok(self.images.images())
    }

    /// The eyes at the display time; where they were last after a loss.
    pub fn locate(&mut self) -> Result<[StageEye; 2], Fault> {
        let Some(frame) = &mut self.frame else {
            return Err(Fault::Order("no frame has begun to locate the eyes for"));
        };
        let located = locate(&self.session, &self.stage, frame.display_time, &mut self.eyes);
        self.life.survive("xrLocateViews", located)?;
        frame.located = true;
        let gaze_in_stage = self.input.gaze(&self.session, &self.stage, frame.display_time);
        Ok(self.eyes.in_stage(gaze_in_stage))
    }

    /// Submits the commands, releases the images and ends the frame, under one lock of the queue.
    pub fn submit(&mut self, commands: Option<wgpu::CommandEncoder>) -> Result<(), Fault> {
        let Some(frame) = self.frame.take() else { return Err(Fault::Order("no frame has begun to submit")) };
        let shows = commands.is_some();
        if shows && !frame.located {
            return Err(Fault::Order("a frame was drawn without locating the eyes"));
        }
        let closed = commands.map(|commands| self.images.close(commands));

        let queue = self.gpu.queue.lock();
        if let Some(closed) = closed {
            let released = self.images.release(&queue, closed);
            self.life.survive("xrReleaseSwapchainImage", released)?;
        }
        if self.life.ended().is_some() {
            return Ok(());
        }
        let finished = if shows {
            self.frames.end(&queue, frame.display_time, &self.stage, &self.eyes, &self.images, self.near_m)
        } else {
            self.frames.end_empty(&queue, frame.display_time)
        };
        drop(queue);
        self.life.survive("xrEndFrame", finished)?;
        Ok(())
    }

    /// Asks the runtime to end the session.
    pub fn request_exit(&mut self) {
        if self.life.ask_exit(Instant::now())
            && let Err(result) = self.session.request_exit()
        {
            tracing::warn!("xrRequestExitSession: {result:?}");
            self.life.end(End::ByUser);
        }
    }
}

/// Adds depth images, if the runtime has a format that fits; without them all goes on as well.
fn add_depth(images: &mut EyeSwapchains, session: &xr::Session<xr::Vulkan>, gpu: &Gpu, offered: &[u32]) {
    match ImageFormat::depth(offered).map(|format| images.add_depth(session, gpu, format)) {
        Some(Ok(())) => {
            tracing::info!("the headset takes depth: {:?}", images.depth_format());
        }
        Some(Err(result)) => {
            tracing::warn!("the headset takes no depth images: xrCreateSwapchain: {result:?}")
        }
        None => tracing::info!("the headset takes depth, but in no format that we have"),
    }
}

/// The stage: the floor at y = 0, under the user where the runtime can tell.
///
/// LOCAL_FLOOR follows the user's recentering and knows the floor; STAGE knows the floor; LOCAL knows
/// neither, so its floor is taken to be [`EYE_HEIGHT_M`] below its origin.
fn stage_space(session: &xr::Session<xr::Vulkan>) -> xr::Result<(xr::Space, xr::ReferenceSpaceType)> {
    let offered = session.enumerate_reference_spaces()?;
    let preferred = [xr::ReferenceSpaceType::LOCAL_FLOOR, xr::ReferenceSpaceType::STAGE];
    let kind = preferred.into_iter().find(|kind| offered.contains(kind));
    let kind = kind.unwrap_or(xr::ReferenceSpaceType::LOCAL);
    let mut pose = xr::Posef::IDENTITY;
    if kind == xr::ReferenceSpaceType::LOCAL {
        pose.position.y = -EYE_HEIGHT_M;
    }
    tracing::debug!("the stage is the runtime's {kind:?} space");
    Ok((session.create_reference_space(kind, pose)?, kind))
}

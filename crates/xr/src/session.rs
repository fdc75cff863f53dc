//! A session: events, frames, images and input together, as the frame thread uses them.

use super::eyes::{Eyes, LOCAL_ORIGIN_M};
use super::fault::{Cause, End, FailedCall};
use super::frames::{FrameCalls, ShownLayers, locate};
use super::hands::HandTrackers;
use super::input::{Input, Moment};
use super::lifecycle::{Duty, Lifecycle};
use super::mask::VisibilityMask;
use super::missing::XrMissing;
use super::panel::PanelLayer;
use super::refresh;
use super::runtime::{Runtime, STEREO, scaled_size};
use super::swapchain::{Acquired, EyeSwapchains, ImageFormat};
use crate::hidden_area::HiddenArea;
use crate::{ControllerInput, EyeImages, FrameState, HandJoints, Panel, SessionState, StageEye, XrOptions};
use openxr as xr;
use raw::device::RuntimeGpu;
use raw::frame::Begun;
use render::fitting_px;
use render::gpu::Gpu;
use std::sync::Arc;
use std::time::Instant;
use timing::{CallTimes, ms};

/// A frame from xrWaitFrame to xrEndFrame.
#[derive(Clone, Copy)]
struct OpenFrame {
    display_time: xr::Time,
    period: xr::Duration,
    should_render: bool,
    /// True once xrBeginFrame has worked: until then it is to be called again, for a frame that was waited for and not
    /// begun lets no other be waited for.
    is_begun: bool,
}

/// An open session.
pub(super) struct XrSession {
    images: EyeSwapchains,
    stage: xr::Space,
    stage_kind: xr::ReferenceSpaceType,
    input: Input,
    /// `None` if the runtime tracks no bare hands, or they are not to be followed.
    trackers: Option<HandTrackers>,
    /// The joints of each hand, as of the last input.
    pub hands: [Option<HandJoints>; 2],
    frames: FrameCalls,
    session: xr::Session<xr::Vulkan>,
    xr: xr::Instance,
    gpu: Arc<Gpu>,
    pub format: wgpu::TextureFormat,
    pub refresh_hz: f64,
    pub life: Lifecycle,
    mask: Option<VisibilityMask>,
    panel: PanelLayer,
    /// The near plane that depth images are relative to, meters.
    near_m: f32,
    eyes: Eyes,
    frame: Option<OpenFrame>,
    /// True if the runtime tells what time it is on its clock.
    has_clock: bool,
    /// What the last frame's calls took.
    pub call_times: CallTimes,
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
        let wanted_px = runtime.eye_images()?.map(|view| scaled_size(&view, scale));
        let sizes_px = wanted_px.map(|size_px| fitting_px(gpu, size_px));
        if sizes_px != wanted_px {
            let [[wide, high], _] = wanted_px;
            let [[width, height], _] = sizes_px;
            tracing::warn!(
                "the headset's images of {wide} × {high} pixels are too large for this GPU, so they have {width} × {height}; \
                 headset.resolution_scale chooses a size"
            );
        }
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
        let mut profiles = runtime.profiles.clone();
        profiles.retain(|profile| options.hands || !profile.is_bare_hand());
        let input = Input::new(&runtime.xr, &session, &profiles, runtime.offers.eye_gaze)
            .map_err(refused("xrAttachSessionActionSets"))?;
        let refresh_hz = refresh::settle(&session, runtime.offers.refresh_rate, options.refresh_hz);
        let trackers = if runtime.offers.hand_tracking && options.hands { track(&session) } else { None };
        Ok(Self {
            images,
            stage,
            stage_kind,
            input,
            trackers,
            hands: [None; 2],
            frames: FrameCalls::new(waiter, stream, blend_mode),
            session,
            xr: runtime.xr.clone(),
            gpu: Arc::clone(gpu),
            format: format.wgpu,
            refresh_hz,
            life: Lifecycle::new(),
            mask: (runtime.offers.visibility_mask && options.visibility_mask).then(VisibilityMask::default),
            panel: PanelLayer::new(format),
            near_m: options.near_m as f32,
            eyes: Eyes::standing(),
            frame: None,
            has_clock: runtime.offers.clock,
            call_times: CallTimes::default(),
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

    /// Handles events, then waits for the next frame's time and begins it. A frame that was not submitted is ended first.
    pub fn wait(&mut self) -> FrameState {
        if self.frame.is_some_and(|frame| frame.is_begun) {
            self.submit(None);
        }
        self.handle_events();
        self.life.lose_patience(Instant::now());
        if let Some(end) = self.life.ended() {
            return FrameState::Ended(end.clone());
        }
        let frame = if self.life.running() { self.begin_frame() } else { None };
        match (frame, self.life.ended()) {
            (_, Some(end)) => FrameState::Ended(end.clone()),
            (None, None) => FrameState::Idle,
            (Some(frame), None) => FrameState::Frame {
                predicted_display_ns: frame.display_time.as_nanos(),
                period_ns: frame.period.as_nanos(),
                should_render: frame.should_render,
            },
        }
    }

    /// Waits for a frame and begins it; `None` if one of the two fails.
    fn begin_frame(&mut self) -> Option<OpenFrame> {
        if self.frame.is_none() {
            let waited = self.frames.wait();
            let state = self.life.survive("xrWaitFrame", waited, Instant::now())?;
            self.frame = Some(OpenFrame {
                display_time: state.predicted_display_time,
                period: state.predicted_display_period,
                should_render: state.should_render,
                is_begun: false,
            });
        }
        let begun = self.frames.begin(&self.gpu.queue.lock(), &self.session);
        if self.life.survive("xrBeginFrame", begun, Instant::now())? == Begun::Discarding {
            let result = xr::sys::Result::FRAME_DISCARDED;
            self.life.tell(Cause::Call { call: "xrBeginFrame", result });
        }
        let frame = self.frame.as_mut()?;
        frame.is_begun = true;
        Some(*frame)
    }

    fn handle_events(&mut self) {
        let mut storage = xr::EventDataBuffer::new();
        while self.life.ended().is_none() {
            let polled = self.xr.poll_event(&mut storage);
            let Some(Some(event)) = self.life.survive("xrPollEvent", polled, Instant::now()) else { break };
            match event {
                xr::Event::SessionStateChanged(event) => self.enter(event.state()),
                xr::Event::InstanceLossPending(_) => {
                    self.life.end(End::RuntimeLost(Cause::InstanceLossPending));
                }
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
    }

    fn enter(&mut self, state: xr::SessionState) {
        tracing::info!("headset session: {state:?}");
        let (call, result) = match self.life.enter(state) {
            Some(Duty::Begin) => ("xrBeginSession", self.session.begin(STEREO)),
            Some(Duty::End) => ("xrEndSession", self.session.end()),
            None => return,
        };
        // A frame of the time before is none of the session that begins now.
        self.frame = None;
        self.life.survive(call, result, Instant::now());
    }

    /// Input of both hands; at rest if it cannot be had.
    pub fn input(&mut self) -> ControllerInput {
        self.hands = [None; 2];
        let Some(frame) = self.frame else { return ControllerInput::default() };
        let has_focus = self.life.state() == SessionState::FOCUSED;
        if let Some(trackers) = self.trackers.as_ref().filter(|_| has_focus) {
            let located = trackers.locate(&self.stage, frame.display_time);
            let located = self.life.survive("xrLocateHandJointsEXT", located, Instant::now());
            self.hands = located.unwrap_or_default();
        }
        let moment = Moment {
            session: &self.session,
            stage: &self.stage,
            display_time: frame.display_time,
            stage_from_head: self.eyes.head(),
            has_focus,
        };
        match self.input.read(&moment, &self.hands) {
            Ok(input) => input,
            Err(FailedCall { call, result }) => {
                self.life.survive(call, Err(result), Instant::now()).unwrap_or_default()
            }
        }
    }

    /// Shakes a controller, if a session runs.
    pub fn vibrate(&mut self, hand: usize, strength: f32, seconds: f32) {
        if self.life.running() {
            let applied = self.input.vibrate(&self.session, hand, strength, seconds);
            self.life.survive("xrApplyHapticFeedback", applied, Instant::now());
        }
    }

    /// Shows a panel from now on, or none; false if it cannot be shown.
    pub fn show_panel(&mut self, panel: Option<&Panel>) -> bool {
        self.panel.want(panel, &self.session, &self.gpu)
    }

    /// The images to draw into; `None` if they cannot be had in this frame.
    pub fn acquire(&mut self) -> Option<EyeImages> {
        self.frame.filter(|frame| frame.is_begun)?;
        let began = Instant::now();
        let acquired = self.images.acquire(&self.gpu.queue);
        if let Err(FailedCall { call, result }) = self.panel.acquire(&self.gpu) {
            self.life.survive::<()>(call, Err(result), Instant::now());
        }
        let now = Instant::now();
        self.call_times = CallTimes { image_ms: ms(now - began), ..CallTimes::default() };
        match self.life.survive("xrAcquireSwapchainImage", acquired, now)? {
            Acquired::All => Some(self.images.images()),
            Acquired::TimedOut => {
                let expired = xr::sys::Result::TIMEOUT_EXPIRED;
                self.life.survive::<()>("xrWaitSwapchainImage", Err(expired), now);
                None
            }
        }
    }

    /// The eyes at the display time; where they were last if that cannot be told.
    pub fn locate(&mut self) -> [StageEye; 2] {
        let Some(frame) = self.frame else { return self.eyes.in_stage(None) };
        let began = Instant::now();
        if let Some(now) = self.has_clock.then(|| self.xr.now().ok()).flatten() {
            self.call_times.pose_age_ms = (frame.display_time.as_nanos() - now.as_nanos()) as f32 * 1e-6;
        }
        let located = locate(&self.session, &self.stage, frame.display_time, &mut self.eyes);
        self.life.survive("xrLocateViews", located, Instant::now());
        self.call_times.locate_ms = ms(began.elapsed());
        let gaze_in_stage = self.input.gaze(&self.session, &self.stage, frame.display_time);
        self.eyes.in_stage(gaze_in_stage)
    }

    /// Submits the commands, releases the images and ends the frame, under one lock of the queue.
    pub fn submit(&mut self, commands: Option<wgpu::CommandEncoder>) {
        let Some(frame) = self.frame.take_if(|frame| frame.is_begun) else { return };
        let closed = commands.map(|commands| self.images.close(commands));

        let queue = self.gpu.queue.lock();
        let mut shows = false;
        if let Some(closed) = closed {
            let began = Instant::now();
            let released = self.images.release(&queue, closed);
            shows = self.life.survive("xrReleaseSwapchainImage", released, Instant::now()).is_some();
            if let Err(FailedCall { call, result }) = self.panel.send(&self.gpu, &queue) {
                self.life.survive::<()>(call, Err(result), Instant::now());
            }
            self.call_times.release_ms = ms(began.elapsed());
        }
        if self.life.ended().is_some() {
            return;
        }
        let began = Instant::now();
        let finished = if shows {
            let panel = self.panel.layer(&self.stage);
            let shown = ShownLayers { eyes: &self.eyes, images: &self.images, near_m: self.near_m, panel };
            self.frames.end(&queue, frame.display_time, &self.stage, &shown)
        } else {
            self.frames.end_empty(&queue, frame.display_time)
        };
        drop(queue);
        self.call_times.end_ms = ms(began.elapsed());
        if self.life.survive("xrEndFrame", finished, Instant::now()).is_some() {
            self.life.frame_ended();
        }
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

/// Tracks the hands; without them all goes on as well.
fn track(session: &xr::Session<xr::Vulkan>) -> Option<HandTrackers> {
    let trackers = HandTrackers::new(session);
    trackers
        .inspect_err(|result| tracing::warn!("hands are not tracked: xrCreateHandTrackerEXT: {result:?}"))
        .ok()
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
/// neither, so its floor is taken to be [`LOCAL_ORIGIN_M`] below its origin.
fn stage_space(session: &xr::Session<xr::Vulkan>) -> xr::Result<(xr::Space, xr::ReferenceSpaceType)> {
    let offered = session.enumerate_reference_spaces()?;
    let preferred = [xr::ReferenceSpaceType::LOCAL_FLOOR, xr::ReferenceSpaceType::STAGE];
    let kind = preferred.into_iter().find(|kind| offered.contains(kind));
    let kind = kind.unwrap_or(xr::ReferenceSpaceType::LOCAL);
    let mut pose = xr::Posef::IDENTITY;
    if kind == xr::ReferenceSpaceType::LOCAL {
        pose.position.y = -LOCAL_ORIGIN_M;
    }
    tracing::debug!("the stage is the runtime's {kind:?} space");
    Ok((session.create_reference_space(kind, pose)?, kind))
}

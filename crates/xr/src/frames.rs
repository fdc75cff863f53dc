//! The frame calls, two of which use the Vulkan queue and so take its guard.

use super::eyes::Eyes;
use super::runtime::STEREO;
use super::swapchain::EyeSwapchains;
use openxr as xr;
use raw::depth_layer::DepthInfo;
use raw::frame::Begun;
use render::gpu::QueueGuard;

/// xrWaitFrame, xrBeginFrame, xrEndFrame; the openxr objects do not leave this struct.
pub(super) struct FrameCalls {
    waiter: xr::FrameWaiter,
    stream: xr::FrameStream<xr::Vulkan>,
    blend_mode: xr::EnvironmentBlendMode,
}

/// What a frame shows.
pub(super) struct ShownLayers<'a> {
    /// The eyes that the images were drawn for.
    pub eyes: &'a Eyes,
    /// The eyes' images.
    pub images: &'a EyeSwapchains,
    /// What depth images, if there are any, hold divided by w, meters.
    pub near_m: f32,
    /// A panel, if there is one.
    pub panel: Option<xr::CompositionLayerQuad<'a, xr::Vulkan>>,
}

impl FrameCalls {
    pub fn new(
        waiter: xr::FrameWaiter,
        stream: xr::FrameStream<xr::Vulkan>,
        blend_mode: xr::EnvironmentBlendMode,
    ) -> Self {
        Self { waiter, stream, blend_mode }
    }

    /// Blocks until the next frame should begin. Call it without the queue's lock.
    pub fn wait(&mut self) -> xr::Result<xr::FrameState> {
        self.waiter.wait()
    }

    /// Begins the frame's GPU work.
    pub fn begin(&mut self, _queue: &QueueGuard<'_>, session: &xr::Session<xr::Vulkan>) -> xr::Result<Begun> {
        raw::frame::begin(session)
    }

    /// Ends the frame, which shows nothing.
    pub fn end_empty(&mut self, _queue: &QueueGuard<'_>, display_time: xr::Time) -> xr::Result<()> {
        self.stream.end(display_time, self.blend_mode, &[])
    }

    /// Ends the frame, which shows the images last released, and the panel before them.
    pub fn end(
        &mut self,
        _queue: &QueueGuard<'_>,
        display_time: xr::Time,
        stage: &xr::Space,
        shown: &ShownLayers<'_>,
    ) -> xr::Result<()> {
        let ShownLayers { eyes, images, near_m, ref panel } = *shown;
        let depth = [0, 1].map(|eye| Some(DepthInfo::new(images.depth_sub_image(eye)?, near_m)));
        let views: [_; 2] = std::array::from_fn(|eye| {
            let located = eyes.views()[eye];
            let view = xr::CompositionLayerProjectionView::new()
                .pose(located.pose)
                .fov(located.fov)
                .sub_image(images.sub_image(eye));
            match &depth[eye] {
                Some(depth) => depth.chain(view),
                None => view,
            }
        });
        let layer = xr::CompositionLayerProjection::new().space(stage).views(&views);
        match panel {
            Some(panel) => self.stream.end(display_time, self.blend_mode, &[&layer, panel]),
            None => self.stream.end(display_time, self.blend_mode, &[&layer]),
        }
    }
}

/// The eyes at `display_time`, as the runtime predicts them at the moment of the call.
pub(super) fn locate(
    session: &xr::Session<xr::Vulkan>,
    stage: &xr::Space,
    display_time: xr::Time,
    eyes: &mut Eyes,
) -> xr::Result<()> {
    let (flags, views) = session.locate_views(STEREO, display_time, stage)?;
    eyes.update(flags, &views)
}

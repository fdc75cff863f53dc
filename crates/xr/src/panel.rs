//! A panel: a picture that the compositor shows as a rectangle in the stage, as sharp as the display allows, for it is
//! sampled once only (a quad layer).

use super::fault::FailedCall;
use super::headset::Panel;
use super::pose::to_runtime;
use super::swapchain::{ImageFormat, LayerSwapchain};
use openxr as xr;
use render::gpu::{Gpu, QueueGuard};

/// The panel of a session, and its swapchain.
pub(super) struct PanelLayer {
    swapchain: Option<LayerSwapchain>,
    format: ImageFormat,
    wanted: Option<Panel>,
    /// The picture that the compositor has.
    sent: Option<wgpu::Texture>,
    /// True once the runtime has refused a swapchain: it would refuse the next.
    is_refused: bool,
}

impl PanelLayer {
    /// No panel, for a session whose images have this format.
    pub fn new(format: ImageFormat) -> Self {
        Self { swapchain: None, format, wanted: None, sent: None, is_refused: false }
    }

    /// Wants a panel shown, or none; false if it cannot be.
    pub fn want(&mut self, panel: Option<&Panel>, session: &xr::Session<xr::Vulkan>, gpu: &Gpu) -> bool {
        self.wanted = None;
        let Some(panel) = panel else { return true };
        if self.is_refused || panel.picture.format() != self.format.wgpu {
            return false;
        }
        let size_px = [panel.picture.width(), panel.picture.height()];
        if self.swapchain.as_ref().is_none_or(|swapchain| swapchain.size_px() != size_px) {
            match LayerSwapchain::new(session, gpu, self.format, size_px, "panel") {
                Ok(swapchain) => (self.swapchain, self.sent) = (Some(swapchain), None),
                Err(result) => {
                    tracing::warn!("the headset shows no panel of its own: xrCreateSwapchain: {result:?}");
                    self.is_refused = true;
                    return false;
                }
            }
        }
        self.wanted = Some(panel.clone());
        true
    }

    /// Acquires an image for a picture that the compositor does not have, and waits for it without the queue's lock.
    ///
    /// # Errors
    /// The call that failed.
    pub fn acquire(&mut self, gpu: &Gpu) -> Result<(), FailedCall> {
        let Some(panel) = self.wanted.as_ref().filter(|panel| Some(&panel.picture) != self.sent.as_ref())
        else {
            return Ok(());
        };
        let size_px = [panel.picture.width(), panel.picture.height()];
        if let Some(swapchain) = self.swapchain.as_mut().filter(|swapchain| swapchain.size_px() == size_px) {
            let acquired = swapchain.acquire(&gpu.queue.lock());
            acquired.map_err(|result| FailedCall { call: "xrAcquireSwapchainImage", result })?;
            // An image that the compositor still reads is waited for with the next frame.
            swapchain.wait().map_err(|result| FailedCall { call: "xrWaitSwapchainImage", result })?;
        }
        Ok(())
    }

    /// Sends the picture, if an image is held for it.
    ///
    /// # Errors
    /// The call that failed.
    pub fn send(&mut self, gpu: &Gpu, queue: &QueueGuard<'_>) -> Result<(), FailedCall> {
        if let (Some(swapchain), Some(panel)) = (&mut self.swapchain, &self.wanted) {
            let filled = swapchain.fill(gpu, queue, &panel.picture);
            if filled.map_err(|result| FailedCall { call: "xrReleaseSwapchainImage", result })? {
                self.sent = Some(panel.picture.clone());
            }
        }
        Ok(())
    }

    /// The layer to show, if there is one.
    pub fn layer<'a>(&'a self, stage: &'a xr::Space) -> Option<xr::CompositionLayerQuad<'a, xr::Vulkan>> {
        let (Some(swapchain), Some(panel), Some(_)) = (&self.swapchain, &self.wanted, &self.sent) else {
            return None;
        };
        let [width, height] = panel.size_m.map(|edge| edge as f32);
        let layer = xr::CompositionLayerQuad::new()
            .layer_flags(xr::CompositionLayerFlags::BLEND_TEXTURE_SOURCE_ALPHA)
            .space(stage)
            .eye_visibility(xr::EyeVisibility::BOTH)
            .sub_image(swapchain.sub_image())
            .pose(to_runtime(&panel.stage_from_panel))
            .size(xr::Extent2Df { width, height });
        Some(layer)
    }
}

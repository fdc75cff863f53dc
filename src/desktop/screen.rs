//! The window's surface: configured, acquired and presented so that the frame thread never waits for it.
//!
//! - The present mode does not wait for the display; FIFO is taken only where there is no other.
//! - There is one picture at a time: the next is begun when the GPU has finished the one before, so acquiring never
//!   waits for work that is queued behind the headset's frames.
//! - Configuring waits for the GPU, under the queue lock; so a resize does it at most ten times a second.

use super::{DesktopError, QUEUE_PATIENCE};
use render::gpu::Gpu;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use winit::window::Window;

/// Shortest time between two configurations.
const CONFIGURE_PAUSE: Duration = Duration::from_millis(100);

/// A surface and what it is configured to.
#[derive(Debug)]
pub(super) struct WindowSurface {
    gpu: Arc<Gpu>,
    window: Arc<Window>,
    /// `None` only inside [`WindowSurface::recreate`] and `drop`.
    surface: Option<wgpu::Surface<'static>>,
    config: wgpu::SurfaceConfiguration,
    /// True if the surface is as `config` says.
    configured: bool,
    last_configure: Option<Instant>,
    /// True once the GPU has finished the last picture.
    finished: Arc<AtomicBool>,
}

impl WindowSurface {
    /// The surface of `window`, which is configured when the first picture is begun.
    pub(super) fn new(gpu: Arc<Gpu>, window: Arc<Window>) -> Result<Self, DesktopError> {
        let surface = gpu.instance.create_surface(Arc::clone(&window))?;
        let capabilities = surface.get_capabilities(&gpu.adapter);
        let (Some(format), Some(present_mode)) =
            (choose_format(&capabilities.formats), choose_present_mode(&capabilities.present_modes))
        else {
            return Err(DesktopError::CannotPresent { gpu: gpu.name() });
        };
        let config = wgpu::SurfaceConfiguration {
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            format,
            color_space: wgpu::SurfaceColorSpace::Auto,
            width: 0,
            height: 0,
            present_mode,
            desired_maximum_frame_latency: 2,
            alpha_mode: wgpu::CompositeAlphaMode::Auto,
            view_formats: Vec::new(),
        };
        let finished = Arc::new(AtomicBool::new(true));
        let surface = Some(surface);
        Ok(Self { gpu, window, surface, config, configured: false, last_configure: None, finished })
    }

    /// Format of the pictures.
    pub(super) fn format(&self) -> wgpu::TextureFormat {
        self.config.format
    }

    /// Returns a texture of the window's size to draw the next picture into. `None` if the window has no area or is
    /// hidden, the GPU is still at the last picture, or the surface is between two sizes.
    pub(super) fn begin(&mut self) -> Result<Option<wgpu::SurfaceTexture>, DesktopError> {
        if !self.finished.load(Ordering::Acquire) {
            // This runs the callback of `present` if its time has come, and waits for nothing.
            let _ = self.gpu.poll(wgpu::PollType::Poll);
            if !self.finished.load(Ordering::Acquire) {
                return Ok(None);
            }
        }
        if !self.fit() {
            return Ok(None);
        }
        let Some(surface) = &self.surface else { return Ok(None) };
        Ok(match surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(texture) => Some(texture),
            wgpu::CurrentSurfaceTexture::Suboptimal(texture) => {
                self.configured = false;
                Some(texture)
            }
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Validation => {
                self.configured = false;
                None
            }
            wgpu::CurrentSurfaceTexture::Lost => {
                self.recreate()?;
                None
            }
            wgpu::CurrentSurfaceTexture::Timeout | wgpu::CurrentSurfaceTexture::Occluded => None,
        })
    }

    /// Submits the picture's commands and shows it, if the queue is to be had.
    pub(super) fn present(&self, commands: Vec<wgpu::CommandBuffer>, picture: wgpu::SurfaceTexture) {
        let Some(queue) = self.gpu.queue.lock_within(QUEUE_PATIENCE) else { return };
        self.finished.store(false, Ordering::Release);
        self.window.pre_present_notify();
        queue.submit(commands);
        let finished = Arc::clone(&self.finished);
        queue.on_submitted_work_done(move || finished.store(true, Ordering::Release));
        queue.present(picture);
    }

    /// Configures the surface if the window's size is another; false while there is nothing to draw into.
    fn fit(&mut self) -> bool {
        let size = self.window.inner_size();
        if size.width == 0 || size.height == 0 {
            return false;
        }
        let limit = self.gpu.device.limits().max_texture_dimension_2d;
        let (width, height) = (size.width.min(limit), size.height.min(limit));
        if self.configured && (self.config.width, self.config.height) == (width, height) {
            return true;
        }
        if self.last_configure.is_some_and(|last| last.elapsed() < CONFIGURE_PAUSE) {
            return false;
        }
        let Some(queue) = self.gpu.queue.lock_within(QUEUE_PATIENCE) else { return false };
        (self.config.width, self.config.height) = (width, height);
        if let Some(surface) = &self.surface {
            queue.configure(surface, &self.gpu.device, &self.config);
        }
        drop(queue);
        self.last_configure = Some(Instant::now());
        self.configured = true;
        true
    }

    fn recreate(&mut self) -> Result<(), DesktopError> {
        self.release();
        self.surface = Some(self.gpu.instance.create_surface(Arc::clone(&self.window))?);
        self.configured = false;
        Ok(())
    }

    /// Destroys the surface under the queue lock: that waits for the GPU, which uses the queue. Where a runtime holds the
    /// queue for ever, the surface is left to the system.
    pub(super) fn release(&mut self) {
        match self.gpu.queue.lock_within(QUEUE_PATIENCE) {
            Some(_queue) => self.surface = None,
            None => std::mem::forget(self.surface.take()),
        }
    }
}

impl Drop for WindowSurface {
    fn drop(&mut self) {
        self.release();
    }
}

/// Chooses a format that is not sRGB, in which egui blends as designers expect; the mirror encodes by itself then.
fn choose_format(formats: &[wgpu::TextureFormat]) -> Option<wgpu::TextureFormat> {
    let wanted = [wgpu::TextureFormat::Bgra8Unorm, wgpu::TextureFormat::Rgba8Unorm];
    wanted.into_iter().find(|f| formats.contains(f)).or_else(|| formats.first().copied())
}

/// Chooses a present mode that never waits for the display, if there is one.
fn choose_present_mode(modes: &[wgpu::PresentMode]) -> Option<wgpu::PresentMode> {
    let wanted = [wgpu::PresentMode::Mailbox, wgpu::PresentMode::Immediate];
    wanted.into_iter().find(|m| modes.contains(m)).or_else(|| modes.first().copied())
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::{PresentMode, TextureFormat};

    #[test]
    fn fifo_is_the_last_choice() {
        use PresentMode::{Fifo, FifoRelaxed, Immediate, Mailbox};
        assert_eq!(choose_present_mode(&[Fifo, FifoRelaxed, Immediate, Mailbox]), Some(Mailbox));
        assert_eq!(choose_present_mode(&[Fifo, Immediate]), Some(Immediate));
        assert_eq!(choose_present_mode(&[Fifo]), Some(Fifo));
        assert_eq!(choose_present_mode(&[]), None);
    }

    #[test]
    fn formats_that_egui_likes_come_first() {
        use TextureFormat::{Bgra8Unorm, Bgra8UnormSrgb, Rgba8Unorm, Rgba16Float};
        assert_eq!(choose_format(&[Bgra8UnormSrgb, Rgba8Unorm, Bgra8Unorm]), Some(Bgra8Unorm));
        assert_eq!(choose_format(&[Rgba16Float, Rgba8Unorm]), Some(Rgba8Unorm));
        assert_eq!(choose_format(&[Bgra8UnormSrgb]), Some(Bgra8UnormSrgb));
        assert_eq!(choose_format(&[]), None);
    }
}

//! The one queue lock.
//!
//! OpenXR runtimes use the Vulkan queue inside xrBeginFrame, xrEndFrame, xrAcquireSwapchainImage and
//! xrReleaseSwapchainImage, while the window presents from another thread. Vulkan demands that the two never
//! meet. The queue is therefore reachable only through a guard, and the four OpenXR calls take the guard
//! as an argument. Never hold it while waiting for anything.

use std::ops::Deref;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// wgpu's queue, locked away.
#[derive(Debug)]
pub struct Queue(Mutex<wgpu::Queue>);

/// The right to use the queue; derefs to it. Submit, present, configure a surface, then let go.
#[derive(Debug)]
pub struct QueueGuard<'a>(MutexGuard<'a, wgpu::Queue>);

impl Queue {
    /// Takes the queue in.
    #[must_use]
    pub fn new(queue: wgpu::Queue) -> Self {
        Self(Mutex::new(queue))
    }

    /// Waits for the lock: microseconds, since nobody waits while holding it.
    pub fn lock(&self) -> QueueGuard<'_> {
        // A panic on another thread leaves the queue itself whole.
        QueueGuard(self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Deref for QueueGuard<'_> {
    type Target = wgpu::Queue;

    fn deref(&self) -> &wgpu::Queue {
        &self.0
    }
}

impl QueueGuard<'_> {
    /// Configures a surface, which uses the queue under the hood.
    pub fn configure(
        &self,
        surface: &wgpu::Surface,
        device: &wgpu::Device,
        config: &wgpu::SurfaceConfiguration,
    ) {
        surface.configure(device, config);
    }
}

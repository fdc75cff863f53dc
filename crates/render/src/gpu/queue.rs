//! The one queue lock.
//!
//! OpenXR runtimes use the Vulkan queue inside xrBeginFrame, xrEndFrame, xrAcquireSwapchainImage and
//! xrReleaseSwapchainImage, while the window presents from another thread. Vulkan demands that the two never
//! meet. The queue is therefore reachable only through a guard, and the four OpenXR calls take the guard
//! as an argument. Never hold it while waiting for anything.

use parking_lot::{Mutex, MutexGuard};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

/// wgpu's queue, locked away.
#[derive(Debug)]
pub struct Queue {
    queue: Mutex<wgpu::Queue>,
    /// True since somebody has waited for the lock in vain, until it is had again.
    is_stuck: AtomicBool,
    written_bytes: AtomicU64,
}

/// The right to use the queue. It does not deref to wgpu's queue: that one can be cloned, and a clone knows no lock.
#[derive(Debug)]
pub struct QueueGuard<'a> {
    queue: MutexGuard<'a, wgpu::Queue>,
    written_bytes: &'a AtomicU64,
}

impl Queue {
    /// Takes the queue in.
    #[must_use]
    pub fn new(queue: wgpu::Queue) -> Self {
        Self { queue: Mutex::new(queue), is_stuck: AtomicBool::new(false), written_bytes: AtomicU64::new(0) }
    }

    /// Waits for the lock: microseconds, since nobody waits while holding it, unless an OpenXR runtime is stuck in one of
    /// its four calls.
    pub fn lock(&self) -> QueueGuard<'_> {
        QueueGuard { queue: self.queue.lock(), written_bytes: &self.written_bytes }
    }

    /// Waits for the lock at most this long: for those who must go on where a runtime is stuck. After a wait in vain
    /// nobody waits any more until the lock is to be had.
    #[must_use]
    pub fn lock_within(&self, patience: Duration) -> Option<QueueGuard<'_>> {
        let patience = if self.is_stuck.load(Ordering::Relaxed) { Duration::ZERO } else { patience };
        let queue = self.queue.try_lock_for(patience);
        self.is_stuck.store(queue.is_none(), Ordering::Relaxed);
        Some(QueueGuard { queue: queue?, written_bytes: &self.written_bytes })
    }

    /// Bytes that [`QueueGuard::write_buffer`] has sent to the GPU so far.
    #[must_use]
    pub fn written_bytes(&self) -> u64 {
        self.written_bytes.load(Ordering::Relaxed)
    }
}

impl QueueGuard<'_> {
    /// Hands commands to the GPU.
    pub fn submit<I: IntoIterator<Item = wgpu::CommandBuffer>>(&self, commands: I) -> wgpu::SubmissionIndex {
        self.queue.submit(commands)
    }

    /// Writes bytes into a buffer before the next submit's commands run.
    pub fn write_buffer(&self, buffer: &wgpu::Buffer, offset: u64, bytes: &[u8]) {
        self.queue.write_buffer(buffer, offset, bytes);
        self.written_bytes.fetch_add(bytes.len() as u64, Ordering::Relaxed);
    }

    /// Calls back when everything submitted so far is done. The callback may run while somebody holds this lock:
    /// it must not take it.
    pub fn on_submitted_work_done(&self, callback: impl FnOnce() + Send + 'static) {
        self.queue.on_submitted_work_done(callback);
    }

    /// Shows a window's picture.
    pub fn present(&self, picture: wgpu::SurfaceTexture) {
        self.queue.present(picture);
    }

    /// Configures a surface, which uses the queue under the hood.
    pub fn configure(
        &self,
        surface: &wgpu::Surface,
        device: &wgpu::Device,
        config: &wgpu::SurfaceConfiguration,
    ) {
        surface.configure(device, config);
    }

    /// Nanoseconds a tick of the GPU's timestamps.
    #[must_use]
    pub fn timestamp_period(&self) -> f32 {
        self.queue.get_timestamp_period()
    }

    /// The queue itself, for a library that stages its own uploads (egui). Never to be cloned or submitted to:
    /// `tests/program/house/calls.rs` allows its use in the window's painter alone.
    #[must_use]
    pub fn for_uploads(&self) -> &wgpu::Queue {
        &self.queue
    }
}

//! wgpu, thinly: the device, its one queue, shaders, stages, timers, readback. Knows no cloud, no eye and
//! no configuration.

mod open;
mod queue;
pub mod readback;
pub mod stage;
pub mod timer;

pub use open::{GpuError, required_features};
pub(crate) use open::{block_on, instance_flags};
pub use queue::{Queue, QueueGuard};

/// A GPU, opened: by us ([`Gpu::open`]) or by an OpenXR runtime (`xr::vulkan`).
#[derive(Debug)]
pub struct Gpu {
    /// wgpu's instance; window surfaces are made from it.
    pub instance: wgpu::Instance,
    /// The adapter that `device` was made from.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// The queue behind its lock: the only way to submit, present or configure.
    pub queue: Queue,
}

impl Gpu {
    /// "NAME (driver VERSION)" for logs and people.
    #[must_use]
    pub fn name(&self) -> String {
        self.adapter.get_info().name
    }

    /// Driver name and version.
    #[must_use]
    pub fn driver(&self) -> String {
        let info = self.adapter.get_info();
        format!("{} {}", info.driver, info.driver_info).trim().to_string()
    }

    /// Bytes that one storage binding may hold; buffers that shaders read are cut to it.
    #[must_use]
    pub fn binding_limit(&self) -> u64 {
        let limits = self.device.limits();
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
    }
}

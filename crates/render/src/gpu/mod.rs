//! A thin layer over wgpu: the device, its one queue, shaders, stages, timers, readback. It knows no cloud, no eye and
//! no configuration.

pub mod drawing;
mod lost;
mod open;
mod queue;
pub mod readback;
pub mod stage;
pub mod timer;

pub use lost::{GpuLost, PollError};
pub use open::{Atomics, GpuError, block_on, instance_flags, required_features};
pub use queue::{Queue, QueueGuard};

use std::sync::{Arc, OnceLock};

/// A GPU, opened: by us ([`Gpu::open`]) or by an OpenXR runtime (`raw::device`).
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
    lost: Arc<OnceLock<String>>,
    pipelines: stage::PipelineCache,
}

impl Gpu {
    /// Takes in wgpu's objects, whose device is watched from now on: see [`Self::lost`].
    #[must_use]
    pub fn new(
        instance: wgpu::Instance,
        adapter: wgpu::Adapter,
        device: wgpu::Device,
        queue: wgpu::Queue,
    ) -> Self {
        let lost: Arc<OnceLock<String>> = Arc::default();
        let watched = Arc::clone(&lost);
        device.set_device_lost_callback(move |reason, message| {
            // Only the first reason counts.
            let _ = watched.set(if message.is_empty() { format!("{reason:?}") } else { message });
        });
        let watched = Arc::clone(&lost);
        device.on_uncaptured_error(Arc::new(move |error| {
            // All objects of a lost device are invalid: the loss is reported, errors that follow from it are not.
            assert!(watched.get().is_some(), "a mistake in the use of the GPU: {error}");
        }));
        Self {
            instance,
            adapter,
            device,
            queue: Queue::new(queue),
            lost,
            pipelines: stage::PipelineCache::default(),
        }
    }

    /// Why the device is lost, if it is: nothing more comes of submitted work then.
    #[must_use]
    pub fn lost(&self) -> Option<&str> {
        self.lost.get().map(String::as_str)
    }

    /// The adapter's name, for logs and people.
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

    /// A plain two-dimensional texture.
    #[must_use]
    pub fn texture(
        &self,
        label: &str,
        [width, height]: [u32; 2],
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    }

    /// A buffer of `size` bytes, which are zero.
    #[must_use]
    pub fn buffer(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage,
            mapped_at_creation: false,
        })
    }

    /// Bytes that one storage binding may hold; buffers that shaders read are cut to it.
    #[must_use]
    pub fn binding_limit(&self) -> u64 {
        let limits = self.device.limits();
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
    }
}

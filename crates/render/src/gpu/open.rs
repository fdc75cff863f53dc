//! Choosing an adapter and opening it without a headset runtime.

use super::Gpu;

/// Why no GPU could be opened.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// There is no Vulkan driver at all.
    #[error(
        "no Vulkan driver found: install one (on Debian and Ubuntu: `apt install mesa-vulkan-drivers`) or run scripts/demo, which does"
    )]
    NoDriver,
    /// No GPU has the name that is wanted.
    #[error("no GPU is called like '{wanted}'; there is: {found}")]
    NoSuchAdapter {
        /// Name that was asked for.
        wanted: String,
        /// Names of those that exist.
        found: String,
    },
    /// The GPU lacks something that the frame cannot do without.
    #[error("the GPU '{name}' cannot run scanwalk: it lacks {missing}")]
    Lacking {
        /// The GPU.
        name: String,
        /// What it lacks, in words.
        missing: String,
    },
    /// The driver refused to open it.
    #[error("the GPU '{name}' could not be opened: {source}")]
    Open {
        /// The GPU.
        name: String,
        /// The driver's words.
        source: wgpu::RequestDeviceError,
    },
}

/// Features that are used where they exist.
const WANTED: wgpu::Features = wgpu::Features::TIMESTAMP_QUERY
    .union(wgpu::Features::SHADER_INT64)
    .union(wgpu::Features::SHADER_INT64_ATOMIC_MIN_MAX)
    .union(wgpu::Features::SHADER_INT64_ATOMIC_ALL_OPS)
    .union(wgpu::Features::SUBGROUP)
    .union(wgpu::Features::SHADER_F64);
/// Storage buffers that the largest stage binds without 64-bit addition.
const NUM_STORAGE_BUFFERS: u32 = 10;
/// Storage buffers that the largest stage binds with 64-bit addition.
const NUM_STORAGE_BUFFERS_INT64: u32 = 12;

base::choice! {
    /// What a GPU's atomics can do, in rising order; frames use some of it (docs/FRAME.md §7). Each tier draws the same
    /// picture.
    #[derive(PartialOrd, Ord)]
    pub enum Atomics {
        /// 32-bit minimum and addition.
        Int32 = "int32",
        /// 64-bit minimum, and 32-bit addition.
        Int64Minmax = "int64-minmax",
        /// 64-bit minimum and addition.
        Int64 = "int64",
    }
}

impl Atomics {
    fn of(features: wgpu::Features, limits: &wgpu::Limits) -> Self {
        let minmax = wgpu::Features::SHADER_INT64 | wgpu::Features::SHADER_INT64_ATOMIC_MIN_MAX;
        if !features.contains(minmax) {
            Self::Int32
        } else if features.contains(wgpu::Features::SHADER_INT64_ATOMIC_ALL_OPS)
            && limits.max_storage_buffers_per_shader_stage >= NUM_STORAGE_BUFFERS_INT64
        {
            Self::Int64
        } else {
            Self::Int64Minmax
        }
    }
}

/// The features to open an adapter with.
///
/// # Errors
/// [`GpuError::Lacking`] if the adapter cannot run the frame.
pub fn required_features(
    name: &str,
    offered: wgpu::Features,
    limits: &wgpu::Limits,
) -> Result<wgpu::Features, GpuError> {
    let num_buffers = limits.max_storage_buffers_per_shader_stage;
    if num_buffers < NUM_STORAGE_BUFFERS {
        let missing = format!("{NUM_STORAGE_BUFFERS} storage buffers a shader: it has {num_buffers}");
        return Err(GpuError::Lacking { name: name.to_string(), missing });
    }
    Ok(WANTED & offered)
}

/// Flags that put nothing between us and the driver, unless `WGPU_VALIDATION=1` asks for the validation layer.
#[must_use]
pub fn instance_flags() -> wgpu::InstanceFlags {
    wgpu::InstanceFlags::empty().with_env()
}

impl Gpu {
    /// True if a program on the CPU draws in place of a GPU.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.adapter.get_info().device_type == wgpu::DeviceType::Cpu
    }

    /// True if shaders can compute in f64.
    #[must_use]
    pub fn has_f64(&self) -> bool {
        self.device.features().contains(wgpu::Features::SHADER_F64)
    }

    /// True if threads of a subgroup can ask each other.
    #[must_use]
    pub fn has_subgroups(&self) -> bool {
        self.device.features().contains(wgpu::Features::SUBGROUP)
    }

    /// What its atomics can do.
    #[must_use]
    pub fn atomics(&self) -> Atomics {
        Atomics::of(self.device.features(), &self.device.limits())
    }

    /// Opens a Vulkan GPU: the one whose name contains `wanted` (any case), else the fastest kind there is.
    ///
    /// # Errors
    /// No driver, no such GPU, or one that cannot run the frame.
    pub fn open(wanted: Option<&str>) -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::VULKAN,
            flags: instance_flags(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let mut adapters = block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN));
        adapters.sort_by_key(|a| kind_rank(a.get_info().device_type));
        if adapters.is_empty() {
            return Err(GpuError::NoDriver);
        }
        let adapter = match wanted.filter(|w| !w.is_empty()) {
            None => adapters.swap_remove(0),
            Some(wanted) => {
                let names: Vec<String> = adapters.iter().map(|a| a.get_info().name).collect();
                let matches = |name: &String| name.to_lowercase().contains(&wanted.to_lowercase());
                let Some(index) = names.iter().position(matches) else {
                    return Err(GpuError::NoSuchAdapter { wanted: wanted.into(), found: names.join(", ") });
                };
                adapters.swap_remove(index)
            }
        };
        let name = adapter.get_info().name;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("scanwalk"),
            required_features: required_features(&name, adapter.features(), &adapter.limits())?,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) = block_on(adapter.request_device(&descriptor))
            .map_err(|source| GpuError::Open { name, source })?;
        Ok(Self::new(instance, adapter, device, queue))
    }
}

/// Discrete GPUs first, software last.
fn kind_rank(kind: wgpu::DeviceType) -> u32 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

/// wgpu's Vulkan futures are ready at once; this is all the executor they need.
pub fn block_on<T>(future: impl Future<Output = T>) -> T {
    let mut future = std::pin::pin!(future);
    let mut context = std::task::Context::from_waker(std::task::Waker::noop());
    loop {
        if let std::task::Poll::Ready(value) = future.as_mut().poll(&mut context) {
            return value;
        }
        std::thread::yield_now();
    }
}

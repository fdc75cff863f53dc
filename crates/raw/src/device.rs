//! Raw handles: the OpenXR loader, and the Vulkan instance and device that the runtime makes and wgpu wraps.
//!
//! Everything that must outlive something else is owned by it, so teardown has only one possible order,
//! whichever owner goes last and also when opening fails half-way:
//!
//! ```text
//! session ──▶ Gpu ──▶ wgpu device ──▶ RuntimeDevice ──▶ RuntimeInstance
//!    └──────▶ xr::Instance ──▶ loader
//! ```
//!
//! The Vulkan handles do not need the OpenXR instance once they are made: they are the Vulkan loader's, which the runtime
//! was told to call (XR_KHR_vulkan_enable2). So the GPU lives on where a runtime has stopped, and another OpenXR instance,
//! of which a process has one at a time, can be made meanwhile.
//!
//! wgpu assumes that every extension it would have asked for is enabled; both create-infos are therefore
//! built from its own lists. Vulkan's validation layers are left to the loader's environment
//! (`VK_LOADER_LAYERS_ENABLE=*khronos_validation`): the runtime shares this instance.

use ash::vk::{self, Handle};
use openxr as xr;
use std::any::Any;
use std::ffi::CStr;
use std::fmt::Display;
use std::sync::Arc;
use wgpu_hal::api::Vulkan as HalVulkan;
use wgpu_hal::vulkan as hal;

/// What `xrCreateSession` of the Vulkan flavor yields.
pub type Session = (xr::Session<xr::Vulkan>, xr::FrameWaiter, xr::FrameStream<xr::Vulkan>);

/// Newest Vulkan that wgpu-hal asks for by itself.
const NEWEST_API: u32 = vk::API_VERSION_1_3;

/// Why there is no device.
#[derive(Debug)]
pub enum DeviceError {
    /// The runtime gave up on a call.
    Runtime {
        /// The OpenXR call that failed.
        call: &'static str,
        /// Its result.
        result: xr::sys::Result,
    },
    /// The GPU cannot be used.
    Gpu {
        /// Its name, or "unknown" before it told it.
        name: String,
        /// What it lacks, or the driver's words.
        reason: String,
    },
}

impl DeviceError {
    fn runtime(call: &'static str) -> impl FnOnce(xr::sys::Result) -> Self {
        move |result| Self::Runtime { call, result }
    }

    fn gpu<E: Display>(name: &str) -> impl FnOnce(E) -> Self {
        move |reason| Self::Gpu { name: name.to_string(), reason: reason.to_string() }
    }
}

/// Loads `libopenxr_loader.so.1`.
///
/// # Errors
/// The dynamic linker's words.
pub fn load_loader() -> Result<xr::Entry, String> {
    // SAFETY: the library of that name is the OpenXR loader, which keeps to the OpenXR specification.
    unsafe { xr::Entry::load(&()) }.map_err(|error| match &error {
        xr::EntryError::Load(why) => why.to_string(),
        xr::EntryError::Xr(result) => result.to_string(),
    })
}

/// The VkInstance, destroyed once, when the last of its users is gone.
struct RuntimeInstance {
    raw: ash::Instance,
    /// Keeps the Vulkan library loaded.
    entry: ash::Entry,
}

impl Drop for RuntimeInstance {
    fn drop(&mut self) {
        // SAFETY: we own the handle; every child (RuntimeDevice, wgpu's objects) holds an Arc of this.
        unsafe { self.raw.destroy_instance(None) };
    }
}

/// The VkDevice, destroyed once.
struct RuntimeDevice {
    raw: ash::Device,
    /// A device must not outlive its instance.
    _instance: Arc<RuntimeInstance>,
}

impl Drop for RuntimeDevice {
    fn drop(&mut self) {
        // SAFETY: we own the handle; wgpu drops its guard, and so this, after all that it made on the device.
        unsafe { self.raw.destroy_device(None) };
    }
}

/// The device that a runtime made, and the handles that a session is made with.
pub struct RuntimeGpu {
    xr: xr::Instance,
    system: xr::SystemId,
    handles: xr::vulkan::SessionCreateInfo,
}

// SAFETY: the pointers are Vulkan handles, which any thread may name; this struct only hands them to xrCreateSession.
unsafe impl Send for RuntimeGpu {}

/// The device as wgpu has it.
pub struct Wrapped {
    /// wgpu's view of the runtime's Vulkan instance.
    pub instance: wgpu::Instance,
    /// The GPU that the headset is connected to.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its one queue.
    pub queue: wgpu::Queue,
}

/// What the device is asked for.
pub struct DeviceRequest<'a> {
    /// Flags of wgpu's instance.
    pub flags: wgpu::InstanceFlags,
    /// Tells from the GPU's name, features and limits which features are enabled, or what it lacks.
    pub features: &'a dyn Fn(&str, wgpu::Features, &wgpu::Limits) -> Result<wgpu::Features, String>,
}

impl RuntimeGpu {
    /// Has the runtime make a Vulkan instance and device, and wraps them.
    ///
    /// # Errors
    /// The runtime fails, or its GPU cannot run the frame.
    pub fn open(
        xr: &xr::Instance,
        system: xr::SystemId,
        wanted: &DeviceRequest<'_>,
    ) -> Result<(Self, Wrapped), DeviceError> {
        let instance = create_instance(xr, system, wanted.flags)?;
        let hal_instance = wrap_instance(&instance, wanted.flags)?;
        // SAFETY: the VkInstance was made for this system by create_vulkan_instance.
        let raw_gpu = unsafe {
            xr.vulkan_graphics_device(system, instance.raw.handle().as_raw() as xr_handle::Instance)
        }
        .map_err(DeviceError::runtime("xrGetVulkanGraphicsDevice2KHR"))?;
        let physical_device = vk::PhysicalDevice::from_raw(raw_gpu as u64);
        let exposed = hal_instance
            .expose_adapter(physical_device)
            .ok_or("its Vulkan is too old")
            .map_err(DeviceError::gpu("unknown"))?;
        let name = exposed.info.name.clone();
        let features = (wanted.features)(&name, exposed.features, &exposed.capabilities.limits)
            .map_err(DeviceError::gpu(&name))?;
        let limits = exposed.capabilities.limits.clone();
        let queue_family_index = graphics_family(&instance.raw, physical_device)
            .ok_or("it has no queue for graphics and compute")
            .map_err(DeviceError::gpu(&name))?;

        let device =
            create_device(&instance, (xr, system), &exposed, physical_device, features, queue_family_index)?;
        let raw_device = device.raw.handle();
        let extensions = exposed.adapter.required_device_extensions(features);
        let raw_for_hal = device.raw.clone();
        // SAFETY: the device was made from this adapter with these very extensions, features and family;
        // RuntimeDevice, kept by the callback, lives until wgpu has let go of the device.
        let open_device = unsafe {
            exposed.adapter.device_from_raw(
                raw_for_hal,
                Some(Box::new(move || drop(device))),
                &extensions,
                features,
                &limits,
                &wgpu::MemoryHints::Performance,
                queue_family_index,
                0,
            )
        }
        .map_err(DeviceError::gpu(&name))?;

        // SAFETY: a Vulkan instance of wgpu's, given away.
        let wgpu_instance = unsafe { wgpu::Instance::from_hal::<HalVulkan>(hal_instance) };
        // SAFETY: exposed by that instance.
        let adapter = unsafe { wgpu_instance.create_adapter_from_hal(exposed) };
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("scanwalk headset"),
            required_features: features,
            required_limits: limits,
            ..Default::default()
        };
        // SAFETY: opened from that adapter with the features and limits of the descriptor.
        let (device, queue) = unsafe { adapter.create_device_from_hal(open_device, &descriptor) }
            .map_err(DeviceError::gpu(&name))?;
        let handles = xr::vulkan::SessionCreateInfo {
            instance: instance.raw.handle().as_raw() as xr_handle::Instance,
            physical_device: raw_gpu,
            device: raw_device.as_raw() as xr_handle::Device,
            queue_family_index,
            queue_index: 0,
        };
        let wrapped = Wrapped { instance: wgpu_instance, adapter, device, queue };
        Ok((Self { xr: xr.clone(), system, handles }, wrapped))
    }

    /// Creates the session; it keeps `owner`, which holds the device, until it is destroyed.
    ///
    /// # Errors
    /// What the runtime says.
    pub fn create_session(&self, owner: Box<dyn Any + Send + Sync>) -> xr::Result<Session> {
        // SAFETY: the handles are those that the runtime made for this system, alive as long as `owner`;
        // the runtime uses the queue in four calls only, and those take a queue guard (`super::frame`,
        // `super::swapchain`).
        unsafe { self.xr.create_session_with_guard::<xr::Vulkan>(self.system, &self.handles, owner) }
    }
}

/// The Vulkan handle types of the openxr crate, which are its own.
mod xr_handle {
    pub(super) use openxr::sys::platform::{
        VkDevice as Device, VkGetInstanceProcAddr as GetInstanceProcAddr, VkInstance as Instance,
        VkPhysicalDevice as PhysicalDevice,
    };
}

/// `vkGetInstanceProcAddr` in the openxr crate's type.
fn get_instance_proc_addr(entry: &ash::Entry) -> xr_handle::GetInstanceProcAddr {
    // SAFETY: both are the same C function pointer; the two crates spell its opaque handle types differently.
    unsafe {
        std::mem::transmute::<vk::PFN_vkGetInstanceProcAddr, xr_handle::GetInstanceProcAddr>(
            entry.static_fn().get_instance_proc_addr,
        )
    }
}

/// The Vulkan version to ask for: what the Vulkan loader has, at most [`NEWEST_API`].
fn api_version(entry: &ash::Entry) -> u32 {
    // SAFETY: no preconditions beyond a loaded Vulkan library.
    let loader = unsafe { entry.try_enumerate_instance_version() };
    loader.ok().flatten().unwrap_or(vk::API_VERSION_1_0).min(NEWEST_API)
}

/// Has the runtime make the VkInstance, with the extensions that wgpu wants and those that it adds itself.
fn create_instance(
    xr: &xr::Instance,
    system: xr::SystemId,
    flags: wgpu::InstanceFlags,
) -> Result<Arc<RuntimeInstance>, DeviceError> {
    // This call is mandatory before xrCreateVulkanInstanceKHR.
    let needed = xr
        .graphics_requirements::<xr::Vulkan>(system)
        .map_err(DeviceError::runtime("xrGetVulkanGraphicsRequirements2KHR"))?
        .min_api_version_supported;
    // SAFETY: the library of that name is the Vulkan loader.
    let entry = unsafe { ash::Entry::load() }.map_err(DeviceError::gpu("unknown"))?;
    let api = api_version(&entry);
    if (vk::api_version_major(api), vk::api_version_minor(api))
        < (u32::from(needed.major()), u32::from(needed.minor()))
    {
        let reason = format!("the headset needs Vulkan {needed}");
        return Err(DeviceError::Gpu { name: "unknown".into(), reason });
    }
    let extensions = wanted_extensions(&entry, api, flags)?;
    let extension_pointers: Vec<_> = extensions.iter().map(|name| name.as_ptr()).collect();
    let application = vk::ApplicationInfo::default()
        .application_name(c"scanwalk")
        .engine_name(c"wgpu-hal")
        .engine_version(1)
        .api_version(api);
    let info = vk::InstanceCreateInfo::default()
        .application_info(&application)
        .enabled_extension_names(&extension_pointers);
    // SAFETY: the create-info and all that it points to live until the call returns.
    let raw = unsafe {
        xr.create_vulkan_instance(system, get_instance_proc_addr(&entry), std::ptr::from_ref(&info).cast())
    }
    .map_err(DeviceError::runtime("xrCreateVulkanInstanceKHR"))?
    .map_err(vk::Result::from_raw)
    .map_err(DeviceError::gpu("unknown"))?;
    // SAFETY: a live VkInstance made through this very entry.
    let raw = unsafe { ash::Instance::load(entry.static_fn(), vk::Instance::from_raw(raw as u64)) };
    Ok(Arc::new(RuntimeInstance { raw, entry }))
}

/// Instance extensions that wgpu takes for granted.
fn wanted_extensions(
    entry: &ash::Entry,
    api: u32,
    flags: wgpu::InstanceFlags,
) -> Result<Vec<&'static CStr>, DeviceError> {
    hal::Instance::desired_extensions(entry, api, flags).map_err(DeviceError::gpu("unknown"))
}

/// wgpu's view of the instance; its drop callback is one of the instance's owners.
fn wrap_instance(
    instance: &Arc<RuntimeInstance>,
    flags: wgpu::InstanceFlags,
) -> Result<hal::Instance, DeviceError> {
    let api = api_version(&instance.entry);
    let extensions = wanted_extensions(&instance.entry, api, flags)?;
    let owner = Arc::clone(instance);
    // SAFETY: the instance was made with `api` and these extensions, and lives until the callback ran.
    unsafe {
        hal::Instance::from_raw(
            instance.entry.clone(),
            instance.raw.clone(),
            api,
            0,
            None,
            extensions,
            flags,
            wgpu::MemoryBudgetThresholds::default(),
            false,
            Some(Box::new(move || drop(owner))),
        )
    }
    .map_err(DeviceError::gpu("unknown"))
}

/// The first queue family that can draw and compute.
fn graphics_family(instance: &ash::Instance, gpu: vk::PhysicalDevice) -> Option<u32> {
    // SAFETY: the physical device belongs to this instance.
    let families = unsafe { instance.get_physical_device_queue_family_properties(gpu) };
    let wanted = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
    families.iter().position(|family| family.queue_flags.contains(wanted)).map(|index| index as u32)
}

/// Has the runtime make the VkDevice, with the extensions and features that wgpu takes for granted.
fn create_device(
    instance: &Arc<RuntimeInstance>,
    (xr, system): (&xr::Instance, xr::SystemId),
    exposed: &wgpu_hal::ExposedAdapter<HalVulkan>,
    physical_device: vk::PhysicalDevice,
    features: wgpu::Features,
    queue_family_index: u32,
) -> Result<RuntimeDevice, DeviceError> {
    let extensions = exposed.adapter.required_device_extensions(features);
    let extension_pointers: Vec<_> = extensions.iter().map(|name| name.as_ptr()).collect();
    let mut vk_features = exposed.adapter.physical_device_features(&extensions, features);
    let queues = [vk::DeviceQueueCreateInfo::default()
        .queue_family_index(queue_family_index)
        .queue_priorities(&[1.0])];
    let info = vk_features.add_to_device_create(
        vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_extension_names(&extension_pointers),
    );
    // SAFETY: the create-info and all that it points to live until the call returns; the physical device is
    // the one that the runtime chose.
    let raw = unsafe {
        xr.create_vulkan_device(
            system,
            get_instance_proc_addr(&instance.entry),
            physical_device.as_raw() as xr_handle::PhysicalDevice,
            std::ptr::from_ref(&info).cast(),
        )
    }
    .map_err(DeviceError::runtime("xrCreateVulkanDeviceKHR"))?
    .map_err(vk::Result::from_raw)
    .map_err(DeviceError::gpu(&exposed.info.name))?;
    // SAFETY: a live VkDevice of this instance.
    let raw = unsafe { ash::Device::load(instance.raw.fp_v1_0(), vk::Device::from_raw(raw as u64)) };
    Ok(RuntimeDevice { raw, _instance: Arc::clone(instance) })
}

//! The same library as a Vulkan layer, which loses the GPU: when `devicelost` is due, a submission fails with
//! ERROR_DEVICE_LOST, and so does all that is asked of that device afterwards. Another device is a whole one.

use crate::plan::fires;
use ash::vk::{self, Handle as _};
use std::collections::HashMap;
use std::ffi::{CStr, c_char, c_void};
use std::mem::transmute;
use std::sync::{LazyLock, Mutex, PoisonError};

/// What the loader puts before all that a handle points to: handles of one device have the same, and so have an
/// instance and its physical devices.
type DispatchKey = usize;

/// A device that was made through this layer.
#[derive(Clone, Copy)]
struct Device {
    raw: vk::Device,
    /// The function below that finds the device's functions.
    find: vk::PFN_vkGetDeviceProcAddr,
    is_lost: bool,
}

/// The function below that finds an instance's functions.
static INSTANCES: LazyLock<Mutex<HashMap<DispatchKey, vk::PFN_vkGetInstanceProcAddr>>> =
    LazyLock::new(Mutex::default);
static DEVICES: LazyLock<Mutex<HashMap<DispatchKey, Device>>> = LazyLock::new(Mutex::default);

fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// # Safety
/// `handle` is a dispatchable handle that is alive.
unsafe fn key(handle: impl vk::Handle) -> DispatchKey {
    unsafe { *(handle.as_raw() as *const DispatchKey) }
}

/// The structs that the loader chains to those of creation (vk_layer.h).
#[repr(C)]
struct LayerCreateInfo {
    kind: i32,
    next: *const LayerCreateInfo,
    /// 0 where `link` is a link.
    function: i32,
    link: *mut LayerLink,
}

/// The next layer, or the driver. An instance's third member finds functions of physical devices, a device's those of
/// devices.
#[repr(C)]
struct LayerLink {
    next: *mut LayerLink,
    find_of_instance: vk::PFN_vkGetInstanceProcAddr,
    third: *const c_void,
}

const OF_INSTANCE: i32 = 47;
const OF_DEVICE: i32 = 48;

/// Takes the link that is this layer's out of a chain, so that the next layer finds its own.
///
/// # Safety
/// `chain` is what the loader gave to a function that creates something.
unsafe fn take_link<'a>(chain: *const c_void, kind: i32) -> Option<&'a LayerLink> {
    let mut info = chain.cast_mut().cast::<LayerCreateInfo>();
    unsafe {
        while !info.is_null() {
            if (*info).kind == kind && (*info).function == 0 {
                let link = (*info).link;
                (*info).link = (*link).next;
                return Some(&*link);
            }
            info = (*info).next.cast_mut();
        }
    }
    None
}

unsafe extern "system" fn create_instance(
    info: *const vk::InstanceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    instance: *mut vk::Instance,
) -> vk::Result {
    unsafe {
        let Some(link) = take_link((*info).p_next, OF_INSTANCE) else {
            return vk::Result::ERROR_INITIALIZATION_FAILED;
        };
        let find = link.find_of_instance;
        let create = find(vk::Instance::null(), c"vkCreateInstance".as_ptr());
        let create: vk::PFN_vkCreateInstance = transmute(create.expect("every driver has it"));
        let result = create(info, allocator, instance);
        if result == vk::Result::SUCCESS {
            locked(&INSTANCES).insert(key(*instance), find);
        }
        result
    }
}

unsafe extern "system" fn create_device(
    physical: vk::PhysicalDevice,
    info: *const vk::DeviceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    device: *mut vk::Device,
) -> vk::Result {
    unsafe {
        let Some(link) = take_link((*info).p_next, OF_DEVICE) else {
            return vk::Result::ERROR_INITIALIZATION_FAILED;
        };
        let find: vk::PFN_vkGetDeviceProcAddr = transmute(link.third);
        let create = (link.find_of_instance)(vk::Instance::null(), c"vkCreateDevice".as_ptr());
        let create: vk::PFN_vkCreateDevice = transmute(create.expect("every driver has it"));
        let result = create(physical, info, allocator, device);
        if result == vk::Result::SUCCESS {
            locked(&DEVICES).insert(key(*device), Device { raw: *device, find, is_lost: false });
        }
        result
    }
}

/// The function below a device's function, unless the device is lost.
///
/// # Safety
/// `F` is the type of the function that has this name; `handle` belongs to a device that is alive.
unsafe fn below<F: Copy>(handle: impl vk::Handle, name: &CStr) -> Option<F> {
    let device = unsafe { locked(&DEVICES).get(&key(handle)).copied() }.filter(|device| !device.is_lost)?;
    let function = unsafe { (device.find)(device.raw, name.as_ptr()) };
    function.map(|function| unsafe { std::mem::transmute_copy(&function) })
}

/// Loses the device of a queue if it is time.
///
/// # Safety
/// `queue` is alive.
unsafe fn lose(queue: vk::Queue) {
    let mut devices = locked(&DEVICES);
    if let Some(device) = unsafe { devices.get_mut(&key(queue)) } {
        device.is_lost |= fires("devicelost");
    }
}

/// Functions that fail once the device is lost.
macro_rules! failing {
    ($($function:ident: $kind:ident = $name:literal, ($handle:ident: $of:ty $(, $argument:ident: $type:ty)*);)*) => {
        $(unsafe extern "system" fn $function($handle: $of $(, $argument: $type)*) -> vk::Result {
            unsafe {
                match below::<vk::$kind>($handle, $name) {
                    Some(below) => below($handle $(, $argument)*),
                    None => vk::Result::ERROR_DEVICE_LOST,
                }
            }
        })*

        /// This layer's function of a device, by name.
        fn ours(name: &CStr) -> vk::PFN_vkVoidFunction {
            // SAFETY of the casts: Vulkan hands every function out as this one type.
            unsafe {
                match name {
                    $(name if name == $name => transmute::<vk::$kind, vk::PFN_vkVoidFunction>($function),)*
                    name if name == c"vkQueueSubmit" => {
                        transmute::<vk::PFN_vkQueueSubmit, vk::PFN_vkVoidFunction>(queue_submit)
                    }
                    name if name == c"vkGetDeviceProcAddr" => {
                        transmute::<vk::PFN_vkGetDeviceProcAddr, vk::PFN_vkVoidFunction>(find_of_device)
                    }
                    _ => None,
                }
            }
        }
    };
}

failing! {
    wait_for_fences: PFN_vkWaitForFences = c"vkWaitForFences",
        (device: vk::Device, count: u32, fences: *const vk::Fence, all: vk::Bool32, timeout: u64);
    get_fence_status: PFN_vkGetFenceStatus = c"vkGetFenceStatus", (device: vk::Device, fence: vk::Fence);
    wait_semaphores: PFN_vkWaitSemaphores = c"vkWaitSemaphores",
        (device: vk::Device, info: *const vk::SemaphoreWaitInfo<'_>, timeout: u64);
    wait_semaphores_khr: PFN_vkWaitSemaphores = c"vkWaitSemaphoresKHR",
        (device: vk::Device, info: *const vk::SemaphoreWaitInfo<'_>, timeout: u64);
    get_counter: PFN_vkGetSemaphoreCounterValue = c"vkGetSemaphoreCounterValue",
        (device: vk::Device, semaphore: vk::Semaphore, value: *mut u64);
    get_counter_khr: PFN_vkGetSemaphoreCounterValue = c"vkGetSemaphoreCounterValueKHR",
        (device: vk::Device, semaphore: vk::Semaphore, value: *mut u64);
    queue_submit_2: PFN_vkQueueSubmit2 = c"vkQueueSubmit2",
        (queue: vk::Queue, count: u32, submits: *const vk::SubmitInfo2<'_>, fence: vk::Fence);
    queue_present: PFN_vkQueuePresentKHR = c"vkQueuePresentKHR",
        (queue: vk::Queue, info: *const vk::PresentInfoKHR<'_>);
}

unsafe extern "system" fn queue_submit(
    queue: vk::Queue,
    count: u32,
    submits: *const vk::SubmitInfo<'_>,
    fence: vk::Fence,
) -> vk::Result {
    unsafe {
        lose(queue);
        match below::<vk::PFN_vkQueueSubmit>(queue, c"vkQueueSubmit") {
            Some(below) => below(queue, count, submits, fence),
            None => vk::Result::ERROR_DEVICE_LOST,
        }
    }
}

unsafe extern "system" fn find_of_device(device: vk::Device, name: *const c_char) -> vk::PFN_vkVoidFunction {
    unsafe {
        let made = locked(&DEVICES).get(&key(device)).copied()?;
        let below = (made.find)(made.raw, name)?;
        // A function that the driver lacks is not there.
        ours(CStr::from_ptr(name)).or(Some(below))
    }
}

unsafe extern "system" fn find_of_instance(
    instance: vk::Instance,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    unsafe {
        match CStr::from_ptr(name) {
            name if name == c"vkCreateInstance" => {
                return transmute::<vk::PFN_vkCreateInstance, vk::PFN_vkVoidFunction>(create_instance);
            }
            name if name == c"vkCreateDevice" => {
                return transmute::<vk::PFN_vkCreateDevice, vk::PFN_vkVoidFunction>(create_device);
            }
            name if name == c"vkGetInstanceProcAddr" => {
                return transmute::<vk::PFN_vkGetInstanceProcAddr, vk::PFN_vkVoidFunction>(find_of_instance);
            }
            _ => {}
        }
        if instance.is_null() {
            return None;
        }
        let find = locked(&INSTANCES).get(&key(instance)).copied()?;
        let below = find(instance, name)?;
        ours(CStr::from_ptr(name)).or(Some(below))
    }
}

/// What a layer and the loader tell each other first (vk_layer.h).
#[repr(C)]
pub struct NegotiateLayerInterface {
    kind: i32,
    next: *mut c_void,
    version: u32,
    find_of_instance: vk::PFN_vkGetInstanceProcAddr,
    find_of_device: vk::PFN_vkGetDeviceProcAddr,
    find_of_physical_device: Option<vk::PFN_vkGetInstanceProcAddr>,
}

/// The Vulkan loader's first call.
///
/// # Safety
/// Called by a Vulkan loader.
#[unsafe(no_mangle)]
#[allow(non_snake_case)]
pub unsafe extern "system" fn vkNegotiateLoaderLayerInterfaceVersion(
    interface: *mut NegotiateLayerInterface,
) -> vk::Result {
    unsafe {
        (*interface).version = (*interface).version.min(2);
        (*interface).find_of_instance = find_of_instance;
        (*interface).find_of_device = find_of_device;
        (*interface).find_of_physical_device = None;
    }
    vk::Result::SUCCESS
}

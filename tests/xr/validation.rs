//! The validation layers are on and find mistakes: the negative controls of `assert_valid`.

use crate::probe::Job;
use kit::xr::RuntimeSlot;
use openxr as xr;
use render::gpu::Gpu;

/// A buffer of no bytes, which Vulkan forbids.
#[allow(unsafe_code)] // The mistake is the point: wgpu would not make it.
pub fn misuse_vulkan(gpu: &Gpu) {
    // SAFETY: only the handle is used, and nothing is done with the buffer.
    unsafe {
        let device = gpu.device.as_hal::<wgpu_hal::api::Vulkan>().unwrap();
        let _ = device.raw_device().create_buffer(&ash::vk::BufferCreateInfo::default(), None);
    }
}

/// A struct that says it is another.
#[allow(unsafe_code)] // The mistake is the point: the openxr crate would not make it.
pub fn misuse_openxr() {
    // SAFETY: the loader of the test runtime; the layer refuses the wrong struct before the runtime sees it.
    unsafe {
        let entry = xr::Entry::load(&()).unwrap();
        let application = xr::ApplicationInfo { application_name: "misuse", ..Default::default() };
        let instance = entry.create_instance(&application, &Default::default(), &[], &()).unwrap();
        let info = xr::sys::SystemGetInfo {
            ty: xr::sys::StructureType::SESSION_CREATE_INFO,
            next: std::ptr::null(),
            form_factor: xr::FormFactor::HEAD_MOUNTED_DISPLAY,
        };
        let mut system = xr::SystemId::NULL;
        let result = (instance.fp().get_system)(instance.as_raw(), &info, &mut system);
        assert_eq!(result, xr::sys::Result::ERROR_VALIDATION_FAILURE);
    }
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn a_mistake_in_vulkan_is_found() {
    let lab = RuntimeSlot::enter();
    let job = Job { exit_after: 5, misuse: "vulkan".into(), ..Job::default() };
    let done = job.run(&lab.runtime().validate());
    assert_eq!(done.code, Some(96), "{}", done.stderr);
    let complaints = done.complaints().join("\n");
    assert!(complaints.contains("VkBufferCreateInfo"), "{complaints}");
}

#[test]
#[cfg_attr(not(feature = "with-runtime"), ignore = "needs an OpenXR runtime, see scripts/headless-runtime")]
fn a_mistake_in_openxr_is_found() {
    let lab = RuntimeSlot::enter();
    let done = Job { misuse: "openxr".into(), ..Job::default() }.run(&lab.runtime().validate());
    assert_eq!(done.code, Some(96), "{}", done.stderr);
    let complaints = done.complaints().join("\n");
    assert!(complaints.contains("VALID_ERROR") && complaints.contains("xrGetSystem"), "{complaints}");
}

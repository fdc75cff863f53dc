//! A runtime's images as wgpu textures.

use ash::vk::{self, Handle};
use wgpu_hal::api::Vulkan as HalVulkan;

/// What a swapchain's images were created with.
#[derive(Clone, Copy, Debug)]
pub struct ImageKind {
    /// Width, height.
    pub size_px: [u32; 2],
    /// The Vulkan format that the swapchain has, by wgpu's name.
    pub format: wgpu::TextureFormat,
    /// Uses that the swapchain's usage flags name.
    pub uses: wgpu::TextureUses,
    /// Usages that wgpu's users have for these uses.
    pub usages: wgpu::TextureUsages,
    /// Layout in which the runtime hands images out, and expects them back.
    pub handover: wgpu::TextureUses,
}

/// The images of a swapchain of a session on `device`. The swapchain must outlive their use: whoever drops it waits for
/// the GPU first.
///
/// # Errors
/// What the runtime says.
///
/// # Panics
/// If the device is not Vulkan.
pub fn textures(
    device: &wgpu::Device,
    swapchain: &openxr::Swapchain<openxr::Vulkan>,
    kind: ImageKind,
    label: &str,
) -> openxr::Result<Vec<wgpu::Texture>> {
    let images = swapchain.enumerate_images()?;
    Ok(images.into_iter().map(|image| texture(device, vk::Image::from_raw(image), kind, label)).collect())
}

fn texture(device: &wgpu::Device, image: vk::Image, kind: ImageKind, label: &str) -> wgpu::Texture {
    let [width, height] = kind.size_px;
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let hal_descriptor = wgpu_hal::TextureDescriptor {
        label: Some(label),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: kind.format,
        usage: kind.uses,
        memory_flags: wgpu_hal::MemoryFlags::empty(),
        view_formats: Vec::new(),
    };
    let descriptor = wgpu::TextureDescriptor {
        label: Some(label),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: kind.format,
        usage: kind.usages,
        view_formats: &[],
    };
    // SAFETY: the image was created by the runtime on this device with what the descriptor says. The drop
    // callback, empty as it is, tells wgpu that the image is not its own to destroy; the swapchain outlives
    // the texture's use, as the caller warrants. Runtimes hand images out in the layout of `handover`.
    unsafe {
        // A device that a runtime made for `device::RuntimeGpu` is a Vulkan device.
        let hal = device.as_hal::<HalVulkan>().expect("the headset's device is Vulkan");
        let memory = wgpu_hal::vulkan::TextureMemory::External;
        let texture = hal.texture_from_raw(image, &hal_descriptor, Some(Box::new(|| ())), memory);
        drop(hal);
        device.create_texture_from_hal::<HalVulkan>(texture, &descriptor, kind.handover)
    }
}

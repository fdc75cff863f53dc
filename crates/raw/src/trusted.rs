//! Shaders that go to the driver without wgpu's own checks of every index: ours, whose bounds the host keeps. wgpu
//! still bounds loops and looks at divisors, and what the driver checks, it still checks.

/// Compiles WGSL text of ours without checks. The caller hands in texts of `shaders/` only.
pub fn shader_module(device: &wgpu::Device, name: &str, wgsl: &str) -> wgpu::ShaderModule {
    let descriptor =
        wgpu::ShaderModuleDescriptor { label: Some(name), source: wgpu::ShaderSource::Wgsl(wgsl.into()) };
    // SAFETY: the frame's shaders keep inside, by what the host gives them. Batches: `cull` lists each once,
    // and slices as far as the list has room, and dispatches as many workgroups as it has listed. Points:
    // planes, colors and shapes hold every point of their chunk's batches, in whole loads. Pixels: those inside
    // the eye's image, whose size `Renderer::set_view` compares with the targets'. Tiles: those of the image,
    // made by the host. Arrays in a workgroup's memory are as large as the constants that index them say; of
    // discs that wait, each thread adds as many as a turn has points between two barriers. Loops go over
    // counts, or until a pixel's key has stopped to fall. Divisors are counts of at least one point, or sizes
    // of images. Debug builds and tests check all of that (`Access::checked`). Buffers begin as zeros or are
    // written before they are read.
    unsafe { device.create_shader_module_trusted(descriptor, wgpu::ShaderRuntimeChecks::unchecked()) }
}

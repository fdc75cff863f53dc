//! What the stages draw into: per eye, a u64 a pixel (depth ≪ 32 | point index).

use crate::gpu::Gpu;

/// The eyes' pixels; made anew when an eye's size changes.
#[derive(Debug)]
pub struct Targets {
    /// Width, height of each eye.
    pub sizes_px: Vec<[u32; 2]>,
    /// One buffer an eye. A one-eyed frame has a second, tiny one, since shaders bind two.
    pub depth: [wgpu::Buffer; 2],
}

/// Why targets could not be made.
#[derive(Debug, thiserror::Error)]
#[error(
    "an eye of {width} × {height} pixels needs {bytes} bytes in one buffer, and this GPU allows {limit}; choose a smaller size"
)]
pub struct TargetTooLarge {
    width: u32,
    height: u32,
    bytes: u64,
    limit: u64,
}

impl Targets {
    /// Targets for one or two eyes.
    ///
    /// # Errors
    /// If an eye's image does not fit the device's largest binding.
    pub fn new(gpu: &Gpu, sizes_px: &[[u32; 2]]) -> Result<Self, TargetTooLarge> {
        let limit = gpu.binding_limit();
        for &[width, height] in sizes_px {
            let bytes = depth_bytes([width, height]);
            if bytes > limit {
                return Err(TargetTooLarge { width, height, bytes, limit });
            }
        }
        let depth = |eye: usize| {
            let label = if eye == 0 { "depth_left" } else { "depth_right" };
            let size = depth_bytes(sizes_px.get(eye).copied().unwrap_or([1, 1]));
            gpu.buffer(label, size, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC)
        };
        Ok(Self { sizes_px: sizes_px.to_vec(), depth: [depth(0), depth(1)] })
    }
}

/// Bytes of an eye's pixels, rounded up to the 16 that `clear` writes at once.
fn depth_bytes([width, height]: [u32; 2]) -> u64 {
    (u64::from(width) * u64::from(height) * 8).next_multiple_of(16)
}

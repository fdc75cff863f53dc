//! Copies from the GPU to the CPU that wait, for pictures and tests. The frame loop reads back through [`super::timer`]
//! instead.

use super::Gpu;

/// Why nothing came back from the GPU: in practice, that the device is lost.
#[derive(Debug, thiserror::Error)]
pub enum ReadbackError {
    /// The GPU does not finish its work.
    #[error("the GPU stopped answering: {0}")]
    Poll(#[from] super::PollError),
    /// The memory that was copied to cannot be read.
    #[error("the GPU's memory cannot be read: {0}")]
    Map(#[from] wgpu::BufferAsyncError),
    /// The memory that was copied to has another size.
    #[error("the GPU's memory cannot be read: {0}")]
    Range(#[from] wgpu::MapRangeError),
}

/// The bytes of a whole buffer (usage must include COPY_SRC).
///
/// # Errors
/// If the device is lost.
pub fn read_buffer(gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<Vec<u8>, ReadbackError> {
    let size = buffer.size();
    let staging = staging(gpu, size);
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, size);
    finish(gpu, encoder, &staging)
}

/// The pixels of a 4-byte-a-pixel texture (usage must include COPY_SRC), rows tightly packed.
///
/// # Errors
/// If the device is lost.
pub fn read_texture(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<u8>, ReadbackError> {
    let (width, height) = (texture.width(), texture.height());
    let row = 4 * width;
    let padded_row = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let staging = staging(gpu, u64::from(padded_row) * u64::from(height));
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded_row), rows_per_image: None };
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &staging, layout },
        texture.size(),
    );
    let padded = finish(gpu, encoder, &staging)?;
    Ok(padded.chunks(padded_row as usize).flat_map(|r| &r[..row as usize]).copied().collect())
}

fn staging(gpu: &Gpu, size: u64) -> wgpu::Buffer {
    gpu.buffer("readback", size, wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ)
}

fn finish(
    gpu: &Gpu,
    encoder: wgpu::CommandEncoder,
    staging: &wgpu::Buffer,
) -> Result<Vec<u8>, ReadbackError> {
    let commands = encoder.finish();
    let submission = gpu.queue.lock().submit([commands]);
    let (sender, mapped) = std::sync::mpsc::channel();
    staging.map_async(wgpu::MapMode::Read, .., move |result| {
        let _ = sender.send(result);
    });
    gpu.poll(wgpu::PollType::Wait { submission_index: Some(submission), timeout: None })?;
    mapped.recv().unwrap_or(Err(wgpu::BufferAsyncError))?;
    Ok(staging.get_mapped_range(..)?.to_vec())
}

//! Bandwidth of the device's memory, measured by a plain copy: the yardstick for what points cost to read.

use anyhow::{Context, Result};
use base::percentile::Sorted;
use render::gpu::Gpu;
use std::time::Instant;

/// Bytes that are copied at once, if the device has room.
const COPY_BYTES: u64 = 256 << 20;
const COPIES: usize = 7;

/// Bytes read and written by a copy from buffer to buffer, in 10⁹ a second: the median of several copies.
///
/// # Errors
/// If the device is lost.
pub fn gb_per_s(gpu: &Gpu) -> Result<f64> {
    let bytes = COPY_BYTES.min(gpu.device.limits().max_buffer_size / 4) & !255;
    let usage = wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
    let [from, to] = ["copy from", "copy to"].map(|label| gpu.buffer(label, bytes, usage));
    let mut rates = Vec::new();
    // The first copy does not count, since it allocates the memory.
    for _ in 0..=COPIES {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(&from, 0, &to, 0, bytes);
        let commands = encoder.finish();
        let began = Instant::now();
        gpu.queue.lock().submit([commands]);
        gpu.poll(wgpu::PollType::wait_indefinitely()).context("the GPU stopped answering")?;
        rates.push(2e-9 * bytes as f64 / began.elapsed().as_secs_f64());
    }
    rates.remove(0);
    Sorted::new(rates).median().context("nothing was copied")
}

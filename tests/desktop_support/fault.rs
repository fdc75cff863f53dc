//! A mistake on purpose: it proves that the validation layer watches, synchronization included.

use ash::vk;
use render::gpu::Gpu;

/// Fills a buffer twice in one command buffer with no barrier between: a write-after-write hazard, which the
/// layer reports while it is recorded; nothing is submitted.
#[allow(unsafe_code)] // wgpu cannot be brought to make such a mistake.
pub fn write_twice_without_a_barrier(gpu: &Gpu) {
    // SAFETY: every handle is made from this device, used on this thread only, and destroyed before it.
    unsafe {
        let hal = gpu.device.as_hal::<wgpu_hal::api::Vulkan>().expect("Vulkan is the only backend");
        let device = hal.raw_device();
        let buffer_info =
            vk::BufferCreateInfo::default().size(1024).usage(vk::BufferUsageFlags::TRANSFER_DST);
        let buffer = device.create_buffer(&buffer_info, None).unwrap();
        let needs = device.get_buffer_memory_requirements(buffer);
        let memory_info = vk::MemoryAllocateInfo::default()
            .allocation_size(needs.size)
            .memory_type_index(needs.memory_type_bits.trailing_zeros());
        let memory = device.allocate_memory(&memory_info, None).unwrap();
        device.bind_buffer_memory(buffer, memory, 0).unwrap();
        let pool_info = vk::CommandPoolCreateInfo::default().queue_family_index(hal.queue_family_index());
        let pool = device.create_command_pool(&pool_info, None).unwrap();
        let commands_info =
            vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
        let commands = device.allocate_command_buffers(&commands_info).unwrap()[0];
        device.begin_command_buffer(commands, &vk::CommandBufferBeginInfo::default()).unwrap();
        device.cmd_fill_buffer(commands, buffer, 0, 1024, 1);
        device.cmd_fill_buffer(commands, buffer, 0, 1024, 2);
        device.end_command_buffer(commands).unwrap();
        device.destroy_command_pool(pool, None);
        device.destroy_buffer(buffer, None);
        device.free_memory(memory, None);
    }
}

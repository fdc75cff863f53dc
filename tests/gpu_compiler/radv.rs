//! RADV's null device: Vulkan as far as making pipelines and asking the compiler about them. It runs nothing, and
//! wgpu cannot open it, hence plain ash. Objects are never destroyed: the process ends right after.
#![allow(unsafe_code)]

use super::wgsl::{FragmentOutputs, Parsed};
use ash::vk;
use naga::ShaderStage;
use std::ffi::{CStr, CString};
use std::path::PathBuf;

/// Text before the reason that the child prints if there is no null device.
pub const NO_DEVICE: &str = "no null device: ";

/// Entry point and its statistics.
pub type EntryStats = (String, Vec<(String, u64)>);

/// Where the Vulkan loader finds RADV.
pub fn manifest() -> Option<PathBuf> {
    let folders = ["/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d"];
    let files = folders.iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten();
    let mut paths = files.filter_map(|file| Some(file.ok()?.path()));
    // It is named radeon_icd.x86_64.json or radeon_icd.json; a 32-bit one may lie beside it.
    paths.find(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("radeon_icd") && !name.contains("i686") && !name.contains("i386")
    })
}

/// A device that compiles.
pub struct NullGpu {
    device: ash::Device,
    executables: ash::khr::pipeline_executable_properties::Device,
    /// Keeps the loader's library in memory.
    _entry: ash::Entry,
}

impl NullGpu {
    /// Opens the device that RADV_FORCE_FAMILY and VK_DRIVER_FILES name.
    pub fn open() -> Result<Self, String> {
        let text = |error: vk::Result| error.to_string();
        // SAFETY: the library is the system's Vulkan loader, kept in `_entry`.
        let entry = unsafe { ash::Entry::load() }.map_err(|_| "no Vulkan loader (libvulkan1)")?;
        let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
        let instance_info = vk::InstanceCreateInfo::default().application_info(&application);
        // SAFETY: the structure is valid and outlives the call.
        let instance = unsafe { entry.create_instance(&instance_info, None) }.map_err(text)?;
        // SAFETY: the instance is valid.
        let gpus = unsafe { instance.enumerate_physical_devices() }.map_err(text)?;
        let gpu = *gpus.first().ok_or("this RADV has none for the family")?;
        let priorities = [1.0];
        let queues = [vk::DeviceQueueCreateInfo::default().queue_priorities(&priorities)];
        let extensions = [ash::khr::pipeline_executable_properties::NAME.as_ptr()];
        let features = vk::PhysicalDeviceFeatures::default()
            .shader_int64(true)
            .shader_float64(true)
            .fragment_stores_and_atomics(true)
            .shader_storage_image_extended_formats(true);
        let mut features_12 = vk::PhysicalDeviceVulkan12Features::default()
            .shader_buffer_int64_atomics(true)
            .shader_shared_int64_atomics(true)
            .vulkan_memory_model(true)
            .vulkan_memory_model_device_scope(true);
        let mut features_13 = vk::PhysicalDeviceVulkan13Features::default().dynamic_rendering(true);
        let mut told = vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default()
            .pipeline_executable_info(true);
        let device_info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_extension_names(&extensions)
            .enabled_features(&features)
            .push_next(&mut features_12)
            .push_next(&mut features_13)
            .push_next(&mut told);
        // SAFETY: everything that `device_info` points to lives until the call returns.
        let device = unsafe { instance.create_device(gpu, &device_info, None) }.map_err(text)?;
        let executables = ash::khr::pipeline_executable_properties::Device::new(&instance, &device);
        Ok(Self { device, executables, _entry: entry })
    }

    /// Compiles every compute entry point, and the vertex and fragment entry points as one pass.
    pub fn compile(&self, shader: &Parsed) -> Result<Vec<EntryStats>, String> {
        let info = vk::ShaderModuleCreateInfo::default().code(&shader.spirv);
        // SAFETY: the code is valid SPIR-V from naga.
        let module = unsafe { self.device.create_shader_module(&info, None) }.map_err(|e| e.to_string())?;
        let layout = self.layout(shader).map_err(|e| e.to_string())?;
        let mut told = Vec::new();
        for entry in shader.entries(ShaderStage::Compute) {
            let pipeline = self.compute_pipeline(module, layout, entry).map_err(|e| e.to_string())?;
            told.extend(self.statistics(pipeline, &[entry])?);
        }
        let vertex = shader.entries(ShaderStage::Vertex).next();
        for fragment in shader.entries(ShaderStage::Fragment) {
            let vertex = vertex.ok_or("a fragment entry point without a vertex one")?;
            let targets = shader.targets(fragment);
            let pipeline = self.pass_pipeline(module, layout, [vertex, fragment], &targets);
            told.extend(self.statistics(pipeline.map_err(|e| e.to_string())?, &[vertex, fragment])?);
        }
        Ok(told)
    }

    fn layout(&self, shader: &Parsed) -> Result<vk::PipelineLayout, String> {
        let text = |error: vk::Result| error.to_string();
        let mut groups = Vec::new();
        for group in shader.groups()? {
            let binding = |(at, kind): &(u32, vk::DescriptorType)| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(*at)
                    .descriptor_type(*kind)
                    .descriptor_count(1)
                    .stage_flags(vk::ShaderStageFlags::ALL)
            };
            let bindings: Vec<_> = group.iter().map(binding).collect();
            let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            // SAFETY: `info` and `bindings` outlive the call.
            groups.push(unsafe { self.device.create_descriptor_set_layout(&info, None) }.map_err(text)?);
        }
        // There is room for immediates, whether or not the shader has any.
        let immediates =
            [vk::PushConstantRange { stage_flags: vk::ShaderStageFlags::ALL, offset: 0, size: 128 }];
        let info =
            vk::PipelineLayoutCreateInfo::default().set_layouts(&groups).push_constant_ranges(&immediates);
        // SAFETY: the groups are valid, and all that `info` points to outlives the call.
        unsafe { self.device.create_pipeline_layout(&info, None) }.map_err(text)
    }

    fn compute_pipeline(
        &self,
        module: vk::ShaderModule,
        layout: vk::PipelineLayout,
        entry: &str,
    ) -> Result<vk::Pipeline, vk::Result> {
        let name = c_name(entry);
        let stage = stage(vk::ShaderStageFlags::COMPUTE, module, &name);
        let info = vk::ComputePipelineCreateInfo::default()
            .flags(vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR)
            .layout(layout)
            .stage(stage);
        let cache = vk::PipelineCache::null();
        // SAFETY: module and layout are valid, `name` outlives the call.
        let made = unsafe { self.device.create_compute_pipelines(cache, &[info], None) };
        made.map(|pipelines| pipelines[0]).map_err(|(_, error)| error)
    }

    /// Makes a pass as `resolve` is one: a triangle without buffers, drawn with dynamic rendering.
    fn pass_pipeline(
        &self,
        module: vk::ShaderModule,
        layout: vk::PipelineLayout,
        entries: [&str; 2],
        targets: &FragmentOutputs,
    ) -> Result<vk::Pipeline, vk::Result> {
        let [vertex, fragment] = entries.map(c_name);
        let stages = [
            stage(vk::ShaderStageFlags::VERTEX, module, &vertex),
            stage(vk::ShaderStageFlags::FRAGMENT, module, &fragment),
        ];
        let no_buffers = vk::PipelineVertexInputStateCreateInfo::default();
        let triangles = vk::PipelineInputAssemblyStateCreateInfo::default()
            .topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let raster = vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0);
        let samples = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(vk::SampleCountFlags::TYPE_1);
        let depth = vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(targets.depth)
            .depth_write_enable(targets.depth)
            .depth_compare_op(vk::CompareOp::ALWAYS);
        let all =
            vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA);
        let blends = vec![all; targets.colors.len()];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&blends);
        let dynamic = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&dynamic);
        let depth_format = if targets.depth { vk::Format::D32_SFLOAT } else { vk::Format::UNDEFINED };
        let mut rendering = vk::PipelineRenderingCreateInfo::default()
            .color_attachment_formats(&targets.colors)
            .depth_attachment_format(depth_format);
        let info = vk::GraphicsPipelineCreateInfo::default()
            .flags(vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR)
            .stages(&stages)
            .vertex_input_state(&no_buffers)
            .input_assembly_state(&triangles)
            .viewport_state(&viewport)
            .rasterization_state(&raster)
            .multisample_state(&samples)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(layout)
            .push_next(&mut rendering);
        let cache = vk::PipelineCache::null();
        // SAFETY: module and layout are valid, everything that `info` points to outlives the call.
        let made = unsafe { self.device.create_graphics_pipelines(cache, &[info], None) };
        made.map(|pipelines| pipelines[0]).map_err(|(_, error)| error)
    }

    /// The statistics of a pipeline's executables, which are as many as `entries` and in their order.
    fn statistics(&self, pipeline: vk::Pipeline, entries: &[&str]) -> Result<Vec<EntryStats>, String> {
        let text = |error: vk::Result| error.to_string();
        let info = vk::PipelineInfoKHR::default().pipeline(pipeline);
        // SAFETY: the pipeline is valid and was made with CAPTURE_STATISTICS.
        let executables =
            unsafe { self.executables.get_pipeline_executable_properties(&info) }.map_err(text)?;
        if executables.len() != entries.len() {
            return Err(format!("{} executables of {} entry points", executables.len(), entries.len()));
        }
        let mut told = Vec::new();
        for (index, entry) in (0..).zip(entries) {
            let info = vk::PipelineExecutableInfoKHR::default().pipeline(pipeline).executable_index(index);
            // SAFETY: the index is below the number of executables that the driver gave.
            let stats =
                unsafe { self.executables.get_pipeline_executable_statistics(&info) }.map_err(text)?;
            told.push(((*entry).to_owned(), stats.iter().filter_map(integer).collect()));
        }
        Ok(told)
    }
}

/// Name and value of a statistic, if it is a whole number.
fn integer(stat: &vk::PipelineExecutableStatisticKHR) -> Option<(String, u64)> {
    if stat.format != vk::PipelineExecutableStatisticFormatKHR::UINT64 {
        return None;
    }
    // SAFETY: the driver ends the name with a zero inside its array.
    let name = unsafe { CStr::from_ptr(stat.name.as_ptr()) };
    // SAFETY: `format` says which member of the union was written.
    let value = unsafe { stat.value.u64 };
    Some((name.to_string_lossy().into_owned(), value))
}

fn stage<'a>(
    flag: vk::ShaderStageFlags,
    module: vk::ShaderModule,
    name: &'a CStr,
) -> vk::PipelineShaderStageCreateInfo<'a> {
    vk::PipelineShaderStageCreateInfo::default().stage(flag).module(module).name(name)
}

fn c_name(entry: &str) -> CString {
    CString::new(entry).expect("WGSL names hold no zero byte")
}

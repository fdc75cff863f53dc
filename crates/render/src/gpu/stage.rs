//! A compute stage: one shader, one entry point `main`, its resources bound by their names in the shader.

use super::Gpu;
use wgpu::naga;
use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};

/// Workgroups of a dispatch along one dimension: Vulkan promises as many.
const MAX_ROW: u32 = 65_535;

/// A compiled compute stage.
#[derive(Debug)]
pub struct Stage {
    name: &'static str,
    pipeline: wgpu::ComputePipeline,
    bindings: Bindings,
}

/// Names and numbers of a shader's resources in group 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Bindings(Vec<(String, u32)>);

impl Bindings {
    /// Reads from WGSL text what its entry point `entry` uses.
    ///
    /// # Panics
    /// If the text is not valid: shaders are ours, and a test validates each.
    #[must_use]
    pub fn of(name: &str, wgsl: &str, entry: &str) -> Self {
        let module = naga::front::wgsl::parse_str(wgsl)
            .unwrap_or_else(|e| panic!("shader {name}: {}", e.emit_to_string(wgsl)));
        let mut validator = Validator::new(ValidationFlags::default(), Capabilities::all());
        let info = validator
            .validate(&module)
            .unwrap_or_else(|e| panic!("shader {name}: {}", e.emit_to_string(wgsl)));
        let number = module.entry_points.iter().position(|e| e.name == entry);
        let number = number.unwrap_or_else(|| panic!("shader {name} has no entry point {entry}"));
        let uses = info.get_entry_point(number);
        let named = module.global_variables.iter().filter(|(handle, _)| !uses[*handle].is_empty());
        let numbered = named.filter_map(|(_, v)| {
            Some((v.name.clone()?, v.binding.as_ref().filter(|b| b.group == 0)?.binding))
        });
        Self(numbered.collect())
    }

    /// What both use: the halves of a pass.
    #[must_use]
    pub fn with(mut self, other: Self) -> Self {
        self.0.extend(other.0);
        self.0.sort();
        self.0.dedup();
        self
    }

    /// A bind group of these resources. Every name of the shader must be given; others are ignored, so
    /// that stages can be handed one list.
    ///
    /// # Panics
    /// If a resource of the shader is not given.
    #[must_use]
    pub fn bind(
        &self,
        device: &wgpu::Device,
        label: &str,
        layout: &wgpu::BindGroupLayout,
        resources: &[(&str, wgpu::BindingResource)],
    ) -> wgpu::BindGroup {
        let entries: Vec<_> = self
            .0
            .iter()
            .map(|(name, binding)| {
                let found = resources.iter().find(|(n, _)| n == name);
                let Some((_, resource)) = found else { panic!("{label}: no resource called {name}") };
                wgpu::BindGroupEntry { binding: *binding, resource: resource.clone() }
            })
            .collect();
        device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
    }
}

impl Stage {
    /// Compiles `wgsl` (the whole text, prelude included).
    #[must_use]
    pub fn new(gpu: &Gpu, name: &'static str, wgsl: &str) -> Self {
        Self::of_module(gpu, name, wgsl, &shader_module(&gpu.device, name, wgsl))
    }

    /// The same without a check of every index: for texts of `shaders/`, with resources as large as the frame's.
    #[must_use]
    pub fn trusted(gpu: &Gpu, name: &'static str, wgsl: &str) -> Self {
        Self::of_module(gpu, name, wgsl, &raw::trusted::shader_module(&gpu.device, name, wgsl))
    }

    fn of_module(gpu: &Gpu, name: &'static str, wgsl: &str, module: &wgpu::ShaderModule) -> Self {
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: None,
            module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        Self { name, pipeline, bindings: Bindings::of(name, wgsl, "main") }
    }

    /// A bind group for this stage; see [`Bindings::bind`].
    #[must_use]
    pub fn bind(&self, gpu: &Gpu, resources: &[(&str, wgpu::BindingResource)]) -> wgpu::BindGroup {
        self.bindings.bind(&gpu.device, self.name, &self.pipeline.get_bind_group_layout(0), resources)
    }

    /// Records a dispatch of `num_groups` workgroups; in several rows, and up to a row more than asked for, where
    /// they are more than every GPU takes in one.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass, group: &wgpu::BindGroup, num_groups: u32) {
        let num_rows = num_groups.div_ceil(MAX_ROW).max(1);
        self.dispatch_2d(pass, group, [num_groups.div_ceil(num_rows), num_rows]);
    }

    /// Records a dispatch of `num_groups` workgroups across and down.
    pub fn dispatch_2d(&self, pass: &mut wgpu::ComputePass, group: &wgpu::BindGroup, num_groups: [u32; 2]) {
        let [x, y] = num_groups;
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.dispatch_workgroups(x, y, 1);
    }

    /// Records a dispatch whose workgroup counts lie in `arguments` at `offset` bytes.
    pub fn dispatch_indirect(
        &self,
        pass: &mut wgpu::ComputePass,
        group: &wgpu::BindGroup,
        arguments: &wgpu::Buffer,
        offset: u64,
    ) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.dispatch_workgroups_indirect(arguments, offset);
    }
}

/// Compiles WGSL text.
#[must_use]
pub fn shader_module(device: &wgpu::Device, name: &str, wgsl: &str) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(name),
        source: wgpu::ShaderSource::Wgsl(wgsl.into()),
    })
}

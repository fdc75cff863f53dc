//! A compute stage: one shader, one entry point `main`, its resources bound by their names in the shader.

use super::Gpu;
use crate::bindings::Set;
use crate::draw_options::Access;
use crate::layout::{COUNTERS_STRIDE, Variant};
use crate::shaders::ShaderOfSet;
use std::collections::HashMap;
use std::fmt;
use std::marker::PhantomData;
use std::ops::Deref;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use wgpu::naga;
use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};

/// Workgroups of a dispatch along one dimension that Vulkan promises.
const MAX_ROW: u32 = 65_535;

/// A compiled compute stage whose shader binds resources of a set.
#[derive(Debug)]
pub struct Stage<S: Set> {
    compiled: Compiled,
    bindings: Bindings<S>,
}

/// A compiled shader.
#[derive(Debug)]
pub struct Compiled {
    pipeline: wgpu::ComputePipeline,
}

/// Pipelines that a device has compiled, by the shader's text and by whether every index is checked. The same shader
/// costs nothing in another renderer, so tests do not compile it again and again.
#[derive(Debug, Default)]
pub(super) struct PipelineCache(Mutex<HashMap<(String, bool), Compiling>>);

/// A place that holds a pipeline once it is compiled.
type Compiling = Arc<OnceLock<CompiledText>>;

/// What has come of a text: a pipeline, or what is wrong with the text.
type CompiledText = Result<CachedPipeline, String>;

/// A pipeline of the cache.
#[derive(Clone, Debug)]
struct CachedPipeline {
    pipeline: wgpu::ComputePipeline,
    /// Names and numbers of what it uses.
    used: Vec<(String, u32)>,
}

impl PipelineCache {
    /// What `compile` makes of a text, or has made of it before. Other texts can be compiled meanwhile.
    fn get(&self, wgsl: &str, checked: bool, compile: impl FnOnce() -> CompiledText) -> CompiledText {
        let place = {
            let mut pipelines = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(pipelines.entry((wgsl.to_owned(), checked)).or_default())
        };
        place.get_or_init(compile).clone()
    }
}

/// Why a shader cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the shader '{shader}' cannot be used: {fault}")]
pub struct ShaderError {
    /// Name of the shader, or of the texts that it is made of.
    pub shader: String,
    /// What is wrong with it.
    pub fault: String,
}

impl ShaderError {
    /// Nobody has the resource that it binds.
    pub(crate) fn lacks(shader: &str, resource: &str) -> Self {
        Self { shader: shader.to_owned(), fault: format!("it binds '{resource}', which nobody has") }
    }
}

/// The resources of a set that a shader uses in group 0, each with its binding number.
#[derive(Clone, PartialEq, Eq)]
pub struct Bindings<S: Set> {
    name: String,
    used: Vec<(String, u32)>,
    set: PhantomData<S>,
}

impl<S: Set> fmt::Debug for Bindings<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.used.iter().map(|(name, binding)| (name, binding))).finish()
    }
}

/// Names and numbers of what entry point `entry` of a shader uses in group 0.
///
/// # Errors
/// If the text is not valid, or has no such entry point.
pub fn used(wgsl: &str, entry: &str) -> Result<Vec<(String, u32)>, String> {
    let module = naga::front::wgsl::parse_str(wgsl).map_err(|e| e.emit_to_string(wgsl))?;
    let mut validator = Validator::new(ValidationFlags::default(), Capabilities::all());
    let info = validator.validate(&module).map_err(|e| e.emit_to_string(wgsl))?;
    let number = module.entry_points.iter().position(|e| e.name == entry);
    let uses = info.get_entry_point(number.ok_or_else(|| format!("there is no entry point {entry}"))?);
    let used = module.global_variables.iter().filter(|(handle, _)| !uses[*handle].is_empty());
    let numbered = used.filter_map(|(_, v)| {
        let binding = v.binding.as_ref().filter(|b| b.group == 0)?.binding;
        Some((v.name.clone().unwrap_or_default(), binding))
    });
    Ok(numbered.collect())
}

impl<S: Set> Bindings<S> {
    /// Reads from WGSL text what its entry point `entry` uses. `others` are the names of [`crate::bindings::OtherSet`], if the set has it.
    ///
    /// # Errors
    /// If the text is not valid, or uses what the set lacks. Shaders are ours, and a test looks at each.
    pub fn of(name: &str, wgsl: &str, entry: &str, others: &[&str]) -> Result<Self, ShaderError> {
        let used = used(wgsl, entry).map_err(|fault| ShaderError { shader: name.to_owned(), fault })?;
        Self::found(name, used, others)
    }

    fn found(name: &str, used: Vec<(String, u32)>, others: &[&str]) -> Result<Self, ShaderError> {
        let others = if S::HAS_OTHERS { others } else { &[] };
        let names = [&S::names(), others].concat();
        match used.iter().find(|(used, _)| !names.contains(&used.as_str())) {
            Some((lacking, _)) => Err(ShaderError::lacks(name, lacking)),
            None => Ok(Self { name: name.to_owned(), used, set: PhantomData }),
        }
    }

    /// The resources that either shader of a pass uses.
    #[must_use]
    pub fn with(mut self, other: Self) -> Self {
        self.used.extend(other.used);
        self.used.sort_unstable();
        self.used.dedup();
        self
    }

    /// A bind group of the resources that the shader uses. The set has all of them: they were looked for.
    #[must_use]
    pub fn bind(
        &self,
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        resources: &S::Resources<'_>,
    ) -> wgpu::BindGroup {
        let entry = |(name, binding): &(String, u32)| {
            Some(wgpu::BindGroupEntry { binding: *binding, resource: S::find(resources, name)? })
        };
        let entries: Vec<_> = self.used.iter().filter_map(entry).collect();
        let label = Some(&*self.name);
        device.create_bind_group(&wgpu::BindGroupDescriptor { label, layout, entries: &entries })
    }
}

impl<S: Set> Stage<S> {
    /// Compiles a variant of a shader. `others` are the names of [`crate::bindings::OtherSet`], if the set has it.
    ///
    /// # Errors
    /// See [`Bindings::of`].
    pub fn of(
        gpu: &Gpu,
        shader: ShaderOfSet<S>,
        variant: Variant,
        access: Access,
        others: &[&str],
    ) -> Result<Self, ShaderError> {
        Self::of_text(gpu, shader.name(), &shader.source(variant), access.checked, others)
    }

    /// Compiles `wgsl` (the whole text, prelude included), with a check of every index.
    ///
    /// # Errors
    /// See [`Bindings::of`].
    pub fn new(gpu: &Gpu, name: &'static str, wgsl: &str) -> Result<Self, ShaderError> {
        Self::of_text(gpu, name, wgsl, true, &[])
    }

    /// Without `checked` the text is one of `shaders/`, with resources as large as the frame's.
    fn of_text(
        gpu: &Gpu,
        name: &'static str,
        wgsl: &str,
        checked: bool,
        others: &[&str],
    ) -> Result<Self, ShaderError> {
        let compile = || {
            let used = used(wgsl, "main")?;
            let make = if checked { shader_module } else { raw::trusted::shader_module };
            let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(name),
                layout: None,
                module: &make(&gpu.device, name, wgsl),
                entry_point: Some("main"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            });
            Ok(CachedPipeline { pipeline, used })
        };
        let compiled = gpu.pipelines.get(wgsl, checked, compile);
        let CachedPipeline { pipeline, used } =
            compiled.map_err(|fault| ShaderError { shader: name.to_owned(), fault })?;
        Ok(Self { compiled: Compiled { pipeline }, bindings: Bindings::found(name, used, others)? })
    }

    /// A bind group for this stage; see [`Bindings::bind`].
    #[must_use]
    pub fn bind(&self, gpu: &Gpu, resources: &S::Resources<'_>) -> wgpu::BindGroup {
        let layout = self.compiled.pipeline.get_bind_group_layout(0);
        self.bindings.bind(&gpu.device, &layout, resources)
    }
}

/// A stage records dispatches as its shader does, whatever it binds.
impl<S: Set> Deref for Stage<S> {
    type Target = Compiled;

    fn deref(&self) -> &Compiled {
        &self.compiled
    }
}

impl Compiled {
    /// Records a dispatch of `num_groups` workgroups. If they are more than every GPU takes in one row, there are
    /// several rows, and up to one workgroup a row more than asked for.
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

    /// Records a dispatch for each chunk's group, with a workgroup a visible batch. `counters` are those of all chunks,
    /// [`COUNTERS_STRIDE`] bytes apart.
    pub fn dispatch_visible(
        &self,
        pass: &mut wgpu::ComputePass,
        groups: &[wgpu::BindGroup],
        counters: &wgpu::Buffer,
    ) {
        pass.set_pipeline(&self.pipeline);
        for (number, group) in groups.iter().enumerate() {
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups_indirect(counters, number as u64 * u64::from(COUNTERS_STRIDE));
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bindings::{BatchSet, ClearSet};

    #[test]
    fn a_text_is_compiled_once_for_a_device() {
        let gpu = Gpu::open(None).expect("a Vulkan driver");
        let text = |size: u32| format!("@compute @workgroup_size({size}) fn main() {{}}");
        let stage = |size, checked| Stage::<ClearSet>::of_text(&gpu, "nothing", &text(size), checked, &[]);
        let pipeline = |size, checked| stage(size, checked).expect("a shader").compiled.pipeline;
        assert_eq!(pipeline(1, true), pipeline(1, true));
        assert_ne!(pipeline(1, true), pipeline(2, true));
        assert_ne!(pipeline(1, true), pipeline(1, false));
    }

    /// Nothing is bound that nobody has, and no program ends by it without a sentence.
    #[test]
    fn a_name_that_no_set_has_is_told_of_before_anything_is_bound() {
        let gpu = Gpu::open(None).expect("a Vulkan driver");
        let text = |name: &str| {
            format!(
                "@group(0) @binding(0) var<storage, read_write> {name}: array<u32>;\n\
                 @compute @workgroup_size(1) fn main() {{ {name}[0] = 1u; }}"
            )
        };
        let told = |stage: Result<(), ShaderError>| stage.map_err(|error| error.to_string());
        let clear = |name| told(Stage::<ClearSet>::new(&gpu, "clear", &text(name)).map(|_| ()));
        assert_eq!(clear("left"), Ok(()));
        let lacks = "the shader 'clear' cannot be used: it binds 'middle', which nobody has";
        assert_eq!(clear("middle"), Err(lacks.to_owned()));
        // A technique's names count only where there is a place for its resources.
        let of = |others: &[&str]| {
            told(Bindings::<ClearSet>::of("clear", &text("middle"), "main", others).map(|_| ()))
        };
        assert_eq!(of(&["middle"]), Err(lacks.to_owned()));
        let of = |others: &[&str]| {
            told(Bindings::<BatchSet>::of("clear", &text("middle"), "main", others).map(|_| ()))
        };
        assert_eq!((of(&["middle"]), of(&["left"])), (Ok(()), Err(lacks.to_owned())));
        // A text that is none is told of in the compiler's words.
        assert!(told(Stage::<ClearSet>::new(&gpu, "odd", "fn main(").map(|_| ())).is_err());
    }
}

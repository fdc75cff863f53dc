//! A parsed WGSL module: its SPIR-V and what a pipeline must be told of it.

use ash::vk;
use naga::{AddressSpace, Binding, Module, ShaderStage, TypeInner};
use std::collections::BTreeMap;

/// A parsed module.
pub struct Parsed {
    module: Module,
    /// All entry points in one SPIR-V module.
    pub spirv: Vec<u32>,
}

/// What the fragment entry point writes.
pub struct FragmentOutputs {
    /// A format for each color output, in the order of their locations.
    pub colors: Vec<vk::Format>,
    /// True if it writes depth.
    pub depth: bool,
}

impl Parsed {
    /// Parses, validates, and writes SPIR-V as wgpu does: trusted shaders without bounds checks, others with those
    /// that wgpu adds where the driver has checks of its own (`robustBufferAccess2`).
    pub fn new(text: &str, checked: bool) -> Result<Self, String> {
        use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy::Restrict, BoundsCheckPolicy::Unchecked};
        use naga::valid::{Capabilities, ValidationFlags, Validator};
        let module = naga::front::wgsl::parse_str(text).map_err(|error| error.emit_to_string(text))?;
        let info = Validator::new(ValidationFlags::all(), Capabilities::all())
            .validate(&module)
            .map_err(|error| error.emit_to_string(text))?;
        // Overrides get their values with the pipeline. The value 1 (true) takes the longer way through our shaders.
        let values = module.overrides.iter().filter_map(|(_, o)| Some((o.name.clone()?, 1.0))).collect();
        let (module, info) = naga::back::pipeline_constants::process_overrides(&module, &info, None, &values)
            .map_err(|error| error.to_string())?;
        let options = naga::back::spv::Options {
            lang_version: (1, 4),
            bounds_check_policies: BoundsCheckPolicies {
                index: if checked { Restrict } else { Unchecked },
                buffer: Unchecked,
                image_load: Unchecked,
                binding_array: Unchecked,
            },
            force_loop_bounding: checked,
            emit_int_div_checks: checked,
            ..naga::back::spv::Options::default()
        };
        let spirv = naga::back::spv::write_vec(&module, &info, &options, None).map_err(|e| e.to_string())?;
        Ok(Self { module: module.into_owned(), spirv })
    }

    /// Names of the entry points of a stage.
    pub fn entries(&self, stage: ShaderStage) -> impl Iterator<Item = &str> {
        self.module.entry_points.iter().filter(move |e| e.stage == stage).map(|e| e.name.as_str())
    }

    /// The descriptors of each group: binding and kind. Groups without any are empty.
    pub fn groups(&self) -> Result<Vec<Vec<(u32, vk::DescriptorType)>>, String> {
        let mut groups: BTreeMap<u32, Vec<(u32, vk::DescriptorType)>> = BTreeMap::new();
        for (_, variable) in self.module.global_variables.iter() {
            let Some(at) = &variable.binding else { continue };
            let kind = match variable.space {
                AddressSpace::Uniform => vk::DescriptorType::UNIFORM_BUFFER,
                AddressSpace::Storage { .. } => vk::DescriptorType::STORAGE_BUFFER,
                _ => match &self.module.types[variable.ty].inner {
                    TypeInner::Sampler { .. } => vk::DescriptorType::SAMPLER,
                    TypeInner::Image { class: naga::ImageClass::Storage { .. }, .. } => {
                        vk::DescriptorType::STORAGE_IMAGE
                    }
                    TypeInner::Image { .. } => vk::DescriptorType::SAMPLED_IMAGE,
                    other => return Err(format!("a resource of a kind this test does not know: {other:?}")),
                },
            };
            groups.entry(at.group).or_default().push((at.binding, kind));
        }
        let num_groups = groups.keys().last().map_or(0, |last| last + 1);
        Ok((0..num_groups).map(|group| groups.remove(&group).unwrap_or_default()).collect())
    }

    /// What the fragment entry point writes.
    pub fn targets(&self, entry: &str) -> FragmentOutputs {
        let mut targets = FragmentOutputs { colors: Vec::new(), depth: false };
        let function = self.module.entry_points.iter().find(|e| e.name == entry).map(|e| &e.function);
        let Some(result) = function.and_then(|f| f.result.as_ref()) else { return targets };
        let outputs = match (&self.module.types[result.ty].inner, &result.binding) {
            (TypeInner::Struct { members, .. }, None) => {
                members.iter().map(|member| (member.ty, member.binding.clone())).collect()
            }
            (_, binding) => vec![(result.ty, binding.clone())],
        };
        for (ty, binding) in outputs {
            match binding {
                Some(Binding::Location { .. }) => {
                    targets.colors.push(match self.module.types[ty].inner.scalar_kind() {
                        Some(naga::ScalarKind::Uint) => vk::Format::R32G32B32A32_UINT,
                        Some(naga::ScalarKind::Sint) => vk::Format::R32G32B32A32_SINT,
                        _ => vk::Format::R8G8B8A8_SRGB,
                    });
                }
                Some(Binding::BuiltIn(naga::BuiltIn::FragDepth)) => targets.depth = true,
                _ => {}
            }
        }
        targets
    }
}

//! The frame's pipelines, compiled once: for both qualities, so that a change of quality costs nothing.

use super::shaders::{self, ShaderOfSet};
use crate::bindings::{BatchSet, ClearSet, CloudSet, EyeSet, GeometrySet, OfEye, Set};
use crate::draw_options::Access;
use crate::gpu::drawing::Drawing;
use crate::gpu::stage::{Bindings, ShaderError, Stage};
use crate::gpu::{Atomics, Gpu};
use crate::layout::{Sums, Variant};
use crate::nearest::{Closest, Nearest};
use crate::technique::Technique;

/// Every pipeline that a renderer may need.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub clear: Stage<ClearSet>,
    pub lod: Stage<CloudSet>,
    pub cull: Stage<BatchSet>,
    /// True if each pixel's nearest depth and id are one key.
    pub has_keys: bool,
    /// Stages for each form of sums that the GPU can do.
    pub hqs: Vec<Hqs>,
    /// Makes finished pixels in `closest` quality, if gaps are closed.
    pub dilate: Stage<EyeSet>,
    /// Makes finished pixels from the surface, if gaps stay open.
    pub show: Stage<EyeSet>,
    /// Writes depth images, if there are any.
    pub depth_image: Option<DepthImage>,
}

/// The point stages of `hqs` quality.
#[derive(Debug)]
pub(super) struct Hqs {
    pub sums: Sums,
    pub depth: Stage<GeometrySet>,
    pub color: Stage<GeometrySet>,
    /// Makes the surface, if gaps stay open.
    pub blend: Stage<EyeSet>,
    /// `blend` and `dilate` in one step, if gaps are closed.
    pub blend_dilate: Stage<EyeSet>,
}

/// The pass that writes an eye's depth image.
#[derive(Debug)]
pub(super) struct DepthImage {
    pub pipeline: wgpu::RenderPipeline,
    pub bindings: Bindings<EyeSet>,
}

/// What the pipelines are made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PipelineOptions {
    pub num_eyes: u32,
    pub fill: bool,
    pub atomics: Atomics,
    pub access: Access,
    pub depth_format: Option<wgpu::TextureFormat>,
}

impl Pipelines {
    /// Compiles the pipelines, with the technique's way to the nearest points, if it has one, else the frame's.
    pub fn new(
        gpu: &Gpu,
        technique: &dyn Technique,
        options: PipelineOptions,
    ) -> Result<(Self, Box<dyn Nearest>), ShaderError> {
        let PipelineOptions { num_eyes, fill, atomics, access, depth_format } = options;
        let has_keys = atomics >= Atomics::Int64Minmax;
        let together = access.together.unwrap_or(!gpu.is_software());
        let texts = technique.texts();
        let variant = Variant { fill, keys: has_keys, together, texts, ..Variant::eyes(num_eyes) };
        let others = &technique.names()[..];
        let maker = Maker { gpu, access, others };
        let hqs = |sums| {
            let variant = Variant { sums, ..variant };
            let color = match sums {
                Sums::Packed | Sums::Protected => shaders::COLOR,
                Sums::Wide => shaders::COLOR32,
            };
            Ok(Hqs {
                sums,
                depth: maker.stage(shaders::DEPTH32, variant)?,
                color: maker.stage(color, variant)?,
                blend: maker.stage(shaders::BLEND, variant)?,
                blend_dilate: maker.stage(shaders::BLEND_DILATE, variant)?,
            })
        };
        let forms = match technique.sums() {
            Some(sums) => vec![sums],
            None if atomics == Atomics::Int64 => vec![Sums::Packed, Sums::Protected],
            None => vec![Sums::Wide],
        };
        let nearest = match technique.nearest(gpu, variant, access)? {
            Some(nearest) => nearest,
            None => Box::new(Closest::new(gpu, variant, access, others)?),
        };
        let depth_image = |format| DepthImage::new(gpu, format, &shaders::DEPTH_IMAGE.source(variant));
        let pipelines = Self {
            clear: maker.stage(shaders::CLEAR, variant)?,
            lod: maker.stage(shaders::LOD, variant)?,
            cull: maker.stage(shaders::CULL, variant)?,
            has_keys,
            hqs: forms.into_iter().map(hqs).collect::<Result<_, ShaderError>>()?,
            dilate: maker.stage(shaders::DILATE, variant)?,
            show: maker.stage(shaders::SHOW, variant)?,
            depth_image: depth_format.map(depth_image).transpose()?,
        };
        Ok((pipelines, nearest))
    }
}

/// Makes the frame's stages.
#[derive(Clone, Copy)]
struct Maker<'a> {
    gpu: &'a Gpu,
    access: Access,
    /// Names of what the technique binds besides.
    others: &'a [&'static str],
}

impl Maker<'_> {
    /// Compiles a stage.
    fn stage<S: Set>(self, shader: ShaderOfSet<S>, variant: Variant) -> Result<Stage<S>, ShaderError> {
        Stage::of(self.gpu, shader, variant, self.access, self.others)
    }
}

impl DepthImage {
    fn new(gpu: &Gpu, format: wgpu::TextureFormat, wgsl: &str) -> Result<Self, ShaderError> {
        let name = "depth-image";
        let bindings = Bindings::of(name, wgsl, "fragment", &[])?;
        let pipeline = Drawing {
            name,
            wgsl,
            entries: ["vertex", "fragment"],
            buffers: &[],
            target: None,
            depth_format: Some(format),
        }
        .pipeline(gpu);
        Ok(Self { pipeline, bindings })
    }

    /// A bind group for the pass.
    pub fn bind(&self, gpu: &Gpu, resources: &OfEye) -> wgpu::BindGroup {
        let layout = self.pipeline.get_bind_group_layout(0);
        self.bindings.bind(&gpu.device, &layout, resources)
    }
}

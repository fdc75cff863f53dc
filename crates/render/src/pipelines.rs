//! The frame's pipelines, compiled once: for both qualities, so that a change of quality costs nothing.

use super::point_list::PointList;
use super::shaders;
use crate::gpu::drawing::Drawing;
use crate::gpu::stage::{Bindings, Stage};
use crate::gpu::{Atomics, Gpu};
use crate::layout::{Sums, Variant};
use crate::method::{Access, Method};

/// Every pipeline that a renderer may need.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub clear: Stage,
    pub lod: Stage,
    pub cull: Stage,
    pub closest: Closest,
    /// Of each form of sums that the GPU can do.
    pub hqs: Vec<Hqs>,
    /// The surface to the image, where gaps stay open.
    pub show: Stage,
    /// Where there are depth images.
    pub depth_image: Option<DepthImage>,
}

/// The point stages of `closest` quality.
#[derive(Debug)]
pub(super) struct Closest {
    pub depth: Depth,
    /// Where depth and id do not fit one atomic.
    pub ids: Option<Stage>,
    pub shade: Stage,
    pub dilate: Stage,
    /// `shade` gets all from the keys, whatever chunk a point is of, and clears them.
    pub shade_clears: bool,
}

/// The two ways to the nearest points.
#[derive(Debug)]
pub(super) enum Depth {
    /// The stage.
    Compute(Stage),
    /// The hardware's own points.
    PointList(PointList),
}

/// The point stages of `hqs` quality.
#[derive(Debug)]
pub(super) struct Hqs {
    pub sums: Sums,
    pub depth: Stage,
    pub color: Stage,
    /// Where gaps stay open.
    pub blend: Stage,
    /// `blend` and `dilate` in one, where they are closed.
    pub blend_dilate: Stage,
}

/// The pass that writes an eye's depth image.
#[derive(Debug)]
pub(super) struct DepthImage {
    pub pipeline: wgpu::RenderPipeline,
    pub bindings: Bindings,
}

/// What the pipelines are made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct For {
    pub num_eyes: u32,
    pub fill: bool,
    pub discs: bool,
    pub atomics: Atomics,
    pub method: Method,
    pub access: Access,
    /// See [`super::Renderer::counting`].
    pub counts: bool,
    pub depth_format: Option<wgpu::TextureFormat>,
}

impl Pipelines {
    pub fn new(gpu: &Gpu, what: For) -> Self {
        let For { num_eyes, fill, discs, atomics, method, access, counts, depth_format } = what;
        let keys = atomics >= Atomics::Int64Minmax;
        let variant = Variant {
            fill,
            discs,
            keys,
            basic: method.is_basic(),
            plain_looks: access.plain_looks,
            together: access.together.unwrap_or(!gpu.is_software()),
            fixed40: method == Method::Fixed40,
            counts,
            ..Variant::eyes(num_eyes)
        };
        let stage = |name, variant| stage(gpu, access, name, variant);
        let hqs = |sums| {
            let variant = Variant { sums, ..variant };
            let color = match sums {
                Sums::Packed | Sums::Protected => "color",
                Sums::Wide => "color32",
                Sums::Pairs => "color-pairs",
            };
            Hqs {
                sums,
                depth: stage("depth32", variant),
                color: stage(color, variant),
                blend: stage("blend", variant),
                blend_dilate: stage("blend-dilate", variant),
            }
        };
        let forms = match method.sums() {
            Some(sums) => vec![sums],
            None if atomics == Atomics::Int64 => vec![Sums::Packed, Sums::Protected],
            None => vec![Sums::Wide],
        };
        Self {
            clear: stage("clear", variant),
            lod: stage("lod", variant),
            cull: stage("cull", variant),
            closest: Closest {
                depth: match method {
                    Method::PointList => Depth::PointList(PointList::new(gpu, variant)),
                    _ => Depth::Compute(closest(gpu, access, method, variant)),
                },
                ids: (!keys && method != Method::PointList).then(|| stage("ids", variant)),
                shade: stage(
                    match method {
                        Method::Fixed40 => "shade40",
                        Method::PointList => "shade-points",
                        _ => "shade",
                    },
                    variant,
                ),
                dilate: stage("dilate", variant),
                shade_clears: method == Method::Fixed40,
            },
            hqs: forms.into_iter().map(hqs).collect(),
            show: stage("show", variant),
            depth_image: depth_format
                .map(|format| DepthImage::new(gpu, format, &shaders::source("depth-image", variant))),
        }
    }
}

impl Closest {
    /// The hardware's own points, if they are drawn.
    pub fn point_list(&self) -> Option<&PointList> {
        match &self.depth {
            Depth::Compute(_) => None,
            Depth::PointList(point_list) => Some(point_list),
        }
    }
}

/// The method's way to the nearest point.
fn closest(gpu: &Gpu, access: Access, method: Method, variant: Variant) -> Stage {
    let name = match method {
        Method::JustSet | Method::BusyLoop | Method::ExchangeLoop | Method::AtomicMin | Method::Fixed40 => {
            method.name()
        }
        Method::PrefetchJustSet => "just-set",
        Method::Reduce | Method::ReduceEarlyZ if gpu.has_subgroups() => "reduce",
        Method::Reduce | Method::ReduceEarlyZ => "reduce-emulated",
        Method::Dedup if gpu.has_subgroups() => "dedup",
        Method::Dedup => "dedup-emulated",
        // Those of high-quality shading too: the governor may ask for `closest`.
        _ => "depth",
    };
    let (converged, early_z) = (method.is_converged(), method != Method::Reduce);
    stage(gpu, access, name, Variant { converged, early_z, ..variant })
}

/// One of the frame's stages.
fn stage(gpu: &Gpu, access: Access, name: &'static str, variant: Variant) -> Stage {
    let compile = if access.checked { Stage::new } else { Stage::trusted };
    compile(gpu, name, &shaders::source(name, variant))
}

impl DepthImage {
    fn new(gpu: &Gpu, format: wgpu::TextureFormat, wgsl: &str) -> Self {
        let pipeline = Drawing {
            name: "depth-image",
            wgsl,
            entries: ["vertex", "fragment"],
            buffers: &[],
            target: None,
            depth_format: Some(format),
        }
        .pipeline(gpu);
        Self { pipeline, bindings: Bindings::of("depth-image", wgsl, "fragment") }
    }

    /// A bind group for the pass.
    pub fn bind(&self, gpu: &Gpu, resources: &[(&str, wgpu::BindingResource)]) -> wgpu::BindGroup {
        self.bindings.bind(&gpu.device, "depth-image", &self.pipeline.get_bind_group_layout(0), resources)
    }
}

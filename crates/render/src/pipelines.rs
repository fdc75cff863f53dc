//! The frame's pipelines, compiled once: for both qualities, so that a change of quality costs nothing.

use super::point_list::PointList;
use super::shaders::{self, Of};
use crate::bindings::{Chunk, Clear, Cloud, Eye, Geometry, OfEye, PointImage, Set};
use crate::gpu::drawing::Drawing;
use crate::gpu::stage::{Bindings, Compiled, Stage};
use crate::gpu::{Atomics, Gpu};
use crate::layout::{Sums, Variant};
use crate::method::{Access, Method};

/// Every pipeline that a renderer may need.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub clear: Stage<Clear>,
    pub lod: Stage<Cloud>,
    pub cull: Stage<(Cloud, Chunk)>,
    pub closest: Closest,
    /// Of each form of sums that the GPU can do.
    pub hqs: Vec<Hqs>,
    /// The surface to the image, where gaps stay open.
    pub show: Stage<Eye>,
    /// Where there are depth images.
    pub depth_image: Option<DepthImage>,
}

/// The point stages of `closest` quality.
#[derive(Debug)]
pub(super) struct Closest {
    pub depth: Depth,
    /// Where depth and id do not fit one atomic.
    pub ids: Option<Stage<Geometry>>,
    pub shade: Shade,
    pub dilate: Stage<Eye>,
}

/// The two ways to the nearest points.
#[derive(Debug)]
pub(super) enum Depth {
    /// The stage.
    Compute(Stage<Geometry>),
    /// The hardware's own points.
    PointList(PointList),
}

/// The ways from there to colors.
#[derive(Debug)]
pub(super) enum Shade {
    /// From keys, or depths and ids, a chunk at a time.
    Ids(Stage<(Chunk, Eye)>),
    /// From what hardware drew, a chunk at a time.
    Points(Stage<((Chunk, Eye), PointImage)>),
    /// Gets all from the keys, whatever chunk a point is of, and clears them.
    Fixed40(Stage<Eye>),
}

/// The point stages of `hqs` quality.
#[derive(Debug)]
pub(super) struct Hqs {
    pub sums: Sums,
    pub depth: Stage<Geometry>,
    pub color: Stage<Geometry>,
    /// Where gaps stay open.
    pub blend: Stage<Eye>,
    /// `blend` and `dilate` in one, where they are closed.
    pub blend_dilate: Stage<Eye>,
}

/// The pass that writes an eye's depth image.
#[derive(Debug)]
pub(super) struct DepthImage {
    pub pipeline: wgpu::RenderPipeline,
    pub bindings: Bindings<Eye>,
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
        let maker = Maker { gpu, access };
        let hqs = |sums| {
            let variant = Variant { sums, ..variant };
            let color = match sums {
                Sums::Packed | Sums::Protected => shaders::COLOR,
                Sums::Wide => shaders::COLOR32,
                Sums::Pairs => shaders::COLOR_PAIRS,
            };
            Hqs {
                sums,
                depth: maker.stage(shaders::DEPTH32, variant),
                color: maker.stage(color, variant),
                blend: maker.stage(shaders::BLEND, variant),
                blend_dilate: maker.stage(shaders::BLEND_DILATE, variant),
            }
        };
        let forms = match method.sums() {
            Some(sums) => vec![sums],
            None if atomics == Atomics::Int64 => vec![Sums::Packed, Sums::Protected],
            None => vec![Sums::Wide],
        };
        Self {
            clear: maker.stage(shaders::CLEAR, variant),
            lod: maker.stage(shaders::LOD, variant),
            cull: maker.stage(shaders::CULL, variant),
            closest: Closest {
                depth: match method {
                    Method::PointList => Depth::PointList(PointList::new(gpu, variant)),
                    _ => Depth::Compute(maker.closest(method, variant)),
                },
                ids: (!keys && method != Method::PointList).then(|| maker.stage(shaders::IDS, variant)),
                shade: match method {
                    Method::Fixed40 => Shade::Fixed40(maker.stage(shaders::SHADE40, variant)),
                    Method::PointList => Shade::Points(maker.stage(shaders::SHADE_POINTS, variant)),
                    _ => Shade::Ids(maker.stage(shaders::SHADE, variant)),
                },
                dilate: maker.stage(shaders::DILATE, variant),
            },
            hqs: forms.into_iter().map(hqs).collect(),
            show: maker.stage(shaders::SHOW, variant),
            depth_image: depth_format
                .map(|format| DepthImage::new(gpu, format, &shaders::DEPTH_IMAGE.source(variant))),
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

impl Shade {
    /// Its compiled shader.
    pub fn compiled(&self) -> &Compiled {
        match self {
            Self::Ids(stage) => stage,
            Self::Points(stage) => stage,
            Self::Fixed40(stage) => stage,
        }
    }

    /// True if it clears the keys.
    pub fn clears(&self) -> bool {
        matches!(self, Self::Fixed40(_))
    }
}

/// Makes the frame's stages.
#[derive(Clone, Copy)]
struct Maker<'a> {
    gpu: &'a Gpu,
    access: Access,
}

impl Maker<'_> {
    /// One of them.
    fn stage<S: Set>(self, shader: Of<S>, variant: Variant) -> Stage<S> {
        let compile = if self.access.checked { Stage::new } else { Stage::trusted };
        compile(self.gpu, shader.name(), &shader.source(variant))
    }

    /// The method's way to the nearest point.
    fn closest(self, method: Method, variant: Variant) -> Stage<Geometry> {
        let has_subgroups = self.gpu.has_subgroups();
        let shader = match method {
            Method::JustSet | Method::PrefetchJustSet => shaders::JUST_SET,
            Method::BusyLoop => shaders::BUSY_LOOP,
            Method::ExchangeLoop => shaders::EXCHANGE_LOOP,
            Method::AtomicMin => shaders::ATOMIC_MIN,
            Method::Fixed40 => shaders::FIXED40,
            Method::Reduce | Method::ReduceEarlyZ if has_subgroups => shaders::REDUCE,
            Method::Reduce | Method::ReduceEarlyZ => shaders::REDUCE_EMULATED,
            Method::Dedup if has_subgroups => shaders::DEDUP,
            Method::Dedup => shaders::DEDUP_EMULATED,
            // Those of high-quality shading too: the governor may ask for `closest`.
            _ => shaders::DEPTH,
        };
        let (converged, early_z) = (method.is_converged(), method != Method::Reduce);
        self.stage(shader, Variant { converged, early_z, ..variant })
    }
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
    pub fn bind(&self, gpu: &Gpu, resources: OfEye) -> wgpu::BindGroup {
        self.bindings.bind(&gpu.device, "depth-image", &self.pipeline.get_bind_group_layout(0), resources)
    }
}

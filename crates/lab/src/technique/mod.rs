//! Ways to draw beside the frame's own, through the seam of [`render::technique`]: the methods that the papers compare,
//! hardware points among them, and sequential point trees.

pub mod counts;
pub mod fixed40;
mod method;
mod point_list;
mod texts;
pub mod tree;

pub use fixed40::SHADE40;
pub use method::{EarlyZLoad, Method};
pub use point_list::{POINT_LIST, SHADE_POINTS};
pub use texts::texts;

use base::space::View;
use fixed40::Fixed40;
use point_list::PointList;
use render::gpu::{Atomics, Gpu, QueueGuard};
use render::layout::{Detail, Sums, Variant};
use render::technique::{Nearest, Own, Technique, Texts};
use render::{Access, CloudBuffers};
use tree::TreeUniform;

/// What the texts bind besides the frame's sets, by name.
pub const NAMES: [&str; 4] =
    [counts::COUNT_BINS_NAME, tree::TREE_NAME, tree::SHAPES_NAME, point_list::POINTS_NAME];
/// Pixels by which a disc of a sequential point tree may be wrong, unless the settings say otherwise.
pub const DEFAULT_ERROR_PX: f64 = 1.0;
/// [`Detail::fill_reach_px`] for discs beside dilation. They have the sizes that close a surface, but lie unevenly: kernels
/// bridge two, four and six empty pixels, and where the gap comes near that there are pinholes.
pub const DISCS_REACH_PX: [f32; 3] = [2.0, 3.5, 5.0];

/// A way to draw. The default is the frame's own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LabTechnique {
    /// How points get into pixels.
    pub method: Method,
    /// How early-z looks at a pixel.
    pub early_z_load: EarlyZLoad,
    /// Batches that neither eye sees are drawn too, so that all points are read.
    pub keep_unseen: bool,
    /// What is drawn is a sequential point tree, whose discs may be wrong by so many pixels, ε of [SPT §3.5].
    pub error_px: Option<f32>,
}

/// What a method needs and is not there.
#[derive(Debug, thiserror::Error)]
pub enum NoSuchMethod {
    /// Its arithmetic.
    #[error("frame.method: {method} counts in f64, which the shaders of the GPU '{name}' cannot")]
    F64 {
        /// The GPU.
        name: String,
        /// Asked for.
        method: &'static str,
    },
    /// It and what it is to draw.
    #[error(
        "frame.method: {method} draws points of one pixel, and a point tree has discs and triangles; set lod.method = \"octree\""
    )]
    Sizes {
        /// Asked for.
        method: &'static str,
    },
    /// Its atomics.
    #[error("frame.method: {method} needs the tier int64, and this is {tier}; prefetch runs in every tier")]
    Tier {
        /// Asked for.
        method: &'static str,
        /// What there is.
        tier: &'static str,
    },
}

impl LabTechnique {
    /// A method of the papers.
    #[must_use]
    pub fn method(method: Method) -> Self {
        Self { method, ..Self::default() }
    }

    /// A sequential point tree, whose discs may be wrong by so many pixels.
    #[must_use]
    pub fn tree(error_px: f32) -> Self {
        Self { error_px: Some(error_px), ..Self::default() }
    }

    /// Whether any GPU could do it.
    ///
    /// # Errors
    /// What contradicts what.
    pub fn check_itself(&self) -> Result<(), NoSuchMethod> {
        if self.method == Method::PointList && self.error_px.is_some() {
            return Err(NoSuchMethod::Sizes { method: self.method.name() });
        }
        Ok(())
    }

    /// Whether this GPU can do it in a tier.
    ///
    /// # Errors
    /// What it lacks.
    pub fn check(&self, gpu: &Gpu, atomics: Atomics) -> Result<(), NoSuchMethod> {
        let method = self.method.name();
        self.check_itself()?;
        if atomics < Atomics::Int64 && self.method.needs_int64() {
            return Err(NoSuchMethod::Tier { method, tier: atomics.name() });
        }
        if self.method == Method::Fixed40 && !gpu.has_f64() {
            return Err(NoSuchMethod::F64 { name: gpu.name(), method });
        }
        Ok(())
    }

    /// For a renderer.
    #[must_use]
    pub fn open(self, gpu: &Gpu) -> Box<dyn Technique> {
        if self == Self::default() {
            return Box::new(Own);
        }
        Box::new(Open { technique: self, has_subgroups: gpu.has_subgroups(), count_bins: None })
    }

    /// For a renderer that counts what its frames do; with the bins of its counts, see [`counts`].
    #[must_use]
    pub fn counting(self, gpu: &Gpu) -> (Box<dyn Technique>, wgpu::Buffer) {
        let count_bins = counts::bins(gpu);
        let has_subgroups = gpu.has_subgroups();
        (Box::new(Open { technique: self, has_subgroups, count_bins: Some(count_bins.clone()) }), count_bins)
    }
}

/// What a renderer is told of a technique.
#[derive(Debug)]
struct Open {
    technique: LabTechnique,
    has_subgroups: bool,
    count_bins: Option<wgpu::Buffer>,
}

impl Technique for Open {
    fn texts(&self) -> Texts {
        texts(&self.technique, self.count_bins.is_some(), self.has_subgroups)
    }

    fn sums(&self) -> Option<Sums> {
        self.technique.method.sums()
    }

    fn nearest(&self, gpu: &Gpu, variant: Variant, access: Access) -> Option<Box<dyn Nearest>> {
        match self.technique.method {
            Method::PointList => Some(Box::new(PointList::new(gpu, variant, access))),
            Method::Fixed40 => Some(Box::new(Fixed40::new(gpu, variant, access))),
            _ => None,
        }
    }

    fn resource(&self, name: &str) -> Option<wgpu::BindingResource<'_>> {
        let bins = self.count_bins.as_ref().filter(|_| name == counts::COUNT_BINS_NAME);
        bins.map(wgpu::Buffer::as_entire_binding)
    }

    fn set_view(
        &self,
        queue: &QueueGuard,
        view: &View,
        detail: &Detail,
        lod_scale: f32,
        cloud: &CloudBuffers,
    ) {
        if let (Some(error_px), Some(buffer)) = (self.technique.error_px, cloud.besides(tree::TREE_NAME)) {
            // Of the cloud's own it keeps what is behind.
            let tolerance = TreeUniform::new(view, detail, error_px * lod_scale, 0).tolerance_bytes();
            queue.write_buffer(buffer, 0, &tolerance);
        }
    }
}

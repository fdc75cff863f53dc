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
use render::gpu::stage::ShaderError;
use render::gpu::{Atomics, Gpu, QueueGuard};
use render::layout::{Detail, Sums, Variant};
use render::options::Dilate;
use render::technique::{Nearest, Own, Technique, Texts};
use render::{Access, CloudBuffers, DrawOptions, NO_REACH_PX, Targets};
use tree::TreeUniform;

/// Names by which early-z with plain loads binds the targets a second time.
const AGAIN: [&str; 4] = ["keys_left_again", "keys_right_again", "depth_left_again", "depth_right_again"];
/// Error in pixels that a disc of a sequential point tree may have, unless the settings say otherwise.
pub const DEFAULT_ERROR_PX: f64 = 1.0;
/// [`Detail::fill_reach_px`] for discs beside dilation. Discs are wide enough to close a surface, but lie unevenly.
/// Kernels bridge two, four and six empty pixels, and gaps close to these widths leave pinholes.
const DISCS_REACH_PX: [f32; 3] = [2.0, 3.5, 5.0];

/// A way to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabTechnique {
    /// How points get into pixels.
    pub method: Method,
    /// How early-z looks at a pixel.
    pub early_z_load: EarlyZLoad,
    /// Batches that neither eye sees are drawn too, so that all points are read.
    pub keep_unseen: bool,
    /// If set, a sequential point tree is drawn, whose discs may be wrong by this many pixels, ε of [SPT §3.5].
    pub error_px: Option<f32>,
}

/// Why a method cannot be used here.
#[derive(Debug, thiserror::Error)]
pub enum NoSuchMethod {
    /// The method counts in f64, which the GPU's shaders cannot.
    #[error("{method} counts in f64, which the shaders of the GPU '{name}' cannot")]
    F64 {
        /// Name of the GPU.
        name: String,
        /// Name of the method.
        method: &'static str,
    },
    /// The method draws points of one pixel, and a point tree has discs and triangles.
    #[error("{method} draws points of one pixel, and a point tree has discs and triangles")]
    Sizes {
        /// Name of the method.
        method: &'static str,
    },
    /// The method needs 64-bit atomics.
    #[error("{method} needs the tier int64, and this is {tier}; prefetch runs in every tier")]
    Tier {
        /// Name of the method.
        method: &'static str,
        /// Name of the tier in use.
        tier: &'static str,
    },
}

impl LabTechnique {
    /// The frame's own.
    pub const OWN: Self = Self {
        method: Method::Prefetch,
        early_z_load: EarlyZLoad::Atomic,
        keep_unseen: false,
        error_px: None,
    };

    /// A method of the papers.
    #[must_use]
    pub fn method(method: Method) -> Self {
        Self { method, ..Self::OWN }
    }

    /// A sequential point tree, whose discs may be wrong by `error_px` pixels.
    #[must_use]
    pub fn tree(error_px: f32) -> Self {
        Self { error_px: Some(error_px), ..Self::OWN }
    }

    /// Names of the resources that its texts bind besides the frame's sets: its own, and those of its clouds.
    #[must_use]
    pub fn names(&self, counts: bool) -> Vec<&'static str> {
        let of_tree = [tree::TREE_NAME, tree::RUNS_NAME, tree::SHAPES_NAME];
        let names = of_tree.into_iter().filter(|_| self.error_px.is_some());
        let names = names.chain(Some(counts::COUNT_BINS_NAME).filter(|_| counts));
        names.chain(AGAIN.into_iter().filter(|_| self.early_z_load == EarlyZLoad::Plain)).collect()
    }

    /// What frames look like that are drawn this way, where the frame's own would look as `options` say. A method of one
    /// quality draws that, some draw points of one pixel, and discs have sizes of their own and are drawn at these.
    #[must_use]
    pub fn amended(&self, options: DrawOptions) -> DrawOptions {
        let fill_reach_px = match (self.error_px, options.dilate) {
            (None, _) => options.detail.fill_reach_px,
            (Some(_), Dilate::Off) => Some(NO_REACH_PX),
            (Some(_), Dilate::Rings) => Some(DISCS_REACH_PX),
        };
        let fill_reach_px = fill_reach_px.filter(|_| !self.method.draws_pixels());
        let detail = Detail { fill_reach_px, ..options.detail };
        DrawOptions { quality: self.method.quality().unwrap_or(options.quality), detail, ..options }
    }

    /// Checks whether any GPU could draw this way.
    ///
    /// # Errors
    /// Settings that contradict each other.
    pub fn check_itself(&self) -> Result<(), NoSuchMethod> {
        if self.method == Method::PointList && self.error_px.is_some() {
            return Err(NoSuchMethod::Sizes { method: self.method.name() });
        }
        Ok(())
    }

    /// Checks whether this GPU can draw this way in a tier.
    ///
    /// # Errors
    /// What the GPU lacks.
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

    /// Makes the technique for a renderer.
    #[must_use]
    pub fn open(self, gpu: &Gpu) -> Box<dyn Technique> {
        if self == Self::OWN {
            return Box::new(Own);
        }
        Box::new(OpenTechnique { technique: self, has_subgroups: gpu.has_subgroups(), count_bins: None })
    }

    /// Makes the technique for a renderer that counts what its frames do, and the buffer of its bins; see [`counts`].
    #[must_use]
    pub fn counting(self, gpu: &Gpu) -> (Box<dyn Technique>, wgpu::Buffer) {
        let count_bins = counts::bins(gpu);
        let has_subgroups = gpu.has_subgroups();
        (
            Box::new(OpenTechnique { technique: self, has_subgroups, count_bins: Some(count_bins.clone()) }),
            count_bins,
        )
    }
}

/// A technique as a renderer gets it.
#[derive(Debug)]
struct OpenTechnique {
    technique: LabTechnique,
    has_subgroups: bool,
    count_bins: Option<wgpu::Buffer>,
}

impl Technique for OpenTechnique {
    fn texts(&self) -> Texts {
        texts(&self.technique, self.count_bins.is_some(), self.has_subgroups)
    }

    fn sums(&self) -> Option<Sums> {
        self.technique.method.sums()
    }

    fn nearest(
        &self,
        gpu: &Gpu,
        variant: Variant,
        access: Access,
    ) -> Result<Option<Box<dyn Nearest>>, ShaderError> {
        Ok(match self.technique.method {
            Method::PointList => Some(Box::new(PointList::new(gpu, variant, access, &self.names())?)),
            Method::Fixed40 => Some(Box::new(Fixed40::new(gpu, variant, access, &self.names())?)),
            _ => None,
        })
    }

    fn names(&self) -> Vec<&'static str> {
        self.technique.names(self.count_bins.is_some())
    }

    fn resources<'a>(&'a self, targets: &'a Targets) -> Vec<(&'static str, wgpu::BindingResource<'a>)> {
        let bins = self.count_bins.iter().map(|bins| (counts::COUNT_BINS_NAME, bins));
        let again = AGAIN.into_iter().zip(targets.keys.iter().chain(&targets.depth));
        let again = again.filter(|_| self.technique.early_z_load == EarlyZLoad::Plain);
        bins.chain(again).map(|(name, buffer)| (name, buffer.as_entire_binding())).collect()
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
            // Only the tolerance is written: the tree's own lengths, which lie behind it, stay.
            let tolerance = TreeUniform::new(view, detail, error_px * lod_scale, 0).tolerance_bytes();
            queue.write_buffer(buffer, 0, &tolerance);
        }
    }
}

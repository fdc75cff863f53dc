//! The one seam between the frame and other ways to draw, of which the laboratory has many: a technique hands in shader
//! texts that stand in place of the frame's, what they bind besides, and, if need be, another way to the nearest
//! points. The frame's own technique is [`Own`], which hands in nothing.

use crate::cloud_buffers::CloudBuffers;
use crate::draw_options::Access;
use crate::gpu::stage::ShaderError;
use crate::gpu::{Gpu, QueueGuard};
pub use crate::groups::ClearedTarget;
use crate::layout::{Detail, Sums, Variant};
pub use crate::nearest::{Nearest, Recording};
use crate::targets::Targets;
use base::space::View;
use std::fmt;

/// A way to draw.
pub trait Technique: fmt::Debug + Send {
    /// The texts of its shaders.
    fn texts(&self) -> Texts {
        Texts::FRAME
    }

    /// The form of sums that it insists on. `None`: whichever is best for the GPU and the cloud.
    fn sums(&self) -> Option<Sums> {
        None
    }

    /// Another way to the nearest points of `closest` quality than the frame's stages.
    ///
    /// # Errors
    /// If a shader of it binds what it does not name.
    fn nearest(
        &self,
        _gpu: &Gpu,
        _variant: Variant,
        _access: Access,
    ) -> Result<Option<Box<dyn Nearest>>, ShaderError> {
        Ok(None)
    }

    /// Names of the resources that its texts bind besides the frame's ([`crate::bindings::OtherSet`]): its own, and those of
    /// its clouds.
    fn names(&self) -> Vec<&'static str> {
        vec![]
    }

    /// The resources of its own, by name. Those of its clouds are in [`crate::Whole`].
    fn resources<'a>(&'a self, _targets: &'a Targets) -> Vec<(&'static str, wgpu::BindingResource<'a>)> {
        vec![]
    }

    /// Is told of each frame's view before the frame is submitted. `detail` is that of the draw options, with thresholds already
    /// multiplied by `lod_scale`.
    fn set_view(
        &self,
        _queue: &QueueGuard,
        _view: &View,
        _detail: &Detail,
        _lod_scale: f32,
        _cloud: &CloudBuffers,
    ) {
    }
}

/// The frame's own technique.
#[derive(Clone, Copy, Debug, Default)]
pub struct Own;

impl Technique for Own {}

/// A text in pieces.
pub type Pieces = &'static [&'static str];

/// The texts of the stages that techniques may exchange; each says what is asked of it in its own first lines.
#[derive(Clone, Copy)]
pub struct Texts {
    /// Name of these texts.
    pub name: &'static str,
    /// Structs, constants and bindings that the others need besides.
    pub besides: Pieces,
    /// `lod`, except what all shaders share.
    pub lod: Pieces,
    /// `cull`, behind `cull.inc.wgsl`.
    pub cull: Pieces,
    /// Which boxes an eye sees.
    pub seen: Pieces,
    /// What a thread of a geometry stage reads at a time.
    pub turn: Pieces,
    /// How a thread of a geometry stage puts its points into pixels.
    pub put: Pieces,
    /// Which points of a turn an eye sees, and how far they lie apart.
    pub choice: Pieces,
    /// Points wider than a pixel.
    pub wide: fn(Variant) -> Pieces,
    /// Where the geometry stages begin.
    pub main: Pieces,
    /// `depth` of `closest` quality: what is done with a point in a pixel.
    pub depth: fn(Variant) -> Pieces,
    /// `depth` of `hqs` quality, in which a pixel has a depth alone.
    pub hqs_depth: fn(Variant) -> Pieces,
    /// The colors of points.
    pub colors: Pieces,
    /// `color` in four u32.
    pub color32: Pieces,
    /// What becomes of a shader's whole text.
    pub amend: fn(String) -> String,
}

impl fmt::Debug for Texts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

macro_rules! text {
    ($file:literal) => {
        include_str!(concat!("../../../shaders/", $file, ".wgsl"))
    };
}

impl Texts {
    /// Texts of the frame: nodes of an octree, or all points, four a thread at a time, each nearest by an atomic
    /// minimum.
    pub const FRAME: Self = Self {
        name: "frame",
        besides: &[],
        lod: &[text!("sizes.inc"), text!("lod")],
        cull: &[text!("cull")],
        seen: &[text!("seen.inc")],
        turn: &[text!("turn.inc")],
        put: &[text!("put_seen.inc"), text!("put_turn.inc")],
        choice: &[text!("nodes.inc")],
        wide: Self::wide,
        main: &[text!("main.inc")],
        depth: Self::depth,
        hqs_depth: |_| &[text!("depths.inc"), text!("early_z_atomic.inc"), text!("depth")],
        colors: &[text!("node_colors.inc")],
        color32: &[text!("wide_sums.inc"), text!("color32")],
        amend: |text| text,
    };

    /// Points wider than a pixel, if there may be any.
    #[must_use]
    pub fn wide(variant: Variant) -> Pieces {
        match (variant.fill, variant.together) {
            (false, _) => &[text!("no_wide.inc")],
            (true, false) => &[text!("wide.inc"), text!("alone.inc")],
            (true, true) => &[text!("wide.inc"), text!("together.inc")],
        }
    }

    fn depth(variant: Variant) -> Pieces {
        match variant.keys {
            true => &[text!("keys.inc"), text!("early_z_atomic.inc"), text!("depth")],
            false => &[text!("depths.inc"), text!("early_z_atomic.inc"), text!("depth")],
        }
    }
}

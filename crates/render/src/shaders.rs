//! The shaders' final texts: prelude of host constants, shared structs, the file itself.

use crate::bindings::{
    BatchSet, ChunkSet, ClearSet, CloudSet, EyeSet, GeometrySet, OverlaySet, ScenerySet, Set,
};
use crate::layout::{self, Variant};
use crate::technique::Pieces;
use std::marker::PhantomData;

/// Structs shared with the host.
const LAYOUT: &str = include_str!("../../../shaders/layout.inc.wgsl");

/// A text that several shaders share, in a variant of theirs.
pub type SharedText = fn(Variant) -> Pieces;

macro_rules! shared {
    ($($file:literal),+) => {
        |_| &[$(include_str!(concat!("../../../shaders/", $file, ".wgsl"))),+]
    };
}

/// Declarations that a technique's texts need besides.
const BESIDES: SharedText = |variant| variant.texts.besides;
/// Points, read and projected.
const POINTS: SharedText = shared!("points.inc");
/// Points that a thread reads at a time.
const TURN: SharedText = |variant| variant.texts.turn;
/// How a thread puts its points into pixels.
const PUT: SharedText = |variant| variant.texts.put;
/// Which points are drawn, and how large.
const CHOICE: SharedText = |variant| variant.texts.choice;
/// Projected sizes of boxes.
const SIZES: SharedText = shared!("sizes.inc");
/// The rings round the gaze.
const RINGS: SharedText = shared!("rings.inc");
/// The geometry stages' loop over points.
const LOOP: SharedText = shared!("loop.inc");
/// Points wider than a pixel, if there may be any.
const WIDE: SharedText = |variant| (variant.texts.wide)(variant);
/// Where the geometry stages begin.
const MAIN: SharedText = |variant| variant.texts.main;
/// The tiles that the steps of `resolve` work on.
const TILES: SharedText = shared!("tiles.inc");
/// Which points count for a pixel's color.
const SUMS: SharedText = shared!("sums.inc");
/// Sums of colors in four u32.
const WIDE_SUMS: SharedText = shared!("wide_sums.inc");
/// The points' colors.
const COLORS: SharedText = |variant| variant.texts.colors;
/// How far points reach.
const FILL: SharedText = shared!("fill.inc");
/// Frustum, precision and the list of visible batches.
const CULLING: SharedText = shared!("cull.inc");
/// Which boxes an eye sees.
const IN_SIGHT: SharedText = |variant| variant.texts.seen;
/// The walk over the pixels of a tile.
const SURFACE: SharedText = shared!("surface.inc");
/// Ids to colors.
const CHUNK_COLORS: SharedText = shared!("chunk_colors.inc");
/// The rule of dilation.
const DILATION: SharedText = shared!("dilation.inc");
/// A pixel's depth and color before gaps are closed, as `shade` left them.
const KEPT_SURFACE: SharedText = shared!("kept_surface.inc");
/// A pixel's depth and color before gaps are closed, from the sums of `hqs` quality.
const BLENDED_SURFACE: SharedText = shared!("blended_surface.inc");
/// Finished pixels.
const IMAGE: SharedText = shared!("image.inc");
/// Means of color channels.
const MEAN: SharedText = shared!("mean.inc");
/// Stored colors to linear light, and back.
pub const SRGB: SharedText = shared!("srgb.inc");
/// What overlays share.
const OVERLAYS: SharedText = shared!("overlay.inc");

/// What all geometry stages share.
const GEOMETRY: &[SharedText] = &[BESIDES, POINTS, TURN, CHOICE, RINGS, FILL, LOOP, PUT, WIDE, MAIN];

/// A shader's text.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// Name, as the file's.
    pub name: &'static str,
    /// Names of the resources that it may bind.
    pub names: fn() -> Vec<&'static str>,
    /// True if it may bind resources of techniques besides; see [`crate::bindings::OtherSet`].
    pub has_others: bool,
    /// Texts that it shares with others, group by group.
    shared: &'static [&'static [SharedText]],
    /// Its own text.
    text: SharedText,
}

/// A shader that binds resources of a set.
#[derive(Debug)]
pub struct ShaderOfSet<S> {
    shader: Shader,
    set: PhantomData<S>,
}

impl<S> Clone for ShaderOfSet<S> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S> Copy for ShaderOfSet<S> {}

impl<S: Set> ShaderOfSet<S> {
    /// A shader of other techniques: `shared` comes before its own text.
    #[must_use]
    pub const fn new(name: &'static str, shared: &'static [&'static [SharedText]], text: SharedText) -> Self {
        let shader = Shader { name, names: S::names, has_others: S::HAS_OTHERS, shared, text };
        Self { shader, set: PhantomData }
    }

    /// The shader as a type that does not tell what it binds.
    #[must_use]
    pub const fn shader(self) -> Shader {
        self.shader
    }

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.shader.name
    }

    /// Its WGSL, as the driver gets it.
    #[must_use]
    pub fn source(self, variant: Variant) -> String {
        self.shader.source(variant)
    }
}

impl Shader {
    /// Its WGSL, as the driver gets it.
    #[must_use]
    pub fn source(&self, variant: Variant) -> String {
        let shared = self.shared.iter().copied().flatten();
        let pieces = shared.chain([&self.text]).flat_map(|part| part(variant));
        let text = format!("{}{LAYOUT}{}", layout::prelude(variant), pieces.copied().collect::<String>());
        (variant.texts.amend)(text)
    }
}

macro_rules! shaders {
    ($($(#[$about:meta])* $shader:ident: $set:ty = $name:literal, $shared:expr, $text:expr;)+) => {
        $(
            #[doc = concat!("The shader `", $name, "`.")]
            pub const $shader: ShaderOfSet<$set> = ShaderOfSet::new($name, $shared, $text);
        )+

        /// Every shader of the frame, in its order; then the overlays'.
        pub const SHADERS: [Shader; [$($name),+].len()] = [$($shader.shader),+];
    };
}

shaders! {
    CLEAR: ClearSet = "clear", &[], shared!("clear");
    LOD: CloudSet = "lod", &[], |variant| variant.texts.lod;
    CULL: BatchSet = "cull", &[&[BESIDES, SIZES, FILL, CULLING, IN_SIGHT]], |variant| variant.texts.cull;
    DEPTH: GeometrySet = "depth", &[GEOMETRY], |variant| (variant.texts.depth)(variant);
    DEPTH32: GeometrySet = "depth32", &[GEOMETRY], |variant| (variant.texts.hqs_depth)(variant);
    IDS: GeometrySet = "ids", &[GEOMETRY], shared!("ids");
    COLOR: GeometrySet = "color", &[GEOMETRY, &[SUMS, WIDE_SUMS, COLORS]], shared!("color");
    COLOR32: GeometrySet = "color32", &[GEOMETRY, &[SUMS, COLORS]], |variant| variant.texts.color32;
    SHADE: (ChunkSet, EyeSet) = "shade", &[&[TILES, SURFACE, CHUNK_COLORS]], shared!("shade");
    BLEND: EyeSet = "blend", &[&[TILES, SURFACE, MEAN, BLENDED_SURFACE]], shared!("blend");
    DILATE: EyeSet = "dilate", &[&[TILES, RINGS, DILATION, MEAN, KEPT_SURFACE, IMAGE]], shared!("dilate");
    BLEND_DILATE: EyeSet = "blend-dilate", &[&[TILES, RINGS, DILATION, MEAN, BLENDED_SURFACE, IMAGE]],
        shared!("dilate");
    SHOW: EyeSet = "show", &[&[TILES, KEPT_SURFACE, IMAGE]], shared!("show");
    DEPTH_IMAGE: EyeSet = "depth-image", &[], shared!("depth-image");
    SCENERY: ScenerySet = "scenery", &[], shared!("scenery");
    OVERLAY: (CloudSet, OverlaySet) = "overlay", &[&[RINGS, DILATION, SRGB, OVERLAYS]], shared!("overlay");
    BOXES: (CloudSet, OverlaySet) = "boxes", &[&[RINGS, DILATION, SRGB, OVERLAYS]], shared!("boxes");
}

/// Texts that techniques share with the frame's shaders, for shaders of their own.
pub mod parts {
    use super::SharedText;

    /// Points, read and projected, a turn at a time, as the texts choose; with what the texts need besides.
    pub const POINTS: &[SharedText] = &[super::BESIDES, super::POINTS, super::TURN, super::CHOICE];
    /// All of the geometry stages except what is done with a point in a pixel.
    pub const GEOMETRY: &[SharedText] = super::GEOMETRY;
    /// The points' colors, as the texts choose.
    pub const COLORS: &[SharedText] = &[super::COLORS];
    /// The walk over the pixels of tiles, which `finish` ends.
    pub const SURFACE: &[SharedText] = &[super::TILES, super::SURFACE];
    /// Ids to colors, a chunk at a time.
    pub const CHUNK_COLORS: &[SharedText] = &[super::CHUNK_COLORS];
}

/// The WGSL of shader `name`, as the driver gets it: for tests. The program has the shaders themselves.
///
/// # Panics
/// If there is no such shader.
#[must_use]
pub fn source(name: &str, variant: Variant) -> String {
    let Some(shader) = SHADERS.iter().find(|s| s.name == name) else { panic!("no shader called {name}") };
    shader.source(variant)
}

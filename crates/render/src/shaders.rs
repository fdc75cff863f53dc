//! The shaders' final texts: prelude of host constants, shared structs, the file itself.

use crate::bindings::{Chunk, Clear, Cloud, Eye, Geometry, Overlay, PointImage, Set};
use crate::layout::{self, Variant};
use std::marker::PhantomData;

/// Structs shared with the host.
const LAYOUT: &str = include_str!("../../../shaders/layout.inc.wgsl");

/// What several shaders have in common, in a variant of theirs.
type Shared = fn(Variant) -> &'static str;

macro_rules! shared {
    ($file:literal) => {
        |_| include_str!(concat!("../../../shaders/", $file, ".inc.wgsl"))
    };
}

/// Points, read and projected.
const POINTS: Shared = shared!("points");
/// Which points are drawn, and how large.
const CHOICE: Shared = |variant| match variant.discs {
    false => include_str!("../../../shaders/nodes.inc.wgsl"),
    true => {
        concat!(
            include_str!("../../../shaders/steps.inc.wgsl"),
            include_str!("../../../shaders/discs.inc.wgsl")
        )
    }
};
/// How large what lies in a box is drawn.
const SIZES: Shared = shared!("sizes");
/// The rings round the gaze.
const RINGS: Shared = shared!("rings");
/// The geometry stages' loop over them.
const LOOP: Shared = shared!("loop");
/// Points wider than a pixel, where there may be some.
const WIDE: Shared = |variant| match (variant.fill, variant.together) {
    (false, _) => include_str!("../../../shaders/no_wide.inc.wgsl"),
    (true, false) => {
        concat!(
            include_str!("../../../shaders/wide.inc.wgsl"),
            include_str!("../../../shaders/alone.inc.wgsl")
        )
    }
    (true, true) => {
        concat!(
            include_str!("../../../shaders/wide.inc.wgsl"),
            include_str!("../../../shaders/together.inc.wgsl")
        )
    }
};
/// Triangles, where there may be some.
const TRIANGLES: Shared = |variant| match variant.discs {
    false => include_str!("../../../shaders/no_triangles.inc.wgsl"),
    true => include_str!("../../../shaders/triangles.inc.wgsl"),
};
/// Hardware's own points are not counted.
const NO_COUNTS: Shared = shared!("no_counts");
/// What the geometry stages count.
const COUNTS: Shared = |variant| match variant.counts {
    false => include_str!("../../../shaders/no_counts.inc.wgsl"),
    true => include_str!("../../../shaders/counts.inc.wgsl"),
};
/// The lengths of sequential point trees.
const STEPS: Shared = shared!("steps");
/// The targets of `closest` quality.
const KEYS: Shared =
    |variant| if variant.keys { include_str!("../../../shaders/keys.inc.wgsl") } else { DEPTHS(variant) };
/// Depths alone.
const DEPTHS: Shared = shared!("depths");
/// Early-z's look at a pixel.
const LOOK: Shared = |variant| match (variant.plain_looks, variant.keys) {
    (false, _) => include_str!("../../../shaders/atomic_look.inc.wgsl"),
    (true, true) => include_str!("../../../shaders/plain_look_keys.inc.wgsl"),
    (true, false) => LOOK_DEPTHS(variant),
};
/// The same at depths alone.
const LOOK_DEPTHS: Shared = |variant| match variant.plain_looks {
    false => include_str!("../../../shaders/atomic_look.inc.wgsl"),
    true => include_str!("../../../shaders/plain_look_depths.inc.wgsl"),
};
/// What threads of a subgroup tell each other, and the same without subgroups.
const SUBGROUP: Shared = shared!("subgroup");
const SUBGROUP_EMULATED: Shared = shared!("subgroup_emulated");
/// Depths in 40-bit integers.
const DEPTHS40: Shared = shared!("fixed40");
/// The tiles that the steps of `resolve` work on.
const TILES: Shared = shared!("tiles");
/// Which points count for a pixel's color, and their sums in four u32.
const SUMS: Shared = shared!("sums");
/// The points' colors.
const COLORS: Shared = |variant| match variant.discs {
    false => include_str!("../../../shaders/node_colors.inc.wgsl"),
    true => include_str!("../../../shaders/disc_colors.inc.wgsl"),
};
/// How far points reach.
const FILL: Shared = shared!("fill");
/// The walk over the pixels of a tile.
const SURFACE: Shared = shared!("surface");
/// Ids to colors.
const CHUNK_COLORS: Shared = shared!("chunk_colors");
/// The rule of dilation.
const DILATION: Shared = shared!("dilation");
/// A pixel's depth and color before gaps are closed: as `shade` left them, or from the sums of `hqs` quality.
const KEPT_SURFACE: Shared = shared!("kept_surface");
const BLENDED_SURFACE: Shared = shared!("blended_surface");
/// Finished pixels.
const IMAGE: Shared = shared!("image");
/// Means of color channels.
const MEAN: Shared = shared!("mean");
/// Stored colors to linear light.
const SRGB: Shared = shared!("srgb");
/// What overlays share.
const OVERLAYS: Shared = shared!("overlay");

/// A shader's text.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// Its name, as the file's.
    pub name: &'static str,
    /// Names of the resources that it may bind.
    pub names: fn() -> Vec<&'static str>,
    /// What it shares with others.
    shared: &'static [Shared],
    /// Its own text.
    text: &'static str,
}

/// A shader that binds resources of a set.
#[derive(Debug)]
pub struct Of<S> {
    shader: Shader,
    set: PhantomData<S>,
}

impl<S> Clone for Of<S> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S> Copy for Of<S> {}

impl<S> Of<S> {
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
        let shared: String = self.shared.iter().map(|shared| shared(variant)).collect();
        format!("{}{LAYOUT}{shared}{}", layout::prelude(variant), self.text)
    }
}

macro_rules! shaders {
    ($($(#[$about:meta])* $shader:ident: $set:ty = $name:literal, $file:literal, $shared:expr;)+) => {
        $(
            #[doc = concat!("`shaders/", $file, ".wgsl`")]
            pub const $shader: Of<$set> = Of {
                shader: Shader {
                    name: $name,
                    names: <$set>::names,
                    shared: $shared,
                    text: include_str!(concat!("../../../shaders/", $file, ".wgsl")),
                },
                set: PhantomData,
            };
        )+

        /// Every shader of the frame, in its order; then the overlays' and those of other methods.
        pub const SHADERS: [Shader; [$($name),+].len()] = [$($shader.shader),+];
    };
}

shaders! {
    CLEAR: Clear = "clear", "clear", &[];
    LOD: Cloud = "lod", "lod", &[SIZES];
    CULL: (Cloud, Chunk) = "cull", "cull", &[SIZES, STEPS, FILL];
    DEPTH: Geometry = "depth", "depth",
        &[POINTS, CHOICE, RINGS, FILL, LOOP, WIDE, TRIANGLES, COUNTS, KEYS, LOOK];
    DEPTH32: Geometry = "depth32", "depth",
        &[POINTS, CHOICE, RINGS, FILL, LOOP, WIDE, TRIANGLES, COUNTS, DEPTHS, LOOK_DEPTHS];
    IDS: Geometry = "ids", "ids", &[POINTS, CHOICE, RINGS, FILL, LOOP, WIDE, TRIANGLES, COUNTS];
    COLOR: Geometry = "color", "color",
        &[POINTS, CHOICE, RINGS, FILL, LOOP, WIDE, TRIANGLES, COUNTS, SUMS, COLORS];
    COLOR32: Geometry = "color32", "color32",
        &[POINTS, CHOICE, RINGS, FILL, LOOP, WIDE, TRIANGLES, COUNTS, SUMS, COLORS];
    SHADE: (Chunk, Eye) = "shade", "shade", &[TILES, SURFACE, CHUNK_COLORS];
    BLEND: Eye = "blend", "blend", &[TILES, SURFACE, MEAN, BLENDED_SURFACE];
    DILATE: Eye = "dilate", "dilate", &[TILES, RINGS, DILATION, MEAN, KEPT_SURFACE, IMAGE];
    BLEND_DILATE: Eye = "blend-dilate", "dilate", &[TILES, RINGS, DILATION, MEAN, BLENDED_SURFACE, IMAGE];
    SHOW: Eye = "show", "show", &[TILES, KEPT_SURFACE, IMAGE];
    DEPTH_IMAGE: Eye = "depth-image", "depth-image", &[];
    OVERLAY: (Cloud, Overlay) = "overlay", "overlay", &[RINGS, DILATION, SRGB, OVERLAYS];
    BOXES: (Cloud, Overlay) = "boxes", "boxes", &[RINGS, DILATION, SRGB, OVERLAYS];
    JUST_SET: Geometry = "just-set", "methods/just_set",
        &[POINTS, CHOICE, RINGS, FILL, LOOP, WIDE, TRIANGLES, COUNTS, KEYS];
    BUSY_LOOP: Geometry = "busy-loop", "methods/busy_loop",
        &[POINTS, CHOICE, RINGS, FILL, LOOP, WIDE, TRIANGLES, COUNTS];
    EXCHANGE_LOOP: Geometry = "exchange-loop", "methods/exchange_loop",
        &[POINTS, CHOICE, RINGS, FILL, LOOP, WIDE, TRIANGLES, COUNTS, KEYS];
    ATOMIC_MIN: Geometry = "atomic-min", "methods/atomic_min",
        &[POINTS, CHOICE, RINGS, FILL, LOOP, WIDE, TRIANGLES, COUNTS, KEYS];
    REDUCE: Geometry = "reduce", "methods/reduce",
        &[POINTS, CHOICE, RINGS, FILL, LOOP, WIDE, TRIANGLES, COUNTS, KEYS, LOOK, SUBGROUP];
    REDUCE_EMULATED: Geometry = "reduce-emulated", "methods/reduce",
        &[POINTS, CHOICE, RINGS, FILL, LOOP, WIDE, TRIANGLES, COUNTS, KEYS, LOOK, SUBGROUP_EMULATED];
    DEDUP: Geometry = "dedup", "methods/dedup",
        &[POINTS, CHOICE, RINGS, FILL, LOOP, WIDE, TRIANGLES, COUNTS, KEYS, LOOK, SUBGROUP];
    DEDUP_EMULATED: Geometry = "dedup-emulated", "methods/dedup",
        &[POINTS, CHOICE, RINGS, FILL, LOOP, WIDE, TRIANGLES, COUNTS, KEYS, LOOK, SUBGROUP_EMULATED];
    FIXED40: Geometry = "fixed40", "methods/fixed40",
        &[POINTS, CHOICE, RINGS, FILL, LOOP, WIDE, TRIANGLES, COUNTS, KEYS, COLORS, DEPTHS40];
    SHADE40: Eye = "shade40", "methods/shade40", &[TILES, SURFACE, DEPTHS40];
    POINT_LIST: (Cloud, Chunk) = "point-list", "methods/point_list", &[POINTS, CHOICE, NO_COUNTS];
    SHADE_POINTS: ((Chunk, Eye), PointImage) = "shade-points", "methods/shade_points",
        &[TILES, SURFACE, CHUNK_COLORS];
    COLOR_PAIRS: Geometry = "color-pairs", "methods/color_pairs",
        &[POINTS, CHOICE, RINGS, FILL, LOOP, WIDE, TRIANGLES, COUNTS, SUMS, COLORS];
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

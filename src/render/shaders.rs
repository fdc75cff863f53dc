//! The shaders' final texts: prelude of host constants, shared structs, the file itself.

use crate::layout::{self, Variant};

/// Structs shared with the host.
const LAYOUT: &str = include_str!("../../shaders/layout.inc.wgsl");
/// The geometry stages' loop over points.
const POINTS: &str = include_str!("../../shaders/points.inc.wgsl");
/// The targets of `closest` quality.
const KEYS: &str = include_str!("../../shaders/keys.inc.wgsl");
/// What threads of a subgroup tell each other, and the same without subgroups.
const SUBGROUP: &str = include_str!("../../shaders/subgroup.inc.wgsl");
const SUBGROUP_EMULATED: &str = include_str!("../../shaders/subgroup_emulated.inc.wgsl");
/// Depths in 40-bit integers.
const FIXED40: &str = include_str!("../../shaders/fixed40.inc.wgsl");
/// The tiles that the steps of `resolve` work on.
const TILES: &str = include_str!("../../shaders/tiles.inc.wgsl");
/// Which points count for a pixel's color, and their sums in four u32.
const SUMS: &str = include_str!("../../shaders/sums.inc.wgsl");
/// The walk over the pixels of a tile.
const SURFACE: &str = include_str!("../../shaders/surface.inc.wgsl");
/// The rule of dilation.
const DILATION: &str = include_str!("../../shaders/dilation.inc.wgsl");

/// Stored colors to linear light.
const SRGB: &str = include_str!("../../shaders/srgb.inc.wgsl");
/// What overlays share.
const OVERLAY: &str = include_str!("../../shaders/overlay.inc.wgsl");

/// A shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shader {
    /// Its name, as the file's.
    pub name: &'static str,
    /// What it shares with others.
    shared: &'static [&'static str],
    /// Its own text.
    text: &'static str,
}

macro_rules! shader {
    ($name:literal, $shared:expr) => {
        shader!($name, $name, $shared)
    };
    ($name:literal, $file:literal, $shared:expr) => {
        Shader { name: $name, shared: $shared, text: include_str!(concat!("../../shaders/", $file, ".wgsl")) }
    };
}

/// Every shader of the frame, in its order; then the overlays' and those of other methods.
pub const SHADERS: [Shader; 25] = [
    shader!("clear", &[]),
    shader!("lod", &[]),
    shader!("cull", &[]),
    shader!("depth", &[POINTS, KEYS]),
    shader!("depth32", &[POINTS]),
    shader!("ids", &[POINTS]),
    shader!("color", &[POINTS, SUMS]),
    shader!("color32", &[POINTS, SUMS]),
    shader!("shade", &[TILES, SURFACE]),
    shader!("blend", &[TILES, SURFACE]),
    shader!("dilate", &[TILES, DILATION]),
    shader!("resolve", &[SRGB]),
    shader!("overlay", &[DILATION, SRGB, OVERLAY]),
    shader!("boxes", &[DILATION, SRGB, OVERLAY]),
    shader!("just-set", "methods/just_set", &[POINTS, KEYS]),
    shader!("busy-loop", "methods/busy_loop", &[POINTS, KEYS]),
    shader!("atomic-min", "methods/atomic_min", &[POINTS, KEYS]),
    shader!("reduce", "methods/reduce", &[POINTS, KEYS, SUBGROUP]),
    shader!("reduce-emulated", "methods/reduce", &[POINTS, KEYS, SUBGROUP_EMULATED]),
    shader!("dedup", "methods/dedup", &[POINTS, KEYS, SUBGROUP]),
    shader!("dedup-emulated", "methods/dedup", &[POINTS, KEYS, SUBGROUP_EMULATED]),
    shader!("count", "methods/count", &[POINTS, KEYS]),
    shader!("fixed40", "methods/fixed40", &[POINTS, KEYS, FIXED40]),
    shader!("shade40", "methods/shade40", &[TILES, SURFACE, FIXED40]),
    shader!("color-pairs", "methods/color_pairs", &[POINTS, SUMS]),
];

/// The WGSL of shader `name`, as the driver gets it.
///
/// # Panics
/// If there is no such shader: names are written in our own code only.
#[must_use]
pub fn source(name: &str, variant: Variant) -> String {
    let Some(shader) = SHADERS.iter().find(|s| s.name == name) else { panic!("no shader called {name}") };
    format!("{}{LAYOUT}{}{}", layout::prelude(variant), shader.shared.concat(), shader.text)
}

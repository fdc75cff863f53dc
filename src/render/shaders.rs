//! The shaders' final texts: prelude of host constants, shared structs, the file itself.

use crate::layout::{self, Variant};

/// Structs shared with the host.
const LAYOUT: &str = include_str!("../../shaders/layout.inc.wgsl");
/// The geometry stages' loop over points.
const POINTS: &str = include_str!("../../shaders/points.inc.wgsl");
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
        Shader { name: $name, shared: $shared, text: include_str!(concat!("../../shaders/", $name, ".wgsl")) }
    };
}

/// Every shader of the frame, in its order; then the overlays'.
pub const SHADERS: [Shader; 14] = [
    shader!("clear", &[]),
    shader!("lod", &[]),
    shader!("cull", &[]),
    shader!("depth", &[POINTS]),
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

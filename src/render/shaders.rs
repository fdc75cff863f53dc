//! The shaders' final texts: prelude of host constants, shared structs, the file itself.

use crate::layout::{self, Variant};

/// Structs shared with the host.
const LAYOUT: &str = include_str!("../../shaders/layout.inc.wgsl");
/// The geometry stages' loop over points.
const POINTS: &str = include_str!("../../shaders/points.inc.wgsl");

/// A shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shader {
    /// Its name, as the file's.
    pub name: &'static str,
    /// Its own text.
    text: &'static str,
    /// True for those that go through the points.
    is_geometry: bool,
}

macro_rules! shader {
    ($name:literal, $is_geometry:literal) => {
        Shader {
            name: $name,
            text: include_str!(concat!("../../shaders/", $name, ".wgsl")),
            is_geometry: $is_geometry,
        }
    };
}

/// Every shader of the frame, in its order.
pub const SHADERS: [Shader; 11] = [
    shader!("clear", false),
    shader!("lod", false),
    shader!("cull", false),
    shader!("depth", true),
    shader!("depth32", true),
    shader!("ids", true),
    shader!("color", true),
    shader!("color32", true),
    shader!("shade", false),
    shader!("blend", false),
    shader!("resolve", false),
];

/// The WGSL of shader `name`, as the driver gets it.
///
/// # Panics
/// If there is no such shader: names are written in our own code only.
#[must_use]
pub fn source(name: &str, variant: Variant) -> String {
    let Some(shader) = SHADERS.iter().find(|s| s.name == name) else { panic!("no shader called {name}") };
    let points = if shader.is_geometry { POINTS } else { "" };
    format!("{}{LAYOUT}{points}{}", layout::prelude(variant), shader.text)
}

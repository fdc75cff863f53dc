//! The shaders' final texts: prelude of host constants, shared structs, the stage's own file.

use crate::layout;

/// Structs shared with the host.
const LAYOUT: &str = include_str!("../../shaders/layout.inc.wgsl");

/// Every stage's shader, in the frame's order: name and text.
pub const SHADERS: [(&str, &str); 5] = [
    ("clear", include_str!("../../shaders/clear.wgsl")),
    ("cull", include_str!("../../shaders/cull.wgsl")),
    ("depth", include_str!("../../shaders/depth.wgsl")),
    (
        "dilate",
        concat!(include_str!("../../shaders/dilation.inc.wgsl"), include_str!("../../shaders/dilate.wgsl")),
    ),
    ("resolve", include_str!("../../shaders/resolve.wgsl")),
];

/// The WGSL of stage `name` for frames of `num_eyes` eyes, as the driver gets it.
///
/// # Panics
/// If there is no such stage: names are written in our own code only.
#[must_use]
pub fn source(name: &str, num_eyes: u32) -> String {
    let Some((_, text)) = SHADERS.iter().find(|(n, _)| *n == name) else { panic!("no shader called {name}") };
    format!("{}{LAYOUT}{text}", layout::prelude(num_eyes))
}

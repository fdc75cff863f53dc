//! The shaders' final texts: prelude of host constants, shared structs, the file itself.

use crate::layout::{self, Variant};

/// Structs shared with the host.
const LAYOUT: &str = include_str!("../../shaders/layout.inc.wgsl");
/// The geometry stages' loop over points, and triangles where there may be some.
const POINTS: Shared = Shared {
    nodes: concat!(
        include_str!("../../shaders/points.inc.wgsl"),
        include_str!("../../shaders/no_triangles.inc.wgsl")
    ),
    discs: concat!(
        include_str!("../../shaders/points.inc.wgsl"),
        include_str!("../../shaders/triangles.inc.wgsl")
    ),
};
/// Which points it draws, and how large.
const CHOICE: Shared = Shared {
    nodes: include_str!("../../shaders/nodes.inc.wgsl"),
    discs: concat!(
        include_str!("../../shaders/steps.inc.wgsl"),
        include_str!("../../shaders/discs.inc.wgsl")
    ),
};
/// The lengths of sequential point trees.
const STEPS: Shared = both(include_str!("../../shaders/steps.inc.wgsl"));
/// The targets of `closest` quality.
const KEYS: Shared = both(include_str!("../../shaders/keys.inc.wgsl"));
/// What threads of a subgroup tell each other, and the same without subgroups.
const SUBGROUP: Shared = both(include_str!("../../shaders/subgroup.inc.wgsl"));
const SUBGROUP_EMULATED: Shared = both(include_str!("../../shaders/subgroup_emulated.inc.wgsl"));
/// Depths in 40-bit integers.
const FIXED40: Shared = both(include_str!("../../shaders/fixed40.inc.wgsl"));
/// The tiles that the steps of `resolve` work on.
const TILES: Shared = both(include_str!("../../shaders/tiles.inc.wgsl"));
/// Which points count for a pixel's color, and their sums in four u32.
const SUMS: Shared = both(include_str!("../../shaders/sums.inc.wgsl"));
/// The points' colors.
const COLORS: Shared = Shared {
    nodes: include_str!("../../shaders/node_colors.inc.wgsl"),
    discs: include_str!("../../shaders/disc_colors.inc.wgsl"),
};
/// The walk over the pixels of a tile.
const SURFACE: Shared = both(include_str!("../../shaders/surface.inc.wgsl"));
/// The rule of dilation.
const DILATION: Shared = both(include_str!("../../shaders/dilation.inc.wgsl"));
/// Stored colors to linear light.
const SRGB: Shared = both(include_str!("../../shaders/srgb.inc.wgsl"));
/// What overlays share.
const OVERLAY: Shared = both(include_str!("../../shaders/overlay.inc.wgsl"));

/// What several shaders have in common: in a frame of points, and in one of discs ([`Variant::discs`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shared {
    nodes: &'static str,
    discs: &'static str,
}

const fn both(text: &'static str) -> Shared {
    Shared { nodes: text, discs: text }
}

/// A shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shader {
    /// Its name, as the file's.
    pub name: &'static str,
    /// What it shares with others.
    shared: &'static [Shared],
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
    shader!("cull", &[STEPS]),
    shader!("depth", &[POINTS, CHOICE, KEYS]),
    shader!("depth32", &[POINTS, CHOICE]),
    shader!("ids", &[POINTS, CHOICE]),
    shader!("color", &[POINTS, CHOICE, SUMS, COLORS]),
    shader!("color32", &[POINTS, CHOICE, SUMS, COLORS]),
    shader!("shade", &[TILES, SURFACE]),
    shader!("blend", &[TILES, SURFACE]),
    shader!("dilate", &[TILES, DILATION]),
    shader!("resolve", &[SRGB]),
    shader!("overlay", &[DILATION, SRGB, OVERLAY]),
    shader!("boxes", &[DILATION, SRGB, OVERLAY]),
    shader!("just-set", "methods/just_set", &[POINTS, CHOICE, KEYS]),
    shader!("busy-loop", "methods/busy_loop", &[POINTS, CHOICE, KEYS]),
    shader!("atomic-min", "methods/atomic_min", &[POINTS, CHOICE, KEYS]),
    shader!("reduce", "methods/reduce", &[POINTS, CHOICE, KEYS, SUBGROUP]),
    shader!("reduce-emulated", "methods/reduce", &[POINTS, CHOICE, KEYS, SUBGROUP_EMULATED]),
    shader!("dedup", "methods/dedup", &[POINTS, CHOICE, KEYS, SUBGROUP]),
    shader!("dedup-emulated", "methods/dedup", &[POINTS, CHOICE, KEYS, SUBGROUP_EMULATED]),
    shader!("count", "methods/count", &[POINTS, CHOICE, KEYS]),
    shader!("fixed40", "methods/fixed40", &[POINTS, CHOICE, KEYS, COLORS, FIXED40]),
    shader!("shade40", "methods/shade40", &[TILES, SURFACE, FIXED40]),
    shader!("color-pairs", "methods/color_pairs", &[POINTS, CHOICE, SUMS, COLORS]),
];

/// The WGSL of shader `name`, as the driver gets it.
///
/// # Panics
/// If there is no such shader: names are written in our own code only.
#[must_use]
pub fn source(name: &str, variant: Variant) -> String {
    let Some(shader) = SHADERS.iter().find(|s| s.name == name) else { panic!("no shader called {name}") };
    let form = |shared: &Shared| if variant.discs { shared.discs } else { shared.nodes };
    let shared: String = shader.shared.iter().map(form).collect();
    format!("{}{LAYOUT}{shared}{}", layout::prelude(variant), shader.text)
}

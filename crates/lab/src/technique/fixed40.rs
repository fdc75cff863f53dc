//! The method `fixed40`: depths in 40-bit integers from f64, with the color below them, and a step of `resolve` that
//! clears what it has read [2019 §2.1].

use super::texts::text;
use render::Access;
use render::Parts;
use render::bindings::{EyeSet, GeometrySet};
use render::gpu::Gpu;
use render::gpu::stage::{ShaderError, Stage};
use render::layout::{EMPTY_KEY, Variant};
use render::shaders::{self, ShaderOfSet, parts};
use render::technique::{ClearedTarget, Nearest, Pieces, Recording};
use std::cell::Cell;
use std::sync::LazyLock;

/// Ranges of the 40-bit depth: where each begins, in world units, and its steps per unit. Where the unit is the meter,
/// a step is a nanometer up to 10 m, a micrometer up to 10 km, then a millimeter [2019 §2.1].
pub const RANGES: [(f64, f64); 3] = [(0.0, 1e9), (10.0, 1e6), (10_000.0, 1e3)];
/// A depth that no point has reached.
pub const EMPTY40: u64 = (1 << 40) - 1;
/// Bit of a key at which the depth begins, above a color without alpha.
pub const DEPTH40_SHIFT: u32 = 24;

/// The first depths of the ranges of [`RANGES`].
#[must_use]
pub fn firsts() -> [u64; 3] {
    let [(a, per_a), (b, per_b), (c, _)] = RANGES;
    let second = ((b - a) * per_a) as u64;
    [0, second, second + ((c - b) * per_b) as u64]
}

/// WGSL constants for this method's shaders alone, since not every GPU supports f64 and u64.
static CONSTANTS: LazyLock<String> = LazyLock::new(|| {
    let names = ["A", "B", "C"].into_iter().zip(RANGES).zip(firsts());
    let lines = names.map(|((name, (begin, steps)), first)| {
        format!(
            "const RANGE_{name}_BEGIN: f64 = {begin:?}lf;\n\
             const RANGE_{name}_STEPS: f64 = {steps:?}lf;\n\
             const RANGE_{name}_FIRST: u64 = {first}lu;\n"
        )
    });
    let others = format!(
        "const EMPTY40: u64 = {EMPTY40}lu;\n\
         const EMPTY_KEY: u64 = {EMPTY_KEY}lu;\n\
         const DEPTH40_SHIFT: u32 = {DEPTH40_SHIFT}u;\n"
    );
    lines.chain([others]).collect()
});

const HAS_TRIANGLES: &str = "const HAS_TRIANGLES: bool = true;\n";
const HAS_NO_TRIANGLES: &str = "const HAS_TRIANGLES: bool = false;\n";

static OF_NODES: LazyLock<[&str; 6]> = LazyLock::new(|| {
    [
        &CONSTANTS,
        HAS_NO_TRIANGLES,
        text!("keys.inc"),
        text!("node_colors.inc"),
        text!("methods/fixed40.inc"),
        text!("methods/fixed40"),
    ]
});
static OF_TREE: LazyLock<[&str; 6]> = LazyLock::new(|| {
    [
        &CONSTANTS,
        HAS_TRIANGLES,
        text!("keys.inc"),
        text!("spt/colors.inc"),
        text!("methods/fixed40.inc"),
        text!("methods/fixed40"),
    ]
});
static SHADE: LazyLock<[&str; 3]> =
    LazyLock::new(|| [&CONSTANTS, text!("methods/fixed40.inc"), text!("methods/shade40")]);

/// Shader pieces of `depth`, for nodes or for a point tree.
pub(super) fn depth(is_tree: bool) -> fn(Variant) -> Pieces {
    if is_tree { |_| &*OF_TREE } else { |_| &*OF_NODES }
}

render::sets! {
    /// The target of [`SHADE40`].
    Keys40Set, OfKeys40 {
        /// An eye's depths and colors.
        keys40,
    }
}

/// The step of `resolve` that turns keys into colors and clears the keys.
pub const SHADE40: ShaderOfSet<(EyeSet, Keys40Set)> =
    ShaderOfSet::new("shade40", &[parts::SURFACE], |_| &*SHADE);

/// The method's stages.
#[derive(Debug)]
pub(super) struct Fixed40 {
    depth: Stage<GeometrySet>,
    shade: Stage<(EyeSet, Keys40Set)>,
    /// Bind groups of `depth`, one per chunk.
    depth_groups: Vec<wgpu::BindGroup>,
    /// Bind groups of `shade`, one per eye, with the number of its tiles.
    shade_groups: Vec<(wgpu::BindGroup, u32)>,
    /// True if `shade` has not cleared the keys yet.
    keys_are_new: Cell<bool>,
}

impl Fixed40 {
    pub fn new(gpu: &Gpu, variant: Variant, access: Access, others: &[&str]) -> Result<Self, ShaderError> {
        Ok(Self {
            depth: Stage::of(gpu, shaders::DEPTH, variant, access, others)?,
            shade: Stage::of(gpu, SHADE40, variant, access, others)?,
            depth_groups: vec![],
            shade_groups: vec![],
            keys_are_new: Cell::new(true),
        })
    }
}

impl Nearest for Fixed40 {
    fn cleared_targets(&self) -> &'static [ClearedTarget] {
        // `shade` clears the keys.
        &[ClearedTarget::Counters]
    }

    fn bind(&mut self, parts: &Parts<'_>) {
        self.depth_groups = parts.bind_geometry(&self.depth);
        let eyes = 0..parts.targets.sizes_px.len();
        let shade = |eye: usize| {
            let keys = OfKeys40 { keys40: parts.targets.keys[eye].as_entire_binding() };
            (self.shade.bind(parts.gpu, &(parts.of_eye(eye), keys)), parts.num_tiles(eye))
        };
        self.shade_groups = eyes.map(shade).collect();
        self.keys_are_new.set(true);
    }

    fn record_depth(&self, encoder: &mut wgpu::CommandEncoder, recording: &Recording<'_>) {
        if self.keys_are_new.take() {
            // What it makes of other keys, the frame's own step overwrites.
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            for (group, num_tiles) in &self.shade_groups {
                self.shade.dispatch(&mut pass, group, *num_tiles);
            }
        }
        let mut pass = recording.compute_pass(encoder);
        self.depth.dispatch_visible(&mut pass, &self.depth_groups, recording.counters);
    }

    fn record_shade(&self, pass: &mut wgpu::ComputePass<'_>, eye: usize, num_tiles: u32) {
        self.shade.dispatch(pass, &self.shade_groups[eye].0, num_tiles);
    }
}

//! Settings: the defaults here, then `--preset NAME`, then `--config FILE`, then `--set KEY=VALUE`, then the
//! command's own options.
//!
//! `config/default.toml` shows every key with its default and a comment; a test says that it equals
//! [`Config::default`]. Unknown keys and wrong types are refused with the line and the nearest valid key.

mod assign;
mod check;
mod load;
mod presets;

pub use assign::Place;
pub use load::{ConfigError, load};
pub use presets::{PRESETS, Preset};

use cloud::Order;
use lab::technique::{EarlyZLoad, Method};
use points::{Project, Unit, Up};
use render::options::{Dilate, Overlay, Precision, Quality, Tier};
use serde::{Deserialize, Serialize};

/// Everything that can be set.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct Config {
    /// The GPU.
    pub gpu: GpuConfig,
    /// Loading.
    pub cloud: CloudConfig,
    /// The frame's stages.
    pub frame: FrameConfig,
    /// Where the eye looks, and how far out it wants how much.
    pub fovea: FoveaConfig,
    /// Level of detail.
    pub lod: LodConfig,
    /// What keeps the frame within its budget.
    pub governor: GovernorConfig,
    /// Real headsets.
    pub headset: HeadsetConfig,
    /// The headset that stands in where there is none.
    pub simulated: SimulatedConfig,
    /// Getting about.
    pub locomotion: LocomotionConfig,
    /// The desktop window.
    pub window: WindowConfig,
}

impl Config {
    /// All settings as TOML.
    #[must_use]
    pub fn to_table(&self) -> toml::Table {
        // Sections of numbers, texts and lists: none of the things that TOML cannot say.
        toml::Table::try_from(self).expect("a configuration is TOML")
    }

    /// Every valid key, dotted: `frame.near_m`.
    #[must_use]
    pub fn keys() -> Vec<String> {
        let sections = Self::default().to_table();
        let keys = |(section, keys): (String, toml::Value)| match keys {
            toml::Value::Table(keys) => keys.into_iter().map(|(key, _)| format!("{section}.{key}")).collect(),
            _ => vec![section],
        };
        sections.into_iter().flat_map(keys).collect()
    }

    /// 16 hexadecimal digits that differ where two configurations do: FNV-1a of the settings as TOML.
    #[must_use]
    pub fn digest(&self) -> String {
        let fnv = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        let hash = self.to_table().to_string().bytes().fold(0xcbf2_9ce4_8422_2325, fnv);
        format!("{hash:016x}")
    }
}

/// `[gpu]`
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct GpuConfig {
    /// Part of the GPU's name, any case; empty: the fastest kind. A headset's runtime chooses its own.
    pub adapter: String,
    /// Largest part of the point pool in MiB that one binding holds; 0: what the GPU allows.
    pub chunk_mib: u32,
    /// Which atomics the stages use; all draw the same picture.
    pub tier: Tier,
    /// How early-z loads the pixel that it looks at; the picture is the same.
    pub early_z_load: EarlyZLoad,
    /// Shaders check every index besides, to find faults: slower, the same picture. Debug builds always do.
    pub bounds_checks: bool,
}

/// `[cloud]`
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct CloudConfig {
    /// Order of the points in memory.
    pub order: Order,
    /// Axis of the files that points up.
    pub up: Up,
    /// Whether a file that cannot be read, or of which a part cannot, is an error although the rest can.
    pub strict: bool,
    /// Unit of the files' lengths.
    pub unit: Unit,
    /// Unit of the files' heights, where it is another.
    pub vertical_unit: Unit,
    /// Which files lie on the earth.
    pub project: Project,
    /// Draw points that files say are withheld.
    pub show_withheld: bool,
}

/// `[frame]`
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct FrameConfig {
    /// Points nearer than this are not drawn; metres in a headset, world units in a picture, where the default
    /// shrinks with scenes that it would cut.
    pub near_m: f64,
    /// Colour where no point is: red, green, blue, 0–255.
    pub background: [u8; 3],
    /// `auto`: coordinate bits by projected size; `full`: always 30.
    pub precision: Precision,
    /// How points get into pixels.
    pub method: Method,
    /// Leave out what neither eye sees; off: every point is read, to measure what that costs.
    pub cull: bool,
    /// What a pixel shows of the points in it.
    pub quality: Quality,
    /// How gaps between points are filled.
    pub dilate: Dilate,
    /// Where even the finest points lie further apart than `dilate` reaches, it reaches further, and then points are larger.
    pub fill: bool,
}

impl Default for FrameConfig {
    fn default() -> Self {
        Self {
            near_m: 0.05,
            background: [0, 0, 0],
            precision: Precision::Auto,
            method: Method::Prefetch,
            cull: true,
            quality: Quality::Hqs,
            dilate: Dilate::Rings,
            fill: true,
        }
    }
}

/// `[fovea]`: one fovea, in degrees from the gaze, for level of detail and dilation (docs/FRAME.md §4).
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct FoveaConfig {
    /// Where the inner and the middle ring end.
    pub ring_deg: [f64; 2],
    /// Thresholds grow smoothly from ring to ring.
    pub smooth: bool,
}

impl Default for FoveaConfig {
    fn default() -> Self {
        Self { ring_deg: [20.0, 38.0], smooth: false }
    }
}

/// `[lod]`
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct LodConfig {
    /// Draw what matters; off: every point, always.
    pub enabled: bool,
    /// What is built to tell what matters.
    pub method: LodMethod,
    /// Of an octree: a node is drawn if its projected edge has this many pixels: inner, middle, outer ring.
    pub threshold_px: [f64; 3],
    /// Of an octree: points of a node appear one by one rather than all at once.
    pub fade: bool,
    /// Of a sequential point tree: a disc may be wrong by this many pixels.
    pub error_px: f64,
    /// Of a sequential point tree: discs that show the eye their backs, by the files' normals, are not read.
    pub cull_backfaces: bool,
}

/// What level of detail goes by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LodMethod {
    /// A layered octree: nodes by their projected size.
    #[default]
    Octree,
    /// A sequential point tree: discs by their projected error.
    Spt,
}

impl Default for LodConfig {
    fn default() -> Self {
        Self {
            enabled: true,
            method: LodMethod::Octree,
            threshold_px: [100.0, 200.0, 300.0],
            fade: true,
            error_px: lab::technique::DEFAULT_ERROR_PX,
            cull_backfaces: false,
        }
    }
}

/// `[governor]`
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct GovernorConfig {
    /// Trade quality for time when frames take too long.
    pub enabled: bool,
    /// Share of the display period that the GPU may use; the runtime's compositor needs the rest.
    pub budget: f64,
}

impl Default for GovernorConfig {
    fn default() -> Self {
        Self { enabled: true, budget: 0.8 }
    }
}

/// `[headset]`
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct HeadsetConfig {
    /// Factor on the width and height that the runtime recommends.
    pub resolution_scale: f64,
    /// Hand depth to the runtime where it takes it, for its reprojection.
    pub depth_layer: bool,
    /// Do not fill pixels that the lenses hide, where the runtime tells which.
    pub visibility_mask: bool,
}

impl Default for HeadsetConfig {
    fn default() -> Self {
        Self { resolution_scale: 1.0, depth_layer: true, visibility_mask: true }
    }
}

/// `[simulated]`
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct SimulatedConfig {
    /// Pixels of each eye's image: width, height.
    pub size_px: [u32; 2],
    /// Half angles of the left eye's field of view in degrees: outwards (left), inwards (right), up, down;
    /// the right eye mirrors it.
    pub fov_deg: [f64; 4],
    /// Distance of the eyes.
    pub eye_distance_m: f64,
    /// Outward turn of each eye's display in degrees.
    pub cant_deg: f64,
    /// Displays a second.
    pub refresh_hz: f64,
    /// Height of the eyes above the floor.
    pub eye_height_m: f64,
}

impl Default for SimulatedConfig {
    fn default() -> Self {
        Self {
            size_px: [960, 1080],
            fov_deg: [45.0, 45.0, 45.0, 45.0],
            eye_distance_m: 0.063,
            cant_deg: 0.0,
            refresh_hz: 90.0,
            eye_height_m: 1.7,
        }
    }
}

/// `[locomotion]`
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct LocomotionConfig {
    /// Metres a second at full stick or key; 0: from the scan's size.
    pub speed: f64,
    /// Factor while the fast key is held.
    pub fast: f64,
    /// Degrees of a snap turn.
    pub snap_deg: f64,
    /// Degrees a pixel of mouse movement.
    pub look_deg_per_px: f64,
}

impl Default for LocomotionConfig {
    fn default() -> Self {
        Self { speed: 0.0, fast: 4.0, snap_deg: 30.0, look_deg_per_px: 0.15 }
    }
}

/// `[window]`
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct WindowConfig {
    /// Size at start: width, height in points.
    pub size: [u32; 2],
    /// Which eye the window mirrors.
    pub mirror: Mirror,
    /// Show the panel at start.
    pub panel: bool,
    /// What is drawn over the mirror at start.
    pub overlay: Overlay,
}

impl Default for WindowConfig {
    fn default() -> Self {
        Self { size: [1280, 720], mirror: Mirror::Left, panel: true, overlay: Overlay::None }
    }
}

/// What the window mirrors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mirror {
    /// The left eye.
    #[default]
    Left,
    /// The right eye.
    Right,
    /// Side by side.
    Both,
}

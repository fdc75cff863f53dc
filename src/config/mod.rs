//! Settings: the defaults of the one table (`table`), then `--preset NAME`, then `--config FILE`, then `--set KEY=VALUE`,
//! then the command's own options.
//!
//! The command line and [`crate::resolve`] alone see them: all others get options of their own. Unknown keys and wrong types
//! are refused with the line and the nearest valid keys.

mod assign;
mod check;
mod kind;
mod load;
mod near;
mod page;
mod presets;
mod setting;
mod table;

pub use assign::Location;
pub use kind::ValueKind;
pub use load::{ConfigError, load, with_preset};
pub use near::NearClip;
pub use page::{FILES, file, page};
pub use presets::{PRESETS, Preset};
pub use setting::{Audience, Section, Setting};
pub use table::{
    CloudConfig, Config, FoveaConfig, FrameConfig, GovernorConfig, GpuConfig, HeadsetConfig,
    LocomotionConfig, LodConfig, SECTIONS, SimulatedConfig, SurroundConfig, WindowConfig,
};

impl Config {
    /// All settings as TOML.
    #[must_use]
    pub fn to_table(&self) -> toml::Table {
        // The sections hold numbers, texts and lists, all of which TOML can express.
        toml::Table::try_from(self).expect("a configuration is TOML")
    }

    /// 16 hexadecimal digits that differ where two configurations do: FNV-1a of the settings as TOML.
    #[must_use]
    pub fn digest(&self) -> String {
        let fnv = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        let hash = self.to_table().to_string().bytes().fold(0xcbf2_9ce4_8422_2325, fnv);
        format!("{hash:016x}")
    }
}

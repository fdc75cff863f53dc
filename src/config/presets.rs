//! Presets: configurations that come with the program, by name. They are files below `config/`, like those that users
//! write.

use super::ConfigError;
use super::assign::{Assignment, in_file};
use std::path::Path;

/// Settings under a name.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// What `--preset` calls it.
    pub name: &'static str,
    /// Settings as TOML.
    pub text: &'static str,
}

impl Preset {
    /// What it is for: the first sentence of its file, behind the name.
    #[must_use]
    pub fn meaning(&self) -> String {
        let comment = self.text.lines().map_while(|line| line.strip_prefix('#'));
        let words: Vec<_> = comment.flat_map(str::split_whitespace).collect();
        let about = words.join(" ");
        let meaning = about.split_once(": ").map_or(about.as_str(), |(_, meaning)| meaning);
        meaning.split(". ").next().unwrap_or_default().trim_end_matches('.').to_owned()
    }
}

/// All presets: how to draw, then which headset to simulate.
pub const PRESETS: [Preset; 7] = [
    Preset { name: "plain", text: include_str!("../../config/plain.toml") },
    Preset { name: "quality", text: include_str!("../../config/quality.toml") },
    Preset { name: "balanced", text: include_str!("../../config/balanced.toml") },
    Preset { name: "performance", text: include_str!("../../config/performance.toml") },
    Preset { name: "valve-index", text: include_str!("../../config/valve-index.toml") },
    Preset { name: "meta-quest-3", text: include_str!("../../config/meta-quest-3.toml") },
    Preset { name: "bigscreen-beyond-2", text: include_str!("../../config/bigscreen-beyond-2.toml") },
];

/// All assignments of the preset called `name`.
pub(super) fn in_preset(name: &str) -> Result<Vec<Assignment>, ConfigError> {
    match PRESETS.iter().find(|preset| preset.name == name) {
        Some(preset) => in_file(Path::new(&format!("preset {name}")), preset.text),
        None => {
            let names = PRESETS.map(|preset| preset.name).join(", ");
            Err(ConfigError::UnknownPreset { name: name.to_owned(), names })
        }
    }
}

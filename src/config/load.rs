//! Reading configuration: assignments of presets, a file and the command line, one after the other, on top of the
//! defaults. Each is checked when it is made, so that every complaint names the line it stems from.

use super::assign::{Assignment, Location, in_file, in_set};
use super::kind::ValueKind;
use super::presets::in_preset;
use super::{Config, Setting, check};
use base::words::advice;
use serde::Deserialize;
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Largest configuration file in bytes: a larger one is refused before it fills the memory.
const MAX_FILE_BYTES: u64 = 1 << 20;

/// Why a configuration was refused.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The file cannot be read at all.
    #[error("the configuration {} cannot be read: {source}{advice}", path.display(), advice = advice(source))]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's words.
        source: io::Error,
    },
    /// The file is not TOML.
    #[error("{place}: this is not TOML: {message}")]
    Syntax {
        /// Place of the error.
        place: Location,
        /// The parser's words.
        message: String,
    },
    /// A `--set` without an equals sign.
    #[error("--set {0}: write it as KEY=VALUE, for example --set frame.near_m=0.1")]
    NoAssignment(String),
    /// A preset that does not exist.
    #[error("--preset {name}: there is no such preset; choose one of {names}")]
    UnknownPreset {
        /// Name as it was written.
        name: String,
        /// Names of all presets.
        names: String,
    },
    /// A key that does not exist.
    #[error("{place}: there is no setting '{key}'; {advice}")]
    UnknownKey {
        /// Place of the key.
        place: Location,
        /// Key as it was written.
        key: String,
        /// What to write instead, or where to look.
        advice: String,
    },
    /// A value of another type than the key wants.
    #[error("{place}: {key} must be {wanted}, not {found}")]
    WrongType {
        /// Place of the value.
        place: Location,
        /// The key.
        key: &'static str,
        /// Kind of value that the key takes.
        wanted: ValueKind,
        /// Kind and text of the value.
        found: String,
    },
    /// A value of the right type that makes no sense.
    #[error("{place}: {key} {problem}")]
    OutOfRange {
        /// Place of the value.
        place: Location,
        /// The key.
        key: &'static str,
        /// A sentence about its value.
        problem: String,
    },
}

impl ConfigError {
    /// True if the configuration is wrong; false if it could not be read.
    #[must_use]
    pub fn is_usage(&self) -> bool {
        !matches!(self, Self::Read { .. })
    }
}

/// Resolves the configuration: the defaults, then each of `presets`, then `file`, then each `KEY=VALUE` of `sets`.
///
/// # Errors
/// An unknown preset, an unreadable file, bad TOML, an unknown key, a wrong type, a value out of its range.
pub fn load(presets: &[String], file: Option<&Path>, sets: &[String]) -> Result<Config, ConfigError> {
    let mut assignments = Vec::new();
    for name in presets {
        assignments.extend(in_preset(name)?);
    }
    if let Some(path) = file {
        assignments.extend(in_file(path, &read(path)?)?);
    }
    for set in sets {
        assignments.push(in_set(set)?);
    }
    let mut resolving = Resolving::defaults();
    for assignment in assignments {
        resolving.apply(assignment)?;
    }
    resolving.finish()
}

/// The same configuration with the settings of a preset.
///
/// # Errors
/// An unknown preset.
pub fn with_preset(config: &Config, name: &str) -> Result<Config, ConfigError> {
    let mut resolving =
        Resolving { table: config.to_table(), config: config.clone(), places: HashMap::new() };
    for assignment in in_preset(name)? {
        resolving.apply(assignment)?;
    }
    resolving.finish()
}

/// Reads the file's text.
fn read(path: &Path) -> Result<String, ConfigError> {
    let fail = |source| ConfigError::Read { path: path.to_owned(), source };
    let mut text = String::new();
    File::open(path).map_err(fail)?.take(MAX_FILE_BYTES + 1).read_to_string(&mut text).map_err(fail)?;
    if text.len() as u64 > MAX_FILE_BYTES {
        return Err(fail(io::Error::other(
            "it is larger than 1 MiB, which no configuration is; name another file",
        )));
    }
    Ok(text)
}

/// The configuration while assignments are made to it.
struct Resolving {
    /// All keys with their values so far.
    table: Table,
    /// The configuration with the values so far, typed.
    config: Config,
    /// Where a key was last assigned.
    places: HashMap<&'static str, Location>,
}

impl Resolving {
    fn defaults() -> Self {
        Self { table: Config::default().to_table(), config: Config::default(), places: HashMap::new() }
    }

    /// Makes one assignment, or says what is wrong with it.
    fn apply(&mut self, assignment: Assignment) -> Result<(), ConfigError> {
        let Assignment { key, value, place } = assignment;
        let Some(setting) = Setting::find(&key) else {
            return Err(ConfigError::UnknownKey { place, advice: Setting::advice(&key), key });
        };
        let found = in_words(&value);
        self.table[setting.section][setting.name] = value;
        let Ok(config) = Config::deserialize(self.table.clone()) else {
            return Err(ConfigError::WrongType { place, key: setting.key, wanted: setting.kind(), found });
        };
        self.config = config;
        self.places.insert(setting.key, place);
        Ok(())
    }

    /// Returns the configuration, if its values make sense.
    fn finish(mut self) -> Result<Config, ConfigError> {
        match check::check(&self.config) {
            Ok(()) => Ok(self.config),
            Err(check::Problem { key, problem }) => {
                let place = self.places.remove(key).unwrap_or(Location::Default);
                Err(ConfigError::OutOfRange { place, key, problem })
            }
        }
    }
}

/// A value's kind and text, for people.
fn in_words(value: &Value) -> String {
    let kind = match value {
        Value::String(_) => "the text ",
        Value::Table(_) => "the section ",
        Value::Array(_) => "the list ",
        Value::Datetime(_) => "the date ",
        Value::Integer(_) | Value::Float(_) | Value::Boolean(_) => "",
    };
    format!("{kind}{value}").replace('\n', " ").trim_end().to_owned()
}

//! Reading configuration: assignments of presets, a file and the command line, one after the other, on top of the
//! defaults. Each is checked when it is made, so that every complaint names the line it stems from.

use super::assign::{Assignment, Place, in_file, in_set};
use super::presets::in_preset;
use super::{Config, check};
use serde::Deserialize;
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// A configuration larger than this is none: it is refused before it fills the memory.
const MAX_FILE_BYTES: u64 = 1 << 20;

/// Why a configuration was refused.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The file cannot be read at all.
    #[error("the configuration {} cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's words.
        source: io::Error,
    },
    /// The file is not TOML.
    #[error("{place}: this is not TOML: {message}")]
    Syntax {
        /// Where.
        place: Place,
        /// The parser's words.
        message: String,
    },
    /// A `--set` without an equals sign.
    #[error("--set {0}: write it as KEY=VALUE, for example --set frame.near_m=0.1")]
    NoAssignment(String),
    /// A preset that does not exist.
    #[error("--preset {name}: there is no such preset; choose one of {names}")]
    UnknownPreset {
        /// As written.
        name: String,
        /// All that there are.
        names: String,
    },
    /// A key that does not exist.
    #[error("{place}: there is no setting '{key}'; did you mean '{nearest}'?")]
    UnknownKey {
        /// Where.
        place: Place,
        /// As written.
        key: String,
        /// The valid key that is spelt most like it.
        nearest: String,
    },
    /// A value of another type than the key wants.
    #[error("{place}: {key} must be {wanted}, not {found}")]
    WrongType {
        /// Where.
        place: Place,
        /// The key.
        key: String,
        /// What it takes, in words.
        wanted: String,
        /// What it got.
        found: String,
    },
    /// A value of the right type that makes no sense.
    #[error("{place}: {key} {problem}")]
    OutOfRange {
        /// Where.
        place: Place,
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

/// The file's text.
fn read(path: &Path) -> Result<String, ConfigError> {
    let fail = |source| ConfigError::Read { path: path.to_owned(), source };
    let mut text = String::new();
    File::open(path).map_err(fail)?.take(MAX_FILE_BYTES + 1).read_to_string(&mut text).map_err(fail)?;
    if text.len() as u64 > MAX_FILE_BYTES {
        return Err(fail(io::Error::other("it is larger than 1 MiB, which no configuration is")));
    }
    Ok(text)
}

/// The configuration while assignments are made to it.
struct Resolving {
    /// All keys with their values so far.
    table: Table,
    /// The same, typed.
    config: Config,
    /// Where a key was last assigned.
    places: HashMap<String, Place>,
}

impl Resolving {
    fn defaults() -> Self {
        Self { table: Config::default().to_table(), config: Config::default(), places: HashMap::new() }
    }

    /// Makes one assignment, or says what is wrong with it.
    fn apply(&mut self, assignment: Assignment) -> Result<(), ConfigError> {
        let Assignment { key, value, place } = assignment;
        let Some(slot) = value_mut(&mut self.table, &key) else {
            return Err(ConfigError::UnknownKey { place, nearest: nearest_key(&key), key });
        };
        let found = in_words(&value);
        let before = std::mem::replace(slot, value);
        match Config::deserialize(self.table.clone()) {
            Ok(config) => self.config = config,
            Err(error) => {
                let wanted = wanted_in_words(&before, error.message());
                return Err(ConfigError::WrongType { place, key, wanted, found });
            }
        }
        self.places.insert(key, place);
        Ok(())
    }

    /// The configuration, if its values make sense.
    fn finish(mut self) -> Result<Config, ConfigError> {
        match check::check(&self.config) {
            Ok(()) => Ok(self.config),
            Err(check::Problem { key, problem }) => {
                let place = self.places.remove(key).unwrap_or(Place::Default);
                Err(ConfigError::OutOfRange { place, key, problem })
            }
        }
    }
}

/// The value of a dotted key; `None` if there is no such key or it is a section.
fn value_mut<'a>(table: &'a mut Table, key: &str) -> Option<&'a mut Value> {
    match key.split_once('.') {
        Some((section, rest)) => value_mut(table.get_mut(section)?.as_table_mut()?, rest),
        None => table.get_mut(key).filter(|value| !value.is_table()),
    }
}

/// The valid key that is spelt most like `key`: as a whole, or by its last word where the section is wrong.
fn nearest_key(key: &str) -> String {
    let word = |key: &str| key.rsplit('.').next().unwrap_or_default().to_owned();
    let distance = |candidate: &String| {
        let whole = strsim::damerau_levenshtein(key, candidate);
        let last = strsim::damerau_levenshtein(&word(key), &word(candidate)) + 1;
        whole.min(last)
    };
    Config::keys().into_iter().min_by_key(distance).unwrap_or_default()
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

/// What a key takes, told by its present (valid) value and, for names, by serde's list of them.
fn wanted_in_words(valid: &Value, message: &str) -> String {
    match valid {
        Value::String(_) => match message.split_once("expected ") {
            Some((_, names)) if names.contains('`') => names.replace('`', "\""),
            _ => "a text in quotes".into(),
        },
        Value::Integer(_) => format!("a whole number from 0 to {}", u32::MAX),
        Value::Float(_) => "a number".into(),
        Value::Boolean(_) => "true or false".into(),
        Value::Array(items) => match items.first() {
            Some(Value::Integer(_)) if message.contains("u8") => {
                format!("a list of {} whole numbers from 0 to 255", items.len())
            }
            Some(Value::Integer(_)) => {
                format!("a list of {} whole numbers from 0 to {}", items.len(), u32::MAX)
            }
            _ => format!("a list of {} numbers", items.len()),
        },
        Value::Table(_) => "a section".into(),
        Value::Datetime(_) => "a date".into(),
    }
}

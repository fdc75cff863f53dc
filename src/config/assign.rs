//! Assignments `section.key = value`, as a file or `--set` makes them, each with its place.

use super::{ConfigError, SECTIONS, Setting};
use serde::Deserialize;
use std::fmt;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue, ValueDeserializer};
use toml::{Spanned, Value};

/// Where a value was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Location {
    /// A line of a file, counted from 1.
    File {
        /// The file.
        path: PathBuf,
        /// The line.
        line: usize,
    },
    /// The text behind a `--set`.
    Set(String),
    /// Nowhere: it is a default.
    Default,
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { path, line } => write!(f, "{}, line {line}", path.display()),
            Self::Set(text) => write!(f, "--set {text}"),
            Self::Default => f.write_str("the defaults"),
        }
    }
}

/// One key gets one value.
#[derive(Debug)]
pub(super) struct Assignment {
    /// Dotted key.
    pub key: String,
    /// Value, not yet checked.
    pub value: Value,
    /// Where it was written.
    pub place: Location,
}

/// All assignments of a file.
pub(super) fn in_file(path: &Path, text: &str) -> Result<Vec<Assignment>, ConfigError> {
    let place = |start: usize| {
        let before = text.as_bytes().iter().take(start);
        Location::File { path: path.to_owned(), line: 1 + before.filter(|byte| **byte == b'\n').count() }
    };
    let syntax = |error: toml::de::Error| ConfigError::Syntax {
        place: place(error.span().map_or(0, |span| span.start)),
        message: error.message().to_owned(),
    };
    let table = DeTable::parse(text).map_err(syntax)?.into_inner();
    let mut assignments = Vec::new();
    let mut flat = Vec::new();
    flatten(table, "", &mut flat);
    for (key, start, value) in flat {
        let value = Value::deserialize(ValueDeserializer::from(value)).map_err(syntax)?;
        assignments.push(Assignment { key, value, place: place(start) });
    }
    Ok(assignments)
}

/// Appends each value below `table` as (dotted key, byte where the key starts, value). A section is handed on as a
/// value where a value belongs, or where it is empty and unknown, so that it is refused.
fn flatten<'i>(table: DeTable<'i>, section: &str, flat: &mut Vec<(String, usize, Spanned<DeValue<'i>>)>) {
    for (name, value) in table {
        let start = name.span().start;
        let name = name.into_inner();
        let key = if section.is_empty() { name.into_owned() } else { format!("{section}.{name}") };
        let is_section = SECTIONS.iter().any(|section| section.name == key);
        let span = value.span();
        match value.into_inner() {
            DeValue::Table(inner) if is_section || !(inner.is_empty() || Setting::find(&key).is_some()) => {
                flatten(inner, &key, flat);
            }
            other => flat.push((key, start, Spanned::new(span, other))),
        }
    }
}

/// Parses the assignment of a `--set KEY=VALUE`. A value that is not TOML is taken as text.
pub(super) fn in_set(set: &str) -> Result<Assignment, ConfigError> {
    let Some((key, value)) = set.split_once('=') else {
        return Err(ConfigError::NoAssignment(set.to_owned()));
    };
    let text = value.trim();
    let parsed = DeValue::parse(text).map(ValueDeserializer::from).and_then(Value::deserialize);
    let value = parsed.unwrap_or_else(|_| Value::String(text.to_owned()));
    Ok(Assignment { key: key.trim().to_owned(), value, place: Location::Set(set.to_owned()) })
}

//! Reading configuration.
use super::Config;
use std::path::Path;
/// What was wrong.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct ConfigError(pub String);
/// Resolves the configuration.
///
/// # Errors
/// An unreadable file, an unknown key, a wrong type.
pub fn load(_file: Option<&Path>, _sets: &[String]) -> Result<Config, ConfigError> {
    Ok(Config::default())
}

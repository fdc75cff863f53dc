//! `scanwalk settings`: what can be set, what it means, and what it is set to.

use super::SettingsArgs;
use crate::config::{Audience, Config, Setting, page};
use crate::failure::Failure;
use std::io::{self, Write};

/// Prints the settings that were asked for, as `config` has them.
pub(super) fn run(args: &SettingsArgs, config: &Config) -> Result<(), Failure> {
    for word in &args.words {
        if !Setting::all().any(|setting| setting.key.contains(word.as_str())) {
            return Err(Failure::Usage(format!("there is no setting '{word}'; {}", Setting::advice(word))));
        }
    }
    let (values, defaults) = (config.to_table(), Config::default().to_table());
    let is_wanted = |setting: &Setting| match (&args.words[..], args.laboratory) {
        ([], true) => setting.audience == Audience::Laboratory,
        // Settings that somebody has changed are listed too, so that the page, used as a file, says the same as
        // `config`.
        ([], false) => {
            let Setting { section, name, audience, .. } = *setting;
            audience == Audience::Users || values[section][name] != defaults[section][name]
        }
        (words, _) => words.iter().any(|word| setting.key.contains(word.as_str())),
    };
    write!(io::stdout().lock(), "{}", page(config, is_wanted))?;
    Ok(())
}

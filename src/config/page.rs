//! Settings as a file that a user can read, and copy lines of: TOML with each setting's meaning above it.

use super::setting::{Audience, Setting};
use super::{Config, SECTIONS};

/// Columns that comments keep to.
const WIDTH: usize = 120;

/// The files below `config/` that show every setting, with what their first lines say.
pub const FILES: [(&str, Audience, &str); 2] = [
    (
        "default.toml",
        Audience::Users,
        "Settings of scanwalk with their defaults. Copy what you want to change into a file of your own and pass it with \
         `--config FILE`, or change one with `--set`, for example `--set frame.near_m=0.1`. What measures and compares is \
         in laboratory.toml, and goes into the same files.",
    ),
    (
        "laboratory.toml",
        Audience::Laboratory,
        "Further settings of scanwalk with their defaults: the papers' methods, and what one needs to compare, to measure \
         and to look for faults. They go into the same files as those of default.toml, and with `--set`.",
    ),
];

/// The text of one of [`FILES`].
#[must_use]
pub fn file(audience: Audience, about: &str) -> String {
    comment(about) + "\n" + &page(&Config::default(), |setting| setting.audience == audience)
}

/// The settings that are wanted, with the values that `config` gives them.
#[must_use]
pub fn page(config: &Config, is_wanted: impl Fn(&Setting) -> bool) -> String {
    let values = config.to_table();
    let mut page = String::new();
    for section in SECTIONS {
        let mut wanted = section.settings.iter().filter(|setting| is_wanted(setting)).peekable();
        if wanted.peek().is_none() {
            continue;
        }
        if !page.is_empty() {
            page.push('\n');
        }
        page += &format!("{}[{}]\n", comment(section.about()), section.name);
        for setting in wanted {
            let value = &values[section.name][setting.name];
            page += &format!("{}{} = {value}\n", comment(&setting.help()), setting.name);
        }
    }
    page
}

/// A text as lines of a comment.
fn comment(text: &str) -> String {
    let (mut lines, mut line) = (String::new(), String::from("#"));
    for word in text.split_whitespace() {
        if line.chars().count() + 1 + word.chars().count() > WIDTH {
            lines += &std::mem::replace(&mut line, String::from("#"));
            lines.push('\n');
        }
        line.push(' ');
        line += word;
    }
    lines + &line + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_keep_to_their_width() {
        assert_eq!(comment(" One\n two. "), "# One two.\n");
        let long = comment(&"word ".repeat(60));
        assert!(long.lines().count() == 3 && long.lines().all(|line| line.len() <= WIDTH), "{long}");
        assert_eq!(long.matches("word").count(), 60);
    }

    #[test]
    fn a_page_shows_what_is_wanted_as_it_is_set() {
        let mut config = Config::default();
        config.governor.budget = 0.5;
        let page = page(&config, |setting| setting.key.starts_with("governor."));
        let (before, after) = page.split_once("From 0.1 to 1.\n").unwrap();
        assert!(before.contains("\n[governor]\n") && !before.contains("[frame]"), "{page}");
        assert_eq!(after, "budget = 0.5\n");
    }
}

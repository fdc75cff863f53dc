//! What a setting is, and the macro that makes structs, defaults and the list of all settings from the one table.

use super::kind::ValueKind;

/// Settings that a wrong key may be meant for, at most.
const MOST_NEAR: usize = 3;

/// Settings that belong together.
#[derive(Debug)]
pub struct Section {
    /// Name as it stands in brackets: `frame`.
    pub name: &'static str,
    /// What the section is about: a sentence.
    pub(super) about: &'static str,
    /// Settings of the section.
    pub settings: &'static [Setting],
}

impl Section {
    /// Tells what the section is about: a sentence.
    #[must_use]
    pub fn about(&self) -> &'static str {
        self.about.trim()
    }
}

/// Something that can be set.
#[derive(Debug)]
pub struct Setting {
    /// Its section's name: `frame`.
    pub section: &'static str,
    /// Its own name: `near_m`.
    pub name: &'static str,
    /// Both, dotted: `frame.near_m`.
    pub key: &'static str,
    /// What it means, without its limits.
    pub(super) help: &'static str,
    /// The least and the greatest value, of each number in it.
    pub range: Option<[f64; 2]>,
    /// Unit of its numbers in words; empty if it has no numbers or they have no unit.
    pub unit: &'static str,
    /// Who changes it.
    pub audience: Audience,
    /// Kind of value that its type takes.
    pub(super) kind: fn() -> ValueKind,
}

/// Who changes a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Audience {
    /// Whoever walks or draws pictures.
    Users,
    /// Whoever compares the papers' methods, measures, or looks for faults.
    Laboratory,
}

impl Setting {
    /// All settings, in the table's order.
    pub fn all() -> impl Iterator<Item = &'static Self> {
        super::SECTIONS.iter().flat_map(|section| section.settings)
    }

    /// The setting with this dotted key.
    #[must_use]
    pub fn find(key: &str) -> Option<&'static Self> {
        Self::all().find(|setting| setting.key == key)
    }

    /// What a user can do who wrote a key that no setting has: take one that is spelled much like it, or look for one.
    #[must_use]
    pub fn advice(key: &str) -> String {
        let near = Self::near(key);
        let Some((last, others)) = near.split_last() else {
            return "`scanwalk settings` lists those of users, `scanwalk settings --laboratory` the others"
                .into();
        };
        let others: Vec<String> = others.iter().map(|setting| format!("'{}'", setting.key)).collect();
        let or = if others.is_empty() { "" } else { " or " };
        format!("did you mean {}{or}'{}'?", others.join(", "), last.key)
    }

    /// The settings whose keys are spelled most like `key`: as a whole, by the last word where the section is wrong, or by
    /// the section alone. There are none if more than half of the letters are others.
    fn near(key: &str) -> Vec<&'static Self> {
        let distance = strsim::damerau_levenshtein;
        let word = key.rsplit('.').next().unwrap_or_default();
        let distance = |candidate: &Self| {
            let parts = distance(word, candidate.name).min(distance(key, candidate.section));
            distance(key, candidate.key).min(parts + 1)
        };
        let most = key.chars().count() / 2;
        let least = Self::all().map(distance).min().filter(|least| *least <= most);
        Self::all().filter(|candidate| Some(distance(candidate)) == least).take(MOST_NEAR).collect()
    }

    /// Kind of value that its type takes.
    #[must_use]
    pub fn kind(&self) -> ValueKind {
        (self.kind)()
    }

    /// What it means, which numbers make sense, and what each name stands for: sentences.
    #[must_use]
    pub fn help(&self) -> String {
        match self.kind() {
            ValueKind::Choice(_, words) => format!("{} {words}.", self.meaning()),
            _ => self.meaning(),
        }
    }

    /// What it means and which numbers make sense: sentences.
    #[must_use]
    pub fn meaning(&self) -> String {
        let each = if matches!(self.kind(), ValueKind::List(..)) { "Each from" } else { "From" };
        let limits = match (self.range, self.unit) {
            (None, "") => String::new(),
            (None, unit) => format!(" In {unit}."),
            (Some([least, most]), "") => format!(" {each} {least} to {most}."),
            (Some([least, most]), unit) => format!(" {each} {least} to {most} {unit}."),
        };
        self.help.trim().to_owned() + &limits
    }
}

/// Makes [`Config`](super::Config), a struct for each section, their defaults, and [`SECTIONS`](super::SECTIONS) from
/// the table. A setting is an entry
///
/// ```text
/// /// What it means.
/// key: Type = default, from LEAST to MOST, in "unit", for Laboratory;
/// ```
///
/// of which `from … to`, `in` and `for` may be left out. Users read the entry's comment.
macro_rules! settings {
    ($(
        $(#[doc = $about:literal])+
        $section:ident: $Section:ident {
            $(
                $(#[doc = $help:literal])+
                $key:ident: $type:ty = $default:expr
                    $(, from $least:literal to $most:literal)? $(, in $unit:literal)? $(, for $audience:ident)?;
            )+
        }
    )+) => {
        /// Everything that can be set.
        #[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
        #[serde(deny_unknown_fields, default)]
        pub struct Config {
            $($(#[doc = $about])+ pub $section: $Section,)+
        }

        $(
            $(#[doc = $about])+
            #[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
            #[serde(deny_unknown_fields, default)]
            pub struct $Section {
                $($(#[doc = $help])+ pub $key: $type,)+
            }

            impl Default for $Section {
                fn default() -> Self {
                    Self { $($key: $default,)+ }
                }
            }
        )+

        /// Every setting, by section.
        pub const SECTIONS: &[Section] = &[$(Section {
            name: stringify!($section),
            about: concat!($($about),+),
            settings: &[$(Setting {
                section: stringify!($section),
                name: stringify!($key),
                key: concat!(stringify!($section), ".", stringify!($key)),
                help: concat!($($help),+),
                range: settings!(@range $($least, $most)?),
                unit: concat!($($unit)?),
                audience: settings!(@audience $($audience)?),
                kind: ValueKind::of::<$type>,
            },)+],
        },)+];
    };
    (@range) => { None };
    (@range $least:literal, $most:literal) => { Some([$least as f64, $most as f64]) };
    (@audience) => { Audience::Users };
    (@audience $audience:ident) => { Audience::$audience };
}

pub(super) use settings;

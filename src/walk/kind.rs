//! What a scan is of, which decides where one begins to see it, and how large.

use serde::{Deserialize, Serialize};

/// What a scan is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ScanKind {
    /// A room, a building from inside, a tunnel: one stands in it.
    Interior,
    /// A building, a yard, a street: one stands before it or in it, on the ground.
    Outdoors,
    /// So wide that nobody sees it from the ground: it begins as a model.
    Landscape,
    /// A thing to be seen from outside.
    Object,
}

impl ScanKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Interior, Self::Outdoors, Self::Landscape, Self::Object];

    /// Name for people: "an interior".
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Interior => "an interior",
            Self::Outdoors => "outdoors",
            Self::Landscape => "a landscape",
            Self::Object => "an object",
        }
    }
}

/// What the user says that a scan is of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SeenAs {
    /// Nothing: its size, its floor and its walls tell.
    #[default]
    Auto,
    /// An interior.
    Interior,
    /// Outdoors.
    Outdoors,
    /// A landscape.
    Landscape,
    /// An object.
    Object,
}

impl SeenAs {
    /// The kind, if the user says one.
    #[must_use]
    pub fn kind(self) -> Option<ScanKind> {
        match self {
            Self::Auto => None,
            Self::Interior => Some(ScanKind::Interior),
            Self::Outdoors => Some(ScanKind::Outdoors),
            Self::Landscape => Some(ScanKind::Landscape),
            Self::Object => Some(ScanKind::Object),
        }
    }
}

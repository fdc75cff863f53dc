//! What the window is told at start: how large it is, what it shows, and what the panel lets the user choose.

use render::options::Overlay;
use serde::{Deserialize, Serialize};

/// How the window begins.
#[derive(Clone, Debug, PartialEq)]
pub struct WindowOptions {
    /// Width, height in points.
    pub size: [u32; 2],
    /// Whether the panel is shown.
    pub panel: bool,
    /// Which eye is mirrored.
    pub mirror: MirroredEyes,
    /// What the panel changes.
    pub widgets: Widgets,
}

/// The settings that the panel changes while a walk goes on.
#[derive(Clone, Debug, PartialEq)]
pub struct Widgets {
    /// Which eye is mirrored.
    pub mirror: Selector<MirroredEyes>,
    /// What is drawn over the mirror.
    pub overlay: Selector<Overlay>,
    /// How fast the user moves.
    pub speed: Label,
}

/// What a widget is called, and what it does.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// Text before the widget: "Mirror".
    pub title: String,
    /// Text for a user who points at the widget.
    pub help: String,
}

/// A widget that takes one of several values.
#[derive(Clone, Debug, PartialEq)]
pub struct Selector<T> {
    /// Name and meaning of the widget.
    pub label: Label,
    /// All values with their titles: "Left".
    pub values: Vec<(String, T)>,
}

#[cfg(test)]
impl WindowOptions {
    /// A window whose panel is shown and offers all that there is.
    pub(super) fn sample() -> Self {
        let label = |title: &str| Label { title: title.into(), help: String::new() };
        let mirrors =
            [("Left", MirroredEyes::Left), ("Right", MirroredEyes::Right), ("Both", MirroredEyes::Both)];
        let widgets = Widgets {
            mirror: Selector {
                label: label("Mirror"),
                values: mirrors.map(|(title, eyes)| (title.into(), eyes)).into(),
            },
            overlay: Selector {
                label: label("Overlay"),
                values: Overlay::ALL.map(|overlay| (overlay.name().into(), overlay)).into(),
            },
            speed: label("Speed"),
        };
        Self { size: [640, 480], panel: true, mirror: MirroredEyes::Left, widgets }
    }
}

impl<T: PartialEq> Selector<T> {
    /// The title of a value.
    pub(super) fn title(&self, of: &T) -> &str {
        self.values.iter().find(|(_, value)| value == of).map_or("", |(title, _)| title)
    }
}

/// What the window mirrors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MirroredEyes {
    /// The left eye.
    #[default]
    Left,
    /// The right eye.
    Right,
    /// Both eyes, side by side.
    Both,
}

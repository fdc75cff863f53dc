//! What the window is told at start: how large it is, what it shows, and what the panel lets the user choose.

use std::collections::BTreeMap;

/// How the window begins.
#[derive(Clone, Debug, PartialEq)]
pub struct WindowOptions {
    /// Width, height in points.
    pub size: [u32; 2],
    /// Whether the panel is shown.
    pub panel: bool,
    /// Which eye is mirrored.
    pub mirror: MirroredEyes,
    /// True if the scans that were opened last are kept in a file of the user's.
    pub recent: bool,
    /// What the panel can offer.
    pub widgets: Widgets,
}

/// A widget for each setting, by its key. The panel offers those that a walk can change.
pub type Widgets = BTreeMap<&'static str, Widget>;

/// A setting as the panel shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Widget {
    /// Text before the widget: "Mirror".
    pub title: String,
    /// Text for a user who points at the widget.
    pub help: String,
    /// Names of values; none if the setting is not chosen by name.
    pub names: Vec<String>,
    /// The least and the greatest number.
    pub range: Option<[f64; 2]>,
    /// Unit of its numbers in words.
    pub unit: &'static str,
}

impl Widget {
    /// A name as people read it: "speed_factor" as "Speed factor".
    #[must_use]
    pub fn title_of(name: &str) -> String {
        let words = name.replace('_', " ");
        let mut letters = words.chars();
        letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
    }
}

#[cfg(test)]
impl WindowOptions {
    /// A window whose panel is shown and offers all that there is. A test of `src/resolve.rs` compares its widgets with
    /// the settings.
    pub(crate) fn sample() -> Self {
        let widget = |title: &str, names: &[&str], range, unit| {
            let (title, help) = (title.into(), format!("What {title} means"));
            let names = names.iter().map(ToString::to_string).collect();
            Widget { title, help, names, range, unit }
        };
        let overlays = ["none", "rings", "nodes", "overdraw", "depth", "precision"];
        let widgets = [
            ("frame.quality", widget("Quality", &["closest", "hqs"], None, "")),
            ("frame.background", widget("Background", &[], Some([0.0, 255.0]), "")),
            ("surround.show", widget("Show", &[], None, "")),
            ("surround.sky", widget("Sky", &[], Some([0.0, 255.0]), "")),
            ("surround.horizon", widget("Horizon", &[], Some([0.0, 255.0]), "")),
            ("surround.ground", widget("Ground", &[], Some([0.0, 255.0]), "")),
            ("window.mirror", widget("Mirror", &["left", "right", "both"], None, "")),
            ("window.overlay", widget("Overlay", &overlays, None, "")),
            ("cloud.up", widget("Up", &["auto", "z", "y", "-y"], None, "")),
            (
                "cloud.unit",
                widget("Unit", &["auto", "m", "mm", "cm", "ft", "us-ft"], Some([1e-9, 1e9]), "meters"),
            ),
            (
                "locomotion.seen_as",
                widget("Seen as", &["auto", "interior", "outdoors", "landscape", "object"], None, ""),
            ),
            ("locomotion.speed_factor", widget("Speed factor", &[], Some([1.0 / 64.0, 64.0]), "times")),
        ];
        Self {
            size: [640, 480],
            panel: true,
            mirror: MirroredEyes::Left,
            recent: false,
            widgets: widgets.into(),
        }
    }
}

base::choice! {
    /// What the window mirrors.
    pub enum MirroredEyes {
        /// The left eye.
        Left = "left",
        /// The right eye.
        Right = "right",
        /// Both eyes, side by side.
        Both = "both",
    }
}

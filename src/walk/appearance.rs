//! How the walk's frames look, which users change while they walk, and the presets that change several things at once.

use super::governor::GovernorOptions;
use render::DrawOptions;
use render::scenery::Surround;

base::choice! {
    /// A preset of how to draw that a walk can change to, the dearest first; see `config/`.
    pub enum QualityPreset {
        /// For a GPU with time to spare.
        Quality = "quality",
        /// What most have.
        Balanced = "balanced",
        /// For a small GPU or a very fast display.
        Performance = "performance",
    }
}

/// What a preset changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PresetOptions {
    /// What frames are to look like.
    pub draw: DrawOptions,
    /// How they are kept within their time.
    pub governor: GovernorOptions,
}

/// How the walk's frames look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Appearance {
    /// What frames are to look like while there is time.
    pub draw: DrawOptions,
    /// How they are kept within their time.
    pub governor: GovernorOptions,
    /// What is seen where the scan has nothing.
    pub surround: Surround,
    /// False: the background of the draw options is seen there.
    pub shows_surround: bool,
}

#[cfg(test)]
impl Appearance {
    /// A look for tests.
    pub(crate) fn sample() -> Self {
        let governor = GovernorOptions::sample();
        Self {
            draw: kit::frames::sample_options(),
            governor,
            surround: Surround::default(),
            shows_surround: false,
        }
    }
}

impl Appearance {
    /// What is seen where the scan has nothing, besides the background.
    #[must_use]
    pub fn shown_surround(&self) -> Option<Surround> {
        self.shows_surround.then_some(self.surround)
    }

    /// The same as a preset has it; the colors where the scan has nothing stay.
    #[must_use]
    pub fn with(&self, preset: &PresetOptions) -> Self {
        let background = self.draw.background;
        let draw = DrawOptions { background, ..preset.draw };
        Self { draw, governor: preset.governor, ..*self }
    }
}

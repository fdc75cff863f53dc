//! The application's state: owned and changed by the frame thread alone. Surfaces (the window, hands, a panel in the headset)
//! send [`Action`]s and get [`Snapshot`]s.

use super::action::{Action, Stance};
use super::appearance::{Appearance, PresetOptions, QualityPreset};
use super::buttons::{ButtonHelp, ButtonLabels};
use super::locomotion::Locomotion;
use super::moving::Hand;
use render::options::Overlay;

/// Factor on the speed for one step of the wheel.
pub const SPEED_STEP: f32 = 1.25;

/// How many times as fast as the speed that a scan or the user chose one moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedFactor {
    /// The factor at start.
    pub at_start: f32,
    /// The least and the greatest factor.
    pub range: [f32; 2],
}

#[cfg(test)]
impl SpeedFactor {
    /// Factors for tests.
    pub(crate) fn sample() -> Self {
        Self { at_start: 1.0, range: [1.0 / 64.0, 64.0] }
    }
}

/// The application's state.
#[derive(Clone, Debug)]
pub struct AppState {
    /// Overlay that is drawn over the mirror.
    pub overlay: Overlay,
    /// The hand that has opened the menu, while it is open.
    pub menu: Option<usize>,
    /// The labels of the controllers' buttons.
    pub buttons: ButtonHelp,
    appearance: Appearance,
    /// How frames are to look from the next one on, if the GPU has room for it.
    wanted_appearance: Option<Appearance>,
    /// What [`QualityPreset::ALL`] come to; none where nobody offers them.
    presets: Vec<PresetOptions>,
    speed: f32,
    speed_range: [f32; 2],
    /// Where the user is and how they get about; `None` until something of the scan has come.
    pub locomotion: Option<Locomotion>,
}

/// What surfaces show of the state, as it was at some moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snapshot {
    /// Overlay that is drawn over the mirror.
    pub overlay: Overlay,
    /// Speed as a factor on where it began.
    pub speed: f32,
    /// The hand that has opened the menu in the headset, while it is open.
    pub menu: Option<usize>,
    /// What the labels of controllers' buttons are seen of in the headset, while they are.
    pub buttons: Option<ButtonLabels>,
    /// How frames look.
    pub appearance: Appearance,
    /// The preset by which they look so, if one does.
    pub preset: Option<QualityPreset>,
    /// How the user is in the scan; `None` until something of it has come.
    pub stance: Option<Stance>,
}

#[cfg(test)]
impl Snapshot {
    /// A state for tests, before anything has come of a scan.
    pub(crate) fn sample() -> Self {
        AppState::new(Overlay::None, SpeedFactor::sample(), Appearance::sample()).snapshot()
    }
}

impl AppState {
    /// The state at start.
    #[must_use]
    pub fn new(overlay: Overlay, speed: SpeedFactor, appearance: Appearance) -> Self {
        let SpeedFactor { at_start, range } = speed;
        let presets = Vec::new();
        let buttons = ButtonHelp::new(Hand::Left, false);
        Self {
            overlay,
            menu: None,
            buttons,
            appearance,
            wanted_appearance: None,
            presets,
            speed: at_start,
            speed_range: range,
            locomotion: None,
        }
    }

    /// The same with presets to change to.
    #[must_use]
    pub fn with_presets(self, presets: [PresetOptions; QualityPreset::ALL.len()]) -> Self {
        Self { presets: presets.to_vec(), ..self }
    }

    /// The same with labels of buttons for somebody whose stick of this hand moves; they are seen at first if `begins`.
    #[must_use]
    pub fn labeling(self, moving_hand: Hand, begins: bool) -> Self {
        Self { buttons: ButtonHelp::new(moving_hand, begins), ..self }
    }

    /// Speed as a factor on the one that a scan or the user chose.
    #[must_use]
    pub fn speed(&self) -> f32 {
        self.speed
    }

    /// How frames look.
    #[must_use]
    pub fn appearance(&self) -> Appearance {
        self.appearance
    }

    /// How frames are to look from now on, if somebody wants it otherwise: once. Who draws them says by
    /// [`Self::set_appearance`] that they do.
    pub fn take_wanted_appearance(&mut self) -> Option<Appearance> {
        self.wanted_appearance.take()
    }

    /// Takes in how frames look from now on.
    pub fn set_appearance(&mut self, appearance: Appearance) {
        self.appearance = appearance;
    }

    /// What surfaces show.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        let stance = self.locomotion.as_ref().map(Locomotion::stance);
        let Self { overlay, menu, speed, appearance, .. } = *self;
        let is_by = |preset: &PresetOptions| appearance.with(preset) == appearance;
        let preset = self.presets.iter().position(is_by).map(|at| QualityPreset::ALL[at]);
        let buttons = self.buttons.shown();
        Snapshot { overlay, speed, menu, buttons, appearance, preset, stance }
    }

    /// Applies an action. Those that end the walk, save images, open a scan or look for a headset are for the walk.
    pub fn apply(&mut self, action: Action) {
        match action {
            Action::Faster(steps) if steps.is_finite() => self.set_speed(self.speed * SPEED_STEP.powf(steps)),
            Action::SetSpeed(speed) if speed.is_finite() => self.set_speed(speed),
            Action::SetOverlay(overlay) => self.overlay = overlay,
            Action::NextOverlay => self.overlay = self.overlay.next(),
            Action::SetAppearance(appearance) => self.wanted_appearance = Some(appearance),
            Action::SetPreset(preset) => {
                // The presets are in the order in which they are declared.
                if let Some(options) = self.presets.get(preset as usize) {
                    self.wanted_appearance = Some(self.appearance.with(options));
                }
            }
            Action::ToggleButtons => self.buttons.toggle(),
            Action::ToggleMenu(hand) => {
                self.menu = if self.menu.is_none() { Some(hand) } else { None };
                tracing::info!("the menu is {}", if self.menu.is_some() { "open" } else { "closed" });
            }
            action => {
                if let Some(locomotion) = &mut self.locomotion {
                    locomotion.apply(action);
                }
            }
        }
    }

    fn set_speed(&mut self, speed: f32) {
        let [least, most] = self.speed_range;
        let speed = speed.clamp(least, most);
        // Repeated steps are wrong in the last bits: ×1 is to read as ×1 again.
        self.speed = if (speed - 1.0).abs() < 1e-3 { 1.0 } else { speed };
    }
}

#[cfg(test)]
mod tests {
    use super::super::governor::GovernorOptions;
    use super::*;
    use render::DrawOptions;

    #[test]
    fn the_speed_changes_within_limits_and_comes_back_to_one() {
        let mut state = AppState::new(
            Overlay::None,
            SpeedFactor { at_start: 1.0, range: [0.5, 4.0] },
            Appearance::sample(),
        );
        let mut speed_after = |action| {
            state.apply(action);
            state.snapshot().speed
        };
        assert_eq!(speed_after(Action::Faster(1.0)), SPEED_STEP);
        speed_after(Action::Faster(2.0));
        assert_eq!(speed_after(Action::Faster(-3.0)), 1.0);
        assert_eq!(speed_after(Action::Faster(1e9)), 4.0);
        assert_eq!(speed_after(Action::Faster(1.0)), 4.0);
        assert_eq!(speed_after(Action::Faster(f32::NAN)), 4.0);
        assert_eq!(speed_after(Action::SetSpeed(f32::INFINITY)), 4.0);
        assert_eq!(speed_after(Action::SetSpeed(0.1)), 0.5);
    }

    #[test]
    fn the_menu_opens_by_a_hand_and_closes_by_either() {
        let mut state = AppState::new(Overlay::None, SpeedFactor::sample(), Appearance::sample());
        let menus = [1, 0, 0].map(|hand| {
            state.apply(Action::ToggleMenu(hand));
            state.snapshot().menu
        });
        assert_eq!(menus, [Some(1), None, Some(0)]);
    }

    #[test]
    fn a_preset_changes_how_points_are_drawn_and_no_color_beside_them() {
        let mut appearance = Appearance { shows_surround: true, ..Appearance::sample() };
        appearance.draw.background = [1, 2, 3];
        let look_as_wanted = |state: &mut AppState| {
            let wanted = state.take_wanted_appearance().expect("it is wanted otherwise");
            state.set_appearance(wanted);
        };
        let preset = |budget| {
            let governor = GovernorOptions { enabled: true, budget };
            PresetOptions { draw: DrawOptions { background: [9; 3], ..appearance.draw }, governor }
        };
        let state = AppState::new(Overlay::None, SpeedFactor::sample(), appearance);
        let mut state = state.with_presets([0.9, 0.8, 0.7].map(preset));
        assert_eq!(state.snapshot().preset, Some(QualityPreset::Balanced));
        for preset in QualityPreset::ALL {
            state.apply(Action::SetPreset(preset));
            look_as_wanted(&mut state);
            let Snapshot { appearance: now, preset: by, .. } = state.snapshot();
            assert_eq!((by, now.draw.background, now.shows_surround), (Some(preset), [1, 2, 3], true));
        }
        assert_eq!(state.appearance.governor.budget, 0.7);
        appearance.governor.enabled = false;
        state.apply(Action::SetAppearance(appearance));
        assert_ne!(state.snapshot().appearance, appearance, "nothing is drawn so yet");
        look_as_wanted(&mut state);
        assert_eq!((state.snapshot().appearance, state.snapshot().preset), (appearance, None));
    }

    #[test]
    fn overlays_go_round() {
        let mut state = AppState::new(Overlay::None, SpeedFactor::sample(), Appearance::sample());
        for overlay in Overlay::ALL.into_iter().cycle().skip(1).take(Overlay::ALL.len()) {
            state.apply(Action::NextOverlay);
            assert_eq!(state.snapshot().overlay, overlay);
        }
        let before = state.snapshot();
        state.apply(Action::Reset);
        assert_eq!(state.snapshot(), before, "there is nobody to reset yet");
    }
}

//! The application's state: owned and changed by the frame thread alone. Surfaces (the window, hands, a panel in the headset)
//! send [`Action`]s and get [`Snapshot`]s.

use super::action::{Action, Stance};
use super::locomotion::Locomotion;
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

impl Default for SpeedFactor {
    /// What the default settings say.
    fn default() -> Self {
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
    /// How the user is in the scan; `None` until something of it has come.
    pub stance: Option<Stance>,
}

impl AppState {
    /// The state at start.
    #[must_use]
    pub fn new(overlay: Overlay, speed: SpeedFactor) -> Self {
        let SpeedFactor { at_start, range } = speed;
        Self { overlay, menu: None, speed: at_start, speed_range: range, locomotion: None }
    }

    /// Speed as a factor on the one that a scan or the user chose.
    #[must_use]
    pub fn speed(&self) -> f32 {
        self.speed
    }

    /// What surfaces show.
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        let stance = self.locomotion.as_ref().map(Locomotion::stance);
        Snapshot { overlay: self.overlay, speed: self.speed, menu: self.menu, stance }
    }

    /// Applies an action. Those that end the walk, save images, open a scan or look for a headset are for the walk.
    pub fn apply(&mut self, action: Action) {
        match action {
            Action::Faster(steps) if steps.is_finite() => self.set_speed(self.speed * SPEED_STEP.powf(steps)),
            Action::SetSpeed(speed) if speed.is_finite() => self.set_speed(speed),
            Action::SetOverlay(overlay) => self.overlay = overlay,
            Action::NextOverlay => self.overlay = self.overlay.next(),
            Action::ToggleMenu(hand) => self.menu = if self.menu.is_none() { Some(hand) } else { None },
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
    use super::*;

    #[test]
    fn the_speed_changes_within_limits_and_comes_back_to_one() {
        let mut state = AppState::new(Overlay::None, SpeedFactor { at_start: 1.0, range: [0.5, 4.0] });
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
        let mut state = AppState::new(Overlay::None, SpeedFactor::default());
        let menus = [1, 0, 0].map(|hand| {
            state.apply(Action::ToggleMenu(hand));
            state.snapshot().menu
        });
        assert_eq!(menus, [Some(1), None, Some(0)]);
    }

    #[test]
    fn overlays_go_round() {
        let mut state = AppState::new(Overlay::None, SpeedFactor::default());
        for overlay in Overlay::ALL.into_iter().cycle().skip(1).take(Overlay::ALL.len()) {
            state.apply(Action::NextOverlay);
            assert_eq!(state.snapshot().overlay, overlay);
        }
        let before = state.snapshot();
        state.apply(Action::Reset);
        assert_eq!(state.snapshot(), before, "there is nobody to reset yet");
    }
}

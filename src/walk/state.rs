//! The application's state that more than one surface shows: owned and changed by the frame thread alone. Surfaces (the
//! window, later a panel in the headset) send [`Action`]s and get [`Snapshot`]s.

use glam::DVec3;
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

/// What the user asks of the walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Keys now held: right, up, forward, each −1 to 1, in the viewer's own directions; and the fast key.
    Move {
        /// Right, up, forward.
        direction: [f32; 3],
        /// Fast key held.
        fast: bool,
    },
    /// Mouse moved while looking: pixels right, pixels down.
    Look {
        /// Pixels right, pixels down.
        delta_px: [f32; 2],
    },
    /// Faster (> 0) or slower (< 0) from now on, by this many steps of [`SPEED_STEP`].
    Faster(f32),
    /// This many times as fast as the speed that a scan or the user chose, from now on.
    SetSpeed(f32),
    /// Turn by this many snap steps; right is positive.
    Snap(i32),
    /// Go back to the starting place.
    Reset,
    /// Move back until the whole scan is in view.
    WholeView,
    /// Walk on floors if one flew, fly if one walked.
    ToggleWalking,
    /// Go to a floor, the head above it.
    TeleportTo {
        /// Place on the floor, world space.
        floor_in_world: DVec3,
        /// Direction in which the head faces then, about the world's vertical, radians; 0 is north, positive to the left.
        yaw: f64,
    },
    /// Show the whole scan as a model before the user.
    ShowModel,
    /// Show the scan as large as life, from where a hand or the head points.
    LifeSize,
    /// Keep the place where the user is.
    SavePlace,
    /// Go to the next place that was kept.
    NextPlace,
    /// Go to the place before.
    PreviousPlace,
    /// Raise the user by so many meters, or lower them (< 0).
    Raise(f32),
    /// Raise somebody who sits as if they stood, and back.
    ToggleSeated,
    /// Draw this over the mirror from now on.
    SetOverlay(Overlay),
    /// Draw the next overlay over the mirror from now on.
    NextOverlay,
    /// Look for a headset at once, if one is looked for at all.
    LookForHeadset,
    /// Save both eyes' images.
    Screenshot,
    /// End the walk.
    Quit,
}

/// The application's state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AppState {
    /// Overlay that is drawn over the mirror.
    pub overlay: Overlay,
    speed: f32,
    speed_range: [f32; 2],
}

/// The state as it was at some moment, for those who show it.
pub type Snapshot = AppState;

impl AppState {
    /// The state at start.
    #[must_use]
    pub fn new(overlay: Overlay, speed: SpeedFactor) -> Self {
        let SpeedFactor { at_start, range } = speed;
        Self { overlay, speed: at_start, speed_range: range }
    }

    /// Speed as a factor on the one that a scan or the user chose.
    #[must_use]
    pub fn speed(&self) -> f32 {
        self.speed
    }

    /// Applies an action that changes the state; returns true if it did. Actions that move the viewer or end the walk
    /// are for others.
    pub fn apply(&mut self, action: Action) -> bool {
        let before = *self;
        match action {
            Action::Faster(steps) if steps.is_finite() => self.set_speed(self.speed * SPEED_STEP.powf(steps)),
            Action::SetSpeed(speed) if speed.is_finite() => self.set_speed(speed),
            Action::SetOverlay(overlay) => self.overlay = overlay,
            Action::NextOverlay => self.overlay = self.overlay.next(),
            _ => {}
        }
        *self != before
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
        assert!(state.apply(Action::Faster(1.0)));
        assert_eq!(state.speed(), SPEED_STEP);
        state.apply(Action::Faster(2.0));
        state.apply(Action::Faster(-3.0));
        assert_eq!(state.speed(), 1.0);
        state.apply(Action::Faster(1e9));
        assert_eq!(state.speed(), 4.0);
        assert!(!state.apply(Action::Faster(1.0)), "already at the limit");
        assert!(!state.apply(Action::Faster(f32::NAN)) && !state.apply(Action::SetSpeed(f32::INFINITY)));
        assert!(state.apply(Action::SetSpeed(0.1)));
        assert_eq!(state.speed(), 0.5);
    }

    #[test]
    fn overlays_go_round() {
        let mut state = AppState::new(Overlay::None, SpeedFactor::default());
        for overlay in Overlay::ALL.into_iter().cycle().skip(1).take(Overlay::ALL.len()) {
            assert!(state.apply(Action::NextOverlay));
            assert_eq!(state.overlay, overlay);
        }
        assert!(!state.apply(Action::SetOverlay(Overlay::None)), "it is so already");
        assert!(!state.apply(Action::Reset));
    }
}

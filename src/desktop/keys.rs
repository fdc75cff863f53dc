//! The one table of keys and mouse: it binds them, and the help lists it.
//!
//! Keys are physical positions, so that W, A, S, D form their cross on every keyboard layout.

use crate::walk::action::Action;
use winit::keyboard::KeyCode;

/// Something that a hand can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WindowInput {
    /// A key by its position.
    Key(KeyCode),
    /// A key while Ctrl is held.
    WithControl(KeyCode),
    /// Moving the mouse with the left button held.
    Drag,
    /// Moving the mouse with the right button held.
    RightDrag,
    /// The left mouse button, pressed and let go at one place.
    Click,
    /// The mouse wheel.
    Wheel,
}

/// What an input does.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum KeyAction {
    /// Moves while held, along right (0), up (1) or forward (2), by −1 or 1.
    Move(usize, f32),
    /// Moves faster while held.
    Fast,
    /// Goes to the frame thread as it is.
    Send(Action),
    /// Looks around.
    Look,
    /// Goes round the scan.
    Orbit,
    /// Goes to the floor that is seen there.
    GoToSeen,
    /// Changes the speed by this many steps, faster (> 0) or slower (< 0); the wheel does so for each line.
    Speed(f32),
    /// Opens another scan.
    Open,
    /// Shows or hides the panel.
    Panel,
    /// Mirrors the next of left, right, both.
    NextMirror,
    /// Full screen and back.
    FullScreen,
    /// Shows or hides the help.
    Help,
    /// Closes the help, leaves full screen, or (pressed twice) quits.
    Back,
}

/// A line of the table.
#[derive(Clone, Debug)]
pub(super) struct KeyBinding {
    /// Inputs, each of which does it.
    pub inputs: &'static [WindowInput],
    /// What the inputs do.
    pub action: KeyAction,
    /// The action in words, for the help.
    pub does: &'static str,
}

/// Every binding there is, in the order of the help.
pub(super) const BINDINGS: &[KeyBinding] = {
    use KeyAction::{
        Back, Fast, FullScreen, GoToSeen, Help, Look, Move, NextMirror, Open, Orbit, Panel, Send, Speed,
    };
    use KeyCode as K;
    use WindowInput::{Click, Drag, Key, RightDrag, Wheel, WithControl};
    const fn bind(inputs: &'static [WindowInput], action: KeyAction, does: &'static str) -> KeyBinding {
        KeyBinding { inputs, action, does }
    }
    &[
        bind(&[Drag], Look, "Look around"),
        bind(&[RightDrag], Orbit, "Go round the scan"),
        bind(&[Click], GoToSeen, "Go to where one clicks"),
        bind(&[Key(K::KeyW), Key(K::ArrowUp)], Move(2, 1.0), "Forward"),
        bind(&[Key(K::KeyS), Key(K::ArrowDown)], Move(2, -1.0), "Back"),
        bind(&[Key(K::KeyA)], Move(0, -1.0), "Left"),
        bind(&[Key(K::KeyD)], Move(0, 1.0), "Right"),
        bind(&[Key(K::KeyE), Key(K::Space)], Move(1, 1.0), "Up"),
        bind(&[Key(K::KeyQ), Key(K::ControlLeft), Key(K::ControlRight)], Move(1, -1.0), "Down"),
        bind(&[Key(K::ShiftLeft), Key(K::ShiftRight)], Fast, "Faster while held"),
        bind(&[Wheel, Key(K::Equal), Key(K::NumpadAdd)], Speed(1.0), "Faster from now on"),
        bind(&[Key(K::Minus), Key(K::NumpadSubtract)], Speed(-1.0), "Slower from now on"),
        bind(&[Key(K::ArrowLeft), Key(K::Comma)], Send(Action::Snap(-1)), "Turn left by a step"),
        bind(&[Key(K::ArrowRight), Key(K::Period)], Send(Action::Snap(1)), "Turn right by a step"),
        bind(&[Key(K::KeyF), Key(K::Home)], Send(Action::WholeView), "See the whole scan"),
        bind(&[Key(K::KeyT)], Send(Action::TopView), "Look down from above"),
        bind(&[Key(K::KeyR)], Send(Action::Reset), "Back to the starting place"),
        bind(&[Key(K::KeyG)], Send(Action::ToggleWalking), "Walk on floors, or fly"),
        bind(&[Key(K::KeyV)], Send(Action::ShowModel), "The whole scan as a model"),
        bind(&[Key(K::KeyL)], Send(Action::LifeSize), "As large as life, where the view points"),
        bind(&[Key(K::KeyB)], Send(Action::SavePlace), "Keep this place"),
        bind(&[Key(K::KeyN), Key(K::PageDown)], Send(Action::NextPlace), "Next place that was kept"),
        bind(&[Key(K::PageUp)], Send(Action::PreviousPlace), "The place before"),
        bind(&[Key(K::BracketRight)], Send(Action::Raise(0.1)), "Higher above the floor"),
        bind(&[Key(K::BracketLeft)], Send(Action::Raise(-0.1)), "Lower above the floor"),
        bind(&[Key(K::KeyH)], Send(Action::ToggleSeated), "Sit as if you stood, and back"),
        bind(&[Key(K::KeyM)], NextMirror, "Mirror left, right or both eyes"),
        bind(&[Key(K::KeyO)], Send(Action::NextOverlay), "Next overlay on the mirror: rings, nodes, …, none"),
        bind(&[Key(K::F12), Key(K::KeyP)], Send(Action::Screenshot), "Save both eyes' images"),
        bind(&[WithControl(K::KeyO)], Open, "Open another scan"),
        bind(&[Key(K::Tab)], Panel, "Show or hide the panel"),
        bind(&[Key(K::F11)], FullScreen, "Full screen"),
        bind(&[Key(K::F1)], Help, "This help"),
        bind(&[Key(K::Escape)], Back, "Close the help, leave full screen; twice: quit"),
    ]
};

/// Returns what `input` does, if anything.
pub(super) fn action(input: WindowInput) -> Option<KeyAction> {
    BINDINGS.iter().find(|binding| binding.inputs.contains(&input)).map(|binding| binding.action.clone())
}

/// Returns the binding that sends `action`, if one does.
pub(super) fn binding_of(action: &Action) -> Option<&'static KeyBinding> {
    BINDINGS.iter().find(|binding| matches!(&binding.action, KeyAction::Send(sent) if sent == action))
}

impl KeyBinding {
    /// Names of its inputs for the help: "E", "Space". Left and right keys of one name count once.
    pub(super) fn labels(&self) -> Vec<String> {
        let mut labels: Vec<String> = self.inputs.iter().map(WindowInput::label).collect();
        labels.dedup();
        labels
    }
}

impl WindowInput {
    fn label(&self) -> String {
        let name = match self {
            Self::WithControl(key) => return format!("Ctrl+{}", Self::Key(*key).label()),
            Self::Drag => "Mouse drag",
            Self::RightDrag => "Right drag",
            Self::Click => "Mouse click",
            Self::Wheel => "Mouse wheel",
            Self::Key(key) => match key {
                KeyCode::ControlLeft | KeyCode::ControlRight => "Ctrl",
                KeyCode::ShiftLeft | KeyCode::ShiftRight => "Shift",
                KeyCode::Escape => "Esc",
                KeyCode::Equal | KeyCode::NumpadAdd => "+",
                KeyCode::Minus | KeyCode::NumpadSubtract => "−",
                KeyCode::Comma => ",",
                KeyCode::Period => ".",
                KeyCode::BracketLeft => "[",
                KeyCode::BracketRight => "]",
                KeyCode::PageUp => "Page up",
                KeyCode::PageDown => "Page down",
                other => {
                    let name = format!("{other:?}");
                    return name.trim_start_matches("Key").trim_start_matches("Arrow").to_string();
                }
            },
        };
        name.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_input_is_bound_twice() {
        let all: Vec<WindowInput> = BINDINGS.iter().flat_map(|b| b.inputs).copied().collect();
        for (i, input) in all.iter().enumerate() {
            assert!(!all[..i].contains(input), "{input:?} is bound twice");
        }
    }

    #[test]
    fn the_table_binds() {
        assert_eq!(action(WindowInput::Key(KeyCode::KeyW)), Some(KeyAction::Move(2, 1.0)));
        assert_eq!(action(WindowInput::Key(KeyCode::Home)), Some(KeyAction::Send(Action::WholeView)));
        assert_eq!(action(WindowInput::Drag), Some(KeyAction::Look));
        assert_eq!(action(WindowInput::Key(KeyCode::F5)), None);
    }

    #[test]
    fn labels_are_short_and_single() {
        let labels = |wanted: KeyAction| {
            BINDINGS.iter().find(|b| b.action == wanted).map(|b| b.labels().join(" ")).unwrap_or_default()
        };
        assert_eq!(labels(KeyAction::Move(1, -1.0)), "Q Ctrl");
        assert_eq!(labels(KeyAction::Fast), "Shift");
        assert_eq!(labels(KeyAction::Send(Action::Snap(-1))), "Left ,");
        assert_eq!(labels(KeyAction::Help), "F1");
        assert_eq!(labels(KeyAction::Open), "Ctrl+O");
        for binding in BINDINGS {
            assert!(binding.labels().iter().all(|l| !l.is_empty() && l.len() <= 12), "{binding:?}");
        }
    }
}

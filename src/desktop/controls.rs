//! Turns keys and mouse into actions for the frame thread and into what the window shows. It knows no window: events
//! go in, and at most one action comes out of each.

use super::keys::{self, KeyAction, WindowInput};
use super::{MirroredEyes, WindowOptions};
use crate::walk::action::Action;
use std::time::{Duration, Instant};
use winit::keyboard::KeyCode;

/// How long a first Esc waits for the second.
const LEAVE_WINDOW: Duration = Duration::from_secs(2);

/// What the panel tells of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum PanelTab {
    /// The scan, what is seen of it, and how one moves.
    #[default]
    Scan,
    /// How the frames go, and what they run on.
    Timing,
}

/// What the window shows; the user changes it with keys and in the panel.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct WindowState {
    /// Which eyes are mirrored.
    pub mirror: MirroredEyes,
    /// True if the panel is shown.
    pub panel: bool,
    /// What the panel tells of.
    pub tab: PanelTab,
    /// True if the help is shown.
    pub help: bool,
    /// True if the panel is a button, false if it is not; `None`: the window's width decides.
    pub folded: Option<bool>,
    /// True while another scan is chosen.
    pub opening: bool,
    /// True if the user wants full screen.
    pub full_screen: bool,
    /// True if the user wants to leave.
    pub leave: bool,
    leave_asked: Option<Instant>,
}

impl WindowState {
    /// What the window shows at start.
    pub(super) fn new(options: &WindowOptions) -> Self {
        let WindowOptions { mirror, panel, .. } = *options;
        Self {
            mirror,
            panel,
            tab: PanelTab::default(),
            help: false,
            folded: None,
            opening: false,
            full_screen: false,
            leave: false,
            leave_asked: None,
        }
    }

    /// True while a second Esc would quit.
    pub(super) fn leave_pending(&self, now: Instant) -> bool {
        self.leave_asked.is_some_and(|asked| now.saturating_duration_since(asked) < LEAVE_WINDOW)
    }

    fn back(&mut self, now: Instant) {
        if self.help {
            self.help = false;
        } else if self.full_screen {
            self.full_screen = false;
        } else if self.leave_pending(now) {
            self.leave = true;
        } else {
            self.leave_asked = Some(now);
        }
    }
}

/// What the user's hands do: keys held, drag under way.
#[derive(Debug)]
pub(super) struct Controls {
    /// What the window shows.
    pub view: WindowState,
    held: Vec<KeyCode>,
    sent: Action,
    drag_from_px: Option<[f64; 2]>,
    /// What a drag that is under way does.
    drag: WindowInput,
    /// Where a button went down, while the pointer has stayed there: letting go is a click.
    click_px: Option<[f64; 2]>,
    pointer_px: [f64; 2],
}

/// Most that the pointer moves during a click, physical pixels.
const CLICK_PX: f64 = 4.0;

const AT_REST: Action = Action::Move { direction: [0.0; 3], fast: false };

impl Controls {
    /// Controls with nothing held.
    pub(super) fn new(view: WindowState) -> Self {
        Self {
            view,
            held: Vec::new(),
            sent: AT_REST,
            drag_from_px: None,
            drag: WindowInput::Drag,
            click_px: None,
            pointer_px: [0.0; 2],
        }
    }

    /// Takes in that a key went down (once, not its repeats) or up.
    pub(super) fn key(&mut self, key: KeyCode, pressed: bool, now: Instant) -> Option<Action> {
        let has_control = |held: &KeyCode| matches!(held, KeyCode::ControlLeft | KeyCode::ControlRight);
        let with_control = self.held.iter().any(has_control).then_some(WindowInput::WithControl(key));
        let action = with_control.and_then(keys::action).or_else(|| keys::action(WindowInput::Key(key)))?;
        if let KeyAction::Move(..) | KeyAction::Fast = action {
            self.held.retain(|held| *held != key);
            if pressed {
                self.held.push(key);
            }
            return self.movement();
        }
        if !pressed {
            return None;
        }
        let view = &mut self.view;
        match action {
            KeyAction::Send(action) => return Some(action),
            KeyAction::Speed(steps) => return Some(Action::Faster(steps)),
            KeyAction::Open => {
                view.opening = true;
                return self.release_all();
            }
            KeyAction::Panel => view.panel = !view.panel,
            KeyAction::NextMirror => view.mirror = next(view.mirror),
            KeyAction::FullScreen => view.full_screen = !view.full_screen,
            KeyAction::Help => view.help = !view.help,
            KeyAction::Back => view.back(now),
            KeyAction::Move(..) | KeyAction::Fast | KeyAction::Look | KeyAction::Orbit => {}
            KeyAction::GoToSeen => {}
        }
        None
    }

    /// Takes in that a mouse button went down on the picture (not on the panel), or up anywhere; while it is down, moving the
    /// mouse is `drag`. True if it was a click.
    pub(super) fn button(&mut self, pressed: bool, drag: WindowInput) -> bool {
        self.drag = drag;
        self.drag_from_px = pressed.then_some(self.pointer_px);
        let clicked = self.click_px.take().is_some() && !pressed;
        self.click_px = self.drag_from_px;
        clicked
    }

    /// Where the pointer is, physical pixels.
    pub(super) fn pointer_px(&self) -> [f64; 2] {
        self.pointer_px
    }

    /// True while a drag is under way.
    pub(super) fn dragging(&self) -> bool {
        self.drag_from_px.is_some()
    }

    /// Takes in that the pointer is at `at_px`, physical pixels.
    pub(super) fn pointer(&mut self, at_px: [f64; 2]) -> Option<Action> {
        self.pointer_px = at_px;
        let is_near = |from: &[f64; 2]| (at_px[0] - from[0]).hypot(at_px[1] - from[1]) <= CLICK_PX;
        self.click_px = self.click_px.filter(is_near);
        let from_px = self.drag_from_px.as_mut().map(|from| std::mem::replace(from, at_px))?;
        let delta_px = [(at_px[0] - from_px[0]) as f32, (at_px[1] - from_px[1]) as f32];
        let action = match keys::action(self.drag)? {
            KeyAction::Look => Action::Look { delta_px },
            KeyAction::Orbit => Action::Orbit { delta_px },
            _ => return None,
        };
        (delta_px != [0.0; 2]).then_some(action)
    }

    /// Takes in that the wheel turned by this many lines; up is positive.
    pub(super) fn wheel(&mut self, lines: f32) -> Option<Action> {
        match keys::action(WindowInput::Wheel)? {
            KeyAction::Speed(steps) if lines.is_finite() => Some(Action::Faster(steps * lines)),
            _ => None,
        }
    }

    /// Lets go of everything: the window lost the keyboard and will not see the keys go up.
    pub(super) fn release_all(&mut self) -> Option<Action> {
        self.held.clear();
        (self.drag_from_px, self.click_px) = (None, None);
        self.movement()
    }

    /// The movement that the held keys ask for, if it changed.
    fn movement(&mut self) -> Option<Action> {
        let mut moving = [0.0f32; 3];
        let mut fast = false;
        for key in &self.held {
            match keys::action(WindowInput::Key(*key)) {
                Some(KeyAction::Move(axis, by)) => moving[axis] += by,
                Some(KeyAction::Fast) => fast = true,
                _ => {}
            }
        }
        let action = Action::Move { direction: moving.map(|m| m.clamp(-1.0, 1.0)), fast };
        let before = std::mem::replace(&mut self.sent, action.clone());
        (action != before).then_some(action)
    }
}

/// The mirror after this one.
fn next(mirror: MirroredEyes) -> MirroredEyes {
    match mirror {
        MirroredEyes::Left => MirroredEyes::Right,
        MirroredEyes::Right => MirroredEyes::Both,
        MirroredEyes::Both => MirroredEyes::Left,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn controls() -> Controls {
        Controls::new(WindowState::new(&WindowOptions::sample()))
    }

    fn moving(direction: [f32; 3], fast: bool) -> Option<Action> {
        Some(Action::Move { direction, fast })
    }

    #[test]
    fn held_keys_add_up_and_opposites_cancel() {
        let (mut c, now) = (controls(), Instant::now());
        assert_eq!(c.key(KeyCode::KeyW, true, now), moving([0.0, 0.0, 1.0], false));
        assert_eq!(c.key(KeyCode::KeyW, true, now), None, "already held");
        assert_eq!(c.key(KeyCode::ArrowUp, true, now), None, "two keys of one direction are no faster");
        assert_eq!(c.key(KeyCode::ShiftRight, true, now), moving([0.0, 0.0, 1.0], true));
        assert_eq!(c.key(KeyCode::KeyA, true, now), moving([-1.0, 0.0, 1.0], true));
        assert_eq!(c.key(KeyCode::KeyD, true, now), moving([0.0, 0.0, 1.0], true));
        assert_eq!(c.key(KeyCode::KeyW, false, now), None, "the arrow still holds");
        assert_eq!(c.key(KeyCode::ArrowUp, false, now), moving([0.0; 3], true));
        assert_eq!(c.key(KeyCode::Space, true, now), moving([0.0, 1.0, 0.0], true));
    }

    #[test]
    fn losing_the_keyboard_stops_everything_once() {
        let (mut c, now) = (controls(), Instant::now());
        c.key(KeyCode::KeyW, true, now);
        c.button(true, WindowInput::Drag);
        assert_eq!(c.release_all(), Some(AT_REST));
        assert_eq!(c.release_all(), None);
        assert!(!c.dragging());
        assert_eq!(c.key(KeyCode::KeyW, false, now), None, "the late release changes nothing");
    }

    #[test]
    fn only_a_drag_looks() {
        let mut c = controls();
        assert_eq!(c.pointer([10.0, 10.0]), None);
        c.button(true, WindowInput::Drag);
        assert_eq!(c.pointer([13.0, 6.0]), Some(Action::Look { delta_px: [3.0, -4.0] }));
        assert_eq!(c.pointer([13.0, 6.0]), None);
        assert_eq!(c.pointer([14.0, 6.0]), Some(Action::Look { delta_px: [1.0, 0.0] }));
        c.button(false, WindowInput::Drag);
        assert_eq!(c.pointer([50.0, 50.0]), None);
        c.button(true, WindowInput::RightDrag);
        assert_eq!(c.pointer([52.0, 50.0]), Some(Action::Orbit { delta_px: [2.0, 0.0] }));
    }

    #[test]
    fn a_click_is_let_go_where_it_began() {
        let mut c = controls();
        c.pointer([10.0, 10.0]);
        assert!(!c.button(true, WindowInput::Drag) && c.button(false, WindowInput::Drag), "a click");
        assert!(!c.button(true, WindowInput::Drag));
        c.pointer([12.0, 12.0]);
        assert!(c.button(false, WindowInput::Drag), "a hand is never quite still");
        assert!(!c.button(true, WindowInput::Drag));
        c.pointer([60.0, 10.0]);
        c.pointer([10.0, 10.0]);
        assert!(!c.button(false, WindowInput::Drag), "a drag that comes back is none");
        assert!(!c.button(false, WindowInput::Drag), "nothing went down");
    }

    #[test]
    fn wheel_and_keys_change_the_speed() {
        let mut c = controls();
        assert_eq!(c.wheel(2.5), Some(Action::Faster(2.5)));
        assert_eq!(c.wheel(f32::NAN), None);
        assert_eq!(c.key(KeyCode::Minus, true, Instant::now()), Some(Action::Faster(-1.0)));
    }

    #[test]
    fn escape_steps_back_and_quits_only_when_pressed_twice() {
        let (mut c, now) = (controls(), Instant::now());
        c.key(KeyCode::F1, true, now);
        c.key(KeyCode::F11, true, now);
        c.key(KeyCode::Escape, true, now);
        assert!(!c.view.help && c.view.full_screen);
        c.key(KeyCode::Escape, true, now);
        assert!(!c.view.full_screen && !c.view.leave_pending(now));
        c.key(KeyCode::Escape, true, now);
        assert!(c.view.leave_pending(now) && !c.view.leave);
        let late = now + Duration::from_secs(3);
        c.key(KeyCode::Escape, true, late);
        assert!(!c.view.leave, "the first one is forgotten");
        c.key(KeyCode::Escape, true, late + Duration::from_millis(300));
        assert!(c.view.leave);
    }

    #[test]
    fn control_makes_another_key_of_a_key() {
        let (mut c, now) = (controls(), Instant::now());
        assert_eq!(c.key(KeyCode::ControlLeft, true, now), moving([0.0, -1.0, 0.0], false));
        assert_eq!(c.key(KeyCode::KeyO, true, now), Some(AT_REST), "nobody sinks while they choose");
        assert!(c.view.opening);
        assert_eq!(c.key(KeyCode::ControlLeft, false, now), None);
        c.key(KeyCode::ControlRight, true, now);
        assert_eq!(
            c.key(KeyCode::KeyD, true, now),
            moving([1.0, -1.0, 0.0], false),
            "Ctrl and D are two keys"
        );
    }

    #[test]
    fn keys_change_what_is_shown_when_they_go_down() {
        let (mut c, now) = (controls(), Instant::now());
        c.key(KeyCode::Tab, true, now);
        c.key(KeyCode::Tab, false, now);
        assert!(!c.view.panel);
        for mirror in [MirroredEyes::Right, MirroredEyes::Both, MirroredEyes::Left] {
            assert_eq!(c.key(KeyCode::KeyM, true, now), None);
            assert_eq!(c.view.mirror, mirror);
        }
        assert_eq!(c.key(KeyCode::KeyO, true, now), Some(Action::NextOverlay));
        assert_eq!(c.key(KeyCode::KeyR, true, now), Some(Action::Reset));
        assert_eq!(c.key(KeyCode::KeyR, false, now), None);
    }
}

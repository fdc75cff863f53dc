//! From keys and mouse to commands for the frame thread and to what the window shows. Knows no window: events
//! go in, at most one command comes out of each.

use super::keys::{self, Action, Input};
use crate::config::{Mirror, WindowConfig};
use crate::walk::link::Command;
use render::options::Overlay;
use std::time::{Duration, Instant};
use winit::keyboard::KeyCode;

/// Factor on the speed a step of the wheel.
const SPEED_STEP: f32 = 1.25;
/// The speed stays within this factor of where it began, up and down.
pub(super) const SPEED_LIMIT: f32 = 64.0;
/// How long a first Esc waits for the second.
const LEAVE_WINDOW: Duration = Duration::from_secs(2);

/// What the window shows; the user changes it with keys and in the panel.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct View {
    /// Eyes mirrored.
    pub mirror: Mirror,
    /// Drawn over the mirror; the frame thread does it.
    pub overlay: Overlay,
    /// Panel shown.
    pub panel: bool,
    /// Help shown.
    pub help: bool,
    /// Full screen wished for.
    pub full_screen: bool,
    /// The user wants to leave.
    pub leave: bool,
    leave_asked: Option<Instant>,
    speed: f32,
}

impl View {
    /// At start.
    pub(super) fn new(config: &WindowConfig) -> Self {
        let WindowConfig { mirror, panel, overlay, .. } = *config;
        let (help, full_screen, leave) = (false, false, false);
        Self { mirror, overlay, panel, help, full_screen, leave, leave_asked: None, speed: 1.0 }
    }

    /// Chooses an overlay; the command that tells the frame thread.
    pub(super) fn set_overlay(&mut self, overlay: Overlay) -> Option<Command> {
        let before = std::mem::replace(&mut self.overlay, overlay);
        (overlay != before).then_some(Command::Overlay(overlay))
    }

    /// Speed as a factor on where it began.
    pub(super) fn speed(&self) -> f32 {
        self.speed
    }

    /// Sets the speed; the command that brings the frame thread there.
    pub(super) fn set_speed(&mut self, speed: f32) -> Option<Command> {
        let speed = speed.clamp(1.0 / SPEED_LIMIT, SPEED_LIMIT);
        // The last bits of repeated steps: ×1 is to read as ×1 again.
        let speed = if (speed - 1.0).abs() < 1e-3 { 1.0 } else { speed };
        let change = speed / self.speed;
        self.speed = speed;
        (change != 1.0).then_some(Command::ScaleSpeed(change))
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

/// The hands: keys held, drag under way.
#[derive(Debug)]
pub(super) struct Controls {
    /// What the window shows.
    pub view: View,
    held: Vec<KeyCode>,
    sent: Command,
    drag_from_px: Option<[f64; 2]>,
    pointer_px: [f64; 2],
}

const AT_REST: Command = Command::Move { direction: [0.0; 3], fast: false };

impl Controls {
    /// Nothing held.
    pub(super) fn new(view: View) -> Self {
        Self { view, held: Vec::new(), sent: AT_REST, drag_from_px: None, pointer_px: [0.0; 2] }
    }

    /// A key went down (once, not its repeats) or up.
    pub(super) fn key(&mut self, key: KeyCode, pressed: bool, now: Instant) -> Option<Command> {
        let action = keys::action(Input::Key(key))?;
        if let Action::Move(..) | Action::Fast = action {
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
            Action::Send(command) => return Some(command),
            Action::Speed(steps) => return view.set_speed(view.speed * SPEED_STEP.powf(steps)),
            Action::Panel => view.panel = !view.panel,
            Action::NextMirror => view.mirror = next(view.mirror),
            Action::NextOverlay => return view.set_overlay(view.overlay.next()),
            Action::FullScreen => view.full_screen = !view.full_screen,
            Action::Help => view.help = !view.help,
            Action::Back => view.back(now),
            Action::Move(..) | Action::Fast | Action::Look => {}
        }
        None
    }

    /// A mouse button went down on the picture (not on the panel), or up anywhere.
    pub(super) fn button(&mut self, pressed: bool) {
        self.drag_from_px = pressed.then_some(self.pointer_px);
    }

    /// Where the pointer is, physical pixels.
    pub(super) fn pointer_px(&self) -> [f64; 2] {
        self.pointer_px
    }

    /// True while a drag is under way.
    pub(super) fn dragging(&self) -> bool {
        self.drag_from_px.is_some()
    }

    /// The pointer is here now, physical pixels.
    pub(super) fn pointer(&mut self, at_px: [f64; 2]) -> Option<Command> {
        self.pointer_px = at_px;
        let from_px = self.drag_from_px.as_mut().map(|from| std::mem::replace(from, at_px))?;
        let delta_px = [(at_px[0] - from_px[0]) as f32, (at_px[1] - from_px[1]) as f32];
        (keys::action(Input::Drag) == Some(Action::Look) && delta_px != [0.0; 2])
            .then_some(Command::Look { delta_px })
    }

    /// The wheel turned by so many lines, up is positive.
    pub(super) fn wheel(&mut self, lines: f32) -> Option<Command> {
        match keys::action(Input::Wheel)? {
            Action::Speed(steps) if lines.is_finite() => {
                self.view.set_speed(self.view.speed * SPEED_STEP.powf(steps * lines))
            }
            _ => None,
        }
    }

    /// Lets go of everything: the window lost the keyboard and will not see the keys go up.
    pub(super) fn release_all(&mut self) -> Option<Command> {
        self.held.clear();
        self.drag_from_px = None;
        self.movement()
    }

    /// The movement that the held keys ask for, if it changed.
    fn movement(&mut self) -> Option<Command> {
        let mut moving = [0.0f32; 3];
        let mut fast = false;
        for key in &self.held {
            match keys::action(Input::Key(*key)) {
                Some(Action::Move(axis, by)) => moving[axis] += by,
                Some(Action::Fast) => fast = true,
                _ => {}
            }
        }
        let command = Command::Move { direction: moving.map(|m| m.clamp(-1.0, 1.0)), fast };
        (command != std::mem::replace(&mut self.sent, command)).then_some(command)
    }
}

/// The mirror after this one.
fn next(mirror: Mirror) -> Mirror {
    match mirror {
        Mirror::Left => Mirror::Right,
        Mirror::Right => Mirror::Both,
        Mirror::Both => Mirror::Left,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn controls() -> Controls {
        Controls::new(View::new(&WindowConfig::default()))
    }

    fn moving(direction: [f32; 3], fast: bool) -> Option<Command> {
        Some(Command::Move { direction, fast })
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
        c.button(true);
        assert_eq!(c.release_all(), Some(AT_REST));
        assert_eq!(c.release_all(), None);
        assert!(!c.dragging());
        assert_eq!(c.key(KeyCode::KeyW, false, now), None, "the late release changes nothing");
    }

    #[test]
    fn only_a_drag_looks() {
        let mut c = controls();
        assert_eq!(c.pointer([10.0, 10.0]), None);
        c.button(true);
        assert_eq!(c.pointer([13.0, 6.0]), Some(Command::Look { delta_px: [3.0, -4.0] }));
        assert_eq!(c.pointer([13.0, 6.0]), None);
        assert_eq!(c.pointer([14.0, 6.0]), Some(Command::Look { delta_px: [1.0, 0.0] }));
        c.button(false);
        assert_eq!(c.pointer([50.0, 50.0]), None);
    }

    #[test]
    fn the_wheel_changes_speed_within_limits_and_comes_back_to_one() {
        let mut c = controls();
        assert_eq!(c.wheel(1.0), Some(Command::ScaleSpeed(SPEED_STEP)));
        c.wheel(2.0);
        c.wheel(-3.0);
        assert_eq!(c.view.speed(), 1.0);
        c.wheel(1e9);
        assert_eq!(c.view.speed(), SPEED_LIMIT);
        assert_eq!(c.wheel(1.0), None, "already at the limit");
        assert_eq!(c.wheel(f32::NAN), None);
        assert_eq!(c.key(KeyCode::Minus, true, Instant::now()), Some(Command::ScaleSpeed(1.0 / SPEED_STEP)));
    }

    #[test]
    fn the_frame_threads_speed_is_the_product_of_the_commands() {
        let mut c = controls();
        let mut theirs = 1.0;
        for lines in [3.0, 0.5, -7.0, 40.0, -90.0, 12.0] {
            if let Some(Command::ScaleSpeed(by)) = c.wheel(lines) {
                theirs *= by;
            }
        }
        assert!((theirs / c.view.speed() - 1.0).abs() < 1e-3);
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
    fn keys_change_what_is_shown_when_they_go_down() {
        let (mut c, now) = (controls(), Instant::now());
        c.key(KeyCode::Tab, true, now);
        c.key(KeyCode::Tab, false, now);
        assert!(!c.view.panel);
        for mirror in [Mirror::Right, Mirror::Both, Mirror::Left] {
            assert_eq!(c.key(KeyCode::KeyM, true, now), None);
            assert_eq!(c.view.mirror, mirror);
        }
        for overlay in Overlay::ALL.into_iter().cycle().skip(1).take(Overlay::ALL.len()) {
            assert_eq!(c.key(KeyCode::KeyO, true, now), Some(Command::Overlay(overlay)));
            assert_eq!(c.view.overlay, overlay);
        }
        assert_eq!(c.view.set_overlay(Overlay::None), None, "it is so already");
        assert_eq!(c.key(KeyCode::KeyR, true, now), Some(Command::Reset));
        assert_eq!(c.key(KeyCode::KeyR, false, now), None);
    }
}

//! What hands ask for: sticks, triggers and grips over time become intents. A press means something else when it is held.

use super::options::Turn;
use super::stick::deflection;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use xr::{ControllerInput, HandInput};

/// Deflection at which a stick begins to aim, or turns by a step.
const PUSHED: f32 = 0.7;
/// Deflection below which a stick is back, and may turn by a step again.
const BACK: f32 = 0.35;
/// Seconds after which a pressed trigger aims; a shorter press turns.
const HELD_S: f64 = 0.25;
/// Seconds for which a stick may pass its middle on the way back, which cancels, before it counts as let go.
const MIDDLE_S: f64 = 0.08;
/// Seconds for which the button that leads back to the start is held.
const RESET_S: f64 = 0.8;
/// Angle of a stick, or of a wrist, that turns nothing yet, radians.
const UNTWISTED: f64 = 0.3;
/// Radians that a landing turns for each that the wrist does.
const TWIST: f64 = 2.0;

/// How a hand aims.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AimedBy {
    /// By its stick.
    Stick,
    /// By its trigger.
    Select,
}

/// A hand that aims.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// Left 0, right 1.
    pub hand: usize,
    /// How it aims.
    pub by: AimedBy,
    /// Radians by which the landing is turned, positive to the left.
    pub twist: f64,
    roll_before: f64,
    middle_s: f64,
}

/// What hands ask for in a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Intents {
    /// Way to the right and forward, at most 1 long.
    pub stride: DVec2,
    /// Smooth turn, −1 to 1, positive to the right.
    pub turn: f64,
    /// Turn by steps for the left and for the right hand, positive to the right.
    pub snaps: [i32; 2],
    /// The hand that aims.
    pub aim: Option<Aim>,
    /// True in the frame in which that hand has begun to.
    pub began: bool,
    /// The hand that has let go: the user wants to be where it aimed.
    pub go: Option<usize>,
    /// The hand that has given up its aim.
    pub cancelled: Option<usize>,
    /// Hands that grab.
    pub grab: [bool; 2],
    /// True if the user wants back to the start.
    pub reset: bool,
    /// The hand whose menu button has gone down.
    pub menu: Option<usize>,
}

/// What hands did until now.
#[derive(Clone, Copy, Debug)]
pub struct Gestures {
    moving: usize,
    turn: Turn,
    hands: [Past; 2],
    /// True once a hand has had a stick: triggers need not turn.
    has_sticks: bool,
    aim: Option<Aim>,
}

/// What a hand did until now.
#[derive(Clone, Copy, Debug, Default)]
struct Past {
    /// Seconds for which the trigger is pressed; `None` if it is not, or has been used up.
    select_s: Option<f64>,
    is_select_used: bool,
    has_snapped: bool,
    is_stick_used: bool,
    reset_s: f64,
    menu: bool,
}

impl Gestures {
    /// Hands at rest, of which the one with the number `moving` has the stick that moves.
    #[must_use]
    pub fn new(moving: usize, turn: Turn) -> Self {
        Self { moving, turn, hands: [Past::default(); 2], has_sticks: false, aim: None }
    }

    /// How the stick turns.
    #[must_use]
    pub fn turn(&self) -> Turn {
        self.turn
    }

    /// Has the stick turn in this way from now on.
    pub fn set_turn(&mut self, turn: Turn) {
        self.turn = turn;
    }

    /// Takes in what hands do for `seconds`.
    pub fn advance(&mut self, input: &ControllerInput, seconds: f64) -> Intents {
        let grab = input.hands.map(|hand| hand.grab);
        let mut intents = Intents { grab, ..Intents::default() };
        let has_stick = |hand: &HandInput| hand.has_stick || deflection(hand.stick) != DVec2::ZERO;
        self.has_sticks |= input.hands.iter().any(has_stick);
        for (number, hand) in input.hands.iter().enumerate() {
            self.select(number, hand, seconds, &mut intents);
            let past = &mut self.hands[number];
            let before = past.reset_s;
            past.reset_s = if hand.reset { before + seconds } else { 0.0 };
            if hand.menu && !past.menu {
                intents.menu = Some(number);
            }
            past.menu = hand.menu;
            intents.reset |= before < RESET_S && past.reset_s >= RESET_S;
        }
        self.turning_stick(&input.hands[1 - self.moving], &mut intents);
        self.aim(input, seconds, &mut intents);
        // One stands still while one aims, and while one holds the world.
        if self.aim.is_none() && grab == [false; 2] {
            intents.stride = deflection(input.hands[self.moving].stick);
        }
        intents
    }

    /// The trigger: a short press turns where there are no sticks, a longer one aims.
    fn select(&mut self, number: usize, hand: &HandInput, seconds: f64, intents: &mut Intents) {
        let past = &mut self.hands[number];
        if hand.grab {
            (past.select_s, past.is_select_used) = (None, hand.select);
            return;
        }
        match (hand.select, past.select_s) {
            (true, None) if !past.is_select_used => past.select_s = Some(0.0),
            (true, Some(held)) => past.select_s = Some(held + seconds),
            (true, None) => {}
            (false, held) => {
                let was_short = held.is_some_and(|held| held < HELD_S);
                if was_short && !self.has_sticks && self.aim.is_none() {
                    intents.snaps[number] = if number == 0 { -1 } else { 1 };
                }
                (past.select_s, past.is_select_used) = (None, false);
            }
        }
        if past.select_s.is_some_and(|held| held >= HELD_S) && self.aim.is_none() {
            (past.select_s, past.is_select_used) = (None, true);
            self.begin(number, AimedBy::Select, hand, intents);
        }
    }

    fn begin(&mut self, number: usize, by: AimedBy, hand: &HandInput, intents: &mut Intents) {
        let aim = Aim { hand: number, by, twist: 0.0, roll_before: roll(hand), middle_s: 0.0 };
        (self.aim, intents.began) = (Some(aim), true);
    }

    /// The stick of the other hand: to the sides it turns, forward it aims.
    fn turning_stick(&mut self, hand: &HandInput, intents: &mut Intents) {
        let number = 1 - self.moving;
        let [x, y] = hand.stick;
        let (is_grabbing, is_aiming) = (intents.grab != [false; 2], self.aim.is_some());
        let past = &mut self.hands[number];
        if x.abs() < BACK && y.abs() < BACK {
            past.is_stick_used = false;
        }
        if x.abs() < BACK {
            past.has_snapped = false;
        }
        if is_grabbing || is_aiming || past.is_stick_used {
            return;
        }
        if y > PUSHED && y > x.abs() {
            past.is_stick_used = true;
            self.begin(number, AimedBy::Stick, hand, intents);
        } else if x.abs() > y.abs() {
            match self.turn {
                Turn::Smooth => intents.turn = deflection([x, 0.0]).x,
                Turn::Snap if x.abs() > PUSHED && !past.has_snapped => {
                    past.has_snapped = true;
                    intents.snaps[number] = if x > 0.0 { 1 } else { -1 };
                }
                Turn::Snap => {}
            }
        }
    }

    /// Goes on with an aim, or ends it.
    fn aim(&mut self, input: &ControllerInput, seconds: f64, intents: &mut Intents) {
        let Some(mut aim) = self.aim else { return };
        let hand = &input.hands[aim.hand];
        let [x, y] = hand.stick.map(f64::from);
        let is_pulled = hand.stick[1] < -PUSHED && hand.stick[1] < -hand.stick[0].abs();
        if is_pulled || intents.grab != [false; 2] {
            self.hands[aim.hand].is_stick_used = true;
            (self.aim, intents.cancelled) = (None, Some(aim.hand));
            return;
        }
        let is_held = match aim.by {
            AimedBy::Select => hand.select,
            AimedBy::Stick => {
                let is_out = hand.stick[0].hypot(hand.stick[1]) > BACK;
                aim.middle_s = if is_out { 0.0 } else { aim.middle_s + seconds };
                aim.middle_s < MIDDLE_S
            }
        };
        if !is_held {
            (self.aim, intents.go) = (None, Some(aim.hand));
            intents.aim = Some(aim);
            return;
        }
        if aim.by == AimedBy::Select || aim.middle_s == 0.0 {
            let by_stick = if hand.stick[0].hypot(hand.stick[1]) > PUSHED { (-x).atan2(y) } else { 0.0 };
            let by_wrist = TWIST * beyond(wrapped(roll(hand) - aim.roll_before));
            aim.twist = wrapped(beyond(by_stick) * PI / (PI - UNTWISTED) - by_wrist);
        }
        (self.aim, intents.aim) = (Some(aim), Some(aim));
    }
}

/// Roll of a hand about its own ray, radians, positive to the right; 0 while nobody knows.
fn roll(hand: &HandInput) -> f64 {
    let Some(aim) = hand.stage_from_aim else { return 0.0 };
    let [right, up] = [DVec3::X, DVec3::Y].map(|axis| aim.orientation * axis);
    if right.y.hypot(up.y) < 1e-6 { 0.0 } else { (-right.y).atan2(up.y) }
}

/// The part of an angle that is beyond [`UNTWISTED`].
fn beyond(angle: f64) -> f64 {
    angle.signum() * (angle.abs() - UNTWISTED).max(0.0)
}

/// An angle as one from −π to π.
fn wrapped(angle: f64) -> f64 {
    let turns = (angle / (2.0 * PI)).round();
    angle - 2.0 * PI * turns
}

#[cfg(test)]
#[path = "gestures_tests.rs"]
mod tests;

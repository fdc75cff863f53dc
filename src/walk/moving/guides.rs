//! What a frame shows of how the user moves: fixed in size, copied each frame.

use super::arc::TeleportArc;

/// What a hand is to feel: a tick of its controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The scan has come to be shown as large as life.
    Catch,
    /// The hand has begun to aim.
    Aim,
    /// The user has been taken where the hand aimed.
    Arrival,
    /// The aim was given up.
    Cancel,
    /// The user was turned by a step.
    Snap,
    /// The hand has taken hold of the world.
    Hold,
}

impl Event {
    /// How strongly the hand's controller is shaken, 0 to 1, and for how many seconds: a tick, no buzz.
    #[must_use]
    pub fn tick(self) -> (f32, f32) {
        match self {
            Self::Catch => (0.6, 0.03),
            Self::Aim => (0.2, 0.01),
            Self::Arrival => (0.8, 0.05),
            Self::Cancel => (0.3, 0.02),
            Self::Snap => (0.3, 0.015),
            Self::Hold => (0.4, 0.02),
        }
    }
}

/// What drawing and controllers get of how the user moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Guides {
    /// The arc of the hand that aims.
    pub arc: Option<TeleportArc>,
    /// How far the edge of sight is darkened, 0 to 1.
    pub vignette: f32,
    /// Size at which the scan is shown, 1 as large as life, while hands change it.
    pub scale: Option<f64>,
    /// What the left and the right hand are to feel.
    pub events: [Option<Event>; 2],
}

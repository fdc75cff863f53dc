//! What a user can set about moving, in the units that it is computed with.

use super::comfort::VignetteOptions;

/// How sticks, keys and mouse move the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocomotionOptions {
    /// Meters a second at full stick or key; `None`: chosen from the scan's size.
    pub speed_m_per_s: Option<f64>,
    /// Factor while the fast key is held.
    pub fast: f64,
    /// Whether sticks and keys walk or fly at first.
    pub stride: Stride,
    /// The hand whose stick moves; the other hand's stick turns and teleports.
    pub moving_hand: Hand,
    /// How the stick turns.
    pub turn: Turn,
    /// Radians of a snap turn.
    pub snap_rad: f64,
    /// Radians a second of a smooth turn at full stick.
    pub turn_rad_per_s: f64,
    /// Radians that the view turns for each pixel that the mouse moves.
    pub look_rad_per_px: f64,
    /// Meters that a teleport reaches when the hand points a little upwards.
    pub reach_m: f64,
    /// How far the edge of sight is darkened while a stick moves the user.
    pub vignette: VignetteOptions,
}

#[cfg(test)]
impl LocomotionOptions {
    /// Options for this room's tests, which say what comes of them.
    pub(crate) fn sample() -> Self {
        Self {
            speed_m_per_s: None,
            fast: 4.0,
            stride: Stride::Auto,
            moving_hand: Hand::Left,
            turn: Turn::Snap,
            snap_rad: 30f64.to_radians(),
            turn_rad_per_s: 90f64.to_radians(),
            look_rad_per_px: 0.15f64.to_radians(),
            reach_m: 8.0,
            vignette: VignetteOptions::sample(),
        }
    }
}

base::choice! {
    /// How the stick turns the user.
    pub enum Turn {
        /// By the angle of a snap turn at once.
        Snap = "snap",
        /// Smoothly, while the stick is held.
        Smooth = "smooth",
    }
}

base::choice! {
    /// A hand.
    pub enum Hand {
        /// The left one.
        Left = "left",
        /// The right one.
        Right = "right",
    }
}

impl Hand {
    /// Number of the hand among [`Self::ALL`], which is the order in which headsets report hands.
    #[must_use]
    pub fn index(self) -> usize {
        self as usize
    }

    /// The other hand.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

base::choice! {
    /// How sticks and keys take the user forward.
    pub enum Stride {
        /// Walking where a walk begins inside, flying elsewhere.
        Auto = "auto",
        /// On the floor, wherever the head looks.
        Walk = "walk",
        /// Through the air, where the head looks.
        Fly = "fly",
    }
}

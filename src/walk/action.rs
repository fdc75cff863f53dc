//! What surfaces (the window, hands, a panel in the headset) ask of the walk, and how they are told where the user is.

use super::appearance::{Appearance, QualityPreset};
use super::filling::ScanRequest;
use super::kind::ScanKind;
use super::moving::{Turn, VignetteOptions};
use glam::DVec3;
use render::options::Overlay;
use std::sync::Arc;

/// What the user asks of the walk.
#[derive(Clone, Debug, PartialEq)]
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
    /// Look down on the whole scan from above.
    TopView,
    /// Mouse moved while going round the scan: pixels right, pixels down.
    Orbit {
        /// Pixels right, pixels down.
        delta_px: [f32; 2],
    },
    /// Walk on floors if one flew, fly if one walked.
    ToggleWalking,
    /// Go to a floor, the head above it.
    TeleportTo {
        /// Place on the floor, world space.
        floor_in_world: DVec3,
        /// Direction in which the head faces then, about the world's vertical, radians; 0 is north, positive to the left.
        yaw: f64,
    },
    /// Take the scan for one of this kind, and begin anew.
    TakeFor(ScanKind),
    /// Go to the floor that a place of an eye's image shows; a model becomes as large as life there.
    GoToSeen {
        /// Left 0, right 1.
        eye: usize,
        /// Fractions of the drawn image's width from the left, and of its height from the top.
        at: [f64; 2],
    },
    /// Show the whole scan as a model before the user.
    ShowModel,
    /// Show the scan as large as life, from where a hand or the head points.
    LifeSize,
    /// Keep the place where the user is.
    SavePlace,
    /// Go to the next place that was kept.
    NextPlace,
    /// Go to the place that was kept before the one where the user went last.
    PreviousPlace,
    /// Raise the user by so many meters, or lower them (< 0).
    Raise(f32),
    /// Raise somebody who sits as if they stood, and back.
    ToggleSeated,
    /// Draw this over the mirror from now on.
    SetOverlay(Overlay),
    /// Draw the next overlay over the mirror from now on.
    NextOverlay,
    /// Open the menu by this hand, left 0 or right 1; close it if it is open.
    ToggleMenu(usize),
    /// Label the controllers' buttons for a while, or no longer.
    ToggleButtons,
    /// Turn in this way from now on.
    SetTurn(Turn),
    /// Darken the edge of sight so far while a stick moves the user.
    SetVignette(f32),
    /// Have frames look like this from now on.
    SetAppearance(Appearance),
    /// Have frames look as this preset says from now on.
    SetPreset(QualityPreset),
    /// Show another scan, or the same one read in another way.
    Open(Arc<ScanRequest>),
    /// Look for a headset at once, if one is looked for at all.
    LookForHeadset,
    /// Save both eyes' images.
    Screenshot,
    /// End the walk.
    Quit,
}

/// How the user is in the scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stance {
    /// What the scan is taken for.
    pub kind: ScanKind,
    /// What the user has said that it is of, if they have.
    pub said: Option<ScanKind>,
    /// True if sticks and keys walk on the floor, false if they fly.
    pub is_walking: bool,
    /// Size of the scan: 1 is as large as life.
    pub scale: f64,
    /// True while hands change the size.
    pub is_scaling: bool,
    /// Meters by which the user is raised above the floor.
    pub raised_m: f64,
    /// Number of places that one can go back to.
    pub num_places: usize,
    /// How the stick turns.
    pub turn: Turn,
    /// How far the edge of sight is darkened while a stick moves the user.
    pub vignette: f32,
    /// How far it may be.
    pub vignette_options: VignetteOptions,
}

#[cfg(test)]
impl Stance {
    /// Somebody who walks in an interior.
    pub(crate) fn sample() -> Self {
        Self {
            kind: ScanKind::Interior,
            said: None,
            is_walking: true,
            scale: 1.0,
            is_scaling: false,
            raised_m: 0.0,
            num_places: 0,
            turn: Turn::Snap,
            vignette: VignetteOptions::sample().at_start,
            vignette_options: VignetteOptions::sample(),
        }
    }
}

//! How the user moves, as arithmetic without drawing: where the stage stands in the world, what hands ask for, where a
//! teleport's arc lands, and which floors carry feet. [`Guides`] are what a frame shows of it.

pub mod arc;
mod comfort;
pub mod feet;
pub mod floors;
pub mod gestures;
pub mod grab;
pub mod guides;
pub mod model;
pub mod options;
pub mod place;
pub mod stick;
pub mod visits;

pub use arc::{Landing, TeleportArc};
pub use comfort::{Vignette, VignetteOptions};
pub use floors::{Floor, Floors};
pub use guides::{Event, Guides};
pub use options::{Hand, LocomotionOptions, Stride, Turn};
pub use place::{StagePlace, Standpoint};

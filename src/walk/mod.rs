//! The walk: one thread draws a frame after the other for a headset, real or simulated.
//!
//! The loop reads as the frame's contents list; what differs between an OpenXR runtime and the simulated
//! headset stands behind [`xr::Headset`].

pub mod action;
pub mod appearance;
pub mod buttons;
pub mod filling;
mod frames;
pub mod governor;
pub mod headsets;
pub mod kind;
pub mod link;
pub mod locomotion;
mod marks;
mod masks;
pub mod menu;
mod mirror;
pub mod moving;
mod part;
mod rows;
mod run;
mod scenery;
mod screenshot;
mod shapes_of_hands;
pub mod simulated;
pub mod start;
pub mod state;
mod surroundings;
mod tube;
mod views;
mod walker;

pub use run::{Walk, WalkError, WalkOptions, WalkSummary};

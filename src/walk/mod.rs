//! The walk: one thread draws a frame after the other for a headset, real or simulated.
//!
//! The loop reads as the frame's contents list; what differs between an OpenXR runtime and the simulated
//! headset stands behind [`xr::Headset`].

pub mod filling;
mod frames;
pub mod governor;
pub mod headsets;
pub mod link;
pub mod locomotion;
mod masks;
mod mirror;
mod part;
mod rows;
mod run;
mod screenshot;
pub mod simulated;
pub mod start;
pub mod state;
mod surroundings;
mod tube;
mod views;
mod waiting;
mod walker;

pub use run::{Walk, WalkError, WalkOptions, WalkSummary};

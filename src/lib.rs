//! scanwalk: walk through laser scans and photogrammetry in a VR headset.
//!
//! The rooms below are crates of their own: `docs/ARCHITECTURE.md` says which may name which.
#![forbid(unsafe_code)]

pub mod cli;
pub mod config;
pub mod desktop;
pub mod draw;
pub mod ending;
pub mod failure;
pub mod loader;
pub mod nodes;
pub mod offscreen;
pub mod overview;
pub mod picture_files;
pub mod resolve;
pub mod view;
pub mod walk;

//! `scanwalk view` from start to end: against a real OpenXR runtime without a headset, in a window, and offscreen.

mod card;
mod display;
mod hands;
mod headset;
mod offscreen;
mod phases;
mod recovery;
mod scene;
mod tiers;
mod window;

/// The program under test.
const PROGRAM: &str = env!("CARGO_BIN_EXE_scanwalk");

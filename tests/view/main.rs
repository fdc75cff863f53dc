//! `scanwalk view` from start to end: against a real OpenXR runtime without a headset, in a window, and offscreen.

mod card;
mod display;
mod hands;
mod headset;
mod offscreen;
mod program;
mod recovery;
mod scene;
mod tiers;
mod window;

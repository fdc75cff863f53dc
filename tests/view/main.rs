//! `scanwalk view` from start to end: against a real OpenXR runtime without a headset, and offscreen.

#[path = "../support/xr/mod.rs"]
mod xr_support;

mod headset;
mod offscreen;
mod scene;

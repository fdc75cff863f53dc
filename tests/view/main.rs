//! `scanwalk view` from start to end: against a real OpenXR runtime without a headset, in a window, and offscreen.

#[path = "../support/xr/mod.rs"]
mod xr_support;

#[path = "../desktop_support/screen.rs"]
#[allow(dead_code, reason = "each test program uses its own part")]
mod screen;

mod display;
mod headset;
mod offscreen;
mod program;
mod scene;
mod tiers;
mod window;
#[path = "../support/xwd.rs"]
mod xwd;

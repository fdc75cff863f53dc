//! The headset against a real OpenXR runtime: sessions, pictures, poses, input, faults, validation.
//!
//! The runtime (`scripts/headless-runtime`) runs programs under a C library of its own, so each test starts
//! this very binary again with the test [`probe::probe`] alone, which opens the headset and reports what it
//! gets, a JSON object a line.

mod extras;
mod faults;
mod hands;
mod picture;
mod probe;
mod session;
mod tracking;
mod validation;

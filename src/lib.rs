//! scanwalk: walk through laser scans and photogrammetry in a VR headset.
//!
//! ```text
//!  files ──scan──▶ Scan ──cloud──▶ Cloud ──render──▶ CloudBuffers (GPU)
//!                (columns)   (Morton batches,             │
//!                             quantised planes)           ▼
//!  Headset (xr | simulated) ──eyes──▶ Renderer: clear · lod · cull · depth · color · resolve
//!        ▲                                   │ timings          │ images
//!        └────────── walk (frame thread) ◀───┴──────────────────┘
//!                      │ rows                     │ mirror
//!                      ▼                          ▼
//!                 timing (frame log)        desktop (window, egui)
//! ```
//!
//! Dependencies point one way; `docs/ARCHITECTURE.md` says which, and a test keeps it so.

pub mod bench;
pub mod cli;
pub mod cloud;
pub mod config;
pub mod desktop;
pub mod ending;
pub mod gpu;
pub mod layout;
pub mod look;
pub mod method;
pub mod output;
pub mod overview;
pub mod progress;
pub mod render;
pub mod report;
pub mod scan;
pub mod shot;
pub mod space;
pub mod synth;
pub mod timing;
pub mod twin;
pub mod view;
pub mod walk;
mod words;
pub mod xr;

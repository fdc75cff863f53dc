//! Arguments of `scanwalk view`.

use super::parse;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Walk through scans.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ViewArgs {
    /// Files that are one scan.
    #[arg(required = true, value_name = "SCAN", help = parse::scans_help())]
    pub scans: Vec<PathBuf>,
    /// Refuse all files if one cannot be read to its end, instead of showing the rest [default: cloud.strict]
    #[arg(long)]
    pub strict: bool,
    /// auto: the headset if one answers, else the desktop; require: fail without one
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub headset: HeadsetChoice,
    /// auto: a window if there is a display
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub window: WindowChoice,
    /// Write a line for every frame; `scanwalk report` reads it
    #[arg(long, value_name = "FRAMES.csv")]
    pub log: Option<PathBuf>,
    /// Stop by itself after N frames
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub frames: Option<u64>,
    /// Stop by itself after S seconds
    #[arg(long, value_name = "S", value_parser = parse::seconds)]
    pub seconds: Option<f64>,
    /// Settings that belong together; may be repeated. How to draw: quality, balanced, performance, plain; what
    /// the simulated headset is like: valve-index, meta-quest-3, bigscreen-beyond-2
    #[arg(long, value_name = "NAME")]
    pub preset: Vec<String>,
    /// Replay a recorded path of the head
    #[arg(long, value_name = "FILE")]
    pub pose_path: Option<PathBuf>,
}

const EXAMPLES: &str = "Examples:
  scanwalk view castle.laz
  scanwalk view north.laz south.laz --headset require --log frames.csv
  scanwalk view castle.laz --headset off --set simulated.refresh_hz=72
  scanwalk view castle.laz --headset off --preset performance --preset valve-index
  scanwalk view castle.laz --window off --frames 600 --log frames.csv

In the headset: the left stick walks inside and flies elsewhere, the right stick turns and aims a teleport, grips hold the scan, the menu
button opens a menu; docs/CONTROLLERS.md has all.
In the window: drag to look, click to go there, WASD to move, shift to go faster, F1 for all keys.";

/// Whether to use a headset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum HeadsetChoice {
    /// The headset if an OpenXR runtime with one answers, else the simulated one.
    #[default]
    Auto,
    /// The headset, or the walk fails.
    Require,
    /// The simulated headset, whatever answers.
    Off,
}

/// Whether to open a window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum WindowChoice {
    /// A window if there is a display.
    #[default]
    Auto,
    /// A window, or the walk fails.
    On,
    /// No window.
    Off,
}

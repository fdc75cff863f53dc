//! Arguments of `scanwalk view`.

use super::parse;
use crate::walk::headsets::Wish;
use clap::Args;
use std::path::PathBuf;

/// Walk through scans.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct ViewArgs {
    /// Files that are one scan; a window without any lets one choose.
    #[arg(value_name = "SCAN", help = parse::scans_help() + ". Without any, the window lets one choose")]
    pub scans: Vec<PathBuf>,
    /// Refuse all files if one cannot be read to its end, instead of showing the rest [default: cloud.strict]
    #[arg(long)]
    pub strict: bool,
    /// Whether to use a headset
    #[arg(long, value_name = "WHEN", default_value = "auto", value_parser = parse::wish(HEADSET))]
    pub headset: Wish,
    /// Whether to open a window
    #[arg(long, value_name = "WHEN", default_value = "auto", value_parser = parse::wish(WINDOW))]
    pub window: Wish,
    /// Write a line for every frame; `scanwalk report` reads it
    #[arg(long, value_name = "FRAMES.csv")]
    pub log: Option<PathBuf>,
    /// Stop by itself after N frames
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub frames: Option<u64>,
    /// Stop by itself after S seconds
    #[arg(long, value_name = "S", value_parser = parse::seconds)]
    pub seconds: Option<f64>,
    /// Settings that belong together.
    #[arg(long, value_name = "NAME", help = parse::presets_help())]
    pub preset: Vec<String>,
    /// Replay a recorded path of the head
    #[arg(long, value_name = "FILE")]
    pub pose_path: Option<PathBuf>,
}

/// Names of `--headset`.
const HEADSET: [(&str, &str); 3] = [
    ("auto", "the headset if one answers, else the desktop"),
    ("require", "the headset, or the walk fails"),
    ("off", "the simulated headset, whatever answers"),
];
/// Names of `--window`.
const WINDOW: [(&str, &str); 3] =
    [("auto", "a window if there is a display"), ("on", "a window, or the walk fails"), ("off", "no window")];

const EXAMPLES: &str = "Examples:
  scanwalk view castle.laz
  scanwalk view north.laz south.laz --headset require --log frames.csv
  scanwalk view castle.laz --headset off --set simulated.refresh_hz=72
  scanwalk view castle.laz --headset off --preset performance --preset valve-index
  scanwalk view castle.laz --window off --frames 600 --log frames.csv

In the headset: the left stick walks inside and flies elsewhere, the right stick turns and aims a teleport, grips hold the scan, the menu
button opens a menu; docs/CONTROLLERS.md has all.
In the window: drag to look, click to go there, WASD to move, shift to go faster, F1 for all keys.";

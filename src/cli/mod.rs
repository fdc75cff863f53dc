//! The command line: arguments (`args`), the files that they name (`files`), commands (`commands`), exit codes (`exit`).
//!
//! Names and meanings are a contract with the scripts of those who use scanwalk. Output for programs goes to
//! stdout, everything else to stderr.

mod args;
mod bench;
mod commands;
mod doctor;
mod exit;
mod files;
mod parse;
mod quiet;
mod render;
mod report;
mod settings;
mod view;

pub use args::{BenchArgs, ConvertArgs, DoctorArgs, InfoArgs, ReportArgs, SettingsArgs, SynthArgs};
pub use render::{Lod, RenderArgs};
pub use view::ViewArgs;

use base::output::Partials;
use clap::{Parser, Subcommand};
use std::path::PathBuf;
use std::process::ExitCode;

/// Walk through laser scans and photogrammetry in a VR headset.
#[derive(Debug, Parser)]
#[command(name = "scanwalk", version, max_term_width = 100, after_help = EXAMPLES)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// What all commands share.
    #[command(flatten)]
    pub shared: SharedArgs,
}

const EXAMPLES: &str = "Examples:
  scanwalk view castle.laz                      walk through it: headset, or window if there is none
  scanwalk view a.laz b.laz --log frames.csv    several files as one scan, with a log of every frame
  scanwalk render castle.laz -o castle.png      a picture of the whole, without a window
  scanwalk synth terrestrial -o yard.laz        a made-up scan to try things with
  scanwalk report frames.csv                    was the walk smooth, and which stage costs?

Exit codes: 0 done, 1 failed, 2 wrong usage.";

/// Options of every command.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct SharedArgs {
    /// Settings to use instead of the defaults, as TOML; `scanwalk settings` lists them
    #[arg(long, global = true, value_name = "FILE", help_heading = "Options of every command")]
    pub config: Option<PathBuf>,
    /// One setting, for example frame.near_m=0.1; `scanwalk settings` lists them; may be repeated, wins over --config
    #[arg(long, global = true, value_name = "KEY=VALUE", help_heading = "Options of every command")]
    pub set: Vec<String>,
    /// The GPU to use: part of its name [default: the fastest kind]
    #[arg(long, global = true, value_name = "NAME", help_heading = "Options of every command")]
    pub adapter: Option<String>,
    /// Replace what has an output's name, even if it is a scan or no file of that kind; never what is read
    #[arg(long, global = true, help_heading = "Options of every command")]
    pub force: bool,
    /// Say more on stderr; twice: still more. RUST_LOG goes beyond
    #[arg(short, long, global = true, action = clap::ArgAction::Count, help_heading = "Options of every command")]
    pub verbose: u8,
}

/// What scanwalk can do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Walk through scans: in the headset, on the desktop, or both
    View(ViewArgs),
    /// Draw a picture without a window
    Render(RenderArgs),
    /// Say what is in the files
    Info(InfoArgs),
    /// Write scans as a level-of-detail octree (not there yet)
    Convert(ConvertArgs),
    /// Write a made-up scan
    Synth(SynthArgs),
    /// Measure this machine against the papers' tables: methods, orders, flat clouds and octrees, both eyes
    Bench(BenchArgs),
    /// Say what measurements show: a frame log, two of them compared, benchmark results
    Report(ReportArgs),
    /// List settings with their meanings and values, as a file for --config
    Settings(SettingsArgs),
    /// Say what this machine has and lacks, and what to install
    Doctor(DoctorArgs),
}

/// Runs the program: parses the arguments, runs the command, reports a failure in one line. It is to be called first,
/// while the process has one thread.
#[must_use]
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    quiet::libraries(cli.shared.verbose);
    exit::start_tracing(cli.shared.verbose);
    let partials = Partials::default();
    let stop = exit::stop_on_signals(&partials);
    exit::end(commands::run(&cli, &partials, &stop), &partials)
}

//! What benchmarks share whose every step happens in a process of its own, so that its peak memory is its own. They
//! print CSV rows.

use crate::damage::peak_kib;
use crate::program::this_program;
use anyhow::{Result, ensure};
use clap::Parser;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Arguments of each of them.
#[derive(Debug, Parser)]
struct StepArgs {
    /// Millions of points of each made-up file
    #[arg(long, value_name = "M", default_value_t = 10.0)]
    points: f64,
    /// Measured runs of each step
    #[arg(long, value_name = "N", default_value_t = 5)]
    runs: u64,
    /// Small files, one run: shows that it works, not how fast
    #[arg(long)]
    quick: bool,
    /// Given by `cargo bench`; without it (`cargo test --benches`) the run is quick
    #[arg(long, hide = true)]
    bench: bool,
    /// Given to the processes of the steps
    #[arg(long, hide = true, num_args = 2, value_names = ["STEP", "FILE"])]
    step: Vec<PathBuf>,
}

/// Runs `bench` with a folder for its files, a number of points and a number of runs; or, in a process that
/// [`in_child`] has started, `step` on a file.
///
/// # Errors
/// Those of `bench` or `step`.
pub fn run(
    bench: impl FnOnce(&Path, u64, u64) -> Result<()>,
    step: impl FnOnce(&str, &Path) -> Result<()>,
) -> Result<()> {
    let mut args = StepArgs::parse();
    if let [name, path] = &args.step[..] {
        return step(&name.to_string_lossy(), path);
    }
    if args.quick || !args.bench {
        (args.points, args.runs) = (0.05, 1);
    }
    let folder = tempfile::tempdir()?;
    bench(folder.path(), (1e6 * args.points).round() as u64, args.runs)
}

/// Runs a step in a process of its own and returns what it prints.
///
/// # Errors
/// If the step fails, with what it said.
pub fn in_child(step: &str, path: &Path) -> Result<String> {
    let output = Command::new(this_program()).args(["--step", step]).arg(path).output()?;
    ensure!(output.status.success(), "{step} failed: {}", String::from_utf8_lossy(&output.stderr));
    Ok(String::from_utf8(output.stdout)?.trim().to_owned())
}

/// Largest memory of this process so far, bytes a point; NaN where the system does not say.
pub fn peak_bytes_per_point(num_points: usize) -> f64 {
    peak_kib().map_or(f64::NAN, |kib| 1024.0 * kib as f64 / num_points as f64)
}

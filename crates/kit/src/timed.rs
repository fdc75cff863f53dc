//! What benchmarks share that time the GPU: arguments, the device, the file of samples, medians.

use anyhow::{Context, Result, ensure};
use base::percentile::Sorted;
use clap::Args;
use render::gpu::Gpu;
use std::fmt;
use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;

/// Arguments of each of them.
#[derive(Debug, Args)]
pub struct TimedArgs {
    /// Measured runs of each contestant
    #[arg(long, value_name = "N", default_value_t = 9)]
    pub runs: usize,
    /// Little work and few runs: shows that it works, not how fast
    #[arg(long)]
    quick: bool,
    /// Also write every sample
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// GPU whose name contains this
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Given by `cargo bench`; without it (`cargo test --benches`) the run is quick
    #[arg(long, hide = true)]
    bench: bool,
}

impl TimedArgs {
    /// True for a run whose times do not matter.
    pub fn is_quick(&self) -> bool {
        self.quick || !self.bench
    }

    /// The GPU.
    ///
    /// # Errors
    /// If there is none, if it does not tell times, or if there is nothing to measure.
    pub fn gpu(&self) -> Result<Gpu> {
        ensure!(self.runs > 0, "--runs 0: a median needs a run");
        let gpu = Gpu::open(self.adapter.as_deref())?;
        let can_time = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        ensure!(can_time, "{} cannot tell how long its work takes", gpu.name());
        Ok(gpu)
    }

    /// The file for the samples, if they are wanted.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn csv(&self) -> Result<Option<BufWriter<File>>> {
        let create = |path: &PathBuf| {
            let file = File::create(path).with_context(|| format!("{}: cannot be written", path.display()));
            file.map(BufWriter::new)
        };
        self.csv.as_ref().map(create).transpose()
    }
}

/// Median and range of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The middle value, or the mean of the two in the middle.
    pub median: f64,
    min: f64,
    max: f64,
}

impl Spread {
    /// Median and range of at least one value.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let sorted = Sorted::new(values);
        let [min, max] = [0, 1000].map(|per_mille| sorted.percentile(per_mille).unwrap_or(f64::NAN));
        Self { median: sorted.median().unwrap_or(f64::NAN), min, max }
    }
}

impl fmt::Display for Spread {
    /// Writes "median (min–max)", with two decimals unless a precision is given; a width aligns to the right.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let digits = f.precision().unwrap_or(2);
        let text = format!("{:.digits$} ({:.digits$}–{:.digits$})", self.median, self.min, self.max);
        write!(f, "{text:>0$}", f.width().unwrap_or(0))
    }
}

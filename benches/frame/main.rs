//! The frame against its alternatives, on whatever Vulkan device there is, as ratios within one run: both eyes
//! in one `depth` dispatch (`stereo`) against a renderer for each eye (`two-singles`), and against hardware
//! points (`point-list`). `docs/bench/frame` keeps a run.
//!
//! The contestants take turns, so that whatever else the machine does meets them all, and each draws a frame
//! that does not count before one that does; medians are shown with their range. Before anything is timed, all must have drawn the same picture: see [`check`].

mod check;
mod contestant;
mod figures;
mod point_list;

use anyhow::{Context, Result, ensure};
use clap::Parser;
use contestant::{Compute, Contestant, Hardware};
use figures::Figures;
use glam::DVec3;
use scanwalk::cloud::{self, Cloud, Order};
use scanwalk::gpu::Gpu;
use scanwalk::progress::{Progress, Stop};
use scanwalk::space::{Eye, Fov, Pose, View};
use scanwalk::synth::{self, Kind, SynthOptions, Viewpoint};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Frames that are drawn before any counts.
const WARM_UP_FRAMES: usize = 2;
/// The whole, and a place inside from which culling matters.
const VIEWPOINTS: [&str; 2] = ["overview", "hall"];
/// Angles of an eye's image in degrees, as headsets have them: outer, inner, up and down.
const FOV_DEG: [f64; 4] = [50.0, 45.0, 48.0, 50.0];
/// Distance of the eyes.
const EYE_DISTANCE_M: f64 = 0.063;
const NEAR_M: f64 = 0.05;
const SEED: u64 = 1;

/// Times frames of made-up scans: stereo, two single eyes, hardware points.
#[derive(Debug, Parser)]
struct Args {
    /// Millions of points, one scan each
    #[arg(long, value_name = "M,M,…", value_delimiter = ',', default_value = "1,4,16")]
    points: Vec<f64>,
    /// Measured frames of each contestant
    #[arg(long, value_name = "N", default_value_t = 9)]
    runs: usize,
    /// Pixels an eye, width and height
    #[arg(long, value_name = "PX", default_value_t = 1024)]
    size: u32,
    /// A small scan and few frames: shows that it works, not how fast
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

fn main() -> Result<()> {
    let mut args = Args::parse();
    if args.quick || !args.bench {
        (args.points, args.runs) = (vec![0.2], 5);
    }
    ensure!(args.runs > 0, "--runs 0: a median needs a run");
    let gpu = Arc::new(Gpu::open(args.adapter.as_deref())?);
    let can_time = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
    ensure!(can_time, "{} cannot tell how long its work takes", gpu.name());

    let mut out = io::stdout().lock();
    let mut csv = args.csv.as_deref().map(create).transpose()?;
    if let Some(csv) = &mut csv {
        Figures::csv_header(csv)?;
    }
    writeln!(out, "{}, {}; {}² pixels an eye, {} runs", gpu.name(), gpu.driver(), args.size, args.runs)?;
    for &millions in &args.points {
        let cloud = cloud(millions)?;
        for figures in measure(&gpu, &cloud, &args)? {
            figures.print(&mut out)?;
            if let Some(csv) = &mut csv {
                figures.csv_rows(csv)?;
                csv.flush()?;
            }
        }
    }
    Ok(())
}

fn create(path: &Path) -> Result<BufWriter<File>> {
    Ok(BufWriter::new(File::create(path).with_context(|| format!("{}: cannot be written", path.display()))?))
}

/// A courtyard as a scanner sees it, in Morton order.
fn cloud(millions: f64) -> Result<Cloud> {
    let folder = tempfile::tempdir()?;
    let out = folder.path().join("courtyard.las");
    let points = (1e6 * millions).round() as u64;
    let stop = Stop::default();
    synth::write(&SynthOptions { kind: Kind::Terrestrial, out: out.clone(), points, seed: SEED }, &stop)?;
    Ok(cloud::build(&scanwalk::scan::read(&[out], &stop)?, Order::Morton, &Progress::hidden())?)
}

/// The figures of a cloud from each viewpoint.
fn measure(gpu: &Arc<Gpu>, cloud: &Cloud, args: &Args) -> Result<Vec<Figures>> {
    let size_px = [args.size; 2];
    let mut stereo = Compute::stereo(gpu, cloud, size_px)?;
    let mut singles = Compute::two_singles(gpu, cloud, size_px)?;
    let mut hardware = Hardware::new(gpu, cloud, size_px)?;
    let mut all = Vec::new();
    for place in synth::viewpoints(Kind::Terrestrial).iter().filter(|p| VIEWPOINTS.contains(&p.name)) {
        let view = view(place, size_px);
        let agreement = check::pictures(&mut stereo, &mut singles, &mut hardware, &view)
            .with_context(|| format!("{} points, {}", cloud.num_points, place.name))?;
        let mut contestants: [&mut dyn Contestant; 3] = [&mut stereo, &mut singles, &mut hardware];
        let names = contestants.each_ref().map(|contestant| contestant.name());
        let mut samples = [const { Vec::new() }; 3];
        for run in 0..WARM_UP_FRAMES + args.runs {
            for (contestant, samples) in contestants.iter_mut().zip(&mut samples) {
                // A frame that does not count: caches and scheduler are then as this contestant leaves them,
                // not as the one before did.
                contestant.draw(&view)?;
                let sample = contestant.draw(&view)?;
                if run >= WARM_UP_FRAMES {
                    samples.push(sample);
                }
            }
        }
        all.push(Figures { num_points: cloud.num_points, viewpoint: place.name, names, samples, agreement });
    }
    Ok(all)
}

/// Both eyes of somebody who stands there.
fn view(place: &Viewpoint, size_px: [u32; 2]) -> View {
    let head = Pose::look_at(place.eye, place.target, DVec3::Z);
    let [outer, inner, up, down] = FOV_DEG.map(f64::to_radians);
    let eye = |side: f64, fov| {
        let sideways = Pose { position: DVec3::X * side * 0.5 * EYE_DISTANCE_M, ..Pose::IDENTITY };
        Eye { world_from_view: head.then(&sideways), fov, size_px, gaze_in_view: Eye::AHEAD }
    };
    let left = eye(-1.0, Fov::from_angles(-outer, inner, up, -down));
    let right = eye(1.0, Fov::from_angles(-inner, outer, up, -down));
    View { eyes: vec![left, right], near: NEAR_M }
}

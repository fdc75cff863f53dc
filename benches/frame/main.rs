//! Times the frame against its alternatives, on whatever Vulkan device there is, as ratios within one run; see [`heat`]
//! for the contestants. `docs/bench/frame` keeps a run.
//!
//! The contestants of a heat take turns, so that other load on the machine meets them all. Each draws a frame that does
//! not count before one that does; medians are shown with their range. Before anything is timed, those that claim to
//! draw the same picture must have done so; see [`check`].

mod check;
mod contestant;
mod figures;
mod heat;
mod scene;

use anyhow::{Context, Result};
use base::space::View;
use clap::Parser;
use contestant::StereoContestant;
use figures::{HeatSamples, print_growth};
use heat::{Heat, HeatEntry, MAX_HARDWARE_POINTS};
use kit::quality::scene::DrawnScan;
use kit::timed::TimedArgs;
use render::gpu::Gpu;
use std::io::{self, Write};
use std::sync::Arc;

/// Frames that are drawn before any counts.
const WARM_UP_FRAMES: usize = 2;

/// Times frames of made-up scans, drawn in several ways.
#[derive(Debug, Parser)]
struct FrameArgs {
    /// Millions of points, one scan each
    #[arg(long, alias = "sizes", value_name = "M,M,…", value_delimiter = ',', default_value = "1,4,16,64")]
    points: Vec<f64>,
    /// Only heats whose name contains this: eyes, tiers, octree, parts, access
    #[arg(long, value_name = "NAME", default_value = "")]
    heat: String,
    #[command(flatten)]
    timed: TimedArgs,
    /// Pixels an eye, width and height
    #[arg(long, value_name = "PX", default_value_t = 1024)]
    size: u32,
}

fn main() -> Result<()> {
    let mut args = FrameArgs::parse();
    if args.timed.is_quick() {
        (args.points, args.timed.runs, args.size) = (vec![0.1, 0.2], 2, 256);
    }
    let gpu = Arc::new(args.timed.gpu()?);

    let mut out = io::stdout().lock();
    let mut csv = args.timed.csv()?;
    if let Some(csv) = &mut csv {
        HeatSamples::csv_header(csv)?;
    }
    writeln!(
        out,
        "{}, {}; {}² pixels an eye, {} runs",
        gpu.name(),
        gpu.driver(),
        args.size,
        args.timed.runs
    )?;
    let mut all = Vec::new();
    for &millions in &args.points {
        // Clouds are made one at a time, so that memory holds the largest, not all.
        let scene = scene::courtyard((1e6 * millions).round() as u64)?;
        for heat in heat::heats().iter().filter(|heat| heat.name.contains(&args.heat)) {
            let figures = measure(&gpu, &scene, heat, &args, &mut out)
                .with_context(|| format!("{}, {millions} M points", heat.name))?;
            if let Some(csv) = &mut csv {
                figures.iter().try_for_each(|figures| figures.csv_rows(csv))?;
                csv.flush()?;
            }
            // The other heats draw no cloud that is large enough to tell.
            if heat.max_points == u64::MAX {
                all.extend(figures);
            }
        }
    }
    Ok(print_growth(&mut out, &all)?)
}

/// Contestants by name.
type Contestants = Vec<(&'static str, Box<dyn StereoContestant>)>;

/// The figures of a heat from each viewpoint; prints them too.
fn measure(
    gpu: &Arc<Gpu>,
    scene: &DrawnScan,
    heat: &Heat,
    args: &FrameArgs,
    out: &mut impl Write,
) -> Result<Vec<HeatSamples>> {
    let num_points = scene.cloud.num_points;
    if num_points > heat.max_points {
        writeln!(out, "{}: left out above {} points: it takes too long", heat.name, heat.max_points)?;
        return Ok(vec![]);
    }
    let size_px = [args.size; 2];
    let mut contestants = Contestants::new();
    for &(name, entry) in &heat.entries {
        match entry {
            HeatEntry::Hardware if num_points > MAX_HARDWARE_POINTS => {
                writeln!(out, "{name}: left out above {MAX_HARDWARE_POINTS} points: it takes too long")?;
            }
            HeatEntry::Compute(plan) if plan.atomics.is_some_and(|atomics| atomics > gpu.atomics()) => {
                writeln!(out, "{name}: left out, for the GPU cannot")?;
            }
            _ => contestants.push((name, contestant::make(gpu, scene, size_px, entry)?)),
        }
    }
    let mut all = Vec::new();
    for place in scene::viewpoints() {
        let view = scene::view(place, size_px);
        check_pictures(heat, &mut contestants, &view, out).context(place.name)?;
        let samples = samples(&mut contestants, &view, args.timed.runs)?;
        let figures = HeatSamples { num_points, viewpoint: place.name, heat: heat.name, samples };
        figures.print_times(out)?;
        heat.ratios.iter().try_for_each(|ratio| figures.print_ratio(out, ratio))?;
        all.push(figures);
    }
    Ok(all)
}

/// Checks that the contestants that should draw the same do.
fn check_pictures(
    heat: &Heat,
    contestants: &mut Contestants,
    view: &View,
    out: &mut impl Write,
) -> Result<()> {
    for names in &heat.same {
        if let Some([a, b]) = pair(contestants, names) {
            check::same(a, b, view).with_context(|| names.join(" and "))?;
        }
    }
    for names in &heat.alike {
        if let Some([a, b]) = pair(contestants, names) {
            let share = check::alike(a, b, view).with_context(|| names.join(" and "))?;
            writeln!(out, "{}: depths agree on {:.2} % of the pixels", names.join(" and "), 100.0 * share)?;
        }
    }
    Ok(())
}

/// The two contestants of these names, if both take part.
fn pair<'a>(
    contestants: &'a mut Contestants,
    names: &[&str; 2],
) -> Option<[&'a mut dyn StereoContestant; 2]> {
    let place = |name| contestants.iter().position(|(n, _)| n == name);
    let places = [place(&names[0])?, place(&names[1])?];
    let [(_, a), (_, b)] = contestants.get_disjoint_mut(places).ok()?;
    Some([a.as_mut(), b.as_mut()])
}

/// Samples of the contestants, which take turns.
fn samples(
    contestants: &mut Contestants,
    view: &View,
    num_runs: usize,
) -> Result<Vec<(&'static str, Vec<contestant::FrameSample>)>> {
    let mut all: Vec<_> = contestants.iter().map(|(name, _)| (*name, Vec::new())).collect();
    for run in 0..WARM_UP_FRAMES + num_runs {
        for ((_, contestant), (_, samples)) in contestants.iter_mut().zip(&mut all) {
            // This frame does not count: after it, caches and scheduler are as this contestant leaves them, not as the
            // one before did.
            contestant.draw(view)?;
            let sample = contestant.draw(view)?;
            if run >= WARM_UP_FRAMES {
                samples.push(sample);
            }
        }
    }
    Ok(all)
}

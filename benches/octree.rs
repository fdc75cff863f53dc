//! How fast octrees are built: M points/s of the whole, beside reading the file and beside the Morton sort
//! alone, and what the nodes look like. Prints CSV rows; `docs/bench/octree` keeps a run.
//!
//! The step `read` is the file alone, `sort` the flat cloud's Morton sort as the octree does it, `flat` all of the flat
//! cloud, `octree` the octree, and `nodes` counts nodes.

use anyhow::{Context, Result};
use base::percentile::Sorted;
use base::task::Progress;
use cloud::morton::MortonGrid;
use cloud::octree::{Octree, build_octree};
use kit::{made_up, reading, steps};
use lab::synth::SynthKind;
use points::Scan;
use rayon::prelude::*;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

fn main() -> Result<()> {
    steps::run(bench, run_step)
}

fn bench(folder: &Path, points: u64, num_runs: u64) -> Result<()> {
    println!(
        "scan,step,run,points,seconds,core_seconds,m_points_per_s,m_points_per_core_s,peak_bytes_per_point"
    );
    let kinds = [("terrestrial", SynthKind::Terrestrial), ("aerial", SynthKind::Aerial)];
    let mut files = Vec::new();
    for (name, kind) in kinds {
        let out = folder.join(name).with_extension("las");
        made_up::file(&out, kind, points, 1)?;
        files.push((name, out));
    }
    for run in 0..num_runs {
        for (name, path) in &files {
            for step in ["read", "sort", "flat", "octree"] {
                println!("{name},{step},{run},{}", steps::in_child(step, path)?);
            }
        }
    }
    println!("scan,kind,nodes,points,median_points,largest_points,points_in_nodes_below_1000,levels,batches");
    for (_, path) in &files {
        println!("{}", steps::in_child("nodes", path)?);
    }
    Ok(())
}

/// Runs a step and prints points, seconds, seconds of all cores together, rates, peak memory. Seconds are of the named
/// step alone. The cores' seconds tell more than the clock's where other programs run beside.
fn run_step(step: &str, path: &Path) -> Result<()> {
    if step == "nodes" {
        return list_nodes(path);
    }
    let (mut start, mut core_start) = (Instant::now(), core_seconds());
    let scan = reading::file(path)?;
    let num_points = scan.num_points();
    if step != "read" {
        (start, core_start) = (Instant::now(), core_seconds());
    }
    match step {
        "read" => drop(black_box(scan)),
        "sort" => drop(black_box(sort(&scan))),
        "flat" => drop(black_box(cloud::build(&scan, &Progress::hidden())?)),
        _ => drop(black_box(octree(&scan)?)),
    }
    let (seconds, cores) = (start.elapsed().as_secs_f64(), core_seconds() - core_start);
    let [rate, core_rate] = [seconds, cores].map(|time| num_points as f64 / time / 1e6);
    let peak = steps::peak_bytes_per_point(num_points);
    println!("{num_points},{seconds:.4},{cores:.2},{rate:.2},{core_rate:.2},{peak:.2}");
    Ok(())
}

/// Sorts keys of the octree's size in the octree's order.
fn sort(scan: &Scan) -> Vec<(u64, u32, u32)> {
    let grid = MortonGrid::new(&scan.bounds());
    let file = &scan.files[0];
    let xyz = file.points.xyz.par_iter().enumerate();
    let mut keys: Vec<(u64, u32, u32)> =
        xyz.map(|(i, &xyz)| (grid.code(file.grid.p_in_world(xyz)), i as u32, file.color(i))).collect();
    keys.par_sort_unstable();
    keys
}

fn octree(scan: &Scan) -> Result<Octree> {
    Ok(build_octree(scan, &Progress::hidden())?)
}

/// Prints sizes of nodes: rows of inner nodes and of leaves.
fn list_nodes(path: &Path) -> Result<()> {
    let name = path.file_stem().context("a file of ours")?.display();
    let octree = octree(&reading::file(path)?)?;
    for (kind, wanted) in [("inner", false), ("leaf", true)] {
        let nodes = octree.nodes.iter().filter(|node| node.children.is_empty() == wanted);
        let levels: Vec<u32> = nodes.clone().map(|node| node.level).collect();
        let num_batches: usize = nodes.clone().map(|node| node.batches.len()).sum();
        let mut sizes: Vec<u32> = nodes.map(|node| node.num_points).collect();
        sizes.sort_unstable();
        let small: u32 = sizes.iter().filter(|&&size| size < 1000).sum();
        let (Some(least), Some(most)) = (levels.iter().min(), levels.iter().max()) else { continue };
        println!(
            "{name},{kind},{},{},{},{},{small},{least}-{most},{num_batches}",
            sizes.len(),
            sizes.iter().sum::<u32>(),
            Sorted::new(sizes.iter().copied().map(f64::from)).median().context("no node")?,
            sizes[sizes.len() - 1],
        );
    }
    Ok(())
}

/// Seconds that this process has kept cores busy, where the system says so: hundredths, as Linux counts.
fn core_seconds() -> f64 {
    let ticks = || {
        let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
        // The program's name may hold anything, and numbers follow its bracket: user and system time are the 12th and
        // 13th.
        let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
        Some(fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?)
    };
    ticks().map_or(f64::NAN, |ticks| ticks / 100.0)
}

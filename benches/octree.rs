//! How fast octrees are built: M points/s of the whole, beside reading the file and beside the Morton sort
//! alone, and what the nodes look like. Prints CSV rows; `docs/bench/octree` keeps a run.
//!
//! `SCANWALK_BENCH_POINTS` sets the size of the made-up scans (10 million), `SCANWALK_BENCH_RUNS` the runs (5).
//! Each step happens in a process of its own, so that its peak memory is its own: `read` is the file alone,
//! `sort` and `flat` are the flat cloud (its Morton sort as the octree does it; all of it), `octree` the octree.

use anyhow::{Context, Result, bail, ensure};
use rayon::prelude::*;
use scanwalk::cloud::morton::Grid;
use scanwalk::cloud::octree::{Octree, build_octree};
use scanwalk::cloud::{Order, build};
use scanwalk::progress::{Progress, Stop};
use scanwalk::scan::{self, Scan};
use scanwalk::synth::{self, Kind, SynthOptions};
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

fn main() -> Result<()> {
    let args: Vec<String> = std::env::args().collect();
    if let [_, flag, step, path] = args.as_slice() {
        match flag.as_str() {
            "--step" => return run_step(step, Path::new(path)),
            "--nodes" => return list_nodes(step, Path::new(path)),
            _ => bail!("unknown argument {flag}"),
        }
    }
    let num_points = setting("SCANWALK_BENCH_POINTS", 10_000_000)?;
    let num_runs = setting("SCANWALK_BENCH_RUNS", 5)?;
    let folder = std::env::temp_dir().join(format!("scanwalk-bench-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let result = bench(&folder, num_points, num_runs);
    std::fs::remove_dir_all(&folder)?;
    result
}

fn setting(name: &str, default: u64) -> Result<u64> {
    match std::env::var(name) {
        Ok(text) => text.parse().with_context(|| format!("{name} is '{text}', not a number")),
        Err(_) => Ok(default),
    }
}

fn bench(folder: &Path, points: u64, num_runs: u64) -> Result<()> {
    println!(
        "scan,step,run,points,seconds,core_seconds,m_points_per_s,m_points_per_core_s,peak_bytes_per_point"
    );
    let kinds = [("terrestrial", Kind::Terrestrial), ("aerial", Kind::Aerial)];
    let mut files = Vec::new();
    for (name, kind) in kinds {
        let out = folder.join(name).with_extension("las");
        synth::write(&SynthOptions { kind, out: out.clone(), points, seed: 1 }, &Stop::default())?;
        files.push((name, out));
    }
    for run in 0..num_runs {
        for (name, path) in &files {
            for step in ["read", "sort", "flat", "octree"] {
                println!("{name},{step},{run},{}", child("--step", step, path)?);
            }
        }
    }
    println!("scan,kind,nodes,points,median_points,largest_points,points_in_nodes_below_1000,levels,batches");
    for (name, path) in &files {
        println!("{}", child("--nodes", name, path)?);
    }
    Ok(())
}

fn child(flag: &str, step: &str, path: &Path) -> Result<String> {
    let output = Command::new(std::env::current_exe()?).args([flag, step]).arg(path).output()?;
    ensure!(output.status.success(), "{step} failed: {}", String::from_utf8_lossy(&output.stderr));
    Ok(String::from_utf8(output.stdout)?.trim().to_owned())
}

fn read(path: &Path) -> Result<Scan> {
    let paths: [PathBuf; 1] = [path.to_owned()];
    Ok(scan::read(&paths, &Stop::default())?)
}

/// Points, seconds, seconds of all cores together, rates, peak memory; seconds of the named step alone. Where
/// other programs run beside, the cores' seconds tell more than the clock's.
fn run_step(step: &str, path: &Path) -> Result<()> {
    let (mut start, mut core_start) = (Instant::now(), core_seconds());
    let scan = read(path)?;
    let num_points = scan.num_points();
    if step != "read" {
        (start, core_start) = (Instant::now(), core_seconds());
    }
    match step {
        "read" => drop(black_box(scan)),
        "sort" => drop(black_box(sort(&scan))),
        "flat" => drop(black_box(build(&scan, Order::Morton, &Progress::hidden())?)),
        _ => drop(black_box(octree(&scan)?)),
    }
    let (seconds, cores) = (start.elapsed().as_secs_f64(), core_seconds() - core_start);
    let [rate, core_rate] = [seconds, cores].map(|time| num_points as f64 / time / 1e6);
    let peak = peak_bytes().map_or(f64::NAN, |bytes| bytes as f64 / num_points as f64);
    println!("{num_points},{seconds:.4},{cores:.2},{rate:.2},{core_rate:.2},{peak:.2}");
    Ok(())
}

/// Keys of the octree's size in the octree's order.
fn sort(scan: &Scan) -> Vec<(u64, u32, u32)> {
    let grid = Grid::new(&scan.bounds());
    let file = &scan.files[0];
    let xyz = file.points.xyz.par_iter().enumerate();
    let mut keys: Vec<(u64, u32, u32)> =
        xyz.map(|(i, &xyz)| (grid.code(file.lattice.p_in_world(xyz)), i as u32, file.color(i))).collect();
    keys.par_sort_unstable();
    keys
}

fn octree(scan: &Scan) -> Result<Octree> {
    Ok(build_octree(scan, &Progress::hidden(), &mut |_, _| ())?)
}

/// Sizes of nodes: rows of inner nodes and of leaves.
fn list_nodes(name: &str, path: &Path) -> Result<()> {
    let octree = octree(&read(path)?)?;
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
            sizes[sizes.len() / 2],
            sizes[sizes.len() - 1],
        );
    }
    Ok(())
}

/// Seconds that this process has kept cores busy, where the system says so: hundredths, as Linux counts.
fn core_seconds() -> f64 {
    let ticks = || {
        let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
        // The program's name may hold anything; what follows its bracket is numbers: user and system time are
        // the 12th and 13th.
        let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
        Some(fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?)
    };
    ticks().map_or(f64::NAN, |ticks| ticks / 100.0)
}

/// Largest memory of this process so far, where the system says so.
fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
}

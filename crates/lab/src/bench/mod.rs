//! The papers' tables on this machine: every method, order and viewpoint, timed by the GPU's own clock.
//!
//! Contestants take turns, so that other load on the machine meets them all. A turn draws one frame that does not count
//! before one that does. Another frame, which is not timed, counts what is read and drawn.

mod contestant;
mod copy;
mod papers;
pub mod point_list;
mod rows;
mod subject;
mod tables;
mod way;

use crate::report::{BenchResults, in_order};
use anyhow::{Context, Result, ensure};
use base::task::Task;
use glam::DVec3;
use points::{ReadOptions, Scene};
use render::DrawOptions;
use render::gpu::Gpu;
use std::path::PathBuf;
use std::sync::Arc;
use subject::{Model, Subject};

/// Points of a made-up scan on a software driver, which is slow.
const SOFTWARE_POINTS: u64 = 1_000_000;
/// Points of a made-up scan on a GPU: as many as the 2021 paper's Retz has.
const GPU_POINTS: u64 = 145_000_000;
/// Bytes of memory that a point takes at most, while scan, cloud and octree are made.
const BYTES_PER_POINT: u64 = 100;

base::choice! {
    /// Tables of the papers.
    pub enum Table {
        /// 40-bit depths and two passes beside hardware points.
        Paper2019 = "2019",
        /// Methods × orders × viewpoints.
        Paper2021 = "2021",
        /// Flat clouds and octrees, batches, quantized coordinates.
        Paper2022 = "2022",
        /// Where the time of a headset's frame goes.
        Vr = "vr",
        /// Sequential point trees beside octrees.
        Spt = "spt",
    }
}

/// What to measure.
#[derive(Clone, Debug)]
pub struct BenchOptions {
    /// The scan to measure with; `None`: made-up ones.
    pub scan: Option<PathBuf>,
    /// How the scan is read.
    pub read: ReadOptions,
    /// Where somebody stands in the scan.
    pub eyes: EyesIn,
    /// The GPU to measure.
    pub gpu: Arc<Gpu>,
    /// Draw options of a headset by default.
    pub headset_options: DrawOptions,
    /// Largest part of the point pool that one binding holds, in bytes; 0: as much as the GPU allows.
    pub chunk_limit: u64,
    /// The tables to measure.
    pub tables: Vec<Table>,
    /// Points of the made-up scans; empty: as many as the papers had, or as there is room for.
    pub points: Vec<u64>,
    /// Rows that are wanted beside hardware points, by their methods' names; empty: all.
    pub methods: Vec<String>,
    /// Frames of each row that count.
    pub num_runs: usize,
    /// Width and height of every picture; `None`: the papers'.
    pub size_px: Option<[u32; 2]>,
}

/// Eye positions in world space, one that sees all of a scene and one inside it; the number is the meters of a unit.
pub type EyesIn = fn(&Scene, f64) -> [DVec3; 2];

/// Names that [`BenchOptions::methods`] may hold for these tables: those of their rows, each once.
#[must_use]
pub fn methods(tables: &[Table]) -> Vec<&'static str> {
    in_order(tables.iter().flat_map(|&table| tables::names(table)))
}

/// Measures the tables.
///
/// # Errors
/// A GPU that tells no times or lacks 64-bit atomics, an unreadable scan, too little memory.
pub fn run(options: &BenchOptions, task: &Task) -> Result<BenchResults> {
    ensure!(options.num_runs > 0, "--runs 0: a median needs a run");
    let gpu = &options.gpu;
    let can_time = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
    ensure!(
        can_time,
        "{} cannot tell how long its work takes; choose another GPU with --adapter",
        gpu.name()
    );
    if options.tables.contains(&Table::Paper2021) && !gpu.has_subgroups() {
        eprintln!(
            "scanwalk: {} has no subgroup operations: reduce, reduce-early-z and dedup are measured with a stand-in",
            gpu.name()
        );
    }
    let bench = tables::Bench {
        gpu,
        chunk_limit: options.chunk_limit,
        headset_options: options.headset_options,
        num_runs: options.num_runs,
        size_px: options.size_px,
        methods: &options.methods,
        task,
    };
    let mut results = BenchResults {
        device: gpu.name(),
        driver: gpu.driver(),
        copy_gb_per_s: Some(copy::gb_per_s(gpu)?),
        rows: Vec::new(),
    };
    let mut measure = |subject: &Subject| -> Result<()> {
        let is_of = |table: &&Table| tables::models(**table).contains(&subject.model);
        for table in options.tables.iter().filter(|table| subject.model == Model::Scan || is_of(table)) {
            results.rows.extend(match table {
                Table::Paper2019 => bench.table_2019(subject)?,
                Table::Paper2021 => bench.table_2021(subject)?,
                Table::Paper2022 => bench.table_2022(subject)?,
                Table::Vr => bench.table_vr(subject)?,
                Table::Spt => bench.table_spt(subject)?,
            });
        }
        Ok(())
    };
    if let Some(path) = &options.scan {
        measure(&Subject::read(path, options, task)?)?;
    } else {
        let sizes =
            if options.points.is_empty() { vec![default_points(gpu)] } else { options.points.clone() };
        for points in sizes {
            for model in
                in_order(options.tables.iter().flat_map(|&table| tables::models(table).iter().copied()))
            {
                measure(&Subject::made_up(model, points, task).context("the made-up scan")?)?;
            }
        }
    }
    Ok(results)
}

/// Points of a made-up scan: as many as the papers had, as memory holds, or as a software driver can draw in time.
fn default_points(gpu: &Gpu) -> u64 {
    if gpu.is_software() {
        return SOFTWARE_POINTS;
    }
    available_bytes()
        .map_or(GPU_POINTS / 4, |bytes| GPU_POINTS.min(bytes / BYTES_PER_POINT))
        .max(SOFTWARE_POINTS)
}

/// Memory that programs may take, where the system says so.
fn available_bytes() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("MemAvailable:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
}

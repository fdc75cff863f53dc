//! `scanwalk bench`: the papers' tables on this machine, as text, CSV or JSON on stdout, and as a page.

use super::BenchArgs;
use super::report::bench_document;
use crate::failure::Failure;
use crate::resolve::Plan;
use crate::walk::start::{EYE_HEIGHT_M, start};
use base::output::{OutputKind, Outputs};
use base::task::Task;
use glam::DVec3;
use lab::bench::{self, BenchOptions, Table};
use lab::report::BenchResults;
use points::Scene;
use render::gpu::Gpu;
use std::io::{self, Write};
use std::sync::Arc;

/// Measures, writes the page if one is wanted, prints the results.
pub(super) fn run(args: &BenchArgs, mut outputs: Outputs, plan: &Plan, task: &Task) -> Result<(), Failure> {
    let tables = args.table.map_or(Table::ALL.to_vec(), |table| vec![table]);
    let known = bench::methods(&tables);
    if let Some(unknown) = args.method.iter().find(|name| !known.contains(&name.as_str())) {
        let known = known.join(", ");
        return Err(Failure::Usage(format!("--method {unknown}: not in these tables, which have: {known}")));
    }
    let options = BenchOptions {
        scan: args.scan.clone(),
        read: plan.read.clone(),
        eyes,
        gpu: Arc::new(Gpu::open(Some(&plan.adapter))?),
        chunk_limit: plan.cloud.chunk_limit,
        headset_options: Plan::default().draw.options,
        tables,
        points: args.points.iter().map(|millions| (1e6 * millions).round() as u64).collect(),
        methods: args.method.clone(),
        num_runs: args.runs,
        size_px: args.size,
    };
    let results = bench::run(&options, task).map_err(Failure::Bench)?;
    if let Some((output, out)) = outputs.take_one(OutputKind::Page).zip(args.out.as_ref()) {
        output.write(bench_document(&results, out).as_bytes())?;
    }
    let mut stdout = io::stdout().lock();
    if args.json {
        writeln!(stdout, "{}", serde_json::to_string_pretty(&results).map_err(io::Error::from)?)?;
    } else if args.csv {
        print_csv(&mut stdout, &results)?;
    } else {
        write!(stdout, "{results}")?;
    }
    Ok(())
}

/// Returns the eye of somebody who sees all of a scene, and the eye at a walk's start.
fn eyes(scene: &Scene, unit_m: f64) -> [DVec3; 2] {
    let start = start(scene, unit_m, None);
    [start.overview, start.standpoint].map(|at| {
        let units_per_m = start.units_per_m / at.scale;
        at.floor_in_world + DVec3::Z * EYE_HEIGHT_M * units_per_m
    })
}

/// Prints a row a line. Names hold neither commas nor quotes, except those of the papers' GPUs and scans.
fn print_csv(out: &mut impl Write, results: &BenchResults) -> io::Result<()> {
    writeln!(
        out,
        "table,model,method,order,viewpoint,points,points_read,points_drawn,pixels_asked,nodes,nodes_drawn,median_ms,min_ms,max_ms,\
         geometry_ms,m_points_per_s,gb_per_s,ratio_to_point_list,culled_share,cpu_share,paper_ms,paper_device"
    )?;
    let number = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v:.4}"));
    let count = |value: Option<u64>| value.map_or_else(String::new, |v| v.to_string());
    for row in &results.rows {
        write!(out, "{},{},{},{},{},", row.table, row.model, row.method, row.order, row.viewpoint)?;
        write!(out, "{},{},{},", row.points, row.points_read, row.points_drawn)?;
        write!(out, "{},", count(row.pixels_asked))?;
        write!(out, "{},{},", count(row.nodes), count(row.nodes_drawn))?;
        write!(out, "{:.4},{:.4},{:.4},", row.gpu_ms.median, row.gpu_ms.min, row.gpu_ms.max)?;
        write!(out, "{},", number(row.geometry_ms))?;
        write!(out, "{:.2},{},", row.m_points_per_s, number(row.gb_per_s))?;
        write!(out, "{},{},", number(row.ratio_to_point_list), number(row.culled_share))?;
        write!(out, "{},{},", number(row.cpu_share), number(row.paper_ms))?;
        writeln!(out, "\"{}\"", row.paper_device.as_deref().unwrap_or_default())?;
    }
    Ok(())
}

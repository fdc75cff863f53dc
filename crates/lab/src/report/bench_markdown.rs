//! Benchmark results as Markdown: a page of tables for the documents, as `scanwalk report RESULTS.json… -o TABLES.md`
//! writes it.

use super::bench_results::{BenchResults, BenchRow, GpuMs, PaperSays};
use super::table::in_order;
use std::fmt::Write;

/// The whole page.
#[must_use]
pub fn bench_markdown(results: &BenchResults) -> String {
    let mut page = String::from("# The papers' tables\n\n");
    for (name, value) in results.facts() {
        line(&mut page, &format!("- {name}: {value}"));
    }
    page += HOW_TO_READ;
    for table in results.tables() {
        line(&mut page, &format!("\n## {table}\n"));
        let rows: Vec<&BenchRow> = results.rows.iter().filter(|row| row.table == table).collect();
        match table {
            "2019" | "2021" | "2021-nodes" => add_methods(&mut page, &rows),
            "vr" => add_parts(&mut page, &rows),
            _ => add_rows(&mut page, &rows),
        }
        add_papers(&mut page, &rows);
    }
    page
}

const HOW_TO_READ: &str = "\nMedians of GPU milliseconds a frame (smallest–largest). × is the time of hardware points \
    on the same scan in the same order from the same place, divided by the row's; in parentheses the paper's, of its own \
    scan and GPU: factors can be compared, milliseconds cannot. Geometry is the part of the frame that reads points. Drawn \
    are the points, or discs, that asked for a pixel. GB/s counts the coordinates by their precision, the discs' shapes, \
    the pixels looked at and the colors blended. `report` made this page from the JSON beside it.\n";

fn line(page: &mut String, text: &str) {
    page.push_str(text);
    page.push('\n');
}

fn head(page: &mut String, columns: &[String]) {
    line(page, &format!("| {} |", columns.join(" | ")));
    line(page, &format!("|{}", "---|".repeat(columns.len())));
}

/// Adds a table with a column per method: milliseconds, and the factor beside the paper's.
fn add_methods(page: &mut String, rows: &[&BenchRow]) {
    let methods = in_order(rows.iter().map(|row| row.method.as_str()));
    let names = ["points", "model", "viewpoint", "order"].into_iter().chain(methods.iter().copied());
    head(page, &names.map(String::from).collect::<Vec<_>>());
    let key = |row: &BenchRow| (row.points, row.model.clone(), row.viewpoint.clone(), row.order.clone());
    for wanted in in_order(rows.iter().map(|row| key(row))) {
        let here: Vec<&BenchRow> = rows.iter().copied().filter(|row| key(row) == wanted).collect();
        let of = |method: &str| here.iter().copied().find(|row| row.method == method);
        let hardware_ms = of("point-list").and_then(|row| row.paper_ms);
        let cell = |method: &&str| {
            of(method).map_or_else(
                || "–".into(),
                |row| format!("{}{}", short(row.gpu_ms.median), factor(row, hardware_ms)),
            )
        };
        let (points, model, viewpoint, order) = &wanted;
        let cells: Vec<String> = methods.iter().map(cell).collect();
        line(
            page,
            &format!("| {} | {model} | {viewpoint} | {order} | {} |", millions(*points), cells.join(" | ")),
        );
    }
}

/// Text such as "; 3.1 × (9.3)"; empty for hardware points themselves.
fn factor(row: &BenchRow, paper_hardware_ms: Option<f64>) -> String {
    let Some(ratio) = row.ratio_to_point_list.filter(|_| row.method != "point-list") else {
        return String::new();
    };
    let paper =
        row.paper_ms.zip(paper_hardware_ms).map(|(ms, hardware)| format!(" ({})", short(hardware / ms)));
    format!("; {} ×{}", short(ratio), paper.unwrap_or_default())
}

/// Adds a table with a row per part of the frame and a column per size of the scan.
fn add_parts(page: &mut String, rows: &[&BenchRow]) {
    let sizes = in_order(rows.iter().map(|row| row.points));
    let names = ["viewpoint", "part"].map(String::from).into_iter();
    let columns = names.chain(sizes.iter().map(|&size| millions(size))).chain(["paper".into()]);
    head(page, &columns.collect::<Vec<_>>());
    for (viewpoint, part) in in_order(rows.iter().map(|row| (&row.viewpoint, &row.method))) {
        let of = |size: &u64| {
            let is =
                |row: &&&BenchRow| row.points == *size && (&row.viewpoint, &row.method) == (viewpoint, part);
            rows.iter().find(is).copied()
        };
        let cells: Vec<String> =
            sizes.iter().map(|size| of(size).map_or_else(|| "–".into(), |row| spread(row.gpu_ms))).collect();
        let paper = sizes.iter().find_map(of).and_then(|row| row.paper_ms);
        line(
            page,
            &format!("| {viewpoint} | {part} | {} | {} |", cells.join(" | "), or_dash(paper.map(short))),
        );
    }
    let totals = rows.iter().copied().filter(|row| row.method.starts_with("total"));
    let counted = totals.map(|row| {
        format!(
            "- {}, {}, {}: {} of {} nodes, {} M points read, {} M drawn into {} M pixels{}",
            millions(row.points),
            row.viewpoint,
            row.method,
            row.nodes_drawn.unwrap_or(0),
            row.nodes.unwrap_or(0),
            short(row.points_read as f64 / 1e6),
            short(row.points_drawn as f64 / 1e6),
            short(row.pixels_asked.unwrap_or(0) as f64 / 1e6),
            row.paper_says.as_ref().map_or_else(String::new, |says| format!("; the paper: {}", said(says))),
        )
    });
    page.push('\n');
    counted.for_each(|text| line(page, &text));
}

/// Adds a table with a line per row and all that is counted.
fn add_rows(page: &mut String, rows: &[&BenchRow]) {
    let names = [
        "points",
        "model",
        "viewpoint",
        "order",
        "method",
        "ms",
        "geometry",
        "×",
        "nodes drawn / all",
        "M points read",
        "M drawn",
        "M pixels asked",
        "M points/s",
        "GB/s",
        "culled",
        "CPU",
        "paper, ms",
        "the paper's counts",
    ];
    let are_told = |of: fn(&BenchRow) -> Option<f64>| rows.iter().any(|row| of(row).is_some());
    let is_spt = are_told(|row| row.culled_share);
    let keep = |name: &str| is_spt || !["culled", "CPU"].contains(&name);
    head(page, &names.into_iter().filter(|name| keep(name)).map(String::from).collect::<Vec<_>>());
    for row in rows {
        let is = |other: &&&BenchRow| {
            (&other.model, &other.viewpoint, &other.order, &other.method, other.points)
                == (&row.model, &row.viewpoint, &row.order, &"point-list".to_owned(), row.points)
        };
        let hardware_ms = rows.iter().find(is).and_then(|row| row.paper_ms);
        let percent = |share: Option<f64>| or_dash(share.map(|share| format!("{:.0} %", 100.0 * share)));
        let mut cells = vec![
            millions(row.points),
            row.model.clone(),
            row.viewpoint.clone(),
            row.order.clone(),
            row.method.clone(),
            spread(row.gpu_ms),
            or_dash(row.geometry_ms.map(short)),
            factor(row, hardware_ms).trim_start_matches("; ").replace(" ×", ""),
            row.nodes_drawn
                .zip(row.nodes)
                .map_or_else(|| "–".into(), |(drawn, all)| format!("{drawn}/{all}")),
            short(row.points_read as f64 / 1e6),
            short(row.points_drawn as f64 / 1e6),
            or_dash(row.pixels_asked.map(|pixels| short(pixels as f64 / 1e6))),
            short(row.m_points_per_s),
            or_dash(row.gb_per_s.map(short)),
        ];
        if is_spt {
            cells.extend([percent(row.culled_share), percent(row.cpu_share)]);
        }
        cells.extend([
            or_dash(row.paper_ms.map(short)),
            row.paper_says.as_ref().map_or_else(|| "–".into(), said),
        ]);
        line(page, &format!("| {} |", cells.join(" | ")));
    }
}

/// Adds a list of the papers' scans and GPUs that stand beside ours.
fn add_papers(page: &mut String, rows: &[&BenchRow]) {
    let beside = |row: &BenchRow| {
        row.paper_device.as_ref().map(|device| (row.model.clone(), row.viewpoint.clone(), device.clone()))
    };
    let pairs = in_order(rows.iter().filter_map(|row| beside(row)));
    if pairs.is_empty() {
        return;
    }
    page.push('\n');
    for (model, viewpoint, device) in pairs {
        let of_here = |row: &&&BenchRow| row.model == model && row.viewpoint == viewpoint;
        let here = || rows.iter().filter(of_here);
        let others = in_order(here().flat_map(|row| &row.other_papers).map(|paper| paper.device.as_str()));
        let mut text = format!("- {model}, {viewpoint}: the paper's {device}");
        for other in others {
            let of_row = |row: &&BenchRow| {
                let paper = row.other_papers.iter().find(|paper| paper.device == other)?;
                Some(format!("{} {} ms", row.method, short(paper.ms)))
            };
            let order = here().map(|row| row.order.as_str()).next().unwrap_or_default();
            let times = in_order(here().filter(|row| row.order == order).filter_map(of_row));
            let _ = write!(text, "; {other} ({order}): {}", times.join(", "));
        }
        line(page, &text);
    }
}

/// What a paper says beside its times.
fn said(says: &PaperSays) -> String {
    let thousands = |v: f64| if v < 1e3 { format!("{v}") } else { format!("{} k", short(v / 1e3)) };
    let percent = |[from, to]: [f64; 2]| format!("{:.0}–{:.0} %", 100.0 * from, 100.0 * to);
    let parts = [
        says.nodes_drawn
            .zip(says.nodes)
            .map(|(drawn, all)| format!("{}/{} nodes", thousands(drawn), thousands(all))),
        says.nodes_culled_share.map(|share| format!("{:.0} % of the nodes culled", 100.0 * share)),
        says.points_read.map(|v| format!("{} M read", short(v / 1e6))),
        says.points_drawn.map(|v| format!("{} M drawn", short(v / 1e6))),
        says.m_points_per_s.map(|v| format!("{v:.0} M points/s")),
        says.m_drawn_per_s.map(|v| format!("{v:.0} M drawn/s")),
        says.culled_share.map(|share| format!("{} culled", percent(share))),
        says.cpu_share.map(|share| format!("CPU {}", percent(share))),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn or_dash(text: Option<String>) -> String {
    text.unwrap_or_else(|| "–".into())
}

fn spread(GpuMs { median, min, max }: GpuMs) -> String {
    format!("{} ({}–{})", short(median), short(min), short(max))
}

fn millions(points: u64) -> String {
    format!("{} M", points as f64 / 1e6)
}

/// A number with three digits, or with all digits before the point.
fn short(value: f64) -> String {
    match value {
        v if v >= 100.0 => format!("{v:.0}"),
        v if v >= 10.0 => format!("{v:.1}"),
        v => format!("{v:.2}"),
    }
}

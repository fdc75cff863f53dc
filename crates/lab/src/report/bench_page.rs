//! The page of benchmark results: for each table of a paper its bars, beside the paper's own figures.

use super::bars::{Bar, axis_of, bars};
use super::bench_results::{BenchResults, BenchRow, GpuMs, count};
use super::page::{self, Page};
use super::table::in_order;
use base::words::counted;

/// The whole page as HTML.
#[must_use]
pub fn bench_page(results: &BenchResults) -> String {
    let mut page = Page::new(&format!("Benchmarks on {}", results.device));
    let facts = results.facts();
    page.add(page::facts(facts.iter().map(|(name, value)| (*name, value.as_str()))));
    if results.rows.is_empty() {
        page.add(page::note("Nothing was measured."));
    }
    for table in results.tables() {
        add_table(&mut page, results, table);
    }
    page.finish()
}

/// Model, viewpoint, order and number of points of rows that can be compared with each other.
type Group<'a> = (&'a str, &'a str, &'a str, u64);

fn group(row: &BenchRow) -> Group<'_> {
    (&row.model, &row.viewpoint, &row.order, row.points)
}

fn add_table(page: &mut Page, results: &BenchResults, table: &str) {
    page.section(&heading(table));
    let rows: Vec<&BenchRow> = results.rows.iter().filter(|row| row.table == table).collect();
    page.add(page::paragraph(&compared_with(results, &rows)));
    let mut keys = vec![("good", "median here, and a line from the fastest to the slowest frame")];
    if rows.iter().any(|row| row.paper_ms.is_some()) {
        keys.push(("paper", "the paper's, on the GPU named beside it"));
    }
    page.add(page::keys(keys));
    // All plots of a table share one axis, so that their bars can be compared.
    let all: Vec<Bar> = rows.iter().map(|row| bar(row)).collect();
    let axis = axis_of(all.iter());
    for wanted in in_order(rows.iter().map(|row| group(row))) {
        let (model, viewpoint, order, points) = wanted;
        let bars_of: Vec<Bar> = rows
            .iter()
            .zip(&all)
            .filter(|(row, _)| group(row) == wanted)
            .map(|(_, bar)| bar.clone())
            .collect();
        let model = if model.is_empty() { String::new() } else { format!("{model}, ") };
        let described =
            format!("{model}viewpoint {viewpoint}, order {order}, {}", counted(count(points), "point"));
        page.add(page::figure(bars(&described, "milliseconds a frame", axis, &bars_of), &described));
    }
    page.add(page::figure(
        results.text_table(table).markup(),
        "geometry: of the median, the stages that read points. x point list: how many times as fast as point-list, the hardware's own points, with the same points, order \
         and viewpoint on this GPU.",
    ));
}

/// Sentence that says where a table's times, and the papers' beside them, were measured.
fn compared_with(results: &BenchResults, rows: &[&BenchRow]) -> String {
    let papers = in_order(rows.iter().filter_map(|row| row.paper_device.as_deref()));
    let here = format!("GPU time of a frame on {}.", results.device);
    if papers.is_empty() {
        return format!("{here} The paper has no figures for these.");
    }
    let papers = papers.join(", ");
    format!(
        "{here} The paper's times were measured on {papers} with the paper's scans: compare which method is faster and \
         by what factor rather than milliseconds."
    )
}

fn heading(table: &str) -> String {
    match table {
        "2019" => "Table 2019: 40-bit depths and two passes beside hardware points".into(),
        "2021-nodes" => "Table 2021-nodes: all points in small and in large nodes".into(),
        "2022-order" => "Table 2022-order: a scanner's order beside Morton order".into(),
        "2021" => "Table 2021: compute shaders beside hardware points".into(),
        "2022" => "Table 2022: batches and quantized coordinates".into(),
        "vr" => "Table vr: both eyes".into(),
        "spt" => "Table spt: sequential point trees".into(),
        other => format!("Table {other}"),
    }
}

fn bar(row: &BenchRow) -> Bar {
    let GpuMs { median, min, max } = row.gpu_ms;
    let paper = row.paper_ms.map_or_else(String::new, |ms| {
        // Only the GPU is named here; the scan, which may follow it, stands in the table below.
        let device = row.paper_device.as_deref().and_then(|text| text.split(',').next()).unwrap_or("its GPU");
        format!("; paper {} on {device}", short(ms))
    });
    Bar {
        name: row.method.clone(),
        words: format!("{} ms{paper}", short(median)),
        value: median,
        range: [min, max],
        mark: row.paper_ms,
    }
}

/// Milliseconds with three digits.
fn short(ms: f64) -> String {
    match ms {
        ms if ms < 10.0 => format!("{ms:.2}"),
        ms if ms < 100.0 => format!("{ms:.1}"),
        ms => format!("{ms:.0}"),
    }
}

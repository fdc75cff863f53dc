//! `scanwalk bench` at a size where nothing is worth timing: every row is there, and its counts are true.

use base::task::{CancelToken, Task};
use lab::bench::{self, BenchOptions, Table};
use lab::report::{BenchResults, BenchRow, bench_markdown, bench_page};
use lab::technique::Method;
use points::ReadOptions;
use render::gpu::Gpu;
use scanwalk::resolve::Plan;
use std::sync::Arc;

const POINTS: u64 = 20_000;

fn measure(table: Table, points: u64) -> BenchResults {
    measure_some(table, points, &[])
}

fn measure_some(table: Table, points: u64, methods: &[&str]) -> BenchResults {
    let options = BenchOptions {
        scan: None,
        read: ReadOptions::AS_FILES_SAY,
        eyes: |_, _| unreachable!("no scan of a user's"),
        // Times are read from a GPU that draws nothing else meanwhile.
        gpu: Arc::new(Gpu::open(None).expect("a GPU")),
        chunk_limit: 0,
        headset_options: Plan::default().draw.options,
        tables: vec![table],
        points: vec![points],
        methods: methods.iter().map(|&name| name.into()).collect(),
        num_runs: 1,
        size_px: Some([96, 54]),
    };
    bench::run(&options, &Task::new(&CancelToken::default())).expect("a software driver has all it takes")
}

fn row<'a>(results: &'a BenchResults, method: &str, order: &str, viewpoint: &str) -> &'a BenchRow {
    let is = |row: &&BenchRow| row.method == method && row.order == order && row.viewpoint == viewpoint;
    results.rows.iter().find(is).unwrap_or_else(|| panic!("{method} {order} {viewpoint}"))
}

#[test]
fn the_table_of_2021_has_every_method_order_and_viewpoint() {
    let results = measure(Table::Paper2021, POINTS);
    assert!(results.copy_gb_per_s.is_some_and(|rate| rate > 0.0));
    // There are four places in the courtyard, two before the statue, and its nodes.
    assert_eq!(results.rows.len(), 14 * 4 * (4 + 2) + 2 * 2);
    let methods =
        ["point-list", "just-set", "busy-loop", "atomic-min", "early-z", "reduce", "reduce-early-z", "dedup"];
    for method in methods.into_iter().chain(["hqs", "hqs1", "hqs1r", "fixed40", "prefetch", "exchange-loop"])
    {
        for order in ["original", "morton", "shuffled", "shuffled-morton"] {
            for viewpoint in ["overview", "close-up", "outside-frustum", "stair", "face"] {
                let row = row(&results, method, order, viewpoint);
                // Nothing is culled, as in the 2021 paper.
                assert_eq!((row.points, row.points_read), (POINTS, POINTS), "{method} {order} {viewpoint}");
                assert!(row.gpu_ms.median > 0.0 && row.ratio_to_point_list.is_some());
                assert_eq!(
                    row.points_drawn == 0,
                    viewpoint == "outside-frustum",
                    "{method} {order} {viewpoint}"
                );
                // The paper's table lacks these methods.
                let is_ours = ["hqs1", "fixed40", "prefetch", "exchange-loop"].contains(&method);
                assert_eq!(row.paper_ms.is_none(), is_ours, "{method}");
            }
        }
    }
    for viewpoint in ["small-nodes", "large-nodes"] {
        for method in ["point-list", "reduce-early-z"] {
            assert!(row(&results, method, "morton", viewpoint).paper_ms > Some(0.0));
        }
    }
    let nodes = |viewpoint| row(&results, "reduce-early-z", "morton", viewpoint).nodes;
    assert!(nodes("small-nodes") > nodes("large-nodes"));
    // The first point of a pixel is rarely the nearest in the files' order; all methods ask at least once a pixel.
    let drawn = row(&results, "early-z", "morton", "overview").points_drawn;
    assert!(drawn > 1000 && drawn < POINTS, "{drawn}");
    // Each row counts what its own method asks for.
    let drawn = |method| row(&results, method, "morton", "overview").points_drawn;
    let in_picture = drawn("atomic-min");
    assert_eq!(drawn("point-list"), in_picture);
    assert_eq!(drawn("just-set"), in_picture);
    for looks_first in ["early-z", "prefetch", "busy-loop", "exchange-loop", "fixed40", "hqs"] {
        assert!(drawn(looks_first) < in_picture, "{looks_first}");
    }
    assert!(drawn("reduce") <= in_picture && drawn("reduce-early-z") <= drawn("reduce"));
    // Dedup looks first, and one of a subgroup's points in a pixel asks: fewer than with early-z, whose threads ask
    // alone.
    let looks = |method| row(&results, method, "morton", "overview").bytes_read.expect("bytes").pixels;
    assert_eq!(looks("dedup"), 8 * in_picture, "every point in the picture looks first");
    assert_eq!((looks("atomic-min"), looks("just-set")), (0, 0));
    assert!(drawn("dedup") < in_picture);
    // Both stages read coordinates and look at the depth; colors are loaded only of points near the surface.
    let [hqs, closest] = ["hqs", "early-z"]
        .map(|method| row(&results, method, "morton", "overview").bytes_read.expect("bytes"));
    assert_eq!((hqs.planes, closest.planes), (2 * 12 * POINTS, 12 * POINTS));
    assert_eq!((hqs.pixels, closest.pixels), (2 * 4 * in_picture, 8 * in_picture));
    assert!(hqs.colors > 0 && hqs.colors <= 4 * in_picture && closest.colors == 0);
    let page = bench_page(&results);
    assert!(Method::ALL.iter().filter(|m| methods.contains(&m.name())).all(|m| page.contains(m.name())));
}

#[test]
fn the_table_of_2022_counts_what_culling_and_precision_save() {
    // There are enough batches for some to be far away.
    const POINTS: u64 = 150_000;
    let results = measure(Table::Paper2022, POINTS);
    let row = |method, viewpoint| row(&results, method, "morton", viewpoint);
    for viewpoint in ["overview", "close-up"] {
        assert_eq!(row("basic-no-cull", viewpoint).points_read, POINTS);
        let [culled, all] = ["prefetch", "prefetch-no-cull"].map(|method| row(method, viewpoint));
        assert!(culled.points_read <= all.points_read && culled.nodes_drawn <= all.nodes_drawn);
        // Both methods see the same points, and which point asks first differs from run to run.
        assert!(culled.points_drawn.abs_diff(all.points_drawn) * 5 < all.points_drawn);
        assert!(row("lod", viewpoint).points_read <= POINTS);
        assert!(row("hqs", viewpoint).gb_per_s > Some(0.0));
        for method in ["prefetch", "prefetch-just-set", "lod-hqs"] {
            let row = row(method, viewpoint);
            assert!(row.geometry_ms > Some(0.0) && row.geometry_ms < Some(row.gpu_ms.median), "{method}");
        }
        assert_eq!(row("point-list", viewpoint).geometry_ms, None);
    }
    let rate = |method| row(method, "overview").gb_per_s.zip(Some(row(method, "overview").gpu_ms.median));
    let bytes = |method| rate(method).map(|(rate, ms)| rate * ms * 1e6).expect("a rate");
    let ratio = bytes("prefetch-full-precision") / bytes("prefetch");
    assert!(ratio > 1.2 && ratio < 3.01, "{ratio} times as many bytes at full precision");
}

/// Hardware points are always measured: the other methods' ratios are to them.
#[test]
fn some_methods_of_a_table_can_be_measured_alone() {
    let results = measure_some(Table::Paper2022, POINTS, &["lod", "prefetch"]);
    let of_table = |table: &str| -> Vec<String> {
        let rows = results.rows.iter().filter(|row| row.table == table);
        rows.map(|row| format!("{} {} {}", row.model, row.viewpoint, row.method)).collect()
    };
    let places = [
        "courtyard overview",
        "courtyard close-up",
        "courtyard terrace",
        "landscape overview",
        "statue overview",
    ];
    let wanted = places.iter().flat_map(|p| ["point-list", "prefetch", "lod"].map(|m| format!("{p} {m}")));
    assert_eq!(of_table("2022"), wanted.collect::<Vec<_>>());
    assert!(results.rows.iter().filter(|row| row.table == "2022").all(|row| row.paper_ms.is_some()));
    // A scanner's order is measured beside Morton's, from outside and from inside.
    assert_eq!(of_table("2022-order").len(), 2 * 2 * 2);
    let says = |order| row(&results, "prefetch", order, "close-up").paper_says.clone().expect("counts");
    assert_eq!(says("original").nodes_culled_share, Some(0.35));
    assert!(says("morton").m_points_per_s.is_some());
    let markdown = bench_markdown(&results);
    assert!(markdown.contains("## 2022-order") && markdown.contains("Niederweiden"), "{markdown}");
    let columns = |line: &str| line.matches('|').count();
    for table in markdown.split("\n\n").filter(|part| part.starts_with('|')) {
        let head = table.lines().next().map(columns);
        assert!(table.lines().all(|line| Some(columns(line)) == head), "{table}");
    }
    assert!(bench::methods(&[Table::Paper2022, Table::Spt]).contains(&"spt-hqs"));
}

#[test]
fn the_table_of_2019_is_of_three_models() {
    let results = measure(Table::Paper2019, POINTS);
    let models = ["courtyard", "landscape", "statue"];
    assert_eq!(results.rows.len(), 3 * models.len());
    for (rows, model) in results.rows.chunks(3).zip(models) {
        let names: Vec<&str> = rows.iter().map(|row| row.method.as_str()).collect();
        assert_eq!(names, ["point-list", "fixed40", "hqs"]);
        assert!(rows.iter().all(|row| row.model == model && row.paper_ms > Some(1.0)));
    }
}

#[test]
fn the_table_of_vr_breaks_the_frame_down() {
    let results = measure(Table::Vr, POINTS);
    let names: Vec<&str> = results.rows.iter().map(|row| row.method.as_str()).collect();
    let wanted = ["total", "clear", "lod", "cull", "depth-both-eyes", "depth-one-eye", "color-both-eyes"];
    assert!(wanted.iter().all(|name| names.contains(name)), "{names:?}");
    // Counts are of the frame that is timed: each of its two eyes sees as many points as one does.
    let counts = |name: &str| &results.rows[names.iter().position(|n| *n == name).expect(name)];
    let (both, one) = (counts("total"), counts("total-one-eye"));
    assert!(both.points_drawn > one.points_drawn && both.points_read >= one.points_read);
    assert!(both.pixels_asked > Some(both.points_drawn), "points are drawn as discs");
    let ms = |name: &str| results.rows[names.iter().position(|n| *n == name).expect(name)].gpu_ms.median;
    let parts: f64 =
        ["clear", "lod", "cull", "depth-both-eyes", "color-both-eyes", "resolve"].map(ms).iter().sum();
    assert!((0.5..1.5).contains(&(parts / ms("total"))), "parts {parts} of {}", ms("total"));
}

#[test]
fn the_table_of_spt_compares_trees() {
    let results = measure(Table::Spt, POINTS);
    for viewpoint in ["overview", "close-up"] {
        let row = |method| row(&results, method, "morton", viewpoint);
        assert!(row("spt").points_read > 0 && row("spt-hqs").gpu_ms.median > 0.0);
        // A small disc stands for many points, counts once, and asks for all of its pixels.
        let (drawn, asked) = (row("spt").points_drawn, row("spt").pixels_asked.expect("pixels"));
        assert!(drawn > 0 && drawn <= row("spt").points_read, "{drawn} of {}", row("spt").points_read);
        assert!(asked > drawn, "{asked} pixels of {drawn} discs");
        let share = row("spt").culled_share.expect("a share");
        assert!((0.0..1.0).contains(&share) && row("lod").culled_share.is_none());
        assert!(row("spt").cpu_share > Some(0.0) && row("spt").paper_says.is_some());
        let bytes = row("spt").bytes_read.expect("bytes");
        assert_eq!(bytes.shapes, 4 * row("spt").points_read);
    }
}

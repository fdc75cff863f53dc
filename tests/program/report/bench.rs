//! Benchmark results: the contract's JSON, read, written and shown.

use super::faults;
use lab::report::{BenchError, BenchResults, BenchRow, GpuMs, bench_page};

/// The contract's own text, word for word.
const JSON: &str = r#"{"device": "some GPU", "driver": "1.2", "copy_gb_per_s": 12.5, "rows": [
    {"table": "2021", "method": "point-list", "order": "original", "viewpoint": "overview", "points": 4000000,
     "points_read": 4000000, "points_drawn": 3900000, "gpu_ms": {"median": 20.0, "min": 19.0, "max": 24.0},
     "m_points_per_s": 200.0, "ratio_to_point_list": 1.0, "paper_ms": 13.3, "paper_device": "RTX 3090"},
    {"table": "2021", "method": "reduce-early-z", "order": "original", "viewpoint": "overview", "points": 4000000,
     "points_read": 4000000, "points_drawn": 3900000, "gpu_ms": {"median": 0.5, "min": 0.4, "max": 0.9},
     "m_points_per_s": 8000.0, "ratio_to_point_list": 40.0, "paper_ms": null, "paper_device": null, "more": 1}]}"#;

fn read(text: &str) -> Result<BenchResults, BenchError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.json");
    std::fs::write(&path, text).unwrap();
    BenchResults::read(&path)
}

#[test]
fn the_contracts_json_is_read_and_written() {
    let results = read(JSON).unwrap();
    assert_eq!((results.device.as_str(), results.rows.len()), ("some GPU", 2));
    assert_eq!(results.rows[0].paper_device.as_deref(), Some("RTX 3090"));
    assert_eq!(results.rows[1].paper_ms, None);
    let again = read(&serde_json::to_string(&results).unwrap()).unwrap();
    assert_eq!(again, results);
    let other = BenchResults { device: "x".into(), ..results.clone() };
    assert_ne!(read(&serde_json::to_string(&other).unwrap()).unwrap(), results, "the comparison can fail");
    let keys: serde_json::Value = serde_json::to_value(&results.rows[0]).unwrap();
    for key in ["table", "method", "order", "viewpoint", "points", "points_read", "points_drawn", "gpu_ms"] {
        assert!(!keys[key].is_null(), "{key}");
    }
}

#[test]
fn what_is_no_result_says_why() {
    for (text, words) in [
        ("", "EOF"),
        ("[1, 2]", "line 1"),
        (&JSON[..JSON.len() / 2], "EOF"),
        (&JSON.replace("\"rows\"", "\"lines\""), "missing field `rows`"),
        (&JSON.replace("19.0", "-19.0"), "the times of row 1 cannot be"),
        (&JSON.replace("\"min\": 0.4", "\"min\": 0.6"), "the times of row 2 cannot be"),
        (&JSON.replace("8000.0", "1e300"), "the times of row 2 cannot be"),
        (&JSON.replace("24.0", "1e999"), "number out of range"),
        (&JSON.replace("20.0", "NaN"), "line 3"),
        (&JSON.replace("\"more\": 1", &format!("\"more\": {}", "[".repeat(1 << 20))), "expected value"),
        (&" ".repeat(17 << 20), "larger than 16 MiB"),
    ] {
        let message = read(text).expect_err(words).to_string();
        assert!(message.contains(words) && message.contains("results.json"), "{message}");
    }
    assert!(BenchResults::read("no/such.json".as_ref()).unwrap_err().to_string().contains("no/such.json"));
}

#[test]
fn the_page_shows_every_row_and_what_it_stands_beside() {
    let results = read(JSON).unwrap();
    let page = bench_page(&results);
    assert_eq!(faults(&page), Vec::<String>::new());
    for expected in [
        "Benchmarks on some GPU",
        "12.5 GB/s",
        "viewpoint overview, order original, 4 000 000 points",
        "logarithmic",
        "20.0 ms; paper 13.3 on RTX 3090",
        "0.50 ms<",
        "class=\"paper\"",
        "class=\"whisker\"",
        "<td>40.00</td>",
        "x point list: how many times as fast as point-list",
    ] {
        assert!(page.contains(expected), "{expected} is not in the page");
    }
    let text = results.to_string();
    assert!(text.contains("table 2021") && text.contains("reduce-early-z"), "{text}");
}

#[test]
fn odd_results_have_a_page_too() {
    let row = |name: &str, median: f64| BenchRow {
        table: name.into(),
        method: format!("{name}<i>"),
        gpu_ms: GpuMs { median, min: 0.0, max: 1e12 },
        ..BenchRow::default()
    };
    let rows = (0..50).map(|at| row(["a", "b", "2022", "<c>"][at % 4], [0.0, 1e-9, 5.0, 1e11][at / 4 % 4]));
    for rows in [vec![], vec![row("", 0.0)], rows.collect()] {
        let results = BenchResults { rows, ..BenchResults::default() };
        assert_eq!(faults(&bench_page(&results)), Vec::<String>::new());
        assert!(!results.to_string().is_empty());
    }
}

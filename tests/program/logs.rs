//! The text of a frame log, in the form in which the program writes it.

use timing::columns;

/// A log of `num_frames` rows, a hundred a second, all within the budget; the stage `depth` takes longest. `head` stands in
/// each cell of the head's pose.
pub fn frame_log(num_frames: usize, head: &str) -> String {
    let names = columns::names();
    let row = |frame: usize| {
        let cell = |name: &String| match name.as_str() {
            "frame" => frame.to_string(),
            "time_s" => (frame as f64 / 100.0).to_string(),
            "depth_ms" => "4".into(),
            "gpu_ms" => "8".into(),
            "budget_ms" => "11.1".into(),
            "over_budget" | "missed_periods" => "0".into(),
            "quality" => "closest".into(),
            "phase" => "walking".into(),
            "session" => "simulated".into(),
            name if name.starts_with("head_") => head.into(),
            _ => "1".into(),
        };
        names.iter().map(cell).collect::<Vec<String>>().join(",") + "\n"
    };
    let rows: String = (0..num_frames).map(row).collect();
    format!("{}, version 0.1.0\n# scan: yard.laz\n{}\n{rows}", columns::TITLE, names.join(","))
}

//! Reports: pages that open anywhere, that lose no spike and believe no name, whatever was measured; worst frames
//! that can be seen again; comparisons that tell a difference from chance.

mod bench;
mod compare;
mod page;
mod phases;
mod worst;

use base::space::Pose;
use glam::{DQuat, DVec3};
use timing::{FrameLogFile, FrameRow, LoggedFrame, Phase};

/// A log at 90 Hz whose frames take the GPU `ms(frame)`.
pub fn log_of(num_frames: u64, ms: impl FnMut(u64) -> f64) -> FrameLogFile {
    let budget_ms = 1000.0 / 90.0;
    let frame = |(frame, gpu_ms): (u64, f64)| LoggedFrame {
        frame,
        time_s: frame as f64 / 90.0,
        cpu_ms: [2.0, 0.5, 0.2],
        stage_ms: [0.02, 0.05, 0.05, 0.5, 0.25, 0.08, 0.02].map(|part| part * gpu_ms).to_vec(),
        gpu_ms,
        budget_ms,
        over_budget: gpu_ms > budget_ms,
        missed_periods: u64::from(gpu_ms > 2.0 * budget_ms),
        lod_scale: if frame % 5000 > 4000 { 1.5 } else { 1.0 },
        resolution_scale: 1.0,
        quality: Some(u8::from(frame % 7000 > 6500)),
        world_from_head: Some(Pose {
            position: DVec3::new(4e6 + frame as f64 / 7.0, -3.25, 1.7),
            orientation: DQuat::from_rotation_z(0.01 * frame as f64),
        }),
        call_ms: [f64::NAN; 5],
        session: Some(0),
        phase: Phase::Walking,
    };
    FrameLogFile {
        facts: [("scan", "yard.laz"), ("device", "some GPU")].map(|(n, v)| (n.into(), v.into())).to_vec(),
        stages: ["clear", "lod", "cull", "depth", "color", "resolve"].map(String::from).to_vec(),
        qualities: vec!["hqs".into(), "closest".into()],
        sessions: vec!["FOCUSED".into()],
        frames: (0..num_frames).zip((0..num_frames).map(ms)).map(frame).collect(),
        ..FrameLogFile::default()
    }
}

/// The frame thread's row of such a frame.
pub fn row_of(frame: &LoggedFrame) -> FrameRow {
    FrameRow {
        frame: frame.frame,
        time_s: frame.time_s,
        gpu_ms: frame.gpu_ms as f32,
        budget_ms: frame.budget_ms as f32,
        quality: "hqs",
        world_from_head: frame.world_from_head,
        phase: frame.phase,
        ..FrameRow::sample()
    }
}

/// Frame times like a walk's, without a spike: slow waves and a little noise, the same every time.
pub fn wave_ms(frame: u64) -> f64 {
    let noise = frame.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40;
    6.0 + 2.0 * (frame as f64 / 900.0).sin() + 0.5 * (noise as f64 / (1 << 24) as f64)
}

/// What keeps a page from opening right in any browser, without a network: nothing if all is well.
pub fn faults(page: &str) -> Vec<String> {
    use quick_xml::events::Event;
    let mut reader = quick_xml::Reader::from_str(page);
    let (mut depth, mut faults) = (0, Vec::new());
    loop {
        match reader.read_event() {
            Ok(Event::Eof) => break,
            Ok(Event::Start(_)) => depth += 1,
            Ok(Event::End(_)) => depth -= 1,
            Ok(_) => {}
            Err(error) => {
                faults.push(format!("{error} at byte {}", reader.error_position()));
                break;
            }
        }
    }
    if depth != 0 && faults.is_empty() {
        faults.push(format!("{depth} elements stay open"));
    }
    let needed = ["<!DOCTYPE html>", "charset=\"utf-8\"", "name=\"viewport\"", "prefers-color-scheme: dark"];
    faults
        .extend(needed.iter().filter(|word| !page.contains(**word)).map(|word| format!("{word} is missing")));
    let outside = ["<script", "<link", "<img", "<iframe", "src=", "href=", "url(", "@import", "NaN", "inf\""];
    faults.extend(outside.iter().filter(|word| page.contains(**word)).map(|word| format!("it has {word}")));
    faults
}

#[test]
fn faults_are_found() {
    let good = lab::report::walk_page(&log_of(100, wave_ms));
    assert_eq!(faults(&good), Vec::<String>::new());
    for (from, to) in [
        ("</figure>", ""),
        ("</h1>", "</h2>"),
        ("yard.laz", "yard & son.laz"),
        ("yard.laz", "<script>1</script>"),
        ("name=\"viewport\"", "name=\"view\""),
        ("</html>", ""),
        ("<h1>", "<h1 style=\"background: url(x)\">"),
    ] {
        assert_eq!(faults(&good.replacen(from, to, 1)).len(), 1, "{from} to {to}");
    }
}

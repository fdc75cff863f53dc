//! The page of one log.

use super::{faults, log_of, wave_ms};
use lab::report::walk_page;
use timing::FrameLogFile;

#[test]
fn whatever_was_logged_there_is_a_page() {
    let usual = log_of(3000, |frame| wave_ms(frame) + if frame % 500 == 7 { 30.0 } else { 0.0 });
    let changed = |change: &dyn Fn(&mut FrameLogFile)| {
        let mut log = usual.clone();
        change(&mut log);
        log
    };
    let logs = [
        ("usual", usual.clone()),
        ("empty", log_of(0, wave_ms)),
        ("one frame", log_of(1, wave_ms)),
        ("two frames", log_of(2, wave_ms)),
        (
            "no GPU times",
            changed(&|log| {
                for frame in &mut log.frames {
                    frame.gpu_ms = f64::NAN;
                    frame.stage_ms.fill(f64::NAN);
                }
            }),
        ),
        (
            "a stage without times",
            changed(&|log| log.frames.iter_mut().for_each(|f| f.stage_ms[2] = f64::NAN)),
        ),
        (
            "no stages",
            changed(&|log| {
                log.stages.clear();
                log.frames.iter_mut().for_each(|frame| frame.stage_ms.clear());
            }),
        ),
        (
            "no governor, no poses",
            changed(&|log| {
                log.qualities.clear();
                for frame in &mut log.frames {
                    (frame.lod_scale, frame.resolution_scale) = (f64::NAN, f64::NAN);
                    (frame.quality, frame.world_from_head) = (None, None);
                }
            }),
        ),
        ("all at one time", changed(&|log| log.frames.iter_mut().for_each(|frame| frame.time_s = 5.0))),
        ("backwards", changed(&|log| log.frames.reverse())),
        (
            "beyond measure",
            changed(&|log| {
                log.frames[9].gpu_ms = 1e12;
                log.frames[10].gpu_ms = -1e12;
                log.frames[11].time_s = -1e12;
                log.frames[12].budget_ms = -5.0;
                log.frames[13].stage_ms[0] = 1e12;
            }),
        ),
        (
            "all zero",
            changed(&|log| {
                for frame in &mut log.frames {
                    (frame.gpu_ms, frame.budget_ms) = (0.0, 0.0);
                }
            }),
        ),
        (
            "many budgets",
            changed(&|log| {
                for (at, frame) in log.frames.iter_mut().enumerate() {
                    frame.budget_ms = 1000.0 / [72.0, 90.0, 120.0][at % 3];
                }
            }),
        ),
    ];
    for (name, log) in logs {
        assert_eq!(faults(&walk_page(&log)), Vec::<String>::new(), "{name}");
    }
}

#[test]
fn the_page_has_what_the_text_has_and_more() {
    let page = walk_page(&log_of(3000, |frame| wave_ms(frame) + if frame == 1234 { 30.0 } else { 0.0 }));
    for expected in [
        "A walk through yard.laz",
        "<dt>device</dt><dd>some GPU</dd>",
        "3000 in 33.3 s, 90.0 a second",
        "1 frame, 0.03 %",
        "One frame goes beyond the top: 3",
        "99.9 %",
        "Costliest: depth, ",
        "class=\"missed\"",
        "class=\"over\"",
        "closest",
        "<td>1234</td><td>13.71</td>",
        "--pose-path worst.poses",
        "time_s,x,y,z,qx,qy,qz,qw",
    ] {
        assert!(page.contains(expected), "{expected} is not in the page");
    }
}

/// The lowest y of a path's points, that is its highest point.
fn highest_point(page: &str, class: &str) -> f64 {
    let start = page.find(&format!("<path class=\"{class}\" d=\"")).expect("the path");
    let d = page[start..].split('"').nth(3).expect("its points");
    let points = d.split(['M', 'L', 'Z']).filter(|point| !point.is_empty());
    points
        .map(|point| point.split(' ').nth(1).expect("y").parse::<f64>().expect("a number"))
        .fold(f64::MAX, f64::min)
}

#[test]
fn a_long_log_makes_a_small_page_and_loses_no_spike() {
    const NUM: u64 = 100_000;
    let calm = walk_page(&log_of(NUM, wave_ms));
    let spiky = walk_page(&log_of(NUM, |frame| if frame == 54_321 { 15.0 } else { wave_ms(frame) }));
    for page in [&calm, &spiky] {
        assert!(page.len() < 500_000, "{} bytes", page.len());
        assert_eq!(faults(page), Vec::<String>::new());
    }
    // The plot reaches to 15.75 ms, 1.05 times the longest frame, over 240 units below the first 8.
    let y = |ms: f64| 8.0 + 240.0 * (1.0 - ms / 15.75);
    assert!((highest_point(&spiky, "frames") - y(15.0)).abs() < 0.2, "{}", highest_point(&spiky, "frames"));
    assert!((highest_point(&spiky, "over") - y(15.0)).abs() < 0.2);
    assert!(!calm.contains("<path class=\"over\""));
}

#[test]
fn names_from_files_stay_text() {
    let mut log = log_of(300, wave_ms);
    let hostile = "</title><script>alert(\"&\")</script>\u{1}'";
    log.facts = vec![("scan".into(), hostile.into()), (hostile.into(), hostile.into())];
    log.stages = vec![hostile.into(); 6];
    log.qualities = vec![hostile.into(), "x".into()];
    let page = walk_page(&log);
    assert_eq!(faults(&page), Vec::<String>::new());
    assert!(page.contains("&lt;/title&gt;&lt;script&gt;"));
}

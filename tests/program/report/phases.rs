//! Frames before the walk are told apart: those without a scan, and those while it is built beside them.

use super::{faults, log_of, row_of, wave_ms};
use base::output::{Output, OutputKind};
use lab::report::{Comparison, Summary, walk_page, worst};
use timing::{FrameLog, FrameLogFile, Phase, RunFacts, columns, read};

/// A walk that is the same whatever came before, after a start in which every frame is over its budget, by ten times
/// while the scan is built.
fn started(num_waiting: u64, num_arriving: u64, num_walking: u64) -> FrameLogFile {
    let walk_begins = num_waiting + num_arriving;
    let mut log = log_of(walk_begins + num_walking, |frame| match frame {
        _ if frame < num_waiting => 13.0,
        _ if frame < walk_begins => 130.0,
        _ => wave_ms(frame - walk_begins),
    });
    for frame in &mut log.frames {
        if frame.frame < num_waiting {
            (frame.phase, frame.world_from_head) = (Phase::Waiting, None);
        } else if frame.frame < walk_begins {
            frame.phase = Phase::Arriving;
        }
    }
    log
}

/// The log as if nobody told the phases apart.
fn mixed(log: &FrameLogFile) -> FrameLogFile {
    let mut log = log.clone();
    log.frames.iter_mut().for_each(|frame| frame.phase = Phase::Walking);
    log
}

#[test]
fn figures_are_of_the_walk() {
    let log = started(120, 54, 169);
    let summary = Summary::of(&log);
    assert_eq!((summary.counted_phase, summary.num_frames), (Phase::Walking, 169));
    assert_eq!((summary.num_over_budget, summary.missed_periods), (0, 0));
    assert!(summary.gpu_ms.percentile(1000) < Some(9.0));
    assert!((summary.duration_s - 168.0 / 90.0).abs() < 1e-9, "{}", summary.duration_s);
    let text = summary.to_string();
    for expected in [
        "waiting     120 frames before the scan was shown: 120 over budget, 0 display periods missed",
        "arriving    54 frames while the scan was being built beside them: 54 over budget, 54 display periods",
        "frames      169 in 1.9 s, 90.0 a second",
        "over        0 frames, 0.00 %",
    ] {
        assert!(text.contains(expected), "{expected} is not in\n{text}");
    }
    assert!(worst(&log).iter().all(|frame| frame.phase == Phase::Walking));
    // These would be the figures otherwise.
    assert_eq!(Summary::of(&mixed(&log)).num_over_budget, 174);
    assert!(worst(&mixed(&log))[0].gpu_ms > 100.0);
}

/// What is written of the marks beside a plot: where they end, and how long they are at most.
fn marks(page: &str) -> Vec<(f64, String)> {
    page.split("<text class=\"mark end\" x=\"")
        .skip(1)
        .filter_map(|rest| {
            let (x, rest) = rest.split_once('"')?;
            let text = rest.split_once('>')?.1.split_once('<')?.0;
            Some((x.parse().ok()?, text.to_owned()))
        })
        .collect()
}

#[test]
fn marks_fit_beside_their_plots() {
    let mut log = started(5, 5, 50);
    let states = ["IDLE", "READY", "SYNCHRONIZED", "VISIBLE", "FOCUSED", "LOSS_PENDING", "simulated"];
    log.sessions = states.map(String::from).to_vec();
    for (frame, state) in log.frames.iter_mut().zip((0..states.len() as u8).cycle()) {
        frame.session = Some(state);
    }
    let page = walk_page(&log);
    let marks = marks(&page);
    assert!(!marks.is_empty() && states.iter().all(|state| page.contains(&format!("</span>{state}</li>"))));
    // Letters of marks are 12 units high, and capital letters 8 wide at most.
    let cut: Vec<_> = marks.iter().filter(|(x, text)| *x < 7.5 * text.chars().count() as f64).collect();
    assert!(cut.is_empty(), "{cut:?}");
}

#[test]
fn states_of_the_session_are_bands_as_long_as_they_lasted() {
    let mut log = started(0, 0, 300);
    log.sessions = ["READY", "FOCUSED"].map(String::from).to_vec();
    for (at, frame) in log.frames.iter_mut().enumerate() {
        frame.session = Some(u8::from(at >= 75));
    }
    let page = walk_page(&log);
    let widths: Vec<f64> = page
        .split("<rect class=\"band")
        .skip(1)
        .filter_map(|rest| rest.split_once("width=\"")?.1.split_once('"')?.0.parse().ok())
        .collect();
    let [ready, focused] = widths[..] else { panic!("{widths:?}") };
    assert!((3.0 * ready - focused).abs() < 4.0, "{widths:?}");
    assert!(page.contains("<path class=\"cpu\""));
    log.sessions.truncate(1);
    assert!(!walk_page(&log).contains("<rect class=\"band"), "one state needs no bands");
}

#[test]
fn the_page_shows_when_the_walk_begins() {
    let log = started(120, 54, 169);
    let page = walk_page(&log);
    assert_eq!(faults(&page), Vec::<String>::new());
    for expected in [
        "<dt>waiting</dt><dd>120 frames",
        "<dt>arriving</dt>",
        "0 frames, 0.00 %",
        "not counted below",
        ">phase<",
    ] {
        assert!(page.contains(expected), "{expected} is not in the page");
    }
    assert!(!walk_page(&mixed(&log)).contains(">phase<"), "one phase needs no lane");
}

/// A disk that reads slowly, or a longer build, makes no walk slower.
#[test]
fn a_longer_start_is_no_difference() {
    let [quick, slow] = [started(20, 10, 600), started(900, 300, 600)];
    let compared = |a: &FrameLogFile, b: &FrameLogFile| Comparison::of(["a".into(), "b".into()], [a, b]);
    let comparison = compared(&quick, &slow);
    assert_eq!(comparison.summaries.each_ref().map(|summary| summary.num_over_budget), [0, 0]);
    let [a, b] = comparison.differences[0].medians_ms.map(|ms| ms.expect("a median"));
    assert!((a - b).abs() < 0.1 * a, "{a} and {b}");
    let text = comparison.to_string();
    let others = text.lines().find(|line| line.starts_with("not counted")).expect("the line");
    assert_eq!(others.split_whitespace().collect::<Vec<_>>(), ["not", "counted", "30", "1200"]);
    assert_eq!(faults(&comparison.page()), Vec::<String>::new());
    let mixed = compared(&mixed(&quick), &mixed(&slow));
    let [a, b] = mixed.differences[0].medians_ms.map(|ms| ms.expect("a median"));
    assert!(b > 1.5 * a, "the comparison can fail: {a} and {b}");
}

#[test]
fn a_log_that_ends_before_the_walk_says_so() {
    let arriving = Summary::of(&started(20, 30, 0));
    assert_eq!((arriving.counted_phase, arriving.num_frames), (Phase::Arriving, 30));
    assert!(arriving.to_string().contains("the log ends while the scan was being built"), "{arriving}");
    let waiting = Summary::of(&started(20, 0, 0));
    assert_eq!((waiting.counted_phase, waiting.num_frames), (Phase::Waiting, 20));
    assert!(waiting.to_string().contains("before a scan was shown"), "{waiting}");
    for log in [started(20, 30, 0), started(20, 0, 0), started(0, 0, 0)] {
        assert_eq!(faults(&walk_page(&log)), Vec::<String>::new());
    }
}

/// Frames that the runtime wanted undrawn are told, and no figure is made of them.
#[test]
fn unseen_frames_are_no_frames_of_the_walk() {
    let mut log = started(0, 0, 100);
    let walked = Summary::of(&log).to_string();
    let mut unseen = log.frames.clone();
    for frame in &mut unseen {
        (frame.phase, frame.world_from_head) = (Phase::Unseen, None);
        (frame.gpu_ms, frame.over_budget, frame.missed_periods) = (f64::NAN, false, 0);
    }
    log.frames.extend(unseen);
    let summary = Summary::of(&log);
    assert_eq!((summary.counted_phase, summary.num_frames), (Phase::Walking, 100));
    let text = summary.to_string();
    let without: String = text
        .lines()
        .filter(|line| !line.starts_with("unseen"))
        .fold(String::new(), |all, line| all + line + "\n");
    assert!(text.contains("100 frames that the runtime wanted undrawn"), "{text}");
    assert_eq!(without, walked);
    assert_eq!(faults(&walk_page(&log)), Vec::<String>::new());
}

/// The phase goes from the frame thread's row to the report; a log of an earlier version has no such column.
#[test]
fn logs_tell_the_phase() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.csv");
    let log =
        FrameLog::start(&Output::new(&path, OutputKind::FrameLog).unwrap(), &RunFacts::default()).unwrap();
    started(1, 1, 1).frames.iter().for_each(|frame| log.push(row_of(frame)));
    assert_eq!(log.finish().num_rows, 3);
    let phases = |path| read(path).unwrap().frames.iter().map(|frame| frame.phase).collect::<Vec<_>>();
    assert_eq!(phases(&path), Phase::DRAWN);

    let text = std::fs::read_to_string(&path).unwrap();
    let num_before = columns::names().iter().position(|name| name == "phase").unwrap();
    let before = |line: &str| line.split(',').take(num_before).collect::<Vec<_>>().join(",");
    let without: Vec<String> =
        text.lines().map(|line| if line.starts_with('#') { line.to_owned() } else { before(line) }).collect();
    let older = folder.path().join("older.csv");
    std::fs::write(&older, without.join("\n") + "\n").unwrap();
    assert_eq!(phases(&older), [Phase::Waiting, Phase::Walking, Phase::Walking]);

    std::fs::write(&older, text.replace("arriving", "elsewhere")).unwrap();
    assert!(read(&older).unwrap_err().to_string().contains("'elsewhere' is no phase"));
}

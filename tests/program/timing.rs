//! The frame log: a report reads the rows that were pushed, and nothing that a disk does reaches the frame.

use base::output::{Output, OutputKind};
use base::space::Pose;
use glam::{DQuat, DVec3};
use kit::program::named_pipe;
use kit::wait::wait_for;
use lab::report::Summary;
use std::path::Path;
use std::sync::mpsc::channel;
use timing::{FrameLog, FrameRow, ReadError, RunFacts, STAGES, columns, read};

/// A row whose GPU times follow from `frame`: 5 ms, and 15 ms in every tenth frame.
fn row(frame: u64) -> FrameRow {
    let slow = frame.is_multiple_of(10);
    FrameRow {
        frame,
        time_s: frame as f64 / 90.0,
        predicted_display_ns: 11_111_111 * frame as i64,
        stage_ms: [0.5, 0.25, 0.25, if slow { 12.0 } else { 3.0 }, 0.5, 0.25, 0.25],
        gpu_ms: if slow { 15.0 } else { 5.0 },
        missed_periods: u32::from(slow),
        upload_bytes: 4096,
        world_from_head: slow.then_some(pose(frame)),
        ..FrameRow::sample()
    }
}

/// A pose far from the origin, with digits that no decimal has.
fn pose(frame: u64) -> Pose {
    let position = DVec3::new(4e6 + frame as f64 / 3.0, -1e-7, 1.7);
    Pose { position, orientation: DQuat::from_rotation_z(0.1 * frame as f64) }
}

fn output(path: &Path) -> Output {
    Output::new(path, OutputKind::FrameLog).unwrap()
}

fn facts() -> RunFacts {
    RunFacts { scan: "a\nb.laz".into(), device: "some GPU: 8 GiB".into(), ..RunFacts::default() }
}

/// Writes `num_frames` rows to a log in a folder of its own.
fn written(num_frames: u64) -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.csv");
    let log = FrameLog::start(&output(&path), &facts()).unwrap();
    (0..num_frames).for_each(|frame| log.push(row(frame)));
    let summary = log.finish();
    assert_eq!((summary.num_rows, summary.num_dropped, summary.error), (num_frames, 0, None));
    (folder, path)
}

/// Returns the line and the complaint about a file with this text.
fn complaint(text: impl AsRef<[u8]>) -> (usize, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.csv");
    std::fs::write(&path, text).unwrap();
    match read(&path).expect_err("this must be refused") {
        ReadError::Format { line, problem, .. } => (line, problem),
        ReadError::Io { .. } => panic!("the file can be read"),
    }
}

#[test]
fn a_report_reads_what_was_logged() {
    let (_folder, path) = written(1000);
    let report = Summary::of(&read(&path).unwrap());
    assert_eq!(report.num_frames, 1000);
    assert!((report.duration_s - 999.0 / 90.0).abs() < 1e-3);
    assert_eq!(report.num_over_budget, 100);
    assert_eq!(report.missed_periods, 100);
    assert!(report.facts.contains(&("scan".into(), "a b.laz".into())), "{:?}", report.facts);
    assert!(report.facts.contains(&("device".into(), "some GPU: 8 GiB".into())));
    let gpu = [500, 900, 990].map(|per_mille| report.gpu_ms.percentile(per_mille).unwrap());
    assert_eq!(gpu, [5.0, 5.0, 15.0]);
    let (stage, part) = report.costliest().unwrap();
    assert_eq!(stage, "depth");
    assert!((part - 3.9 / 5.9).abs() < 1e-6);
    let text = report.to_string();
    for expected in [
        "frames      1000 in 11.1 s, 90.0 a second",
        "budget      11.11 ms",
        "over        100 frames, 10.00 %",
        "GPU             5.000    5.000   15.000   15.000   15.000",
        "  depth         3.000    3.000   12.000   12.000   12.000",
        "CPU record      0.500    0.500    0.500    0.500    0.500",
        "costliest   depth, 66 % of the stages' GPU time",
    ] {
        assert!(text.contains(expected), "{expected:?} is not in\n{text}");
    }
}

#[test]
fn what_a_replay_needs_is_read_back() {
    let (folder, path) = written(20);
    let log = read(&path).unwrap();
    assert_eq!(log.qualities, ["closest"]);
    let frame = &log.frames[10];
    assert_eq!(
        (frame.frame, frame.lod_scale, frame.resolution_scale, frame.quality),
        (10, 1.0, 1.0, Some(0))
    );
    let head = frame.world_from_head.expect("slow frames have one");
    assert_eq!(head.position, pose(10).position, "to the last bit");
    assert!((head.orientation.dot(pose(10).orientation) - 1.0).abs() < 1e-15);
    assert_eq!(log.frames[11].world_from_head, None);
    // This log is from before heads were logged.
    let text = std::fs::read_to_string(&path).unwrap();
    let num_before = columns::names().iter().position(|name| name == "head_x").expect("a column of heads");
    let without = text.lines().map(|line| match line.starts_with('#') {
        true => line.to_owned(),
        false => line.split(',').take(num_before).collect::<Vec<_>>().join(","),
    });
    let old = folder.path().join("old.csv");
    std::fs::write(&old, without.collect::<Vec<_>>().join("\n") + "\n").unwrap();
    let old = read(&old).unwrap();
    assert!(old.frames.iter().all(|frame| frame.world_from_head.is_none()));
    assert_eq!(Summary::of(&old).to_string(), Summary::of(&log).to_string());
}

#[test]
fn every_stage_has_its_column() {
    let (_folder, path) = written(1);
    let text = std::fs::read_to_string(path).unwrap();
    let header: Vec<&str> = text.lines().find(|line| !line.starts_with('#')).unwrap().split(',').collect();
    assert_eq!(header, columns::names());
    for stage in STAGES {
        assert!(header.contains(&format!("{stage}_ms").as_str()));
    }
    assert_eq!(text.lines().last().unwrap().split(',').count(), header.len());
}

#[test]
fn times_that_the_device_did_not_give() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.csv");
    let log = FrameLog::start(&output(&path), &facts()).unwrap();
    log.push(FrameRow { stage_ms: [f32::NAN; STAGES.len()], gpu_ms: f32::NAN, ..row(1) });
    assert_eq!(log.finish().num_rows, 1);
    let report = Summary::of(&read(&path).unwrap());
    assert_eq!(report.gpu_ms.percentile(500), None);
    assert_eq!(report.costliest(), None);
    assert!(report.to_string().contains("no GPU times"), "{report}");
}

#[test]
fn a_cut_last_line_is_left_out() {
    let (folder, path) = written(20);
    let text = std::fs::read(&path).unwrap();
    let cut = folder.path().join("cut.csv");
    let rows_of = |num_bytes: usize| {
        std::fs::write(&cut, &text[..num_bytes]).unwrap();
        let log = read(&cut).unwrap();
        assert_eq!(log.cut_off, text[num_bytes - 1] != b'\n');
        log.frames.len()
    };
    assert_eq!(rows_of(text.len()), 20, "the whole file");
    assert_eq!(rows_of(text.len() - 1), 19, "without its end a number may lack digits");
    assert_eq!(rows_of(text.len() - 30), 19);
}

#[test]
fn files_that_are_no_frame_log() {
    let (_folder, path) = written(3);
    let good = std::fs::read_to_string(path).unwrap();
    let num_lines = good.lines().count();
    for text in ["", "x", "frame,gpu_ms\n1,2\n", "# scanwalk frame log\n", "\u{0}\u{1}\n"] {
        assert!(complaint(text).1.contains("no frame log"), "{text:?}");
    }
    assert!(complaint(vec![0u8; 1 << 20]).1.contains("no frame log"), "a line without end");
    assert!(complaint([0xff, 0xfe, b'\n']).1.contains("no frame log"));
    let (line, problem) = complaint(good.replace(",gpu_ms,", ",gpu,"));
    assert_eq!((line, problem.as_str()), (num_lines - 3, "the columns lack 'gpu_ms'"));
    let (line, problem) = complaint(good.clone() + "1,2\n");
    let told = format!("2 cells under {} column names", columns::names().len());
    assert_eq!((line, problem), (num_lines + 1, told));
    let (line, problem) = complaint(good.replacen(",2.0000,", ",two,", 1));
    assert_eq!((line, problem.as_str()), (num_lines - 2, "'two' is no number"));
    let (line, problem) = complaint(good.replacen(",2.0000,", ",1e300,", 1));
    assert_eq!((line, problem.as_str()), (num_lines - 2, "'1e300' is no number"));
    let many = (0..20).map(|i| good.lines().last().unwrap().replace("closest", &format!("q{i}")) + "\n");
    assert_eq!(complaint(good.clone() + &many.collect::<String>()).1, "'q15' is no quality");
    let facts: String = (0..100).map(|i| format!("# fact {i}: x\n")).collect();
    assert_eq!(
        complaint(good.replacen("# scan:", &(facts + "# scan:"), 1)).1,
        "more than 64 facts of the run"
    );
    let stages: String = (0..100).map(|i| format!(",s{i}_ms")).collect();
    let last = columns::names().pop().expect("columns");
    let (_, problem) = complaint(good.replacen(&format!(",{last}\n"), &format!(",{last}{stages}\n"), 1));
    assert_eq!(problem, "more than 64 columns of stages");
    let poseless = good.replacen(",4000000,", ",,", 1);
    assert_eq!(complaint(poseless).1, "'' is no number", "half a pose is none");
    assert!(matches!(read(Path::new("no/such.csv")), Err(ReadError::Io { .. })));
    assert!(matches!(read(Path::new(".")), Err(ReadError::Io { .. })));
}

#[test]
fn an_empty_log_is_a_log() {
    let (_folder, path) = written(0);
    let report = Summary::of(&read(&path).unwrap());
    assert!(report.to_string().contains("frames      0 in 0.0 s"), "{report}");
}

#[test]
#[cfg_attr(not(target_os = "linux"), ignore = "needs /dev/full")]
fn a_full_disk_never_stops_the_frame() {
    let full = Path::new("/dev/full");
    let log = FrameLog::start(&output(full), &facts()).unwrap();
    (0..100_000).for_each(|frame| log.push(row(frame)));
    let summary = log.finish();
    assert!(summary.error.unwrap().contains("/dev/full"), "the failure is told");
    assert_eq!(summary.num_rows, 0);
}

#[test]
#[cfg_attr(not(unix), ignore = "needs a named pipe")]
fn a_disk_that_does_not_keep_up_costs_rows_not_frames() {
    // A pipe from which nobody reads holds up the writer, and there are more rows than the queue holds: whatever is lost
    // is counted, and the log says so.
    const NUM_ROWS: u64 = 20_000;
    let folder = tempfile::tempdir().unwrap();
    let (pipe, path) = (named_pipe(folder.path(), "pipe.csv"), folder.path().join("frames.csv"));
    let (pushed, wait) = channel();
    let reader = std::thread::spawn({
        let (pipe, path) = (pipe.clone(), path.clone());
        move || {
            let mut pipe = std::fs::File::open(pipe).unwrap();
            wait.recv().unwrap();
            std::io::copy(&mut pipe, &mut std::fs::File::create(path).unwrap()).unwrap();
        }
    });
    let log = FrameLog::start(&output(&pipe), &facts()).unwrap();
    (0..NUM_ROWS).for_each(|frame| log.push(row(frame)));
    pushed.send(()).unwrap();
    let summary = log.finish();
    reader.join().unwrap();
    assert_eq!(summary.num_rows + summary.num_dropped, NUM_ROWS);
    let read = read(&path).unwrap();
    assert_eq!((read.frames.len() as u64, read.num_dropped), (summary.num_rows, summary.num_dropped));
    assert!(summary.num_dropped > 0, "more rows than the queue holds overrun it, or this test shows nothing");
}

#[test]
fn rows_are_on_the_disk_within_a_second_or_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.csv");
    let log = FrameLog::start(&output(&path), &facts()).unwrap();
    log.push(row(0));
    // A second, and what a slow disk adds: nothing else writes the row while the log goes on.
    wait_for("the row", || read(&path).is_ok_and(|log| !log.frames.is_empty()).then_some(()));
    drop(log);
}

#[test]
fn an_older_log_stays_until_a_scan_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.csv");
    let older = format!("{}, of another day", columns::TITLE);
    std::fs::write(&path, &older).unwrap();
    let text = || std::fs::read_to_string(&path).unwrap();
    let num_files = || std::fs::read_dir(folder.path()).unwrap().count();
    let without_scan = |frame| FrameRow { points_resident: 0, ..row(frame) };
    let log = FrameLog::start(&output(&path), &facts()).unwrap();
    (0..10).for_each(|frame| log.push(without_scan(frame)));
    drop(log);
    assert_eq!((text(), num_files()), (older.clone(), 1), "a walk that failed");

    let log = FrameLog::start(&output(&path), &facts()).unwrap();
    (0..10).for_each(|frame| log.push(without_scan(frame)));
    log.push(row(10));
    // The scan's first frame gives the log its name.
    wait_for("the new log", || (text() != older).then_some(()));
    log.push(row(11));
    drop(log);
    assert_eq!(
        read(&path).unwrap().frames.len(),
        12,
        "rows from before, and those since, though it failed then"
    );
    assert_eq!(num_files(), 1);

    // This walk ends well before a scan is shown.
    let log = FrameLog::start(&output(&path), &facts()).unwrap();
    log.push(without_scan(0));
    assert_eq!(log.finish().num_rows, 1);
    assert_eq!(read(&path).unwrap().frames.len(), 1);
}

//! `view` without headset and window: limits, logs, failures, and the way a signal ends it.

use crate::PROGRAM;
use crate::scene::ViewedScans;
use kit::program::{self, Program, RunOutput};
use kit::rows::LogRows;
use kit::wait::wait_for;
use std::io::{BufRead, BufReader};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

const SMALL: [&str; 6] = ["--headset", "off", "--window", "off", "--set", "simulated.size_px=[97,65]"];

fn view(scan: &Path, args: &[&str]) -> Command {
    let mut command = program::command(PROGRAM);
    command.arg("view").arg(scan).args(SMALL).args(args);
    command
}

fn run(scan: &Path, args: &[&str]) -> RunOutput {
    program::run(&mut view(scan, args))
}

#[test]
fn the_log_has_a_row_a_frame_and_the_report_reads_it() {
    let scene = ViewedScans::get();
    let log = scene.file("offscreen.csv");
    run(&scene.courtyard, &["--frames", "30", "--log", log.to_str().expect("UTF-8")]).ok();
    let rows = LogRows::read(&log);
    let frames = rows.numbers("frame");
    assert!(frames.iter().enumerate().all(|(i, &frame)| frame == i as f64), "in order, and none is missing");
    // On a busy machine, some of the frames come before the last nodes do.
    let is_shown: Vec<bool> = rows.numbers("points_resident").iter().map(|&n| n > 0.0).collect();
    assert!(is_shown.iter().filter(|&&shown| shown).count() >= 30);
    let points_read = rows.numbers("points_read");
    for row in (0..frames.len()).filter(|&row| is_shown[row]) {
        assert!(points_read[row] > 0.0, "{} points in row {row}", points_read[row]);
    }
    for (row, frame) in
        timing::read(&log).expect("a log").frames.iter().enumerate().filter(|(row, _)| is_shown[*row])
    {
        let stages: f64 = frame.stage_ms.iter().sum();
        assert!(stages > 0.0 && stages <= frame.gpu_ms * 1.01 + 0.01, "row {row}: {frame:?}");
    }
    let report = program::run(program::command(PROGRAM).arg("report").arg(&log)).ok();
    let report = report.text();
    assert!(report.contains("costliest") && report.contains("99.9 %"), "{report}");
}

/// Each frame's row has its head, and the worst frames can be seen again from there.
#[test]
fn the_worst_frames_are_replayed() {
    let scene = ViewedScans::get();
    let path = |name: &str| scene.file(name).into_os_string().into_string().expect("UTF-8");
    let (first, poses, second) = (path("first.csv"), path("worst.poses"), path("second.csv"));
    let walk = |pose_path: &str, log: &str| {
        run(&scene.courtyard, &["--frames", "30", "--pose-path", pose_path, "--log", log]).ok();
        let log = timing::read(Path::new(log)).expect("a log");
        log.frames.into_iter().filter_map(|frame| frame.world_from_head).collect::<Vec<_>>()
    };
    let heads = walk(scene.pose_path.to_str().expect("UTF-8"), &first);
    assert!(heads.len() >= 30 && heads.iter().all(|head| head.position == scene.head.position));
    assert!(heads.iter().all(|head| head.orientation.dot(scene.head.orientation).abs() > 1.0 - 1e-12));
    let report = ["report", &first, "--worst-poses", &poses];
    program::run(program::command(PROGRAM).args(report)).ok();
    let again = walk(&poses, &second);
    assert!(again.len() >= 30);
    assert!(again.iter().all(|head| head.position.abs_diff_eq(scene.head.position, 1e-8)));
    // The head is elsewhere without a path, so that the comparison can fail.
    run(&scene.courtyard, &["--frames", "5", "--log", &second]).ok();
    let free = timing::read(Path::new(&second)).expect("a log");
    let mut heads = free.frames.iter().filter_map(|frame| frame.world_from_head);
    assert!(heads.all(|head| head.position.distance(scene.head.position) > 0.01));
}

/// A display that no software driver keeps up with: the governor gives up all it may, in its order, and each row
/// has what its frame was drawn with.
#[test]
fn the_governors_steps_are_in_the_log() {
    let scene = ViewedScans::get();
    let drawn_with = |name: &str, governor: &str| -> Vec<(f64, f64, String)> {
        let log = scene.file(name);
        let log_path = log.to_str().expect("UTF-8");
        let settings = ["--set", "simulated.refresh_hz=1000", "--set", governor, "--frames", "300"];
        run(&scene.courtyard, &[&settings[..], &["--log", log_path]].concat()).ok();
        let rows = LogRows::read(&log);
        let scales = rows.numbers("lod_scale").into_iter().zip(rows.numbers("resolution_scale"));
        let with_quality = scales.zip(rows.column("quality"));
        with_quality.map(|((lod, resolution), quality)| (lod, resolution, quality.to_owned())).collect()
    };
    let governed = drawn_with("governed.csv", "governor.budget=0.1");
    assert_eq!(governed[0], (1.0, 1.0, "hqs".to_string()));
    // The governor went to the cheapest rung and stayed. If even that rung shows an image for more than three
    // displays, it went back to a good picture.
    let [cheapest, good] = [(3.0, 0.6, "closest".to_string()), (1.99, 1.0, "hqs".to_string())];
    assert!(governed.contains(&cheapest), "{governed:?}");
    assert!(governed.last() == Some(&cheapest) || governed.last() == Some(&good), "{governed:?}");
    for (lod_scale, resolution_scale, quality) in &governed {
        assert!(*resolution_scale == 1.0 || *lod_scale == 3.0);
        assert!(quality == "hqs" || *resolution_scale == 0.6);
    }
    let free = drawn_with("free.csv", "governor.enabled=false");
    assert!(free.iter().all(|row| *row == governed[0]));
}

#[test]
fn a_log_on_a_full_disk_is_reported_once_and_stops_nothing() {
    let output = run(&ViewedScans::get().courtyard, &["--frames", "20", "--log", "/dev/full"]).ok();
    assert_eq!(output.err.matches("/dev/full").count(), 1, "{}", output.err);
}

#[test]
fn a_log_into_a_closed_pipe_is_reported_once_and_stops_nothing() {
    let (reader, writer) = std::io::pipe().expect("a pipe");
    let mut view = view(&ViewedScans::get().courtyard, &["--seconds", "3", "--log", "/dev/stdout"]);
    let walk = Program::start_into(&mut view, writer);
    let (mut first, mut reader) = (String::new(), BufReader::new(reader));
    reader.read_line(&mut first).expect("a line");
    assert!(first.starts_with("# scanwalk frame log"), "{first}");
    drop(reader);
    let output = walk.end().ok();
    assert_eq!(output.err.matches("/dev/stdout").count(), 1, "{}", output.err);
}

#[test]
fn a_scan_without_permission_says_so() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let scan = folder.path().join("locked.las");
    std::fs::copy(&ViewedScans::get().ball, &scan).expect("a scan");
    let mode = |path: &Path, mode| std::fs::set_permissions(path, std::fs::Permissions::from_mode(mode));
    mode(&scan, 0o000).expect("locked");
    mode(folder.path(), 0o755).expect("a folder for all");
    let output = if std::fs::File::open(&scan).is_err() {
        program::run(program::command(PROGRAM).arg("info").arg(&scan))
    } else {
        // Root may read everything, so the program runs as another user, from a folder in which that user can start
        // it.
        let program = folder.path().join("scanwalk");
        std::fs::copy(PROGRAM, &program).expect("a copy of the program");
        let nobody = ["--reuid=65534", "--regid=65534", "--clear-groups"];
        program::run(program::command("setpriv").args(nobody).arg(&program).arg("info").arg(&scan))
    };
    let said = output.err;
    assert_eq!(output.code, Some(1), "{said}");
    assert!(said.contains("locked.las") && said.contains("chmod"), "{said}");
}

#[test]
fn a_scan_that_cannot_be_read_ends_the_walk_with_its_sentence() {
    let missing = ViewedScans::get().file("no-such.las");
    let output = run(&missing, &["--frames", "5"]);
    assert_eq!(output.code, Some(1));
    let said = output.err;
    assert!(said.contains("no-such.las") && !said.contains("panicked"), "{said}");
}

/// The reason does not depend on which thread is faster: reading that is stopped because something else is missing is
/// not the reason.
#[test]
fn what_is_required_and_missing_is_the_reason_that_is_given() {
    let scene = ViewedScans::get();
    let missing = scene.file("no-such.las");
    let stale = [("WAYLAND_DISPLAY", "wayland-none")];
    let (window, headset) = (["--window", "on"], ["--headset", "require"]);
    for (scan, more, environment, words) in [
        (&scene.ball, &window[..], &[][..], "neither DISPLAY nor WAYLAND_DISPLAY"),
        (&scene.courtyard, &window, &[], "neither DISPLAY nor WAYLAND_DISPLAY"),
        (&missing, &window, &[], "neither DISPLAY nor WAYLAND_DISPLAY"),
        (&scene.courtyard, &window, &stale, "WAYLAND_DISPLAY names wayland-none"),
        (&scene.courtyard, &window, &[("DISPLAY", ":4711")], "the display does not answer"),
        (&scene.courtyard, &headset, &[], "OpenXR"),
        (&missing, &[], &[], "no-such.las"),
    ] {
        for _ in 0..3 {
            let mut command = program::command(PROGRAM);
            command.arg("view").arg(scan).args(["--frames", "2", "--set", "simulated.size_px=[97,65]"]);
            // clap takes each option once.
            let given = |option: &str| more.contains(&option);
            if !given("--window") {
                command.args(["--window", "off"]);
            }
            if !given("--headset") {
                command.args(["--headset", "off"]);
            }
            command.args(more).env_remove("XDG_RUNTIME_DIR");
            command.env("XR_RUNTIME_JSON", "/nonexistent/runtime.json").envs(environment.iter().copied());
            let output = program::run(&mut command);
            let said = output.for_good();
            assert_eq!(output.code, Some(1), "{words}: {said}");
            assert!(said.contains(words) && said.lines().count() == 1, "{words}: {said}");
        }
    }
}

#[test]
fn a_signal_ends_the_walk_cleanly() {
    let log = ViewedScans::get().file("interrupted.csv");
    let log_path = log.to_str().expect("UTF-8");
    let walk = Program::start(&mut view(&ViewedScans::get().courtyard, &["--log", log_path]));
    // The log gets its name when the scan is first shown.
    wait_for("the scan", || log.exists().then_some(()));
    walk.interrupt();
    // A walk that the user ends is no failure.
    walk.end().ok();
}

/// The walk ends by itself, and not before its time: one that has an hour goes on beyond as many frames.
#[test]
fn seconds_end_the_walk() {
    let scene = ViewedScans::get();
    let log = scene.file("seconds.csv");
    let walk = |seconds| {
        let log_path = log.to_str().expect("UTF-8");
        Program::start(&mut view(&scene.courtyard, &["--seconds", seconds, "--log", log_path]))
    };
    walk("1.5").end().ok();
    let num_frames = LogRows::read(&log).numbers("frame").len();
    std::fs::remove_file(&log).expect("the log");
    let mut long = walk("3600");
    wait_for("further frames", || {
        let rows = LogRows::so_far(&log)?;
        (rows.numbers("frame").len() > 2 * num_frames).then_some(())
    });
    assert!(long.is_running());
    long.interrupt();
    long.end().ok();
}

//! The program from outside: help, wrong usage, exit codes, closed pipes.

use crate::PROGRAM;
use crate::logs::frame_log;
use kit::program::{self, Program, RunOutput};
use std::path::Path;
use std::process::Command;

fn scanwalk(args: &[&str]) -> Command {
    let mut command = program::command(PROGRAM);
    command.args(args);
    command
}

fn output(args: &[&str]) -> RunOutput {
    program::run(&mut scanwalk(args))
}

/// Returns exit code and stderr; wrong usage and failures print nothing on stdout.
fn refusal(args: &[&str]) -> (i32, String) {
    let output = output(args);
    assert!(output.out.is_empty(), "{args:?} wrote to stdout");
    (output.code.expect("no signal ended it"), output.err)
}

/// Saves a frame log of `num_frames` rows without a head's pose; returns its path.
fn saved_log(folder: &Path, num_frames: usize) -> String {
    let path = folder.join("frames.csv");
    std::fs::write(&path, frame_log(num_frames, "")).unwrap();
    path.into_os_string().into_string().unwrap()
}

#[test]
fn help_names_every_command_and_shared_option() {
    let output = output(&["--help"]);
    let output = output.ok();
    let help = output.text();
    for word in ["view", "render", "info", "convert", "synth", "bench", "report", "doctor"] {
        assert!(help.contains(&format!("\n  {word} ")), "{word} is not in\n{help}");
    }
    for option in ["--config", "--set", "--adapter", "--verbose", "Examples:", "Exit codes"] {
        assert!(help.contains(option), "{option} is not in\n{help}");
    }
}

#[test]
fn every_command_explains_its_options() {
    let view =
        ["--headset", "--window", "--log", "--frames", "--seconds", "--pose-path", "--preset", "Examples:"];
    let render = [
        "--eye",
        "--target",
        "--up",
        "--fov-y",
        "--size",
        "--stereo",
        "--ipd",
        "--preset",
        "--quality",
        "--lod",
        "--dilate",
        "--precision",
        "--depth",
        "--background",
        "--metrics",
        "Examples:",
    ];
    for (command, options) in [
        ("view", &view[..]),
        ("render", &render[..]),
        ("info", &["--json"]),
        ("convert", &["--out"]),
        ("synth", &["terrestrial", "aerial", "photogrammetry", "--points", "--seed", "statue.ply"]),
        ("bench", &["2021", "2022", "vr", "spt", "--json", "--csv"]),
        ("report", &["--out", "--worst-poses", "FRAMES.csv", "RESULTS.json", "Examples:"]),
        ("settings", &["--laboratory", "--preset", "WORD", "Examples:"]),
        ("doctor", &["--json"]),
    ] {
        let output = output(&[command, "--help"]);
        assert_eq!(output.code, Some(0), "{command}");
        let help = output.text();
        for option in options.iter().chain(&["--config", "--set", "--adapter"]) {
            assert!(help.contains(option), "{option} is not in\n{help}");
        }
    }
}

/// What an option says of its setting is what the setting says, in one paragraph.
#[test]
fn help_says_of_settings_what_the_table_says() {
    let output = output(&["render", "--help"]);
    let output = output.text();
    let help = output.split_whitespace().collect::<Vec<_>>().join(" ");
    let says = |option: &str, words: &str| {
        let behind =
            help.split_once(&format!(" --{option} <")).and_then(|(_, behind)| behind.split_once("> "));
        behind.is_some_and(|(_, text)| text.starts_with(words))
    };
    for (option, key) in [
        ("method", "frame.method"),
        ("order", "cloud.order"),
        ("quality", "frame.quality"),
        ("dilate", "frame.dilate"),
        ("precision", "frame.precision"),
        ("background", "frame.background"),
    ] {
        let meaning = scanwalk::config::Setting::find(key).unwrap().meaning();
        assert!(says(option, &format!("{meaning} [default: {key}]")), "--{option} in\n{output}");
    }
    let eye_distance_m = scanwalk::config::Config::default().simulated.eye_distance_m;
    assert!(says(
        "ipd",
        &format!("Distance of the eyes for --stereo, in meters [default: {eye_distance_m}]")
    ));
    assert!(!says("size", "Distance of the eyes"));
}

#[test]
fn help_names_every_preset() {
    for command in ["view", "render"] {
        let output = output(&[command, "--help"]);
        let help = output.text();
        for preset in scanwalk::config::PRESETS {
            assert!(help.contains(preset.name), "{} is not in\n{help}", preset.name);
        }
    }
}

/// Returns what `scanwalk settings` lists.
fn listed(args: &[&str]) -> toml::Table {
    let output = output(&[&["settings"], args].concat());
    assert_eq!(output.code, Some(0), "{args:?}");
    output.text().parse().unwrap()
}

#[test]
fn settings_are_listed_as_a_file_for_config() {
    let users = listed(&[]);
    assert!(users["frame"].get("near_m").is_some() && users["frame"].get("method").is_none());
    let laboratory = listed(&["--laboratory"]);
    assert!(laboratory["frame"].get("near_m").is_none() && laboratory["frame"].get("method").is_some());
    // Words find settings of users and of the laboratory.
    let named = listed(&["near_m", "chunk"]);
    assert_eq!(named, "gpu.chunk_mib = 0\nframe.near_m = \"auto\"".parse().unwrap());
    // Settings are listed with the values in force, and the list says the same when it is read.
    let changed = listed(&["--preset", "performance", "--set", "lod.fade=false"]);
    assert!(changed != users && changed["lod"]["fade"].as_bool() == Some(false));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("my.toml");
    std::fs::write(&file, changed.to_string()).unwrap();
    assert_eq!(listed(&["--config", file.to_str().unwrap()]), changed);
    let plain = listed(&["--preset", "plain"]);
    assert_eq!(plain["cloud"].get("order").and_then(toml::Value::as_str), Some("original"), "set, so listed");
    assert!(users["cloud"].get("order").is_none());
    let (_, sentence) = refusal(&["settings", "nearm"]);
    assert!(sentence.contains("no setting 'nearm'; did you mean 'frame.near_m'?"), "{sentence}");
    let (_, sentence) = refusal(&["settings", "bogus"]);
    assert!(sentence.contains("no setting 'bogus'; `scanwalk settings` lists"), "{sentence}");
}

#[test]
fn wrong_usage_exits_2() {
    for args in [
        &[][..],
        &["fly"],
        &["view", "--window", "off"],
        &["view", "a.laz", "--headset", "maybe"],
        &["view", "a.laz", "--frames", "0"],
        &["view", "a.laz", "--seconds", "-1"],
        &["render", "a.laz"],
        &["render", "a.laz", "-o", "a.png", "--size", "0x0"],
        &["render", "a.laz", "-o", "a.png", "--eye", "1,2"],
        &["render", "a.laz", "-o", "a.png", "--eye", "1,2,3", "--target", "1,2,3"],
        &["render", "a.laz", "-o", "a.png", "--up", "0,0,0"],
        &["render", "a.laz", "-o", "a.png", "--fov-y", "180"],
        &["render", "a.laz", "-o", "a.png", "--background", "0,0,256"],
        &["synth", "moon", "-o", "a.las"],
        &["synth", "aerial", "-o", "a.las", "--points", "0"],
        &["bench", "--table", "2023"],
        &["bench", "--json", "--csv"],
        &["bench", "--table", "2021", "--method", "lod"],
        &["info"],
        &["report"],
        &["report", "a.csv", "b.csv", "c.csv"],
        &["report", "a.csv", "b.json"],
        &["report", "a.csv", "b.csv", "--worst-poses", "w.poses"],
        &["report", "a.json", "--worst-poses", "w.poses"],
        &["report", "a.csv", "-o", "a.csv"],
        &["report", "Cargo.toml", "-o", "./src/../Cargo.toml"],
        &["report", "a.csv", "-o", "b", "--worst-poses", "b"],
        &["settings", "nearm"],
        &["settings", "--laboratory", "lod"],
        &["settings", "--set", "lod.fade=7"],
    ] {
        let (code, text) = refusal(args);
        assert_eq!(code, 2, "{args:?}: {text}");
        assert!(!text.is_empty(), "{args:?}");
    }
}

#[test]
fn info_tells_attributes_on_request() {
    let (_folder, scan) = kit::las_files::save("a.las", &kit::las_files::Fixture::new(6).bytes());
    let info = |args: &[&str]| {
        let output =
            Command::new(env!("CARGO_BIN_EXE_scanwalk")).arg("info").arg(&scan).args(args).output().unwrap();
        assert!(output.status.success(), "{args:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    assert!(!info(&[]).contains("smallest"));
    assert!(
        info(&["--attributes"]).contains("smallest") && info(&["--attributes"]).contains("classification")
    );
    let json: serde_json::Value = serde_json::from_str(&info(&["--attributes", "--json"])).unwrap();
    assert_eq!(json["points"], 1000);
    let names = json["columns"].as_array().unwrap().iter().map(|column| column["name"].as_str().unwrap());
    assert_eq!(names.take(2).collect::<Vec<_>>(), ["intensity", "return_number"]);
}

#[test]
fn what_does_not_exist_yet_is_refused_in_one_sentence() {
    let (code, text) = refusal(&["convert", "a.laz", "-o", "a.copc.laz"]);
    assert_eq!(code, 2, "{text}");
    assert!(text.starts_with("scanwalk: ") && text.contains("convert does not exist yet"), "{text}");
    assert_eq!(text.lines().count(), 1, "{text}");
}

#[test]
fn wrong_settings_exit_2_and_name_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let config = folder.path().join("walk.toml");
    std::fs::write(&config, "[frame]\nnear_mm = 5\n").unwrap();
    let config = config.to_str().unwrap();
    for (args, words) in [
        (&["doctor", "--set", "frame.nearm=1"][..], "did you mean 'frame.near_m'?"),
        (&["--set", "frame.near_m=far", "doctor"], "or a number"),
        (&["doctor", "--set", "frame.near_m=-1"], "must be from"),
        (&["doctor", "--set", "frame.near_m"], "KEY=VALUE"),
        (&["doctor", "--config", config], "walk.toml, line 2"),
        (&["view", "a.laz", "--preset", "ultra"], "choose one of plain, quality, balanced, performance"),
        (&["render", "a.laz", "-o", "a.png", "--preset", "ultra"], "choose one of plain"),
    ] {
        let (code, text) = refusal(args);
        assert_eq!(code, 2, "{args:?}: {text}");
        assert!(text.contains(words) && text.lines().count() == 1, "{args:?}: {text}");
    }
    let (code, text) = refusal(&["doctor", "--config", "no/such.toml"]);
    assert_eq!(code, 1, "a file that cannot be read is a failure: {text}");
    assert!(text.contains("no/such.toml") && text.contains("check its name and folder"), "{text}");
}

#[test]
fn failures_exit_1_in_one_line_that_names_the_file() {
    for path in ["no/such.csv", ".", "Cargo.toml", "/dev/zero"] {
        let (code, text) = refusal(&["report", path]);
        assert_eq!(code, 1, "{path}: {text}");
        assert!(text.starts_with("scanwalk: ") && text.contains(path), "{path}: {text}");
        assert_eq!(text.lines().count(), 1, "{path}: {text}");
    }
    for args in [&["report", "no/such.csv"][..], &["view", "a.laz", "--pose-path", "no/such.poses"]] {
        let (code, text) = refusal(args);
        assert_eq!(code, 1, "{args:?}: {text}");
        assert!(text.contains("no/such") && text.contains("check its name and folder"), "{args:?}: {text}");
    }
}

#[test]
fn a_report_of_a_log() {
    let folder = tempfile::tempdir().unwrap();
    let output = output(&["report", &saved_log(folder.path(), 101)]);
    assert_eq!((output.code, &*output.err), (Some(0), ""));
    let text = output.text();
    assert!(text.contains("frames      101 in 1.0 s") && text.contains("costliest   depth"), "{text}");
}

#[test]
fn a_report_writes_what_is_asked_for_and_prints_the_text_all_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).into_os_string().into_string().unwrap();
    let log = saved_log(folder.path(), 101);
    let json = file("results.JSON");
    std::fs::write(&json, r#"{"device": "some GPU", "driver": "1", "copy_gb_per_s": 1, "rows": []}"#)
        .unwrap();
    let page = file("page.html");
    for (files, heading, words) in [
        (&[&log][..], "<h1>A walk through yard.laz</h1>", "frames      101"),
        (&[&log, &log], "<h1>A: ", "no clear difference"),
        (&[&json], "<h1>Benchmarks on some GPU</h1>", "Nothing was measured"),
    ] {
        let args: Vec<&str> =
            ["report", "-o", &page].into_iter().chain(files.iter().map(|f| f.as_str())).collect();
        let output = output(&args);
        assert_eq!((output.code, &*output.err), (Some(0), ""));
        assert!(output.text().contains(words));
        assert!(std::fs::read_to_string(&page).unwrap().contains(heading), "{heading}");
    }
    let nowhere = file("no/such/page.html");
    for (args, words) in [
        (&["report", &log, "-o", &nowhere][..], nowhere.as_str()),
        (&["report", &log, "--worst-poses", &file("worst.poses")], "has no head poses"),
        (&["report", &log, &nowhere], nowhere.as_str()),
    ] {
        let (code, text) = refusal(args);
        assert_eq!(code, 1, "{args:?}: {text}");
        assert!(text.contains(words) && text.lines().count() == 1, "{args:?}: {text}");
    }
}

#[test]
fn a_closed_pipe_is_no_failure() {
    let folder = tempfile::tempdir().unwrap();
    let log = saved_log(folder.path(), 10);
    let scan = folder.path().join("yard.las").into_os_string().into_string().unwrap();
    output(&["synth", "terrestrial", "-o", &scan, "--points", "1000"]).ok();
    // A picture this large is written before it is whole.
    let picture = ["render", &scan, "-o", "-", "--size", "900x900"];
    for args in [&["report", &log][..], &picture, &["info", &scan], &["settings"]] {
        // The pipe's reader is gone before anything is written.
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        Program::start_into(&mut scanwalk(args), writer).end().ok();
    }
    // A full disk, by contrast, is a failure.
    if let Ok(full) = std::fs::File::options().write(true).open("/dev/full") {
        assert_eq!(Program::start_into(&mut scanwalk(&["report", &log]), full).end().code, Some(1));
    }
}

#[test]
fn the_doctor_answers_programs_and_people() {
    let checks = output(&["doctor", "--json"]).ok().json();
    for check in checks.as_array().unwrap() {
        assert!(check["check"].is_string() && check["found"].is_string(), "{check}");
        let advice = check["advice"].as_str().unwrap();
        assert_eq!(
            check["ok"].as_bool().unwrap(),
            advice.is_empty(),
            "advice where, and only where, it lacks"
        );
    }
    let people = output(&["doctor"]);
    assert!(people.text().contains("lacking display"), "{}", people.text());
}

/// The loaders of Vulkan and OpenXR and Mesa's layers print nothing by themselves.
#[test]
fn the_doctor_says_only_what_it_found() {
    let folder = tempfile::tempdir().unwrap();
    let manifest = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.into_os_string().into_string().unwrap()
    };
    let missing = folder.path().join("missing.json").into_os_string().into_string().unwrap();
    let broken = manifest("broken.json", "{ broken");
    let lost = manifest(
        "lost.json",
        r#"{"file_format_version": "1.0.0", "ICD": {"library_path": "/no/such/driver.so", "api_version": "1.3.0"}}"#,
    );
    for drivers in [None, Some(&missing), Some(&broken), Some(&lost)] {
        let mut command = scanwalk(&["doctor"]);
        command.env_remove("XDG_RUNTIME_DIR").env("XR_RUNTIME_JSON", &missing);
        // The variable has a name of today and one from before.
        drivers.map(|drivers| command.env("VK_DRIVER_FILES", drivers).env("VK_ICD_FILENAMES", drivers));
        let output = program::run(&mut command);
        assert_eq!((output.code, &*output.err), (Some(0), ""), "{drivers:?}");
        let text = output.text();
        assert_eq!(text.contains("no Vulkan driver"), drivers.is_some(), "{text}");
    }
    // A user who wants to hear the loaders can: this shows that the test can fail.
    let mut loud = scanwalk(&["doctor", "-vv"]);
    loud.env("VK_DRIVER_FILES", &lost).env("VK_ICD_FILENAMES", &lost).env("VK_LOADER_DEBUG", "all");
    assert!(!program::run(&mut loud).err.is_empty());
}

/// Ctrl-C reaches a program that reads from a pipe which never ends.
#[test]
#[cfg(unix)]
fn a_second_interrupt_ends_the_program_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = program::named_pipe(folder.path(), "pipe.csv");
    // Reading from a pipe that nobody writes to waits, and does not look at a wish to stop.
    let run = Program::start(&mut scanwalk(&["report", pipe.to_str().unwrap()]));
    // This waits until the program has opened the pipe too; then nothing comes, and no end.
    let _writer = std::fs::OpenOptions::new().write(true).open(&pipe).unwrap();
    run.interrupt();
    run.wait_until_said("once more to stop at once", 1);
    run.interrupt();
    assert_eq!(run.end().code, Some(130));
}

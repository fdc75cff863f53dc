//! Rows of kind 1: nothing that is written destroys what is read.

use super::desk::{Desk, decoded};
use super::las::{StrangeLas, place};
use super::{Outcome, StrangerRow, row};
use kit::program::RunOutput;

const LINE: u8 = 1;

fn scan() -> Vec<u8> {
    StrangeLas::new(2, place(500, [0.0; 3], 20.0)).bytes()
}

/// The program refuses with exit code 2, and every file stays as it was.
fn refused(desk: &Desk, args: &[&str]) -> Outcome {
    let kept = ["a.las", "b.las", "frames.csv", "path.poses", "own.toml"];
    let read = |name: &&str| std::fs::read(desk.path(name)).ok();
    let before: Vec<_> = kept.iter().map(read).collect();
    let ran = desk.run(args);
    let lost: Vec<_> =
        kept.iter().zip(before).filter(|(name, bytes)| read(name) != *bytes).map(|(n, _)| n).collect();
    match (ran.code, lost.is_empty(), ran.err.is_empty()) {
        (Some(2), true, false) => Ok(ran.in_words()),
        (_, true, _) => Err(ran.in_words()),
        _ => Err(format!("LOST {lost:?}; {}", ran.in_words())),
    }
}

/// Lays two scans, a log, a pose path, settings and links on a desk.
fn lay_files(desk: &Desk) {
    desk.put("a.las", scan());
    desk.put("b.las", scan());
    desk.put("path.poses", "0,0,0,9,0,0,0,1\n");
    desk.put("own.toml", "[frame]\nnear_m = 0.02\n");
    let names = "frame,time_s,wait_ms,record_ms,submit_ms,gpu_ms,budget_ms,over_budget,missed_periods";
    desk.put("frames.csv", format!("# scanwalk frame log, version 0.1.0\n{names}\n0,0,1,1,1,5,11,0,0\n"));
    std::fs::create_dir(desk.path("folder")).expect("a folder");
    for (target, link) in [("a.las", "link.png"), ("a.las", "log.csv"), ("b.las", "x.left.png")] {
        std::os::unix::fs::symlink(desk.path(target), desk.path(link)).expect("a link");
    }
    std::os::unix::fs::symlink(desk.path(""), desk.path("here")).expect("a link");
    std::fs::hard_link(desk.path("a.las"), desk.path("hard.png")).expect("a link");
}

/// The output that `args` names, and why it must not be written.
const REFUSED: [(&str, &str); 22] = [
    ("render a.las -o a.las", "the scan itself"),
    ("render a.las -o ./folder/../a.las", "the scan by another way"),
    ("render a.las -o link.png", "a link to the scan"),
    ("render a.las -o hard.png", "a hard link to the scan"),
    ("render -o a.las b.las", "*.las: the first is the output"),
    ("render a.las b.las -o x.png --metrics b.las", "the second scan, by --metrics"),
    ("render a.las -o x.png --depth here/a.las", "through a linked folder, by --depth"),
    ("render b.las -o x.png --stereo", "x.left.png is a link to the scan"),
    ("render a.las -o x.png --metrics x.png", "two outputs in one file"),
    ("render a.las -o x.png --depth ./x.png", "two outputs in one file, by another way"),
    ("render a.las -o x.png --config own.toml --metrics own.toml", "the settings that are read"),
    ("render a.las -o x.jpg", "not a PNG by its ending"),
    ("render a.las -o picture", "no ending"),
    ("view a.las --headset off --window off --frames 2 --log a.las", "the scan, by --log"),
    ("view a.las --headset off --window off --frames 2 --log log.csv", "a link to the scan, by --log"),
    (
        "view a.las --headset off --window off --frames 2 --pose-path path.poses --log path.poses",
        "the pose path",
    ),
    ("report frames.csv -o frames.csv", "the log"),
    ("report frames.csv --worst-poses ./frames.csv", "the log, by --worst-poses"),
    ("bench a.las -o a.las", "the scan, by bench"),
    ("synth aerial -o yard.txt --points 10", "not a scan by its ending"),
    ("synth aerial -o b.las --points 10", "a scan that is there"),
    ("render a.las -o x.left.png", "a link to a scan that is not read"),
];

pub fn rows() -> Vec<StrangerRow> {
    let of = |(args, why): (&'static str, &'static str)| {
        row(LINE, format!("{args} ({why})"), "exit 2, a sentence, all files as they were", move |desk| {
            lay_files(desk);
            refused(desk, &args.split(' ').collect::<Vec<_>>())
        })
    };
    let mut rows: Vec<StrangerRow> = REFUSED.into_iter().map(of).collect();
    rows.push(row(
        LINE,
        "-o nowhere/x.png, scan missing too",
        "the folder's absence is found first",
        |desk| {
            let ran = desk.run(&["render", "no-such.las", "-o", "nowhere/x.png"]);
            found(ran, |ran| ran.code != Some(0) && ran.says(&["nowhere"]) && !ran.says(&["no-such.las"]))
        },
    ));
    rows.push(row(LINE, "--log into a folder's name", "refused before reading", |desk| {
        lay_files(desk);
        let args = ["view", "no-such.las", "--headset", "off", "--window", "off", "--log", "folder"];
        found(desk.run(&args), |ran| {
            ran.code != Some(0) && ran.says(&["folder"]) && !ran.says(&["no-such.las"])
        })
    }));
    rows.push(row(LINE, "-o - ", "the PNG on stdout, and nothing else", |desk| {
        lay_files(desk);
        let ran = desk.run(&["render", "a.las", "-o", "-", "--size", "96x64"]);
        match decoded(&ran.out) {
            Ok(pixels) if ran.code == Some(0) => Ok(format!("a PNG of {} pixels", pixels.len())),
            Ok(_) => Err(ran.in_words()),
            Err(error) => Err(format!("{error}; {}", ran.in_words())),
        }
    }));
    rows.push(row(
        LINE,
        "a picture over an older picture, ending .PNG",
        "the new picture, no other file",
        |desk| {
            lay_files(desk);
            desk.put("OLD.PNG", b"\x89PNG\r\n\x1a\n");
            let before = std::fs::read_dir(desk.path("")).expect("a folder").count();
            let ran = desk.run(&["render", "a.las", "-o", "OLD.PNG", "--size", "96x64"]);
            let picture = std::fs::read(desk.path("OLD.PNG")).map_err(|e| e.to_string())?;
            let more = std::fs::read_dir(desk.path("")).expect("a folder").count() - before;
            let got = format!("{}, {more} more files", ran.in_words());
            if ran.code == Some(0) && decoded(&picture).is_ok() && more == 0 { Ok(got) } else { Err(got) }
        },
    ));
    rows
}

fn found(ran: RunOutput, is_right: impl Fn(&RunOutput) -> bool) -> Outcome {
    if is_right(&ran) { Ok(ran.in_words()) } else { Err(ran.in_words()) }
}

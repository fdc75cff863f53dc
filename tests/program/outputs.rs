//! Nothing that scanwalk writes destroys what it reads: every way that we know of to name an input as an output is
//! tried on the program. It refuses before it reads anything.
#![cfg(unix)]

use crate::PROGRAM;
use crate::logs::frame_log;
use kit::las_files::Fixture;
use kit::picture::Picture;
use kit::program::{self, Program, RunOutput};
use kit::wait::{LONGEST_S, wait_for};
use std::fs;
use std::io::{Read, Write};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder with two scans, a frame log, settings, a pose path, and names that lead to them.
struct TestFolder(tempfile::TempDir);

/// Files that no command may change.
const PRECIOUS: [&str; 5] = ["a.las", "b.las", "frames.csv", "set.toml", "walk.poses"];

impl TestFolder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        for (name, num_points) in [("a.las", 7), ("b.las", 9)] {
            folder.put(name, &Fixture::new(0).with_points(num_points).bytes());
        }
        folder.put("frames.csv", frame_log(20, "1").as_bytes());
        folder.put("set.toml", b"[frame]\nnear_m = 0.1\n");
        folder.put("walk.poses", b"0,0,0,5,0,0,0,1\n");
        symlink("a.las", folder.path("link.png")).unwrap();
        symlink("frames.csv", folder.path("link.html")).unwrap();
        symlink("walk.poses", folder.path("link.csv")).unwrap();
        symlink("set.toml", folder.path("link.json")).unwrap();
        fs::hard_link(folder.path("a.las"), folder.path("hard.png")).unwrap();
        fs::hard_link(folder.path("b.las"), folder.path("hard.npy")).unwrap();
        fs::create_dir(folder.path("inner")).unwrap();
        symlink("..", folder.path("inner/up")).unwrap();
        symlink("../inner/up/hard.png", folder.path("inner/far.png")).unwrap();
        // This link has the name of one eye's picture.
        symlink("b.las", folder.path("eye.right.png")).unwrap();
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn put(&self, name: &str, bytes: &[u8]) {
        fs::write(self.path(name), bytes).unwrap();
    }

    /// Several commands, the last of which counts.
    fn shell(&self, line: &str) -> Command {
        let mut command = program::command("sh");
        let line = line.replace("scanwalk", &format!("'{PROGRAM}'"));
        command.arg("-c").arg(line).current_dir(self.0.path());
        command
    }

    /// One command. Signals reach the program because of `exec`.
    fn command(&self, line: &str) -> Command {
        self.shell(&format!("exec {line}"))
    }

    fn run(&self, line: &str) -> RunOutput {
        program::run(&mut self.command(line))
    }

    fn precious(&self) -> Vec<Vec<u8>> {
        PRECIOUS.iter().map(|name| fs::read(self.path(name)).unwrap()).collect()
    }

    fn names(&self) -> Vec<PathBuf> {
        let mut names: Vec<_> =
            fs::read_dir(self.0.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
        names.sort();
        names
    }

    /// Runs a line that must end with `code` and touch nothing; returns what it said.
    fn refused(&self, line: &str, code: i32) -> String {
        let before = (self.precious(), self.names());
        let output = self.run(line);
        let said = output.for_good();
        assert_eq!(output.code, Some(code), "{line}: {said}");
        assert!(self.precious() == before.0, "{line}: what is read was changed");
        assert_eq!(self.names(), before.1, "{line}: something was left behind");
        assert!(output.out.is_empty(), "{line}");
        assert!(said.starts_with("scanwalk: ") && said.lines().count() == 1, "{line}: {said}");
        said
    }
}

#[test]
fn no_output_is_written_over_an_input() {
    let folder = TestFolder::new();
    let view = "scanwalk view a.las b.las --headset off --window off --frames 2";
    let render = "scanwalk render a.las b.las --size 64x48";
    for line in [
        format!("{render} -o link.png"),
        format!("{render} -o hard.png"),
        format!("{render} -o ./inner/../hard.png"),
        format!("{render} -o inner/far.png"),
        format!("{render} -o inner/up/inner/up/link.png"),
        format!("{render} -o $PWD/link.png"),
        format!("{render} -o eye.png --stereo"),
        format!("{render} -o x.png --depth hard.npy"),
        format!("{render} -o x.png --metrics link.json --config set.toml"),
        format!("{render} -o - >> a.las"),
        format!("{render} -o /dev/stdout >> b.las"),
        format!("{render} -o /dev/fd/3 3>> b.las"),
        format!("{view} --log link.csv --pose-path walk.poses"),
        format!("{view} --log walk.poses --pose-path link.csv"),
        "scanwalk report frames.csv -o link.html".into(),
        "scanwalk report ./frames.csv inner/up/frames.csv -o inner/up/link.html".into(),
        "scanwalk bench link.html -o link.html --points 1".into(),
        "scanwalk report frames.csv >> frames.csv".into(),
        "scanwalk info a.las >> a.las".into(),
    ] {
        let line = line.replace(" --points 1", "");
        let said = folder.refused(&line, 2);
        assert!(said.contains("which is read as") && said.contains("another file"), "{line}: {said}");
    }
    // The input need not exist, and no option need come last.
    let said = folder.refused("scanwalk render -o none.png none.png --size 8x8", 2);
    assert!(said.contains("none.png would be written over none.png"), "{said}");
}

#[test]
fn no_two_outputs_are_one_file() {
    let folder = TestFolder::new();
    symlink("x.poses", folder.path("same.html")).unwrap();
    for line in [
        "scanwalk render a.las -o - --depth -",
        "scanwalk render a.las -o /dev/stdout --metrics - | cat",
        "scanwalk render a.las -o x.png --depth x.d --metrics ./x.d",
        "scanwalk render a.las -o x.png --depth x.d --metrics X.D",
        "scanwalk report frames.csv -o same.html --worst-poses x.poses",
    ] {
        // The shell's last command counts in a pipe.
        let said = match line.strip_suffix(" | cat") {
            Some(line) => folder.refused(line, 2),
            None => folder.refused(line, 2),
        };
        assert!(said.contains("are the same file"), "{line}: {said}");
    }
}

#[test]
fn a_pattern_in_the_place_of_an_output_costs_no_file() {
    let folder = TestFolder::new();
    folder.put("before.csv", b"another log");
    for line in [
        "scanwalk render -o *.las --size 64x48",
        "scanwalk render -o x.png --depth *.las",
        "scanwalk render -o x.png --metrics *.las",
        "scanwalk view --headset off --window off --frames 2 --log *.las",
        "scanwalk report -o b*.csv frames.csv",
        "scanwalk report frames.csv --worst-poses *.toml",
        "scanwalk bench -o *.las",
    ] {
        let said = folder.refused(line, 2);
        assert!(said.contains("the shell put its first match here"), "{line}: {said}");
    }
}

#[test]
fn endings_that_say_something_else_are_refused() {
    let folder = TestFolder::new();
    for line in [
        "scanwalk render missing.las -o x.jpg",
        "scanwalk render missing.las -o x",
        "scanwalk render missing.las -o x.png.bak",
        "scanwalk report missing.csv -o report",
        "scanwalk bench -o tables.pdf",
        "scanwalk report frames.csv -o page.md",
        "scanwalk synth aerial -o x.e57",
        "scanwalk synth aerial -o x",
        "scanwalk synth aerial -o x.ply",
        "scanwalk synth aerial -o -",
        "scanwalk report missing.csv -o -",
        "scanwalk render missing.las -o - --stereo",
    ] {
        folder.refused(line, 2);
    }
    // The ending may be in any case.
    folder.run("scanwalk render a.las -o X.PNG --size 64x48").ok();
    assert!(fs::read(folder.path("X.PNG")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn places_where_nothing_can_be_written_are_found_before_reading() {
    let folder = TestFolder::new();
    fs::create_dir(folder.path("x.png")).unwrap();
    for (line, words) in [
        ("scanwalk render missing.las -o no/such/x.png", "no/such"),
        ("scanwalk render missing.las -o x.png", "is a folder"),
        ("scanwalk render missing.las -o new.png/", "is a folder"),
        ("scanwalk render missing.las -o a.las/y.png", "a.las/y.png"),
        ("scanwalk render missing.las -o y.png --depth no/such/y.npy", "no/such"),
        ("scanwalk view missing.las --log no/such/y.csv --headset off --window off", "no/such"),
        ("scanwalk synth aerial -o no/such/y.las", "no/such"),
        ("scanwalk report missing.csv -o no/such/y.html", "no/such"),
        ("scanwalk bench missing.las -o no/such/y.html", "no/such"),
    ] {
        let said = folder.refused(line, 1);
        assert!(said.contains(words) && !said.contains("missing"), "{line}: {said}");
    }
}

#[test]
fn stdout_takes_one_output_and_nothing_else() {
    let folder = TestFolder::new();
    let output = folder.run("scanwalk render a.las -o - --size 64x48 --metrics m.json");
    assert_eq!(Picture::decode(&output.ok().out).expect("a picture and nothing else").width, 64);
    assert!(folder.path("m.json").exists());
    let output = folder.run("scanwalk render a.las -o x.png --size 64x48 --metrics -");
    assert_eq!(output.json()["points"], 7);
    let output = folder.run("scanwalk render a.las -o /dev/null --size 4x2 --depth -");
    assert!(output.out.starts_with(b"\x93NUMPY") && output.out.len() == 128 + 4 * 8);
}

#[test]
fn a_pipe_and_a_link_are_written_through() {
    let folder = TestFolder::new();
    let pipe = program::named_pipe(folder.0.path(), "pipe.png");
    let run = Program::start(&mut folder.command("scanwalk render a.las -o pipe.png --size 64x48"));
    let mut picture = Vec::new();
    fs::File::open(&pipe).unwrap().read_to_end(&mut picture).unwrap();
    run.end().ok();
    assert!(picture.starts_with(b"\x89PNG"));
    symlink("inner/later.png", folder.path("dangling.png")).unwrap();
    folder.run("scanwalk render a.las -o dangling.png --size 64x48").ok();
    assert_eq!(fs::read_link(folder.path("dangling.png")).unwrap(), Path::new("inner/later.png"));
    assert!(fs::read(folder.path("inner/later.png")).unwrap() == picture, "the same picture");
}

/// Outputs of an earlier run, which the next run may replace.
const OLD: [(&str, &[u8]); 5] = [
    ("old.png", b"\x89PNG\r\n\x1a\n and so on"),
    ("old.npy", b"\x93NUMPY\x01\0v\0{'descr': '<f4', 'fortran_order': False, 'shape': (4, 3), }"),
    ("old.json", b"{\"gpu_bytes\": 7}"),
    ("old.csv", b"# scanwalk frame log, version 0.0.9"),
    ("old.html", b"<!DOCTYPE html><meta name=\"generator\" content=\"scanwalk 0.0.9\">"),
];

#[test]
fn a_failure_leaves_what_was_there() {
    let folder = TestFolder::new();
    folder.put("broken.las", b"LASF and then nothing");
    OLD.iter().for_each(|(name, bytes)| folder.put(name, bytes));
    for line in [
        "scanwalk render broken.las -o old.png --depth old.npy --metrics old.json",
        "scanwalk render a.las -o old.png --size 64x48 --metrics /dev/full",
        "scanwalk view broken.las --headset off --window off --log old.csv",
        "scanwalk report broken.las -o old.html",
        "scanwalk bench broken.las -o old.html",
    ] {
        folder.refused(line, 1);
        for (name, bytes) in OLD {
            assert_eq!(fs::read(folder.path(name)).unwrap(), bytes, "{line}: {name}");
        }
    }
}

/// A user's files are kept, though no command reads them: scans by any output, and files that are not of the output's
/// kind.
#[test]
fn what_a_user_has_is_replaced_only_where_it_is_an_older_output_or_by_force() {
    let folder = TestFolder::new();
    folder.put("mesh.ply", b"ply\nformat ascii 1.0\n");
    folder.put("photo.png", b"\xff\xd8\xff\xe0 a JPEG by another name");
    folder.put("package.json", b"{\"name\": \"mine\"}");
    folder.put("table.csv", b"x,y,z\n1,2,3\n");
    folder.put("site.html", b"<!DOCTYPE html><title>mine</title>");
    folder.put("notes", b"remember");
    symlink("b.las", folder.path("scan.png")).unwrap();
    symlink("mesh.ply", folder.path("mesh.json")).unwrap();
    let view = "scanwalk view a.las --headset off --window off --frames 2";
    for line in [
        "scanwalk synth aerial -o a.las --points 100",
        "scanwalk synth aerial -o inner/../b.las --points 100",
        "scanwalk synth photogrammetry -o mesh.ply --points 100",
        "scanwalk render a.las -o scan.png --size 64x48",
        "scanwalk render a.las -o photo.png --size 64x48",
        "scanwalk render a.las -o x.png --metrics mesh.json --size 64x48",
        "scanwalk render a.las -o x.png --metrics package.json --size 64x48",
        "scanwalk render a.las -o x.png --depth notes --size 64x48",
        &format!("{view} --log table.csv"),
        &format!("{view} --log notes"),
        "scanwalk report frames.csv -o site.html",
        "scanwalk report frames.csv --worst-poses notes",
    ] {
        let before: Vec<_> = folder.names().iter().map(fs::read).map(Result::ok).collect();
        let said = folder.refused(line, 2);
        assert!(said.contains("is there already") && said.contains("--force"), "{line}: {said}");
        assert!(folder.names().iter().map(fs::read).map(Result::ok).eq(before), "{line}");
    }
    // The same is allowed by force, except over what is read.
    for line in [
        "scanwalk --force synth aerial -o b.las --points 100",
        "scanwalk synth photogrammetry -o mesh.ply --points 100 --force",
        "scanwalk render a.las -o photo.png --metrics package.json --depth notes --size 64x48 --force",
        &format!("{view} --log table.csv --force"),
        "scanwalk report frames.csv -o site.html --force",
    ] {
        folder.run(line).ok();
    }
    for (name, start) in [("b.las", &b"LASF"[..]), ("photo.png", b"\x89PNG"), ("site.html", b"<!DOCTYPE")] {
        assert!(fs::read(folder.path(name)).unwrap().starts_with(start), "{name}");
    }
    let said = folder.refused("scanwalk render a.las -o link.png --size 64x48 --force", 2);
    assert!(said.contains("which is read as"), "{said}");
}

/// Every command runs twice with the same names; an empty file counts as none.
#[test]
fn outputs_of_an_earlier_run_are_replaced() {
    let folder = TestFolder::new();
    folder.put("empty.las", b"");
    for _ in 0..2 {
        for line in [
            "scanwalk render a.las -o x.png --depth x.npy --metrics x.json --size 64x48",
            "scanwalk view a.las --headset off --window off --frames 2 --log x.csv",
            "scanwalk report frames.csv -o x.html --worst-poses x.poses",
            "scanwalk report results.json -o x.md",
        ] {
            folder.put(
                "results.json",
                br#"{"device": "a GPU", "driver": "1", "copy_gb_per_s": 1, "rows": []}"#,
            );
            folder.run(line).ok();
        }
    }
    folder.run("scanwalk synth aerial -o empty.las --points 100").ok();
}

/// The limit stands in for a full disk: both end a write with an error.
#[test]
fn a_disk_that_fills_up_is_named_and_leaves_nothing() {
    let folder = TestFolder::new();
    folder.put("old.las", b"old");
    folder.put("old.laz", b"old");
    folder.put("old.ply", b"old");
    for (kind, name) in [("aerial", "old.las"), ("terrestrial", "old.laz"), ("photogrammetry", "old.ply")] {
        // The limit is 200 blocks of 512 bytes; the signal that comes with it is ignored.
        let line =
            format!("trap '' XFSZ; ulimit -f 200; scanwalk synth {kind} -o {name} --points 30000 --force");
        let before = folder.names();
        let output = program::run(&mut folder.shell(&line));
        let said = output.err;
        assert_eq!(output.code, Some(1), "{said}");
        assert!(said.contains(name) && said.contains("nothing was kept"), "{said}");
        assert_eq!(fs::read(folder.path(name)).unwrap(), b"old");
        assert_eq!(folder.names(), before);
    }
}

/// Asks a program that writes to end, once and twice, as soon as a part of the file is there.
#[test]
fn ctrl_c_leaves_no_half_file() {
    for signals in [1, 2] {
        let folder = TestFolder::new();
        folder.put("old.las", b"old");
        let before = folder.names();
        let line = "scanwalk synth aerial -o old.las --points 2000000000 --force";
        let mut run = Program::start(&mut folder.command(line));
        wait_for("a part of the file", || {
            assert!(run.is_running(), "it ended by itself");
            (folder.names() != before).then_some(())
        });
        run.interrupt();
        if signals == 2 {
            // The program has heard the first signal, or has ended.
            run.find(LONGEST_S, |said| said.err_text().contains("once more").then_some(()));
            run.interrupt();
        }
        let code = run.end().code;
        assert!(code == Some(1) || signals == 2 && code == Some(130), "{code:?}");
        assert_eq!(folder.names(), before, "after {signals} signals");
        assert_eq!(fs::read(folder.path("old.las")).unwrap(), b"old");
    }
}

#[test]
fn what_is_written_may_be_read_by_whom_the_mask_allows() {
    use std::os::unix::fs::PermissionsExt;
    let folder = TestFolder::new();
    let line = "umask 027; scanwalk report frames.csv -o page.html > /dev/null && touch plain";
    program::run(&mut folder.shell(line)).ok();
    let mode = |name: &str| fs::metadata(folder.path(name)).unwrap().permissions().mode();
    assert_eq!(mode("page.html"), mode("plain"));
    let mut page = fs::File::options().append(true).open(folder.path("page.html")).unwrap();
    page.write_all(b"whole").unwrap();
}
